//! A corner that is held on its support: full contact would lift it, and the other corner alone would press it back.
//!
//! It lifts when it would not be pressed on any more, and bears again when full contact would not lift it.

use crate::block::{Contact, Corner, Regime};
use crate::numerics::dual::Dual;
use crate::numerics::roots::Sample;
use crate::numerics::scalar::{CombinesWith, Elementary};
use crate::system::dynamics::instant;
use crate::system::evaluation::Evaluation;
use crate::system::events::change::{Change, Leaving};
use crate::system::events::lift_off::gap_opening;
use crate::system::events::placement::Placement;
use crate::system::instant::Instant;

/// Acceleration (m/s²) with which a held corner would be pressed on if it were let go. Its rate is not known; a change of sign
/// between samples is enough where the function is monotone.
pub(super) fn pressed_on<T: Elementary>(at: &Evaluation<T>, corner: Corner) -> Sample<T> {
    Sample { value: -gap_opening(at, corner, at.instant.corner_dot[corner.index()]), rate: T::from(0.0) }
}

/// Acceleration (m/s²) at which full contact would take a held corner away from its support; without its rate.
pub(super) fn unloading<T: Elementary>(at: &Evaluation<T>, corner: Corner) -> Sample<T> {
    let i = corner.index();
    let x = instant(at.block, Regime::FullContact, at.state.0, at.footing, at.forcing);
    Sample { value: x.corner_ddot[i] - at.instant.corner_ddot[i], rate: T::from(0.0) }
}

impl<T: Elementary> Change<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// `corner` is held on its support at this height (m).
    pub(super) fn keep(&mut self, corner: Corner, height: T) {
        self.pose.contacts.set(corner, Contact::Held(self.creep_from(corner, height)));
    }

    /// Neither corner bears anything, so that nothing holds the block horizontally. The paper's analysis ends here.
    pub(super) fn bear_nothing(&mut self, x: &Instant<T>) -> Leaving {
        let placement = Placement::of(x);
        if self.system.flies && self.system.block.friction.value() == 0.0 {
            self.release(x);
        } else {
            for corner in Corner::BOTH {
                self.take_off(corner, &placement);
            }
        }
        self.settle(Regime::FullContact, placement);
        if self.regime() == Regime::FullContact { Leaving::Slides } else { Leaving::Lifts }
    }
}
