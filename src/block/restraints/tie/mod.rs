//! Ties and dampers between the block and the ground: their ends, stiffness, strength and yielding, and their states.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`pull`] | position and motion of the block → stretch and tension of a tie; its energy and power |
//! | [`switching`] | event functions of a tie → it is taut, slack or limp, yields, or breaks |
//!
//! A damper is a tie that also pushes. In tables both are ties.

pub mod pull;
pub mod switching;

use serde::{Deserialize, Serialize};

use crate::block::parameters::not_negative;
use crate::block::{Block, BlockError};
use crate::numerics::scalar::{Elementary, Scalar};

pub use switching::{TieEvent, TieFunction};

/// Maximum number of ties of a block.
pub const MAX_TIES: usize = 8;

/// [`MAX_TIES`], in errors.
const EXPECTED: &str = "at most 8 ties";

/// Names of the ties in tables of events.
pub const NAMES: [&str; MAX_TIES] = ["tie 1", "tie 2", "tie 3", "tie 4", "tie 5", "tie 6", "tie 7", "tie 8"];

/// Number of ties among the variables of the FMU.
pub const VARIABLES: usize = 2;

/// A tendon, guy or restrainer: pulls a point of the block towards a point of the ground, and never pushes.
///
/// Positions are relative to the middle of the base of the block at rest without ties (m), x to the right, z up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tie<T = f64> {
    /// End on the block, `[x, z]` (m).
    pub block: [T; 2],
    /// End on the ground, `[x, z]` (m).
    pub ground: [T; 2],
    /// Stiffness k (N/m); 0 means no tie.
    pub stiffness: T,
    /// Tension T0 (N) at the length at rest.
    pub pretension: T,
    /// Elongation (m) beyond the length at rest at which a tie without pretension begins to pull.
    pub slack: T,
    /// Damping c (N.s/m).
    pub damping: T,
    /// Tension (N) at which it breaks; 0 means that it does not break.
    pub strength: T,
}

/// The sense in which a tie acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LinkKind {
    /// It only pulls.
    #[default]
    Tie,
    /// It pulls and pushes.
    Damper,
}

/// The force law of a tie beyond its spring and dashpot: kind, and yielding with the kinematic hardening of W. Prager, "A new method of
/// analyzing stresses and strains in work-hardening plastic solids", Journal of Applied Mechanics 23 (1956), 493–496.
///
/// The force of the spring, positive in tension, stays between the lines `r k s ± (1 − r) F_y` over the stretch s of [`pull`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ForceLaw<T = f64> {
    /// The sense in which it acts.
    pub kind: LinkKind,
    /// Force F_y (N) of the spring, in tension and in compression, at which it yields first; 0 means that it stays elastic.
    pub yield_force: T,
    /// Stiffness while it yields over that before, r (1): at least 0, below 1.
    pub hardening: T,
}

impl<T> ForceLaw<T> {
    /// Returns the law with each number converted by `f`.
    pub fn map<U>(self, f: impl Fn(T) -> U) -> ForceLaw<U> {
        ForceLaw { kind: self.kind, yield_force: f(self.yield_force), hardening: f(self.hardening) }
    }
}

impl<T: Scalar<Real = f64>> ForceLaw<T> {
    /// Whether the tie can yield.
    pub fn yields(&self) -> bool {
        self.yield_force.value() > 0.0
    }
}

impl ForceLaw {
    /// Refuses an impossible law. An error names the parameter.
    pub fn check(&self) -> Result<(), BlockError> {
        not_negative("yield force of a tie", self.yield_force)?;
        match (0.0..1.0).contains(&self.hardening) {
            true => Ok(()),
            false => Err(BlockError::OutOfRange {
                name: "hardening of a tie",
                value: self.hardening,
                expected: "a ratio of stiffnesses from 0 to below 1",
            }),
        }
    }
}

/// The ties of a block, at most [`MAX_TIES`]. A step of lanes, which makes blocks, writes nothing for [`Ties::Nothing`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ties<T = f64> {
    /// No tie.
    Nothing,
    /// The first `count` of an array.
    Some {
        /// The ties, and copies of the last one.
        ties: [Tie<T>; MAX_TIES],
        /// Their force laws.
        laws: [ForceLaw<T>; MAX_TIES],
        /// Their number.
        count: usize,
    },
}

