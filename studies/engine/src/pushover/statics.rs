//! A rotation and the states of restraints → the block at rest under a lateral force. The force acts at the centre of mass.

use super::PushoverError;
use rocking_block::block::restraints::{self, ObservedRestraint, States};
use rocking_block::block::{Block, Corner, Foot, Foundation, Kinematics, Regime};
use rocking_block::numerics::dual::Dual;
use rocking_block::numerics::scalar::{CombinesWith, Scalar};

/// The block, held at a rotation by a lateral force.
#[derive(Clone, Copy, Debug)]
pub struct Equilibrium {
    /// Rotation θ (rad), positive to the right.
    pub theta: f64,
    /// Displacement of the centre of mass to the right of its place at rest (m).
    pub u: f64,
    /// Height of the centre of mass above its place on the settled supports (m).
    pub v: f64,
    /// The corners in contact.
    pub regime: Regime,
    /// Vertical reactions N_L and N_R (N).
    pub reaction: [f64; 2],
    /// Horizontal reaction H on the block (N), positive to the right.
    pub horizontal: f64,
    /// The lateral force F at the centre of mass (N), positive to the right.
    pub force: f64,
    /// Its moment about the foot `F Q` (N.m), positive clockwise. The foot is the standing corner, or the middle of the base.
    pub moment: f64,
    /// Rate of F as θ grows (N/rad).
    pub stiffness: f64,
    /// The restraints, by their numbers.
    pub restraints: [ObservedRestraint; restraints::MAX],
    /// The moment of each restraint against the lateral force, about the foot (N.m).
    pub resisting: [f64; restraints::MAX],
    /// Position of the block, and its rates as θ moves along the path.
    pub(super) kinematics: Kinematics<f64>,
}

/// The contacts and the states of restraints on a stretch of the path without events.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// The corners in contact.
    pub regime: Regime,
    /// Displacement of the foot to the right (m).
    pub place: f64,
    /// The states of the restraints.
    pub states: States,
}

/// Forces on the block at a rotation and a height.
struct Forces<T> {
    kinematics: Kinematics<T>,
    reaction: [T; 2],
    /// Upward force per mass that is left (m/s²).
    surplus: T,
    horizontal: T,
    force: T,
    moment: T,
}

impl Stretch {
    fn foot(&self) -> Foot {
        self.regime.foot().unwrap_or(Foot::Middle)
    }

    /// Returns the displacement of the centre of mass (m), less that of the foot. It is measured from the place over the middle of the
    /// base.
    pub fn lean<T: CombinesWith<f64>>(&self, block: &Block, [sin, cos]: [T; 2]) -> T {
        sin * block.h - sin * sin / (cos + 1.0) * block.offset_from(self.foot())
    }

    fn kinematics<T: CombinesWith<f64>>(&self, block: &Block, theta: T, v: T) -> Kinematics<T> {
        let (sin, cos) = theta.sin_cos();
        let (zero, u) = (T::from(0.0), self.lean(block, [sin, cos]) + self.place);
        Kinematics { sin_cos: [sin, cos], theta_dot: zero, center: [u, v], velocity: [zero; 2] }
    }

    /// Returns the forces at a rotation and a height of the centre of mass. On a rigid base the reactions are those of a block at rest.
    fn forces<T: CombinesWith<f64>>(&self, block: &Block, theta: T, v: T) -> Forces<T> {
        let kinematics = self.kinematics(block, theta, v);
        let [sin, cos] = kinematics.sin_cos;
        let zero = T::from(0.0);
        // The pull enters as a ground acceleration would, its moment as a load.
        let [x, z, load] = restraints::add_pull(block, &self.states.map(T::from), &kinematics, [zero; 3]);
        let weight = z + block.gravity;
        let lever = block.lever(self.foot(), sin, cos);
        let corners = Corner::each(|corner| block.lever(Foot::Corner(corner), sin, cos).x);
        let reaction = match (block.foundation, self.regime.pivot()) {
            (Foundation::Viscoelastic, _) => Corner::each(|corner| match self.regime.touches(corner) {
                true => {
                    (height(block, corner, [sin, cos], v) * -1.0 + block.free_height(corner))
                        * (block.stiffness / block.mass)
                }
                false => zero,
            }),
            (Foundation::Rigid, Some(pivot)) => Corner::each(|corner| if corner == pivot { weight } else { zero }),
            // At rest the lateral force is zero: the reactions balance moments, too.
            (Foundation::Rigid, None) => {
                let left = (x * lever.q - load - weight * corners[1]) / (corners[0] - corners[1]);
                [left, weight - left]
            }
        };
        let turning = reaction[0] * corners[0] + reaction[1] * corners[1] + load;
        let moment = (x * lever.q - turning) * block.mass;
        let force = moment / lever.q;
        Forces {
            kinematics,
            reaction: reaction.map(|reaction| reaction * block.mass),
            surplus: reaction[0] + reaction[1] - weight,
            horizontal: x * block.mass - force,
            force,
            moment,
        }
    }

