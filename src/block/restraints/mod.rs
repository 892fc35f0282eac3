//! Restraints: forces between block and ground that switch on and off, a folder for each kind.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`tie`] | position and motion of the block → its pull; stretch and tension → whether it pulls, or breaks |
//!
//! A kind has parameters, a state, a pull, energies, and event functions that change the state. The functions here name the kinds: each
//! destructures [`Restraints`] or [`States`], or matches [`RestraintFunction`] or [`RestraintEvent`], so that the compiler lists them when a kind is added.
//! All other modules know restraints only through them. Each restraint has a number below [`MAX`].

pub mod tie;

use serde::{Deserialize, Serialize};

use crate::block::{Block, Kinematics};
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};

pub use tie::{ForceLaw, LinkKind, MAX_TIES, Plastic, Tie, TieState, TieStates, Ties};

/// The restraints of a block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Restraints<T = f64> {
    /// The ties.
    pub ties: Ties<T>,
}

impl<T> Restraints<T> {
    /// Returns no restraints.
    #[inline(always)]
    pub fn none() -> Restraints<T> {
        Restraints { ties: Ties::Nothing }
    }

    /// Whether the block has no restraint.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        let Restraints { ties } = self;
        ties.is_empty()
    }

    /// Returns the numbers of the restraints.
    #[inline(always)]
    pub fn numbers(&self) -> impl Iterator<Item = usize> + use<T> {
        let Restraints { ties } = self;
        0..ties.all().len()
    }

    /// Whether the restraint with this number pushes, too.
    pub fn pushes(&self, number: usize) -> bool {
        let Restraints { ties } = self;
        ties.laws().get(number).is_some_and(|law| law.kind == LinkKind::Damper)
    }
}

/// Maximum number of restraints of a block.
pub const MAX: usize = MAX_TIES;

/// The states of the restraints of a block without their memory: they decide the equations of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Modes {
    /// The states of the ties.
    pub ties: TieStates,
}

/// The states of all restraints of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct States<T = f64> {
    /// The states of the ties.
    pub ties: TieStates,
    /// Their plastic elongations (m).
    pub plastic: Plastic<T>,
}

impl<T> States<T> {
    /// No restraint acts.
    pub const NONE: States<T> = States { ties: tie::NO_TIES, plastic: None };

    /// Returns the states without their memory.
    #[inline(always)]
    pub fn modes(&self) -> Modes {
        let States { ties, plastic: _ } = self;
        Modes { ties: *ties }
    }

    /// Returns the memory with other modes.
    #[inline(always)]
    pub fn under(self, modes: Modes) -> States<T> {
        let Modes { ties } = modes;
        States { ties, ..self }
    }

    /// Returns the states with each number converted by `f`.
    #[inline(always)]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> States<U> {
        let States { ties, plastic } = self;
        States { ties, plastic: plastic.map(|all| all.map(f)) }
    }

    /// Whether a restraint pulls.
    #[inline(always)]
    pub fn pull(&self) -> bool {
        let States { ties, plastic: _ } = self;
        tie::pull::pulls(ties)
    }

    /// Whether a restraint takes energy.
    #[inline(always)]
    pub fn dissipate(&self) -> bool {
        let States { ties, plastic: _ } = self;
        tie::pull::dissipates(ties)
    }

    /// Returns the function whose value is the pull of the restraint with this number, if it pulls.
    pub fn pull_of(&self, number: usize) -> Option<RestraintFunction> {
        let States { ties, plastic: _ } = self;
        let function = tie::switching::of_pull(*ties.get(number)?)?;
        Some(RestraintFunction::Tie(number as u8, function))
    }
}

impl<T: Copy> States<T> {
    /// Takes the modes of `run`, and its numbers by `set`. Returns whether the modes were the same.
    pub fn adopt_values(&mut self, run: &States, set: impl Fn(&mut T, f64)) -> bool {
        let alike = self.modes() == run.modes() && self.plastic.is_some() == run.plastic.is_some();
        let States { ties, plastic } = run;
        self.ties = *ties;
        for (number, value) in self.plastic.iter_mut().flatten().zip(plastic.iter().flatten()) {
            set(number, *value);
        }
        alike
    }

    /// Returns the tie with this index.
    fn link<'a, P>(&self, block: &'a Block<P>, tie: u8) -> tie::Link<'a, P, T> {
        let (i, ties) = (usize::from(tie), &block.restraints.ties);
        let plastic = self.plastic.map(|all| all[i]);
        tie::Link { tie: &ties.all()[i], law: &ties.laws()[i], state: self.ties[i], plastic }
    }
}

impl States {
    /// Whether all numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.plastic.iter().flatten().all(|plastic| plastic.is_finite())
    }
}

