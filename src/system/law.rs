//! A pose → its law: the equations of motion from there on.

use crate::block::restraints::States;
use crate::block::{Block, Corner, Foundation, Regime};
use crate::excitation::Forcing;
use crate::numerics::scalar::Elementary;
use crate::system::instant::{Footing, Pose};

/// The choice of the equations of motion while the contacts last.
///
/// [`AnyLaw`] is a value at run time. Frequent laws also have a type ([`Gripping`]), for which steps are compiled separately, so that no
/// stage tests the regime.
pub trait Law: Copy {
    /// Whether the law has its own type.
    const KNOWN: bool;

    /// The regime.
    fn regime(self) -> Regime;
    /// The foundation.
    fn foundation(self) -> Foundation;
    /// Whether the foot does not slide.
    fn grips(self) -> bool;
    /// The corner that is held in contact without load, if any.
    fn held(self) -> Option<Corner>;

    /// Whether the horizontal motion is integrated too, with the works of friction and restraints: for a foot that slides against
    /// friction, or a block with restraints.
    const EXTENDED: bool = false;

    /// The corner of the rigid base about which the block turns under its weight and the excitation alone.
    #[inline(always)]
    fn pivot(self) -> Option<Corner> {
        match (Self::KNOWN, self.foundation()) {
            (true, Foundation::Rigid) => self.regime().pivot(),
            _ => None,
        }
    }

    /// Whether the block rests on the rigid base under its weight and the excitation alone.
    #[inline(always)]
    fn is_at_rest(self) -> bool {
        Self::KNOWN && self.foundation() == Foundation::Rigid && self.regime() == Regime::FullContact
    }

    /// [`Law::KNOWN`], as a value.
    #[inline(always)]
    fn is_known(self) -> bool {
        Self::KNOWN
    }

    /// [`Law::EXTENDED`], as a value.
    #[inline(always)]
    fn is_extended(self) -> bool {
        Self::EXTENDED
    }

    /// Whether friction is limited.
    #[inline(always)]
    fn has_friction(self) -> bool {
        false
    }

    /// The states of the restraints.
    #[inline(always)]
    fn restraints(self) -> States {
        States::NONE
    }

    /// The forcing with the restraints that act under this law.
    #[inline(always)]
    fn acting<T>(self, forcing: Forcing<T>) -> Forcing<T> {
        Forcing { restraints: self.restraints(), ..forcing }
    }
}

/// A law known at run time; if `EXTENDED`, the horizontal motion is integrated too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyLaw<const EXTENDED: bool = false> {
    regime: Regime,
    foundation: Foundation,
    grips: bool,
    held: Option<Corner>,
    has_friction: bool,
    slides: bool,
    restrained: bool,
    restraints: States,
}

impl AnyLaw {
    /// The law of a block in a pose.
    #[inline]
    pub fn of<T: Elementary>(block: &Block<T>, pose: &Pose<T>) -> AnyLaw {
        let Pose { contacts, footing, restraints, .. } = pose;
        AnyLaw {
            regime: contacts.regime(),
            foundation: block.foundation,
            grips: footing.grips(),
            held: contacts.held(),
            has_friction: block.friction.value() > 0.0,
            slides: matches!(footing, Footing::Slides { .. }),
            restrained: !block.restraints.is_empty(),
            restraints: *restraints,
        }
    }

    /// Returns the extended law of a sliding or restrained block, or `None`.
    #[inline]
    pub fn extended(self) -> Option<AnyLaw<true>> {
        let AnyLaw { regime, foundation, grips, held, has_friction, slides, restrained, restraints } = self;
        let extended = AnyLaw { regime, foundation, grips, held, has_friction, slides, restrained, restraints };
        (slides || restrained).then_some(extended)
    }
}

impl<const EXTENDED: bool> Law for AnyLaw<EXTENDED> {
    const KNOWN: bool = false;
    const EXTENDED: bool = EXTENDED;

    #[inline(always)]
    fn regime(self) -> Regime {
        self.regime
    }

    #[inline(always)]
    fn foundation(self) -> Foundation {
        self.foundation
    }

    #[inline(always)]
    fn grips(self) -> bool {
        self.grips
    }

    #[inline(always)]
    fn held(self) -> Option<Corner> {
        self.held
    }

    #[inline(always)]
    fn has_friction(self) -> bool {
        self.has_friction
    }

    #[inline(always)]
    fn restraints(self) -> States {
        self.restraints
    }
}

/// The law of a block that grips the foundation with the left corner, the right corner, or both; no corner is held.
#[derive(Clone, Copy, Debug)]
pub struct Gripping<const LEFT: bool, const RIGHT: bool, const RIGID: bool>;

impl<const LEFT: bool, const RIGHT: bool, const RIGID: bool> Law for Gripping<LEFT, RIGHT, RIGID> {
    const KNOWN: bool = true;

    #[inline(always)]
    fn regime(self) -> Regime {
        Regime::of_touching([LEFT, RIGHT])
    }

    #[inline(always)]
    fn foundation(self) -> Foundation {
        if RIGID { Foundation::Rigid } else { Foundation::Viscoelastic }
    }

    #[inline(always)]
    fn grips(self) -> bool {
        true
    }

    #[inline(always)]
    fn held(self) -> Option<Corner> {
        None
    }
}

/// Evaluates `$body` with `$law` of the law's own type, or as the value `$any` if it has none.
macro_rules! in_law {
    ($any:expr, $law:ident => $body:expr) => {{
        let any = $any;
        if !any.grips() || any.held().is_some() || any.has_friction() {
            let $law = any;
            $body
        } else {
            in_law!(@ any, $law, $body;
                (Viscoelastic, FullContact) <true, true, false>,
                (Viscoelastic, TiltingLeft) <true, false, false>,
                (Viscoelastic, TiltingRight) <false, true, false>,
                (Rigid, FullContact) <true, true, true>,
                (Rigid, TiltingLeft) <true, false, true>,
                (Rigid, TiltingRight) <false, true, true>,
            )
        }
    }};
    (@ $any:ident, $law:ident, $body:expr;
     $(($foundation:ident, $regime:ident) <$left:literal, $right:literal, $rigid:literal>,)*) => {
        match ($any.foundation(), $any.regime()) {
            $((Foundation::$foundation, Regime::$regime) => {
                let $law = Gripping::<$left, $right, $rigid>;
                $body
            })*
            (Foundation::Viscoelastic | Foundation::Rigid, Regime::Separated) => {
                let $law = $any;
                $body
            }
        }
    };
}
pub(crate) use in_law;
