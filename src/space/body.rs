//! Checked parameters → the numbers of the equations of motion: feet, inertia, supports.

use std::f64::consts::TAU;

use nalgebra::{Cholesky, Const, Matrix3, Matrix3x6, Matrix6, Vector3};

use crate::block::parameters::Valid;
use crate::numerics::dual::Dual;
use crate::space::base::{BaseEdge, edges};
use crate::space::motion::{Component, Lean};
use crate::space::parameters::{Base, BaseSize, FEET, FootPlace, SpaceError, SpaceParameters, SpaceSupports, check};

/// A rigid body on n feet.
#[derive(Clone, Debug, PartialEq)]
pub struct SpaceBody {
    /// Mass M (kg).
    pub mass: f64,
    /// Gravity g (m/s²).
    pub gravity: f64,
    /// Inertia I about the centre of mass (kg.m²), in body axes.
    pub inertia: Matrix3<f64>,
    /// I⁻¹.
    pub inverse_inertia: Matrix3<f64>,
    /// Whether the axes of the body are those of its inertia, which has no products then.
    pub has_principal_axes: bool,
    /// The feet.
    pub feet: Vec<SpaceFoot>,
    /// Vertical stiffness K of a foot (N/m).
    pub stiffness: f64,
    /// Vertical damping C of a foot (N.s/m).
    pub damping: f64,
    /// Horizontal stiffness K_h of a foot (N/m).
    pub horizontal_stiffness: f64,
    /// Horizontal damping C_h of a foot (N.s/m).
    pub horizontal_damping: f64,
    /// Coulomb's μ (1).
    pub friction: f64,
    /// Height h of the centre of mass (m).
    pub center_height: f64,
    /// Half width b (m); of a list of feet, the distance from the centre of mass to the nearest edge of the base, seen from above.
    pub half_width: f64,
    /// R0 = √(b² + h²) (m).
    pub r0: f64,
    /// Slenderness angle α (rad), `tan α = b/h`.
    pub alpha: f64,
    /// Frequency parameter p (rad/s); of a list of feet, `√(3 g/(4 R0))`.
    pub p: f64,
    /// Circular frequency ω_v of the block that moves vertically on all feet without gaps (rad/s).
    pub omega_v: f64,
    /// Vertical damping ratio ξ_v (1).
    pub xi_v: f64,
    /// Distance of the farthest foot from the centre of mass (m).
    pub reach: f64,
    /// The edges of the base, the hull of the feet without gaps.
    pub edges: Vec<BaseEdge>,
    /// Distance from the centre of mass to the nearest edge, seen from above (m).
    pub edge_distance: f64,
    /// Tilt of balance over the nearest edge (rad).
    pub edge_angle: f64,
    /// Tangent of the greatest critical tilt, over a corner of the base.
    pub corner_slope: f64,
    /// Square of the greatest circular frequency on all feet (rad²/s²).
    pub fastest_square: f64,
}

/// A foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceFoot {
    /// Its place s from the centre of mass (m), in body axes.
    pub place: Vector3<f64>,
    /// Free height of its support above its own place at rest (m); minus its gap.
    pub free_height: f64,
    /// Load at rest (N).
    pub static_load: f64,
    /// Square of the greatest circular frequency on this foot alone (rad²/s²).
    pub frequency_square: f64,
}

