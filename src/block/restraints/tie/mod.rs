//! Ties and dampers between the block and the ground: their ends, stiffness, strength and yielding, and their states.
//!
//! | module | in → out |
//! | --- | --- |
//! | [`pull`] | position and motion of the block → stretch and tension of a tie; its energy and power |
//! | `switching` | event functions of a tie → it is taut, slack or limp, yields, or breaks |
//!
//! A damper is a tie that also pushes.

pub mod pull;
pub(crate) mod switching;

use serde::{Deserialize, Serialize};

use crate::block::parameters::Valid;
use crate::block::{Block, BlockError, Body};
use crate::numerics::scalar::{Elementary, Scalar};

pub use switching::{TieEvent, TieFunction};

/// Maximum number of ties of a block.
pub const MAX_TIES: usize = 8;

/// [`MAX_TIES`], in errors.
const EXPECTED: &str = "at most 8 ties and dampers";

/// Names of the ties in tables of events.
const TIES: [&str; MAX_TIES] = ["tie 1", "tie 2", "tie 3", "tie 4", "tie 5", "tie 6", "tie 7", "tie 8"];

/// Names of the dampers in tables of events.
const DAMPERS: [&str; MAX_TIES] =
    ["damper 1", "damper 2", "damper 3", "damper 4", "damper 5", "damper 6", "damper 7", "damper 8"];

/// Number of ties and dampers among the variables of the FMU: two of each.
pub const VARIABLES: usize = 4;

/// A tendon, guy or restrainer, or a damper. The first pull a point of the block towards a point of the ground and never push; a damper
/// does both.
///
/// The force of the spring, positive in tension, stays between the lines `r k s ± (1 − r) F_y` over the stretch s of [`pull`]: kinematic
/// hardening after W. Prager, "A new method of analyzing stresses and strains in work-hardening plastic solids", Journal of Applied
/// Mechanics 23 (1956), 493–496.
///
/// Positions are relative to the middle of the base of the block at rest without ties (m), x to the right, z up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tie<T = f64> {
    /// End on the block, `[x, z]` (m).
    pub block: [T; 2],
    /// End on the ground, `[x, z]` (m).
    pub ground: [T; 2],
    /// Stiffness k (N/m). Without it there is no tie, and a damper is a dashpot, if it has a damping.
    pub stiffness: T,
    /// Tension T0 (N) at the length at rest.
    pub pretension: T,
    /// Elongation (m) beyond rest at which a tie without pretension begins to pull.
    pub slack: T,
    /// Damping c (N.s/m).
    pub damping: T,
    /// Tension (N) at which it breaks, of a damper also the compression. It does not break if 0.
    pub strength: T,
    /// Force F_y (N) of the spring at first yielding, in tension and in compression. It stays elastic if 0.
    pub yield_force: T,
    /// Stiffness while it yields over that before, r (1): at least 0, below 1.
    pub hardening: T,
    /// The sense in which it acts.
    pub kind: LinkKind,
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

/// The ties of a block, at most [`MAX_TIES`]. A step of lanes, which makes blocks, writes nothing for [`Ties::Nothing`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ties<T = f64> {
    /// No tie.
    Nothing,
    /// The first `count` of an array.
    Some {
        /// The ties, and copies of the last one.
        ties: [Tie<T>; MAX_TIES],
        /// Their number.
        count: usize,
    },
}

impl<T: Copy> Ties<T> {
    /// Makes ties of the first [`MAX_TIES`] of a list, without checks. Ties are numbered before dampers.
    pub fn of(ties: &[Tie<T>]) -> Ties<T> {
        let Some(&last) = ties.last() else { return Ties::Nothing };
        let of_kind = |kind| ties.iter().filter(move |tie| tie.kind == kind);
        let mut ordered = [last; MAX_TIES];
        for (slot, tie) in ordered.iter_mut().zip(LinkKind::ALL.into_iter().flat_map(of_kind)) {
            *slot = *tie;
        }
        Ties::Some { ties: ordered, count: ties.len().min(MAX_TIES) }
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
            yield_force: f(self.yield_force),
            hardening: f(self.hardening),
            kind: self.kind,
        }
    }
}

impl<T: Scalar<Real = f64>> Tie<T> {
    /// Whether it acts: it has a stiffness, or is a dashpot.
    pub fn is_present(&self) -> bool {
        let is_dashpot = self.kind == LinkKind::Damper && self.damping.value() > 0.0;
        self.stiffness.value() > 0.0 || is_dashpot
    }

    /// Whether it can yield.
    pub fn yields(&self) -> bool {
        self.yield_force.value() > 0.0 && self.stiffness.value() > 0.0
    }
}

