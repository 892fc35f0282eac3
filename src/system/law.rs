//! A pose → the equations of motion that hold from there on.

use crate::block::restraints::States;
use crate::block::{Block, Corner, Foundation, Regime};
use crate::excitation::Forcing;
use crate::numerics::scalar::Elementary;
use crate::system::instant::{Footing, Pose};

/// Which equations of motion hold while the contacts last.
///
/// [`AnyLaw`] is a value that says so at run time. Most laws are types as well ([`Gripping`]): the compiler knows all of them,
/// so that the steps under each are compiled for it alone and no stage asks for the regime.
pub trait Law: Copy {
    /// Whether it is a type, known to the compiler.
    const KNOWN: bool;

    /// Which corners touch.
    fn regime(self) -> Regime;
    /// The ground that they touch.
    fn foundation(self) -> Foundation;
    /// Whether the foot does not slide.
    fn grips(self) -> bool;
    /// The corner that is held in contact though it bears nothing.
    fn held(self) -> Option<Corner>;

    /// Whether the horizontal motion is integrated too, with the works of friction and of the restraints: where the foot slides against
    /// friction, or restraints pull.
    const EXTENDED: bool = false;

    /// The corner of the rigid base about which the block turns under nothing but its weight and the excitation.
    #[inline(always)]
    fn pivot(self) -> Option<Corner> {
        match (Self::KNOWN, self.foundation()) {
            (true, Foundation::Rigid) => self.regime().pivot(),
            _ => None,
        }
    }

    /// Whether the block rests on the rigid base under nothing but its weight and the excitation.
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

    /// Whether the friction of the feet has a limit.
    #[inline(always)]
    fn has_friction(self) -> bool {
        false
    }

    /// The states of the restraints.
    #[inline(always)]
    fn restraints(self) -> States {
        States::NONE
    }

    /// The forcing with the forces that act under this law.
    #[inline(always)]
    fn acting<T>(self, forcing: Forcing<T>) -> Forcing<T> {
        Forcing { restraints: self.restraints(), ..forcing }
    }
}

/// A law that is known at run time; the horizontal motion is integrated too if it is `EXTENDED`.
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

    /// The same as a law under which the horizontal motion is integrated too, if it is one.
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

/// The law of a block that stands on the left corner, the right one, or both, on a rigid base or on supports; the foot does
/// not slide, and no corner is held.
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

/// `$body` with `$law` as the type of the law `$any`, where it has one, and as the value itself otherwise.
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