/// The symmetric matrix of I_xx, I_yy, I_zz, I_xy, I_xz, I_yz.
fn symmetric([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

/// Width, depth and height, and where the feet stand.
struct Plan {
    /// Not of a list.
    half_width: Option<f64>,
    center_height: f64,
    feet: Vec<FootPlace>,
    /// I_xx, I_yy, I_zz of the shape (kg.m²).
    shape_inertia: Option<[f64; 3]>,
}

impl SpaceBody {
    /// Makes a block.
    ///
    /// # Errors
    /// The first invalid parameter, with its value and the valid ones.
    pub fn new(parameters: &SpaceParameters) -> Result<SpaceBody, SpaceError> {
        parameters.check()?;
        let &SpaceParameters { mass, gamma, gravity, kappa, friction, .. } = parameters;
        let Plan { half_width, center_height, feet, shape_inertia } = plan(parameters)?;
        let inertia = match (parameters.inertia, shape_inertia) {
            (Some(inertia), _) => symmetric(inertia),
            (None, Some([x, y, z])) => symmetric([x, y, z, 0.0, 0.0, 0.0]),
            (None, None) => return Err(SpaceError::Missing { name: "inertia" }),
        };
        let root = decompose(&inertia)?;
        let loads = static_loads(&feet, mass * gravity)?;
        let (standing, edges, [edge_distance, corner]) = standing_base(&feet)?;
        let half_width = half_width.unwrap_or(edge_distance);
        let r0 = (half_width * half_width + center_height * center_height).sqrt();
        let p = match parameters.base {
            Base::Rectangle { size: BaseSize::Slenderness { p, .. }, .. }
            | Base::Circle { size: BaseSize::Slenderness { p, .. }, .. } => p,
            Base::Rectangle { .. } | Base::Circle { .. } => (gamma / (1.0 + gamma) * gravity / r0).sqrt(),
            Base::List { .. } => (0.75 * gravity / r0).sqrt(),
        };
        let standing = standing as f64;
        let (omega_v, xi_v, stiffness, damping) = supports(parameters, p, mass / standing)?;
        let horizontal_damping = 2.0 * parameters.xi_h.unwrap_or(xi_v) * kappa.sqrt() * omega_v * (mass / standing);
        let horizontal_stiffness = kappa * stiffness;
        for (name, value) in [
            ("R0", r0),
            ("half_width", half_width),
            ("omega_v", omega_v),
            ("p", p),
            ("K", stiffness),
            ("C", damping),
            ("K_h", horizontal_stiffness),
            ("C_h", horizontal_damping),
        ] {
            check(name, Valid::Positive, value)?;
        }
        let feet: Vec<SpaceFoot> = feet
            .iter()
            .zip(loads)
            .map(|(foot, static_load)| SpaceFoot {
                place: Vector3::new(foot.x, foot.y, foot.gap - center_height),
                free_height: if foot.gap > 0.0 { -foot.gap } else { static_load / stiffness },
                static_load,
                frequency_square: 0.0,
            })
            .collect();
        let reach = feet.iter().map(|foot| foot.place.norm()).fold(0.0, f64::max);
        let mut body = SpaceBody {
            mass,
            gravity,
            inertia,
            inverse_inertia: root.inverse(),
            has_principal_axes: inertia.lower_triangle() == inertia.upper_triangle(),
            feet,
            stiffness,
            damping,
            horizontal_stiffness,
            horizontal_damping,
            friction,
            center_height,
            half_width,
            r0,
            alpha: libm::atan2(half_width, center_height),
            p,
            omega_v,
            xi_v,
            reach,
            edges,
            edge_distance,
            edge_angle: libm::atan2(edge_distance, center_height),
            corner_slope: corner / center_height,
            fastest_square: 0.0,
        };
        body.find_frequencies(&root);
        Ok(body)
    }

    /// Number of feet.
    pub fn count(&self) -> usize {
        self.feet.len()
    }

    /// Returns the product of I or I⁻¹ and a vector in body axes.
    #[inline(always)]
    pub(super) fn times_inertia<T: Component>(&self, m: &Matrix3<f64>, v: &Vector3<T>) -> Vector3<T> {
        if self.has_principal_axes {
            return Vector3::new(v.x * m.m11, v.y * m.m22, v.z * m.m33);
        }
        let row = |i: usize| v.x * m[(i, 0)] + v.y * m[(i, 1)] + v.z * m[(i, 2)];
        Vector3::new(row(0), row(1), row(2))
    }

    /// Whether its feet are frictionless: no horizontal force acts on them, and their horizontal springs have no stretch.
    #[inline(always)]
    pub fn is_frictionless(&self) -> bool {
        self.friction == 0.0
    }

    /// Returns the greater of the stiffnesses of a foot that act, K and K_h (N/m).
    pub(super) fn greater_stiffness(&self) -> f64 {
        self.stiffness.max(if self.is_frictionless() { 0.0 } else { self.horizontal_stiffness })
    }

    /// Returns K/C, the rate at which a lifted support creeps back (1/s).
    #[inline]
    pub fn creep_rate(&self) -> f64 {
        self.stiffness / self.damping
    }

    /// Returns the tilt over the critical one, at which the centre of mass stands over an edge of the base in the direction of the lean (1).
    pub fn tilt_over_critical(&self, lean: &Lean<Dual>) -> Dual {
        let first = &self.edges[0];
        let ahead = self.edges.iter().fold(first, |ahead, edge| if edge.leads(ahead, lean) { edge } else { ahead });
        ahead.tilt_over_critical(lean, self.center_height)
    }

    /// Returns M g R0 (J), the scale of energies.
    pub fn energy_scale(&self) -> f64 {
        self.mass * self.gravity * self.r0
    }

    /// Finds the greatest circular frequencies, with the stiffer spring of a foot that acts in all directions: bounds for any rotation.
    fn find_frequencies(&mut self, root: &Cholesky<f64, Const<3>>) {
        let stiffness = self.greater_stiffness();
        let mut sum = Matrix6::zeros();
        for foot in &mut self.feet {
            // The foot's displacement as the body moves and turns, each with the same kinetic energy.
            let mut displacement = Matrix3x6::zeros();
            displacement.fixed_columns_mut::<3>(0).fill_with_identity();
            displacement /= self.mass.sqrt();
            let turning = root.l_dirty().solve_lower_triangular(&foot.place.cross_matrix());
            displacement.fixed_columns_mut::<3>(3).copy_from(&turning.unwrap_or_default().transpose());
            let mobility: Matrix3<f64> = displacement * displacement.transpose();
            foot.frequency_square = stiffness * mobility.symmetric_eigenvalues().max();
            sum += displacement.transpose() * displacement * stiffness;
        }
        self.fastest_square = sum.symmetric_eigenvalues().max();
    }
}

/// Returns the number of feet without a gap, the edges of their hull, and the distances (m) of the nearest edge and of the farthest corner.
fn standing_base(feet: &[FootPlace]) -> Result<(usize, Vec<BaseEdge>, [f64; 2]), SpaceError> {
    let standing: Vec<[f64; 2]> = feet.iter().filter(|foot| foot.gap == 0.0).map(|foot| [foot.x, foot.y]).collect();
    let count = standing.len();
    let edges = edges(&standing);
    if edges.is_empty() {
        return Err(SpaceError::OnLine { count });
    }
    let nearest = edges.iter().map(|edge| edge.distance).fold(f64::INFINITY, f64::min);
    let corner = standing.iter().map(|[x, y]| libm::hypot(*x, *y)).fold(0.0, f64::max);
    Ok((count, edges, [nearest, corner]))
}

/// Returns ω_v, ξ_v, and K and C of a foot, with p (rad/s) and the share of the mass (kg) of each foot without a gap.
fn supports(parameters: &SpaceParameters, p: f64, share: f64) -> Result<(f64, f64, f64, f64), SpaceError> {
    Ok(match parameters.supports {
        SpaceSupports::OfRocking { .. } if matches!(parameters.base, Base::List { .. }) => {
            return Err(SpaceError::Missing { name: "omega_v, or K and C" });
        }
        SpaceSupports::OfRocking { eta, xi_v } => of_frequency(eta * p, xi_v, share),
        SpaceSupports::OfHeave { omega_v, xi_v } => of_frequency(omega_v, xi_v, share),
        SpaceSupports::OfFoot { stiffness, damping } => {
            let omega_v = (stiffness / share).sqrt();
            (omega_v, damping / (2.0 * share * omega_v), stiffness, damping)
        }
    })
}

/// Returns ω_v, ξ_v, and K and C of a foot that carries this mass (kg).
fn of_frequency(omega_v: f64, xi_v: f64, mass: f64) -> (f64, f64, f64, f64) {
    (omega_v, xi_v, mass * omega_v * omega_v, 2.0 * xi_v * mass * omega_v)
}

/// Returns the places of the feet and the inertia of the shape.
fn plan(parameters: &SpaceParameters) -> Result<Plan, SpaceError> {
    let &SpaceParameters { mass, gamma, gravity, eccentricity: [e_x, e_y], .. } = parameters;
    let of_size = |size: &BaseSize| match *size {
        BaseSize::Slenderness { alpha, p } => {
            let r0 = gamma / (1.0 + gamma) * gravity / (p * p);
            (r0 * libm::sin(alpha), r0 * libm::cos(alpha))
        }
        BaseSize::Lengths { width, center_height } => (0.5 * width, center_height),
    };
    let foot = |x: f64, y: f64| FootPlace { x: x - e_x, y: y - e_y, gap: 0.0 };
    for (name, value) in [("eccentricity_x", e_x), ("eccentricity_y", e_y)] {
        check_finite(name, value)?;
    }
    match &parameters.base {
        Base::Rectangle { size, depth_ratio } => {
            let (b, h) = of_size(size);
            let d = depth_ratio * b;
            let [bb, dd, hh] = [b * b, d * d, h * h];
            Ok(Plan {
                half_width: Some(b),
                center_height: h,
                feet: vec![foot(-b, -d), foot(-b, d), foot(b, -d), foot(b, d)],
                shape_inertia: Some([mass * (dd + hh) / gamma, mass * (bb + hh) / gamma, mass * (bb + dd) / gamma]),
            })
        }
        Base::Circle { size, feet } => {
            check_count(*feet)?;
            let (a, h) = of_size(size);
            let across = mass * (0.25 * a * a + h * h / 3.0) * 3.0 / gamma;
            let on_circle = |i: usize| {
                let (sin, cos) = libm::sincos(TAU * i as f64 / *feet as f64);
                foot(a * cos, a * sin)
            };
            Ok(Plan {
                half_width: Some(a),
                center_height: h,
                feet: (0..*feet).map(on_circle).collect(),
                shape_inertia: Some([across, across, mass * a * a * 0.5 * 3.0 / gamma]),
            })
        }
        Base::List { feet, center_height } => {
            check_count(feet.len())?;
            for foot in feet {
                check_finite("foot_x", foot.x)?;
                check_finite("foot_y", foot.y)?;
                check("foot_gap", Valid::NotNegative, foot.gap)?;
            }
            for (name, eccentricity) in [("eccentricity_x", e_x), ("eccentricity_y", e_y)] {
                if eccentricity != 0.0 {
                    return Err(out_of_range(
                        name,
                        eccentricity,
                        "0 with a list of feet, which are seen from the centre of mass",
                    ));
                }
            }
            Ok(Plan { half_width: None, center_height: *center_height, feet: feet.clone(), shape_inertia: None })
        }
    }
}

fn out_of_range(name: &'static str, value: f64, expected: &'static str) -> SpaceError {
    crate::block::BlockError::OutOfRange { name: name.into(), value, expected }.into()
}

fn check_finite(name: &'static str, value: f64) -> Result<(), SpaceError> {
    if value.is_finite() { Ok(()) } else { Err(out_of_range(name, value, "a finite number")) }
}

fn check_count(count: usize) -> Result<(), SpaceError> {
    if (FEET[0]..=FEET[1]).contains(&count) { Ok(()) } else { Err(SpaceError::Count { count }) }
}

/// Decomposes an inertia, unless no body has it.
fn decompose(inertia: &Matrix3<f64>) -> Result<Cholesky<f64, Const<3>>, SpaceError> {
    /// Excess of a moment over the sum of the others that round-off of a flat body makes.
    const ROUNDING: f64 = 1e-12;
    let principal = if inertia.iter().all(|moment| moment.is_finite()) {
        inertia.symmetric_eigenvalues()
    } else {
        Vector3::repeat(f64::NAN)
    };
    let (least, most, sum) = (principal.min(), principal.max(), principal.sum());
    let possible = least > 0.0 && most <= (sum - most) * (1.0 + ROUNDING);
    match Cholesky::new(*inertia) {
        Some(root) if possible => Ok(root),
        Some(_) | None => Err(SpaceError::Inertia { principal: principal.into() }),
    }
}

/// Returns the loads of the feet at rest (N): springs of equal stiffness under a body that stands upright.
fn static_loads(feet: &[FootPlace], weight: f64) -> Result<Vec<f64>, SpaceError> {
    /// Area of a base over the square of its length that counts as none.
    const NO_AREA: f64 = 1e-12;
    let standing = || feet.iter().filter(|foot| foot.gap == 0.0);
    let count = standing().count();
    if count < FEET[0] {
        return Err(SpaceError::Gaps { count });
    }
    let n = count as f64;
    let mean = |of: &dyn Fn(&FootPlace) -> f64| standing().map(of).sum::<f64>() / n;
    // About the middle of the feet the equations are those of two principal directions.
    let (x_m, y_m) = (mean(&|foot| foot.x), mean(&|foot| foot.y));
    let xx = mean(&|foot| (foot.x - x_m) * (foot.x - x_m));
    let xy = mean(&|foot| (foot.x - x_m) * (foot.y - y_m));
    let yy = mean(&|foot| (foot.y - y_m) * (foot.y - y_m));
    let determinant = xx * yy - xy * xy;
    if determinant.is_nan() || determinant <= NO_AREA * (xx + yy) * (xx + yy) {
        return Err(SpaceError::OnLine { count });
    }
    // The weight acts at the centre of mass, −x_m and −y_m from the middle.
    let (c_x, c_y) = ((-x_m * yy + y_m * xy) / determinant, (-y_m * xx + x_m * xy) / determinant);
    let mut loads = Vec::with_capacity(feet.len());
    for (i, foot) in feet.iter().enumerate() {
        let &FootPlace { x, y, gap } = foot;
        let load = if gap > 0.0 { 0.0 } else { weight / n * (1.0 + c_x * (x - x_m) + c_y * (y - y_m)) };
        if gap == 0.0 && (load.is_nan() || load <= 0.0) {
            return Err(SpaceError::Unloaded { foot: i, x, y, load });
        }
        loads.push(load);
    }
    Ok(loads)
}