impl Tie {
    /// Whether it pulls even at a length of zero. Its pretension stretches it by its length at rest or more, as a weight over a pulley does.
    pub fn pulls_without_length(&self) -> bool {
        self.stiffness > 0.0 && self.pretension > self.stiffness * (self.length() + self.slack)
    }
}

/// Returns the names of ties and dampers, such as `tie_1`, each numbered within its kind.
pub fn names<T>(ties: &[Tie<T>]) -> Vec<String> {
    let number = |i: usize, kind| ties[..=i].iter().filter(|tie| tie.kind == kind).count();
    ties.iter().enumerate().map(|(i, tie)| format!("{}_{}", tie.kind.word(), number(i, tie.kind))).collect()
}

/// A number of a tie as users give it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkNumber {
    /// Its name, the same in options, variables, tables and Python.
    pub name: &'static str,
    /// Its quantity, with its unit and its limits.
    pub quantity: Quantity,
    /// Whether dampers have it, too.
    pub is_of_dampers: bool,
}

/// The quantity of a number of a tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A coordinate of an end, of either sign.
    Coordinate,
    /// A length of at least 0.
    Length,
    /// A force of at least 0.
    Force,
    /// A stiffness of at least 0.
    Stiffness,
    /// A damping of at least 0.
    Damping,
    /// A ratio from 0 to below 1.
    Ratio,
}

impl Quantity {
    /// Returns the unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Quantity::Coordinate | Quantity::Length => "m",
            Quantity::Force => "N",
            Quantity::Stiffness => "N/m",
            Quantity::Damping => "N.s/m",
            Quantity::Ratio => "1",
        }
    }
}

/// Returns the number that a path such as `tie_1.slack` names.
pub fn number_of_path(path: &str) -> Option<LinkNumber> {
    let (link, name) = path.split_once('.')?;
    let kind = LinkKind::ALL.into_iter().find(|kind| link.starts_with(kind.word()))?;
    kind.numbers().find(|number| number.name == name)
}

/// The numbers of a tie in the order of [`Tie::numbers`]. A damper, which is never slack, has no pretension and no slack.
pub const NUMBERS: [LinkNumber; 11] = {
    const fn number(name: &'static str, quantity: Quantity) -> LinkNumber {
        LinkNumber { name, quantity, is_of_dampers: true }
    }
    const fn of_ties_only(number: LinkNumber) -> LinkNumber {
        LinkNumber { is_of_dampers: false, ..number }
    }
    [
        number("block_x", Quantity::Coordinate),
        number("block_z", Quantity::Coordinate),
        number("ground_x", Quantity::Coordinate),
        number("ground_z", Quantity::Coordinate),
        number("stiffness", Quantity::Stiffness),
        of_ties_only(number("pretension", Quantity::Force)),
        of_ties_only(number("slack", Quantity::Length)),
        number("damping", Quantity::Damping),
        number("strength", Quantity::Force),
        number("yield_force", Quantity::Force),
        number("hardening", Quantity::Ratio),
    ]
};

impl LinkKind {
    /// All kinds.
    pub const ALL: [LinkKind; 2] = [LinkKind::Tie, LinkKind::Damper];

    /// Returns its name in tables, messages and study files.
    pub fn word(self) -> &'static str {
        match self {
            LinkKind::Tie => "tie",
            LinkKind::Damper => "damper",
        }
    }

    /// Returns the name of its force in tables: a tie has a tension.
    pub fn force(self) -> &'static str {
        match self {
            LinkKind::Tie => "tension",
            LinkKind::Damper => "force",
        }
    }

    /// Returns the names of its ties in tables of events.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            LinkKind::Tie => &TIES,
            LinkKind::Damper => &DAMPERS,
        }
    }

    /// Returns the [`NUMBERS`] that users give of it.
    pub fn numbers(self) -> impl Iterator<Item = LinkNumber> {
        NUMBERS.into_iter().filter(move |number| self == LinkKind::Tie || number.is_of_dampers)
    }
}

impl<T> Tie<T> {
    /// Returns its numbers in the order of [`NUMBERS`].
    pub fn numbers(&mut self) -> [&mut T; NUMBERS.len()] {
        let Tie { block, ground, stiffness, pretension, slack, damping, strength, yield_force, hardening, kind: _ } =
            self;
        let ([block_x, block_z], [ground_x, ground_z]) = (block, ground);
        [block_x, block_z, ground_x, ground_z, stiffness, pretension, slack, damping, strength, yield_force, hardening]
    }

    /// Returns the number with a name that users give of this kind.
    pub fn number(&mut self, name: &str) -> Option<&mut T> {
        self.kind.numbers().find(|known| known.name == name)?;
        NUMBERS.into_iter().zip(self.numbers()).find_map(|(known, number)| (known.name == name).then_some(number))
    }
}