    /// Returns the equilibrium at a rotation; the search for the height begins at `near` (m).
    ///
    /// # Errors
    /// The vertical forces do not balance.
    pub fn equilibrium(
        &self,
        block: &Block,
        theta: f64,
        direction: f64,
        near: f64,
    ) -> Result<Equilibrium, PushoverError> {
        let with_rate = match (block.foundation, self.regime.pivot()) {
            (Foundation::Rigid, pivot) => {
                let (sin, cos) = Dual::new(theta, direction).sin_cos();
                let offset = pivot.map_or(0.0, |pivot| block.offset(pivot));
                -(sin * sin / (cos + 1.0) * block.h + sin * offset)
            }
            (Foundation::Viscoelastic, _) => self.height_on_supports(block, theta, direction, near)?,
        };
        let Forces { kinematics, reaction, horizontal, force, moment, .. } =
            self.forces(block, Dual::new(theta, direction), with_rate);
        let value = |x: Dual<f64>| x.re;
        let kinematics = Kinematics {
            sin_cos: kinematics.sin_cos.map(value),
            theta_dot: direction,
            center: kinematics.center.map(value),
            velocity: kinematics.center.map(|x| x.eps),
        };
        let [sin, cos] = kinematics.sin_cos;
        let lever = block.lever(self.foot(), sin, cos);
        let mut resisting = [0.0; restraints::MAX];
        for number in block.restraints.numbers() {
            let [x, z, load] = restraints::add_pull(block, &self.states.only(number), &kinematics, [0.0; 3]);
            resisting[number] = (x * lever.q - load - z * lever.x) * block.mass;
        }
        Ok(Equilibrium {
            theta,
            u: kinematics.center[0],
            v: kinematics.center[1],
            regime: self.regime,
            reaction: reaction.map(value),
            horizontal: horizontal.re,
            force: force.re,
            moment: moment.re,
            stiffness: force.eps * direction,
            restraints: restraints::observe(block, &self.states, &kinematics),
            resisting,
            kinematics,
        })
    }

    /// Returns the height at which the supports balance weight and restraints. Its rate is that along the path.
    fn height_on_supports(
        &self,
        block: &Block,
        theta: f64,
        direction: f64,
        near: f64,
    ) -> Result<Dual<f64>, PushoverError> {
        const ITERATIONS: u32 = 100;
        const ROUND_OFF: f64 = 1e-9;
        let lost = || PushoverError::no_equilibrium(theta);
        let scale = block.static_deflection() + block.r0 * theta.abs();
        let (mut v, mut last) = (near, f64::INFINITY);
        for _ in 0..ITERATIONS {
            let Dual { re, eps: slope } = self.forces(block, Dual::from(theta), Dual::new(v, 1.0)).surplus;
            let step = -re / slope;
            if slope >= 0.0 || !step.is_finite() {
                return Err(lost());
            }
            v += step;
            // Steps that no longer shrink are round-off.
            let size = step.abs() / scale;
            let is_round_off = size <= ROUND_OFF && size >= last;
            last = 0.5 * size;
            if size <= 4.0 * f64::EPSILON || is_round_off {
                let along = self.forces(block, Dual::new(theta, direction), Dual::from(v)).surplus.eps;
                return Ok(Dual::new(v, -along / slope));
            }
        }
        Err(lost())
    }
}

/// Returns the height of a corner above its place at rest (m).
pub(super) fn height<T: CombinesWith<f64>>(block: &Block, corner: Corner, [sin, cos]: [T; 2], v: T) -> T {
    v + sin * sin / (cos + 1.0) * block.h + sin * block.offset(corner)
}