/// Energies or powers, one account for each kind of restraint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RestraintEnergies<T = f64> {
    /// Energy dissipated by the dashpots and by the yielding of the ties, and lost from the springs of broken ties.
    pub ties: T,
}

/// Number of kinds of restraints.
pub const KINDS: usize = 1;

impl<T> RestraintEnergies<T> {
    /// Returns the accounts as an array.
    #[inline(always)]
    pub fn into_array(self) -> [T; KINDS] {
        let RestraintEnergies { ties } = self;
        [ties]
    }

    /// Makes energies from the array of accounts.
    #[inline(always)]
    pub fn from_array([ties]: [T; KINDS]) -> RestraintEnergies<T> {
        RestraintEnergies { ties }
    }

    /// Returns the same number in each account.
    #[inline(always)]
    pub fn of_all(number: T) -> RestraintEnergies<T>
    where
        T: Copy,
    {
        RestraintEnergies::from_array([number; KINDS])
    }

    /// Applies `f` to each account.
    #[inline(always)]
    pub fn map<U>(self, f: impl FnMut(T) -> U) -> RestraintEnergies<U> {
        RestraintEnergies::from_array(self.into_array().map(f))
    }
}

impl RestraintEnergies {
    /// Adds `others`, account by account.
    pub fn add(&mut self, others: RestraintEnergies) {
        let RestraintEnergies { ties } = self;
        *ties += others.ties;
    }

    /// Returns `sum` plus all accounts, in their order.
    pub fn added_to(self, sum: f64) -> f64 {
        self.into_array().into_iter().fold(sum, |sum, account| sum + account)
    }

    /// Adds the energy lost in an event.
    pub fn lose(&mut self, event: RestraintEvent, energy: f64) {
        match event {
            RestraintEvent::Tie(..) => self.ties += energy,
        }
    }
}

/// Adds the pull of the restraints to a forcing `[x, z, moment]` per mass.
pub fn add_pull<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &States<T>,
    kinematics: &Kinematics<T>,
    forcing: [T; 3],
) -> [T; 3] {
    let States { ties, plastic } = states;
    tie::pull::add_pull(block, ties, plastic, kinematics, forcing)
}

/// Returns the pulls of all restraints (N), by their numbers.
pub fn pulls<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &States<T>,
    kinematics: &Kinematics<T>,
) -> [T; MAX] {
    let States { ties, plastic } = states;
    tie::pull::tensions(block, ties, plastic, kinematics)
}

/// Returns the plastic elongations of all restraints (m), by their numbers, positive for longer ones, also while they yield.
pub fn plastic_elongations(block: &Block, states: &States, kinematics: &Kinematics<f64>) -> [f64; MAX] {
    let States { ties, plastic } = states;
    let mut all = [0.0; MAX];
    for (value, link) in all.iter_mut().zip(tie::links(block, ties, plastic)) {
        *value = tie::pull::plastic(link, tie::pull::stretch(block, link.tie, kinematics).length);
    }
    all
}

/// Returns the strength (N) of the restraint with this number, if it can break.
pub fn strength<T: Elementary>(block: &Block<T>, number: usize) -> Option<T> {
    let strength = block.ties().get(number)?.strength;
    (strength.value() > 0.0).then_some(strength)
}

/// Returns a vertical force on the block at rest (N, positive up) less the pull of the restraints.
pub fn less_static_pull<T: Elementary>(block: &Block<T>, kinematics: &Kinematics<T>, force: T) -> T {
    let Restraints { ties } = &block.restraints;
    tie::pull::less_static_pull(block, ties, kinematics, force)
}

/// Returns the vertical stiffness (N/m) of the restraints at rest.
pub fn static_stiffness<T: Elementary>(block: &Block<T>, kinematics: &Kinematics<T>) -> f64 {
    let Restraints { ties } = &block.restraints;
    tie::pull::static_stiffness(block, ties, kinematics)
}

/// Returns a bound on the circular frequencies and decay rates that the restraints add to the block (rad/s).
pub fn fastest(block: &Block) -> f64 {
    let Restraints { ties } = &block.restraints;
    let [stiffness, damping] = tie::pull::stiffest(block, ties);
    stiffness.sqrt().max(damping)
}

/// Returns the energy stored in the restraints per mass (m²/s²).
pub fn energy<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(
    block: &Block<P>,
    states: &States<S>,
    kinematics: &Kinematics<T>,
) -> T {
    let States { ties, plastic } = states;
    tie::pull::energy(block, ties, plastic, kinematics)
}

/// Returns the powers per mass (m²/s³) dissipated by the restraints.
pub fn powers<P: Scalar, T: CombinesWith<P>>(
    block: &Block<P>,
    states: &States<T>,
    kinematics: &Kinematics<T>,
) -> RestraintEnergies<T> {
    let States { ties, plastic } = states;
    RestraintEnergies { ties: tie::pull::power(block, ties, plastic, kinematics) }
}