impl<T: Copy> Tie<T> {
    /// Returns the numbers that users give of its kind, with their names.
    pub fn named(mut self) -> impl Iterator<Item = (&'static str, T)> {
        self.kind.numbers().filter_map(move |LinkNumber { name, .. }| self.number(name).map(|number| (name, *number)))
    }
}

impl<T: Elementary> Tie<T> {
    /// Returns the distance of its ends at rest (m).
    pub fn length(&self) -> T {
        (self.block[0] - self.ground[0]).hypot(self.block[1] - self.ground[1])
    }
}

impl Tie {
    /// Refuses an impossible tie. Errors call it `name`, such as "tie_1".
    ///
    /// # Errors
    /// The first impossible parameter, with its value and the valid ones.
    pub fn check(&self, name: &str) -> Result<(), BlockError> {
        let of_kind = |number: &str| format!("{} of {name}", number.replace('_', " ")).into();
        let refused = |name, value, expected| Err(BlockError::OutOfRange { name, value, expected });
        for (LinkNumber { name, quantity, .. }, &mut value) in NUMBERS.into_iter().zip({ *self }.numbers()) {
            match quantity {
                Quantity::Coordinate if !value.is_finite() => return refused(name.into(), value, "a finite number"),
                Quantity::Ratio if !(0.0..1.0).contains(&value) => {
                    return refused(of_kind(name), value, "a ratio of stiffnesses from 0 to below 1");
                }
                Quantity::Coordinate | Quantity::Ratio => {}
                Quantity::Length | Quantity::Force | Quantity::Stiffness | Quantity::Damping => {
                    Valid::NotNegative.check(value).or_else(|expected| refused(of_kind(name), value, expected))?;
                }
            }
        }
        if self.is_present() && self.length() <= 0.0 {
            return refused(format!("distance of the ends of {name}").into(), self.length(), "one above 0 m");
        }
        if self.stiffness > 0.0 && self.strength > 0.0 && self.pretension > self.strength {
            return refused(of_kind("pretension"), self.pretension, "a force (N) up to the strength");
        }
        Ok(())
    }
}

impl Block {
    /// Returns the block with these ties and dampers, at most [`MAX_TIES`]. Ties are numbered before dampers.
    ///
    /// # Errors
    /// More than [`MAX_TIES`], or the first impossible parameter of one.
    pub fn with_ties(mut self, ties: &[Tie]) -> Result<Block, BlockError> {
        if ties.len() > MAX_TIES {
            return Err(BlockError::OutOfRange { name: "ties".into(), value: ties.len() as f64, expected: EXPECTED });
        }
        names(ties).iter().zip(ties).try_for_each(|(name, tie)| tie.check(name))?;
        self.body.restraints.ties = Ties::of(ties);
        Ok(self)
    }
}

impl<T> Body<T> {
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
    /// Limp, while its spring yields and becomes shorter.
    LimpYields,
    /// Broken.
    Broken,
}

impl TieState {
    /// Returns the direction in which its spring yields, if it does.
    #[inline(always)]
    pub fn yields(self) -> Option<YieldDirection> {
        match self {
            TieState::Yields(direction) => Some(direction),
            TieState::LimpYields => Some(YieldDirection::Shorter),
            TieState::Slack | TieState::Taut | TieState::Limp | TieState::Broken => None,
        }
    }

    /// Whether the tie pulls or pushes.
    #[inline(always)]
    pub fn acts(self) -> bool {
        matches!(self, TieState::Taut | TieState::Yields(_))
    }

    /// Whether its spring is stretched, or of a damper also pressed.
    #[inline(always)]
    pub fn is_strained(self) -> bool {
        self.acts() || matches!(self, TieState::Limp | TieState::LimpYields)
    }
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

/// A tie with its state.
#[derive(Clone, Copy, Debug)]
pub struct Link<'a, P, S> {
    /// The tie.
    pub tie: &'a Tie<P>,
    /// Its state.
    pub state: TieState,
    /// Its plastic elongation s_p (m) unless it yields. `None` if no tie of the block can yield.
    pub plastic: Option<S>,
}

/// The plastic elongations s_p (m) of ties after their last yielding, positive for longer ones. `None` if none can yield.
pub type Plastic<T> = Option<[T; MAX_TIES]>;

/// Returns the ties of a block with their numbers and states.
pub fn links<'a, P, S: Copy>(
    body: &'a Body<P>,
    states: &TieStates,
    plastic: &Plastic<S>,
) -> impl Iterator<Item = Link<'a, P, S>> {
    let ties = body.ties().iter().enumerate();
    ties.map(|(i, tie)| Link { tie, state: states[i], plastic: plastic.map(|all| all[i]) })
}

/// The states of all ties of a block.
pub type TieStates = [TieState; MAX_TIES];

/// All ties slack.
pub const NO_TIES: TieStates = [TieState::Slack; MAX_TIES];