impl<T: Copy + Default> Ties<T> {
    /// Makes elastic ties of the first [`MAX_TIES`] of a list, without checks.
    pub fn of(ties: &[Tie<T>]) -> Ties<T> {
        Ties::with_laws(ties, &[])
    }

    /// Makes ties with these force laws of the first [`MAX_TIES`] of a list, without checks. Ties beyond the list of laws are elastic.
    pub fn with_laws(ties: &[Tie<T>], laws: &[ForceLaw<T>]) -> Ties<T> {
        let Some(&last) = ties.last() else { return Ties::Nothing };
        Ties::Some {
            ties: std::array::from_fn(|number| ties.get(number).copied().unwrap_or(last)),
            laws: std::array::from_fn(|number| laws.get(number).copied().unwrap_or_default()),
            count: ties.len().min(MAX_TIES),
        }
    }
}

impl<T> Ties<T> {
    /// Returns the ties.
    #[inline(always)]
    pub fn all(&self) -> &[Tie<T>] {
        match self {
            Ties::Nothing => &[],
            Ties::Some { ties, count, .. } => &ties[..(*count).min(MAX_TIES)],
        }
    }

    /// Returns the force laws of the ties.
    pub fn laws(&self) -> &[ForceLaw<T>] {
        match self {
            Ties::Nothing => &[],
            Ties::Some { laws, count, .. } => &laws[..(*count).min(MAX_TIES)],
        }
    }

    /// Whether there is no tie.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        matches!(self, Ties::Nothing)
    }
}

impl<T: Copy> Tie<T> {
    /// Returns the tie with each number converted by `f`.
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> Tie<U> {
        Tie {
            block: self.block.map(&f),
            ground: self.ground.map(&f),
            stiffness: f(self.stiffness),
            pretension: f(self.pretension),
            slack: f(self.slack),
            damping: f(self.damping),
            strength: f(self.strength),
        }
    }
}

/// Names and units of the numbers of a tie, in the order of [`Tie::numbers`]. Users everywhere write them so.
pub const NUMBERS: [(&str, &str); 9] = [
    ("block_x", "m"),
    ("block_z", "m"),
    ("ground_x", "m"),
    ("ground_z", "m"),
    ("stiffness", "N/m"),
    ("pretension", "N"),
    ("slack", "m"),
    ("damping", "N.s/m"),
    ("strength", "N"),
];

impl<T> Tie<T> {
    /// Returns its numbers in the order of [`NUMBERS`].
    pub fn numbers(&mut self) -> [&mut T; NUMBERS.len()] {
        let Tie { block, ground, stiffness, pretension, slack, damping, strength } = self;
        let ([block_x, block_z], [ground_x, ground_z]) = (block, ground);
        [block_x, block_z, ground_x, ground_z, stiffness, pretension, slack, damping, strength]
    }

    /// Returns the number with a name of [`NUMBERS`].
    pub fn number(&mut self, name: &str) -> Option<&mut T> {
        NUMBERS.into_iter().zip(self.numbers()).find_map(|((known, _), number)| (known == name).then_some(number))
    }
}

