//! A pose → its mode: the equations of motion from there on.

use crate::block::restraints::{Modes, States};
use crate::block::{Body, Corner, Foundation, Regime};
use crate::excitation::Forcing;
use crate::numerics::scalar::Elementary;
use crate::system::instant::{Footing, Pose};

/// The choice of the equations of motion while the contacts last.
///
/// [`AnyMode`] is a value at run time. Frequent modes also have a type ([`Gripping`]), for which steps are compiled separately, so that no
/// stage tests the regime.
pub trait MotionMode: Copy {
    /// Whether the mode has its own type.
    const STATIC: bool;

    /// The regime.
    fn regime(self) -> Regime;
    /// The foundation.
    fn foundation(self) -> Foundation;
    /// Whether the foot does not slide.
    fn grips(self) -> bool;
    /// The corner that is held in contact without load, if any.
    fn held(self) -> Option<Corner>;

    /// Whether the horizontal motion is integrated, with the works of friction and restraints. It is for a foot that slides against
    /// friction, and for a block with restraints.
    const INTEGRATES_U: bool = false;

    /// The corner of the rigid base about which the block turns. Only its weight and the excitation act.
    #[inline(always)]
    fn pivot(self) -> Option<Corner> {
        match (Self::STATIC, self.foundation()) {
            (true, Foundation::Rigid) => self.regime().pivot(),
            _ => None,
        }
    }

    /// Whether the block rests on the rigid base under its weight and the excitation alone.
    #[inline(always)]
    fn is_at_rest(self) -> bool {
        Self::STATIC && self.foundation() == Foundation::Rigid && self.regime() == Regime::FullContact
    }

    /// [`MotionMode::STATIC`], as a value.
    #[inline(always)]
    fn is_static(self) -> bool {
        Self::STATIC
    }

    /// [`MotionMode::INTEGRATES_U`], as a value.
    #[inline(always)]
    fn integrates_u(self) -> bool {
        Self::INTEGRATES_U
    }

    /// Whether friction is limited.
    #[inline(always)]
    fn has_friction(self) -> bool {
        false
    }

    /// The modes under which the restraints act.
    #[inline(always)]
    fn restraints(self) -> Modes {
        States::<f64>::NONE.modes()
    }

    /// The forcing with the restraints that act under this mode, and have this memory.
    #[inline(always)]
    fn acting<T>(self, forcing: Forcing<T>, memory: States<T>) -> Forcing<T> {
        // Blocks with restraints have no mode with its own type; a constant leaves nothing to copy.
        let restraints = if Self::STATIC { States::NONE } else { memory.under(self.restraints()) };
        Forcing { restraints, ..forcing }
    }
}

/// A mode known at run time; if `INTEGRATES_U`, the horizontal motion is integrated too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyMode<const INTEGRATES_U: bool = false> {
    regime: Regime,
    foundation: Foundation,
    grips: bool,
    held: Option<Corner>,
    has_friction: bool,
    slides: bool,
    restrained: bool,
    restraints: Modes,
}

impl AnyMode {
    /// The mode of a block in a pose.
    #[inline]
    pub fn of<T: Elementary>(body: &Body<T>, pose: &Pose<T>) -> AnyMode {
        let Pose { contacts, footing, restraints, .. } = pose;
        AnyMode {
            regime: contacts.regime(),
            foundation: body.foundation,
            grips: footing.grips(),
            held: contacts.held(),
            has_friction: body.friction.value() > 0.0,
            slides: matches!(footing, Footing::Slides { .. }),
            restrained: !body.restraints.is_empty(),
            restraints: restraints.modes(),
        }
    }

    /// Returns the extended mode of a sliding or restrained block, or `None`.
    #[inline]
    pub fn extended(self) -> Option<AnyMode<true>> {
        let AnyMode { regime, foundation, grips, held, has_friction, slides, restrained, restraints } = self;
        let extended = AnyMode { regime, foundation, grips, held, has_friction, slides, restrained, restraints };
        (slides || restrained).then_some(extended)
    }
}

impl<const INTEGRATES_U: bool> MotionMode for AnyMode<INTEGRATES_U> {
    const STATIC: bool = false;
    const INTEGRATES_U: bool = INTEGRATES_U;

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
    fn restraints(self) -> Modes {
        self.restraints
    }
}

/// The mode of a block that grips the foundation with one corner or both. No corner is held.
#[derive(Clone, Copy, Debug)]
pub struct Gripping<const LEFT: bool, const RIGHT: bool, const RIGID: bool>;

impl<const LEFT: bool, const RIGHT: bool, const RIGID: bool> MotionMode for Gripping<LEFT, RIGHT, RIGID> {
    const STATIC: bool = true;

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

/// Evaluates `$body` with `$mode` of the mode's own type, or of that of `$any`.
macro_rules! dispatch_mode {
    ($any:expr, $mode:ident => $body:expr) => {{
        let any = $any;
        if !any.grips() || any.held().is_some() || any.has_friction() {
            let $mode = any;
            $body
        } else {
            dispatch_mode!(@ any, $mode, $body;
                (Viscoelastic, FullContact) <true, true, false>,
                (Viscoelastic, TiltingLeft) <true, false, false>,
                (Viscoelastic, TiltingRight) <false, true, false>,
                (Rigid, FullContact) <true, true, true>,
                (Rigid, TiltingLeft) <true, false, true>,
                (Rigid, TiltingRight) <false, true, true>,
            )
        }
    }};
    (@ $any:ident, $mode:ident, $body:expr;
     $(($foundation:ident, $regime:ident) <$left:literal, $right:literal, $rigid:literal>,)*) => {
        match ($any.foundation(), $any.regime()) {
            $((Foundation::$foundation, Regime::$regime) => {
                let $mode = Gripping::<$left, $right, $rigid>;
                $body
            })*
            (Foundation::Viscoelastic | Foundation::Rigid, Regime::Separated) => {
                let $mode = $any;
                $body
            }
        }
    };
}
pub(crate) use dispatch_mode;
