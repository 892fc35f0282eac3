//! The layout of the state, and a state → the motion of the body and the places and velocities of its feet.
//!
//! The quaternion of the state stands for a rotation at any length: forces, events and outputs do not depend on its norm. Each step ends with
//! a norm of 1, so that it never drifts, and this changes neither events nor energies.

use nalgebra::{ClosedAddAssign, ClosedMulAssign, ClosedSubAssign, Vector3};

use crate::numerics::scalar::Scalar;

/// A number of the equations in space: plain, or with a derivative. Vectors of nalgebra need more operators than formulas do.
pub trait Component: Scalar + nalgebra::Scalar + ClosedAddAssign + ClosedSubAssign + ClosedMulAssign {}

impl<T: Scalar + nalgebra::Scalar + ClosedAddAssign + ClosedSubAssign + ClosedMulAssign> Component for T {}

/// Places in the state: displacement of the centre of mass (m).
pub const DISPLACEMENT: usize = 0;
/// The quaternion, its real part first.
pub const QUATERNION: usize = 3;
/// Velocity of the centre of mass (m/s).
pub const VELOCITY: usize = 7;
/// Angular velocity (rad/s), along the axes of the ground.
pub const OMEGA: usize = 10;
/// The first foot.
pub const FEET_FROM: usize = 13;
/// Numbers of a foot: stretch of its horizontal spring (m) in x and y.
pub const PER_FOOT: usize = 2;
/// Number of energies since the start (J): work of ground motion and loads, energy taken by the dashpots and by slip.
pub const WORKS: usize = 3;

/// Returns the place of a foot's stretches in the state.
pub const fn of_foot(foot: usize) -> usize {
    FEET_FROM + PER_FOOT * foot
}

/// Returns how many numbers the rates depend on, the first ones. The others are sums over time: works, and the lengths of slips (m).
pub const fn moving(feet: usize) -> usize {
    of_foot(feet)
}

/// Returns the place of the length of a foot's slip in the state of a block with n feet.
pub const fn slip_of(foot: usize, feet: usize) -> usize {
    moving(feet) + WORKS + foot
}

/// Returns the works of a state of a block with n feet, or their rates.
pub fn works<T: Copy>(numbers: &[T], feet: usize) -> [T; WORKS] {
    std::array::from_fn(|i| numbers[moving(feet) + i])
}

/// Returns the dimension of the state of a block with n feet.
pub const fn dimension(feet: usize) -> usize {
    slip_of(feet, feet)
}

/// Returns three numbers from a place of the state on.
#[inline(always)]
pub fn three<T: Component>(state: &[T], from: usize) -> Vector3<T> {
    Vector3::new(state[from], state[from + 1], state[from + 2])
}

