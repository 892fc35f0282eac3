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

use crate::block::{Body, Kinematics};
use crate::numerics::dual::Dual;
use crate::numerics::scalar::{CombinesWith, Elementary, Scalar};

pub use tie::{LinkKind, MAX_TIES, Plastic, Tie, TieState, TieStates, Ties};

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

    /// Whether a restraint is a damper.
    pub fn has_dampers(&self) -> bool {
        let Restraints { ties } = self;
        ties.all().last().is_some_and(|tie| tie.kind == LinkKind::Damper)
    }

    /// Whether the restraint with this number pushes, too.
    pub fn pushes(&self, number: usize) -> bool {
        let Restraints { ties } = self;
        ties.all().get(number).is_some_and(|tie| tie.kind == LinkKind::Damper)
    }
}

/// Maximum number of restraints of a block.
pub const MAX: usize = MAX_TIES;

/// The states of the restraints without their memory. They decide the equations of motion.
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

    /// Returns the states in which no restraint but that with this number acts.
    pub fn only(self, number: usize) -> States<T> {
        let States { mut ties, plastic } = self;
        for (_, state) in ties.iter_mut().enumerate().filter(|(i, _)| *i != number) {
            *state = TieState::Slack;
        }
        States { ties, plastic }
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

    /// Returns the function whose value is the pull of a restraint, if it pulls.
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
    fn link<'a, P>(&self, body: &'a Body<P>, tie: u8) -> tie::Link<'a, P, T> {
        let i = usize::from(tie);
        tie::Link { tie: &body.ties()[i], state: self.ties[i], plastic: self.plastic.map(|all| all[i]) }
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
    /// Energy dissipated by dashpots and yielding of ties, or lost from springs of broken ties.
    pub ties: T,
    /// That of the dampers.
    pub dampers: T,
}

/// Number of kinds of restraints.
pub const KINDS: usize = 2;

impl<T> RestraintEnergies<T> {
    /// Returns the accounts as an array.
    #[inline(always)]
    pub fn into_array(self) -> [T; KINDS] {
        let RestraintEnergies { ties, dampers } = self;
        [ties, dampers]
    }

    /// Makes energies from the array of accounts.
    #[inline(always)]
    pub fn from_array([ties, dampers]: [T; KINDS]) -> RestraintEnergies<T> {
        RestraintEnergies { ties, dampers }
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
        let RestraintEnergies { ties, dampers } = self;
        *ties += others.ties;
        *dampers += others.dampers;
    }

    /// Returns `sum` plus all accounts, in their order.
    pub fn added_to(self, sum: f64) -> f64 {
        self.into_array().into_iter().fold(sum, |sum, account| sum + account)
    }

    /// Adds the energy lost in an event.
    pub fn lose(&mut self, event: RestraintEvent, energy: f64) {
        match event {
            RestraintEvent::Tie(LinkKind::Tie, ..) => self.ties += energy,
            RestraintEvent::Tie(LinkKind::Damper, ..) => self.dampers += energy,
        }
    }
}

/// Adds the pull of the restraints to a forcing `[x, z, moment]` per mass.
pub fn add_pull<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    states: &States<T>,
    kinematics: &Kinematics<T>,
    forcing: [T; 3],
) -> [T; 3] {
    let States { ties, plastic } = states;
    tie::pull::add_pull(body, ties, plastic, kinematics, forcing)
}

/// A restraint at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObservedRestraint<T = f64> {
    /// Pull (N), negative for a damper that pushes.
    pub pull: T,
    /// Elongation (m): the stretch s of [`tie::pull`], for a damper that from rest.
    pub elongation: T,
    /// Plastic elongation s_p (m), positive for a longer one.
    pub plastic: T,
}

impl<T> ObservedRestraint<T> {
    /// Returns the same number for each quantity.
    #[inline(always)]
    pub fn of_all(number: T) -> ObservedRestraint<T>
    where
        T: Copy,
    {
        ObservedRestraint { pull: number, elongation: number, plastic: number }
    }

    /// Returns the quantities converted by `f`.
    #[inline(always)]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> ObservedRestraint<U> {
        let ObservedRestraint { pull, elongation, plastic } = self;
        ObservedRestraint { pull: f(pull), elongation: f(elongation), plastic: f(plastic) }
    }
}

/// Returns the restraints at one instant, by their numbers.
pub fn observe<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    states: &States<T>,
    kinematics: &Kinematics<T>,
) -> [ObservedRestraint<T>; MAX] {
    let States { ties, plastic } = states;
    tie::pull::observe(body, ties, plastic, kinematics)
}

