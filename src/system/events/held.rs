//! A held corner: full contact would lift it, and standing on the other corner alone would press it back.
//!
//! It lifts once it would no longer be pressed back, and bears again once full contact would no longer lift it.

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

/// Returns the acceleration (m/s²) with which a held corner would be pressed on if it were let go.
///
/// Its rate is unknown and set to zero, so that only a sign change between samples is found, which suffices for a monotone function.
pub(super) fn pressed_on<T: Elementary>(at: &Evaluation<T>, corner: Corner) -> Sample<T> {
    Sample { value: -gap_opening(at, corner, at.instant.corner_dot[corner.index()]), rate: T::from(0.0) }
}

/// Returns the acceleration (m/s²) with which full contact would lift a held corner off its support; its rate is set to zero.
pub(super) fn unloading<T: Elementary>(at: &Evaluation<T>, corner: Corner) -> Sample<T> {
    let i = corner.index();
    let x = instant(at.block, Regime::FullContact, at.state.0, at.footing, at.forcing);
    Sample { value: x.corner_ddot[i] - at.instant.corner_ddot[i], rate: T::from(0.0) }
}

impl<T: Elementary> Change<'_, T>
where
    Dual<T>: CombinesWith<T>,
{
    /// Holds `corner` on its support at this height (m).
    pub(super) fn hold_corner(&mut self, corner: Corner, height: T) {
        self.pose.contacts.set(corner, Contact::Held(self.creep_from(corner, height)));
    }

    /// Handles two corners without load, so that nothing holds the block horizontally. The paper's analysis ends here.
    pub(super) fn lose_support(&mut self, x: &Instant<T>) -> Leaving {
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