/// Returns the scalar product.
#[inline(always)]
pub fn dot<T: Component>(a: &Vector3<T>, b: &Vector3<T>) -> T {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Returns a constant vector.
#[inline(always)]
pub fn constant<T: Component>(v: &Vector3<f64>) -> Vector3<T> {
    Vector3::new(T::from(v.x), T::from(v.y), T::from(v.z))
}

/// The rotation R of a quaternion of any length.
#[derive(Clone, Copy, Debug)]
pub struct Turn<T> {
    /// The columns of R − 1, each without cancellation near R = 1.
    columns: [Vector3<T>; 3],
}

impl<T: Component> Turn<T> {
    /// Returns the rotation of a state.
    #[inline(always)]
    pub fn of(state: &[T]) -> Turn<T> {
        Turn::of_quaternion([0, 1, 2, 3].map(|i| state[QUATERNION + i]))
    }

    /// Returns the rotation of a quaternion, its real part first.
    #[inline(always)]
    pub fn of_quaternion([w, x, y, z]: [T; 4]) -> Turn<T> {
        let factor = T::from(2.0) / (w * w + (x * x + y * y + z * z));
        let [x_2, y_2, z_2] = [x * factor, y * factor, z * factor];
        let [xx, yy, zz] = [x * x_2, y * y_2, z * z_2];
        let [xy, xz, yz] = [x * y_2, x * z_2, y * z_2];
        let [wx, wy, wz] = [w * x_2, w * y_2, w * z_2];
        Turn {
            columns: [
                Vector3::new(-(yy + zz), xy + wz, xz - wy),
                Vector3::new(xy - wz, -(xx + zz), yz + wx),
                Vector3::new(xz + wy, yz - wx, -(xx + yy)),
            ],
        }
    }

    /// Returns (R − 1) s of a constant vector.
    #[inline(always)]
    pub fn change(&self, s: &Vector3<f64>) -> Vector3<T> {
        let [x, y, z] = self.columns;
        let row = |x: T, y: T, z: T| x * s.x + y * s.y + z * s.z;
        Vector3::new(row(x.x, y.x, z.x), row(x.y, y.y, z.y), row(x.z, y.z, z.z))
    }

    /// Returns R s.
    #[inline(always)]
    pub fn rotate(&self, s: &Vector3<T>) -> Vector3<T> {
        let [x, y, z] = self.columns;
        x * s.x + y * s.y + z * s.z + s
    }

    /// Returns Rᵀ s.
    #[inline(always)]
    pub fn rotate_back(&self, s: &Vector3<T>) -> Vector3<T> {
        let [x, y, z] = &self.columns;
        Vector3::new(dot(x, s), dot(y, s), dot(z, s)) + s
    }

    /// Returns the body's axis R e_z.
    #[inline(always)]
    pub fn axis(&self) -> Vector3<T> {
        let [.., z] = self.columns;
        Vector3::new(z.x, z.y, z.z + 1.0)
    }

    /// Returns the lean of the body.
    #[inline(always)]
    pub fn lean(&self) -> Lean<T> {
        let [x, y, z] = &self.columns;
        Lean { across: [-x.z, -y.z], up: z.z + 1.0 }
    }

    /// Returns the twist about the vertical, as the sine and the cosine of its angle times a common number.
    #[inline(always)]
    pub fn twist(&self) -> [T; 2] {
        let [x, y, _] = &self.columns;
        [x.y - y.x, x.x + y.y + 2.0]
    }

    /// Returns the square of the sine of half the tilt.
    #[inline(always)]
    pub fn half_tilt_square(&self) -> T {
        let [.., z] = &self.columns;
        z.z * -0.5
    }
}

/// The direction of gravity in body axes, of length 1: across the body, towards the side to which it leans, and up, the reversed one along
/// its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lean<T> {
    /// Its components along x and y: the sine of the tilt in the direction of the lean.
    pub across: [T; 2],
    /// The cosine of the tilt.
    pub up: T,
}

/// The motion of the body.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion<T> {
    /// Displacement of the centre of mass (m).
    pub displacement: Vector3<T>,
    /// Rotation.
    pub turn: Turn<T>,
    /// Velocity of the centre of mass (m/s).
    pub velocity: Vector3<T>,
    /// Angular velocity (rad/s).
    pub omega: Vector3<T>,
}

/// The motion of a foot.
#[derive(Clone, Copy, Debug)]
pub struct FootMotion<T> {
    /// From the centre of mass (m), along the axes of the ground.
    pub arm: Vector3<T>,
    /// Displacement from its place at rest (m).
    pub displacement: Vector3<T>,
    /// Velocity (m/s).
    pub velocity: Vector3<T>,
}

impl<T: Component> BodyMotion<T> {
    /// Returns the motion of a state.
    #[inline(always)]
    pub fn of(state: &[T]) -> BodyMotion<T> {
        BodyMotion {
            displacement: three(state, DISPLACEMENT),
            turn: Turn::of(state),
            velocity: three(state, VELOCITY),
            omega: three(state, OMEGA),
        }
    }

    /// Returns the motion of a foot at this place in the body.
    #[inline(always)]
    pub fn foot(&self, place: &Vector3<f64>) -> FootMotion<T> {
        let change = self.turn.change(place);
        let arm = Vector3::new(change.x + place.x, change.y + place.y, change.z + place.z);
        FootMotion { arm, displacement: self.displacement + change, velocity: self.velocity + self.omega.cross(&arm) }
    }
}

/// Gives the quaternion of a state the norm 1.
pub fn normalize(state: &mut [f64]) {
    let q = &mut state[QUATERNION..VELOCITY];
    let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    q.iter_mut().for_each(|x| *x /= norm);
}