impl<T: Copy> Tie<T> {
    /// Returns its numbers with their names.
    pub fn named(mut self) -> [(&'static str, T); NUMBERS.len()] {
        let numbers = self.numbers();
        std::array::from_fn(|i| (NUMBERS[i].0, *numbers[i]))
    }
}

impl<T: Elementary> Tie<T> {
    /// Returns the distance of its ends at rest (m).
    pub fn length(&self) -> T {
        (self.block[0] - self.ground[0]).hypot(self.block[1] - self.ground[1])
    }
}

impl Tie {
    /// Refuses an impossible tie. An error names the parameter.
    pub fn check(&self) -> Result<(), BlockError> {
        let Tie { block, ground, stiffness, pretension, slack, damping, strength } = *self;
        for (name, value) in [
            ("stiffness of a tie", stiffness),
            ("pretension of a tie", pretension),
            ("slack of a tie", slack),
            ("damping of a tie", damping),
            ("strength of a tie", strength),
        ] {
            not_negative(name, value)?;
        }
        for (name, value) in
            [("block_x", block[0]), ("block_z", block[1]), ("ground_x", ground[0]), ("ground_z", ground[1])]
        {
            if !value.is_finite() {
                return Err(BlockError::OutOfRange { name, value, expected: "a finite number" });
            }
        }
        if stiffness > 0.0 && self.length() <= 0.0 {
            return Err(BlockError::OutOfRange {
                name: "length of a tie",
                value: self.length(),
                expected: "a distance of its ends above 0",
            });
        }
        Ok(())
    }
}

impl Block {
    /// Returns the block with these ties, at most [`MAX_TIES`]. An error names the first invalid parameter.
    pub fn with_ties(mut self, ties: &[Tie]) -> Result<Block, BlockError> {
        if ties.len() > MAX_TIES {
            return Err(BlockError::OutOfRange { name: "ties", value: ties.len() as f64, expected: EXPECTED });
        }
        ties.iter().try_for_each(Tie::check)?;
        self.restraints.ties = Ties::of(ties);
        Ok(self)
    }

    /// Returns the block with these ties and dampers, at most [`MAX_TIES`], instead of its ties. An error names the first invalid parameter.
    ///
    /// The FMU has no parameters of force laws: a block whose ties yield is stepped by [`Simulation`](crate::simulation::Simulation) alone.
    pub fn with_links(self, links: &[(Tie, ForceLaw)]) -> Result<Block, BlockError> {
        let (ties, laws): (Vec<Tie>, Vec<ForceLaw>) = links.iter().copied().unzip();
        let mut block = self.with_ties(&ties)?;
        laws.iter().try_for_each(ForceLaw::check)?;
        block.restraints.ties = Ties::with_laws(&ties, &laws);
        Ok(block)
    }
}

impl<T> Block<T> {
    /// Returns its ties.
    #[inline(always)]
    pub fn ties(&self) -> &[Tie<T>] {
        self.restraints.ties.all()
    }
}

/// The state of a tie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TieState {
    /// Too short to pull, or absent.
    #[default]
    Slack,
    /// Pulling, or pushing, without yielding.
    Taut,
    /// Yielding in this direction.
    Yields(YieldDirection),
    /// Stretched, but shortening so fast that dashpot and spring together would push.
    Limp,
    /// Broken.
    Broken,
}

/// The direction in which a tie yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum YieldDirection {
    /// It becomes longer.
    Longer,
    /// It becomes shorter.
    Shorter,
}

impl YieldDirection {
    /// Returns the sign σ of the rate of the plastic elongation.
    pub fn sign(self) -> f64 {
        match self {
            YieldDirection::Longer => 1.0,
            YieldDirection::Shorter => -1.0,
        }
    }
}

/// A tie with its force law and its state.
#[derive(Clone, Copy, Debug)]
pub struct Link<'a, P, S> {
    /// The tie.
    pub tie: &'a Tie<P>,
    /// Its force law.
    pub law: &'a ForceLaw<P>,
    /// Its state.
    pub state: TieState,
    /// Its plastic elongation s_p (m) unless it yields; `None` if no tie of the block can yield.
    pub plastic: Option<S>,
}

/// The plastic elongations s_p (m) of ties at the end of their last yielding, positive for longer ones; `None` if none can yield.
pub type Plastic<T> = Option<[T; MAX_TIES]>;

/// Returns the ties of a block with their numbers and states.
pub fn links<'a, P, S: Copy>(
    block: &'a Block<P>,
    states: &TieStates,
    plastic: &Plastic<S>,
) -> impl Iterator<Item = Link<'a, P, S>> {
    let ties = &block.restraints.ties;
    let both = ties.all().iter().zip(ties.laws()).enumerate();
    both.map(|(i, (tie, law))| Link { tie, law, state: states[i], plastic: plastic.map(|all| all[i]) })
}

/// The states of all ties of a block.
pub type TieStates = [TieState; MAX_TIES];

/// All ties slack.
pub const NO_TIES: TieStates = [TieState::Slack; MAX_TIES];