/// Returns the elongation (m) of the restraint with this number and its rate (m/s).
pub fn elongation<P: Scalar, T: CombinesWith<P>>(body: &Body<P>, kinematics: &Kinematics<T>, number: usize) -> Dual<T> {
    let stretch = tie::pull::stretch(body, &body.ties()[number], kinematics);
    Dual::new(stretch.length, stretch.rate)
}

/// Returns the plastic elongations of all restraints (m), also while they yield. Positive for longer ones.
pub fn plastic_elongations<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    states: &States<T>,
    kinematics: &Kinematics<T>,
) -> [T; MAX] {
    match states.plastic {
        None => [T::from(0.0); MAX],
        Some(_) => observe(body, states, kinematics).map(|restraint| restraint.plastic),
    }
}

/// Returns the strength (N) of the restraint with this number, if it can break.
pub fn strength<T: Elementary>(body: &Body<T>, number: usize) -> Option<T> {
    let strength = body.ties().get(number)?.strength;
    (strength.value() > 0.0).then_some(strength)
}

/// Returns the force (N) at first yielding of a restraint. 0 if it stays elastic.
pub fn yield_force<T: Elementary>(body: &Body<T>, number: usize) -> T {
    body.ties().get(number).map_or_else(|| T::from(0.0), |tie| tie.yield_force)
}

/// Returns a vertical force at rest less the pull of the restraints (N, positive up).
pub fn less_static_pull<T: Elementary>(body: &Body<T>, kinematics: &Kinematics<T>, force: T, rounding: f64) -> T {
    let Restraints { ties } = &body.restraints;
    tie::pull::less_static_pull(body, ties, kinematics, force, rounding)
}

/// Returns the vertical stiffness (N/m) of the restraints at rest.
pub fn static_stiffness<T: Elementary>(body: &Body<T>, kinematics: &Kinematics<T>, rounding: f64) -> f64 {
    let Restraints { ties } = &body.restraints;
    tie::pull::static_stiffness(body, ties, kinematics, rounding)
}

/// Returns a bound on the circular frequencies and decay rates that restraints add (rad/s).
pub fn fastest(body: &Body) -> f64 {
    let Restraints { ties } = &body.restraints;
    let [stiffness, damping] = tie::pull::stiffest(body, ties);
    stiffness.sqrt().max(damping)
}

/// Returns the circular frequencies and decay rates (rad/s) that single numbers of the restraints bring, by their names.
pub fn rates(body: &Body) -> Vec<(String, f64)> {
    let rates = tie::names(body.ties()).into_iter().zip(body.ties()).map(|(name, tie)| {
        let mobility = tie::pull::mobility(body, tie);
        let stiffness = (format!("{name}.stiffness"), (tie.stiffness * mobility).sqrt());
        [stiffness, (format!("{name}.damping"), tie.damping * mobility)]
    });
    rates.flatten().collect()
}

/// Returns the energy stored in the restraints per mass (m²/s²).
pub fn energy<P: Scalar, S: Copy, T: CombinesWith<P> + From<S>>(
    body: &Body<P>,
    states: &States<S>,
    kinematics: &Kinematics<T>,
) -> T {
    let States { ties, plastic } = states;
    tie::pull::energy(body, ties, plastic, kinematics)
}

/// Returns the powers per mass (m²/s³) dissipated by the restraints.
pub fn powers<P: Scalar, T: CombinesWith<P>>(
    body: &Body<P>,
    states: &States<T>,
    kinematics: &Kinematics<T>,
) -> RestraintEnergies<T> {
    let States { ties, plastic } = states;
    let power = |kind| tie::pull::power(body, ties, plastic, kinematics, kind);
    RestraintEnergies { ties: power(LinkKind::Tie), dampers: power(LinkKind::Damper) }
}

/// An event function of a restraint: positive until it falls through zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RestraintFunction {
    /// That of the tie with this index.
    Tie(u8, tie::TieFunction),
}

/// Maximum number of watched functions.
pub const WATCHED: usize = tie::switching::WATCHED * MAX_TIES;

/// Returns the watched functions of restraints in these modes.
pub fn watched(body: &Body, modes: &Modes) -> [Option<RestraintFunction>; WATCHED] {
    let (Modes { ties }, mut watched) = (modes, [None; WATCHED]);
    let (slots, _) = watched.as_chunks_mut::<{ tie::switching::WATCHED }>();
    let links = tie::links::<_, f64>(body, ties, &None).zip(slots).enumerate();
    for (i, (link, slots)) in links.filter(|(_, (link, _))| link.tie.is_present()) {
        *slots = tie::switching::watched(link)
            .map(|function| function.map(|function| RestraintFunction::Tie(i as u8, function)));
    }
    watched
}

/// Number of watched functions of the restraints with variables of the FMU, which come first.
pub const INDICATORS: usize = tie::switching::WATCHED * tie::VARIABLES;

