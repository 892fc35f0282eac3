//! Ground motion and loads on the centre of mass, in the frame of the ground.

use crate::excitation::Forcing;
use crate::numerics::scalar::Scalar;
use crate::system::instant::Instant;

/// Returns the power per mass (m²/s³): `−a_gx u̇ − a_gz v̇`, and that of the loads.
#[inline(always)]
pub fn power<T: Scalar>(x: &Instant<T>, forcing: Forcing<T>) -> T {
    forcing.moment * x.theta_dot - forcing.x * x.u_dot - forcing.z * x.v_dot
}
