//! Ground motion and loads, as they act on the centre of mass of a block seen from the ground.

use crate::excitation::Forcing;
use crate::numerics::scalar::Scalar;
use crate::system::instant::Instant;

/// Power per mass (m²/s³): `−a_gx u̇ − a_gz v̇`, and the loads' work.
#[inline(always)]
pub fn power<T: Scalar>(x: &Instant<T>, forcing: Forcing<T>) -> T {
    forcing.moment * x.theta_dot - forcing.x * x.u_dot - forcing.z * x.v_dot
}