impl RestraintFunction {
    /// Returns value and rate; `rates` has the rates of `kinematics` in the dual parts.
    pub fn sample<T: Elementary>(
        self,
        body: &Body<T>,
        states: &States<T>,
        kinematics: impl Fn() -> Kinematics<T>,
        rates: impl Fn() -> Kinematics<Dual<T>>,
    ) -> Dual<T>
    where
        Dual<T>: CombinesWith<T>,
    {
        match self {
            RestraintFunction::Tie(tie, function) => function.sample(body, states.link(body, tie), kinematics, rates),
        }
    }

    /// Returns the value.
    pub fn value<T: Elementary>(self, body: &Body<T>, states: &States<T>, kinematics: &Kinematics<T>) -> T {
        match self {
            RestraintFunction::Tie(tie, function) => function.value(body, states.link(body, tie), kinematics),
        }
    }

    /// Returns the size of its terms.
    pub fn size<T: Elementary>(self, body: &Body<T>) -> f64 {
        match self {
            RestraintFunction::Tie(tie, function) => function.size(body, &body.ties()[usize::from(tie)]),
        }
    }

    /// Whether value and rate follow from the state and its rate alone.
    pub fn follows_from_state(self) -> bool {
        match self {
            RestraintFunction::Tie(_, function) => function.follows_from_state(),
        }
    }

    /// Whether an impact changes the value.
    pub fn jumps_at_impacts(self) -> bool {
        match self {
            RestraintFunction::Tie(_, function) => function.jumps_at_impacts(),
        }
    }

    /// Whether the block has the restraint.
    pub fn is_of(self, body: &Body) -> bool {
        match self {
            RestraintFunction::Tie(tie, _) => usize::from(tie) < body.ties().len(),
        }
    }

    /// Changes the state of the restraint after this function has fallen through zero. `rounding` is the round-off of a zero over its largest
    /// term.
    pub fn switch<T: Elementary>(
        self,
        body: &Body<T>,
        states: &mut States<T>,
        kinematics: impl Fn() -> Kinematics<T>,
        rounding: f64,
    ) -> Option<RestraintEvent> {
        match self {
            RestraintFunction::Tie(tie, function) => {
                let (i, link) = (usize::from(tie), states.link(body, tie));
                let (state, event) = function.switched(body, link, &kinematics, rounding);
                if let Some(plastic) = &mut states.plastic {
                    plastic[i] = tie::pull::plastic(link, tie::pull::stretch(body, link.tie, &kinematics()).length);
                }
                states.ties[i] = state;
                event.map(|event| RestraintEvent::of_tie(body, i, event))
            }
        }
    }
}

/// Returns the states at the beginning of a run. `rounding` is the round-off of a zero over its largest term.
pub fn at_beginning<T: Elementary>(body: &Body<T>, kinematics: &Kinematics<T>, rounding: f64) -> States<T> {
    let Restraints { ties } = &body.restraints;
    let (ties, plastic) = tie::switching::at_beginning(body, ties, kinematics, rounding);
    States { ties, plastic }
}

/// A reported event of a restraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestraintEvent {
    /// That of the tie or damper with this index among its kind.
    Tie(LinkKind, u8, tie::TieEvent),
}

/// Returns the events by which restraints came into these states before a run began: those that yield or are broken.
pub fn events_at_beginning<T>(body: &Body<T>, states: &States<T>) -> impl Iterator<Item = RestraintEvent> {
    let States { ties, plastic: _ } = *states;
    let count = body.ties().len();
    (0..count).filter_map(move |i| Some(RestraintEvent::of_tie(body, i, ties[i].event_at_beginning()?)))
}

impl RestraintEvent {
    /// Returns an event of the tie with this index.
    fn of_tie<T>(body: &Body<T>, index: usize, event: tie::TieEvent) -> RestraintEvent {
        let kind = body.ties()[index].kind;
        let number = body.ties()[..index].iter().filter(|tie| tie.kind == kind).count() as u8;
        RestraintEvent::Tie(kind, number, event)
    }

    /// Returns its name in tables.
    pub fn word(self) -> &'static str {
        match self {
            RestraintEvent::Tie(_, _, event) => event.word(),
        }
    }

    /// Returns the name of the restraint, such as `tie 1`.
    pub fn location(self) -> Option<&'static str> {
        match self {
            RestraintEvent::Tie(kind, number, _) => kind.names().get(usize::from(number)).copied(),
        }
    }
}

impl std::fmt::Display for RestraintEvent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            RestraintEvent::Tie(kind, number, event) => write!(f, "{} {} {event}", kind.word(), number + 1),
        }
    }
}