/// An event function of a restraint: positive until it falls through zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RestraintFunction {
    /// That of the tie with this index.
    Tie(u8, tie::TieFunction),
}

/// Maximum number of watched functions.
pub const WATCHED: usize = 4 * MAX_TIES;

/// Returns the watched functions of restraints in these modes: those of pulling and breaking first, then those of yielding.
pub fn watched(block: &Block, modes: &Modes) -> [Option<RestraintFunction>; WATCHED] {
    let (Modes { ties }, mut watched) = (modes, [None; WATCHED]);
    let links = tie::links::<_, f64>(block, ties, &None).enumerate();
    for (i, link) in links.filter(|(_, link)| link.tie.stiffness > 0.0) {
        for (part, of_tie) in tie::switching::watched(link).into_iter().enumerate() {
            let first = 2 * (part * MAX_TIES + i);
            [watched[first], watched[first + 1]] =
                of_tie.map(|function| function.map(|function| RestraintFunction::Tie(i as u8, function)));
        }
    }
    watched
}

/// Number of watched functions of the restraints among the variables of the FMU, which come first.
pub const INDICATORS: usize = 2 * tie::VARIABLES;

impl RestraintFunction {
    /// Returns value and rate; `rates` has the rates of `kinematics` in the dual parts.
    pub fn sample<T: Elementary>(
        self,
        block: &Block<T>,
        states: &States<T>,
        kinematics: impl Fn() -> Kinematics<T>,
        rates: impl Fn() -> Kinematics<Dual<T>>,
    ) -> Sample<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        match self {
            RestraintFunction::Tie(tie, function) => function.sample(block, states.link(block, tie), kinematics, rates),
        }
    }

    /// Returns the value.
    pub fn value<T: Elementary>(self, block: &Block<T>, states: &States<T>, kinematics: &Kinematics<T>) -> T {
        match self {
            RestraintFunction::Tie(tie, function) => function.value(block, states.link(block, tie), kinematics),
        }
    }

    /// Returns the size of its terms.
    pub fn size<T: Elementary>(self, block: &Block<T>) -> f64 {
        match self {
            RestraintFunction::Tie(tie, function) => function.size(block, &block.ties()[usize::from(tie)]),
        }
    }

    /// Whether value and rate follow from the state and its rate alone.
    pub fn follows_from_state(self) -> bool {
        match self {
            RestraintFunction::Tie(_, function) => function.follows_from_state(),
        }
    }

    /// Whether the block has the restraint.
    pub fn is_of(self, block: &Block) -> bool {
        match self {
            RestraintFunction::Tie(tie, _) => usize::from(tie) < block.ties().len(),
        }
    }

    /// Changes the state of the restraint after this function has fallen through zero.
    pub fn switch<T: Elementary>(
        self,
        block: &Block<T>,
        states: &mut States<T>,
        kinematics: impl Fn() -> Kinematics<T>,
    ) -> Option<RestraintEvent> {
        match self {
            RestraintFunction::Tie(tie, function) => {
                let (i, link) = (usize::from(tie), states.link(block, tie));
                let (state, event) = function.switched(block, link, &kinematics);
                if let Some(plastic) = &mut states.plastic {
                    plastic[i] = tie::pull::plastic(link, tie::pull::stretch(block, link.tie, &kinematics()).length);
                }
                states.ties[i] = state;
                event.map(|event| RestraintEvent::Tie(tie, event))
            }
        }
    }
}

/// Returns the states at the beginning of a run; `rounding` is the round-off of a zero relative to its largest term.
pub fn at_beginning<T: Elementary>(block: &Block<T>, kinematics: &Kinematics<T>, rounding: f64) -> States<T> {
    let Restraints { ties } = &block.restraints;
    let (ties, plastic) = tie::switching::at_beginning(block, ties, kinematics, rounding);
    States { ties, plastic }
}

/// A reported event of a restraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestraintEvent {
    /// That of the tie with this index.
    Tie(u8, tie::TieEvent),
}

impl RestraintEvent {
    /// Returns its name in tables.
    pub fn word(self) -> &'static str {
        match self {
            RestraintEvent::Tie(_, event) => event.word(),
        }
    }

    /// Returns the name of the restraint, such as `tie 1`.
    pub fn location(self) -> Option<&'static str> {
        match self {
            RestraintEvent::Tie(tie, _) => tie::NAMES.get(usize::from(tie)).copied(),
        }
    }
}

impl std::fmt::Display for RestraintEvent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            RestraintEvent::Tie(tie, event) => write!(f, "tie {} {event}", tie + 1),
        }
    }
}
