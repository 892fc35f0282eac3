//! A block after the ground has come to rest → the end of its run.
//!
//! A run without a given duration ends once the ground is at rest and the block has come down: it has overturned (or
//! separated, where that ends the run), is at rest, or will come to rest. A block with |θ| < α will come to rest if its
//! energy is below the barrier `V(α)` against overturning. Without excitation the energy decreases, so that the next cycle of
//! motion is the greatest; after it, the outcome and the peaks are known. A free motion is followed until the block is at rest.
//! A foot may slide on, or with each swing, and adds to its slip: such a run ends one cycle after the last slip.
//!
//! The barrier is that of the block without ties: the energy of a tie is never negative, so that a tied block below it does not
//! overturn either. Pretensioned ties may hold more energy than that even at rest: such a block is followed until it rests, upright
//! or leaning on a tie.

use std::f64::consts::{FRAC_PI_2, TAU};

use rocking_block::block::restraints::{States, TieState, tie};
use rocking_block::block::{Block, Body, Corner, Foundation, Regime};
use rocking_block::excitation::Inputs;
use rocking_block::simulation::Simulation;

/// Fraction of the barrier that the energy must stay below.
///
/// The margin covers the energy that a lift-off adds until the next landing: 0.1 % at η = 40, 2 % at η = 10
/// (docs/unit/model.md).
const BELOW_THE_BARRIER: f64 = 0.95;

/// Longest time after the ground has come to rest, in 1/p. Blocks without energy loss reach it.
///
/// Approaching the unstable equilibrium to 1e-10 α takes 24/p, and leaving it as long.
const MAX_TIME: u64 = 100;

/// Longest time in 1/p of blocks that lose energy, or whose feet may slide. Slender ones rock for long.
const MAX_DECAY: u64 = 1000;

/// Fraction of the lift-off energy below which a block on supports is at rest. It is that of 1 % of the lift-off rotation.
const AT_REST: f64 = 1e-4;

/// Barrier against overturning per unit mass (m²/s²): the lower one of both sides.
pub fn overturning_barrier(block: &Block) -> f64 {
    let [left, right] = Corner::each(|corner| barrier_over(block, corner));
    left.min(right)
}

/// Barrier against overturning about a corner I, per unit mass (m²/s²). It is the least potential energy at |θ| = α_I, relative to rest.
///
/// On the rigid base `g R_I (1 − cos α_I)`; on supports less by `g δ_s/2`, since the support that carries all the weight sinks by a
/// further δ_s. On supports so soft that both touch at |θ| = α_I, the energy of both springs and of the lowered weight.
///
/// With the shares s of the weight that the supports bear at rest, the weight sinks by `2 δ_s (1 − s_I)`, which leaves `g R_I (1 − cos α_I)
/// − g δ_s (1 + s_L² + s_R² − 2 s_I)`.
fn barrier_over(block: &Block, corner: Corner) -> f64 {
    let Body { gravity, b, h, omega_v, weight_fraction: [left, right], .. } = block.body;
    let radius = if block.eccentricity == 0.0 { block.r0 } else { libm::hypot(block.offset(corner), h) };
    let (sin, cos) = (block.offset(corner).abs() / radius, h / radius);
    let rigid = gravity * (radius - h);
    let sunk = block.static_deflection();
    let fraction = block.weight_fraction[corner.index()];
    let other = block.weight_fraction[corner.other().index()];
    match block.foundation {
        Foundation::Rigid => rigid,
        // The other corner has left its support: `2 b sin α_I ≥ 2 δ_s + δ_J − δ_I`.
        Foundation::Viscoelastic if b * sin >= sunk * (1.0 + other - fraction) => {
            rigid - gravity * sunk * (1.0 + left * left + right * right - 2.0 * fraction)
        }
        Foundation::Viscoelastic => sin * sin * (0.5 * omega_v * omega_v * b * b - gravity * h / (1.0 + cos)),
    }
}

/// Longest rocking period (s) at an energy of `fraction` times the barrier, 0 ≤ fraction < 1.
///
/// On the rigid base `(4/p) arcosh(1/√(1 − fraction))` (Housner 1963, in terms of the energy); supports add the period of rocking
/// in full contact. An uneven block rocks about both corners, at most as slowly as about that with the lower frequency parameter. For a
/// block with ties see [`tied_rocking_period`].
fn cycle(block: &Block, ties: &States, slip: f64, theta: f64, fraction: f64) -> f64 {
    let Body { b, h, i0, gravity, omega_v, .. } = block.body;
    let rocking = match block.ties().is_empty() {
        true => 4.0 / slowest(block) * libm::acosh(1.0 / (1.0 - fraction).sqrt()),
        false => tied_rocking_period(block, ties, slip, theta, fraction),
    };
    let stiffness = omega_v * omega_v * b * b - gravity * h;
    match block.foundation {
        Foundation::Viscoelastic if stiffness > 0.0 => rocking + TAU * ((i0 + h * h) / stiffness).sqrt(),
        Foundation::Viscoelastic | Foundation::Rigid => rocking,
    }
}

/// Rocking period (s) of a block with ties on the rigid base. It has this slip (m), and an energy of `fraction` times the barrier of the
/// rigid base. The period is twice `∫ dθ/θ̇` between the rotations at which the block turns back.
///
/// By energy `½ (I0/M + R_I²) θ̇² = E − g R_I [cos(α_I − |θ|) − cos α_I] − Σ k s²/(2 M)`, with the elastic elongation s of each tie that is not
/// broken; beyond its yield force [`tie::pull::work_to`]. A tendon through the base shortens the period (Vassiliou and Makris
/// 2015); a tie that pulls to a side may lengthen it. Dashpots, impacts, and a gap that only lasting energy would cross are left out.
pub fn tied_rocking_period(block: &Block, ties: &States, slip: f64, theta: f64, fraction: f64) -> f64 {
    /// Intervals of the search for the turning points, over both slenderness angles.
    const SCAN: u32 = 400;
    /// Halvings of the interval of a turning point.
    const HALVINGS: u32 = 50;
    /// Nodes of the integral in the angle of `θ = middle − half cos φ`. It is smooth where the block turns back.
    const NODES: u32 = 400;
    let barrier = Corner::each(|corner| libm::hypot(block.offset(corner), block.h) - block.h);
    let energy = fraction * block.gravity * barrier[0].min(barrier[1]);
    let square = |theta: f64| rate_squared(block, ties, slip, energy, theta);
    let step = (block.alpha_of(Corner::Left) + block.alpha_of(Corner::Right)) / f64::from(SCAN);
    // A block that turns back right now moves to one side.
    let Some(start) = [theta, theta - step, theta + step].into_iter().find(|&theta| square(theta) > 0.0) else {
        return 0.0;
    };
    let turning = |side: f64| {
        let (step, mut inside) = (side * step, start);
        while square(inside + step) > 0.0 && inside.abs() < FRAC_PI_2 {
            inside += step;
        }
        let mut outside = inside + step;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if square(middle) > 0.0 { inside = middle } else { outside = middle }
        }
        inside
    };
    let [left, right] = [turning(-1.0), turning(1.0)];
    let (middle, half) = (0.5 * (left + right), 0.5 * (right - left));
    let slice = std::f64::consts::PI / f64::from(NODES);
    let times = (0..NODES).map(|node| {
        let (sin, cos) = libm::sincos(slice * (f64::from(node) + 0.5));
        slice * half * sin / square(middle - half * cos).max(f64::MIN_POSITIVE).sqrt()
    });
    2.0 * times.sum::<f64>()
}

/// θ̇² (rad²/s²) of a block on the rigid base with this energy. The energy is per unit mass (m²/s²).
fn rate_squared(block: &Block, ties: &States, slip: f64, energy: f64, theta: f64) -> f64 {
    let corner = if theta < 0.0 { Corner::Left } else { Corner::Right };
    let (offset, h) = (block.offset(corner), block.h);
    let (sin, cos) = libm::sincos(theta);
    // The corner stays; the centre of mass rises by `Q − h`.
    let mut potential = block.gravity * (h * cos - offset * sin - h);
    for link in tie::links(block, &ties.ties, &ties.plastic).filter(|link| link.state != TieState::Broken) {
        let tie = link.tie;
        let foot = -block.half_base(corner);
        let [x, z] = [tie.block[0] - foot, tie.block[1]];
        let end = [slip + foot + x * cos + z * sin - tie.ground[0], z * cos - x * sin - tie.ground[1]];
        let free = tie.length() + tie.slack - if tie.stiffness > 0.0 { tie.pretension / tie.stiffness } else { 0.0 };
        potential += tie::pull::work_to(link, libm::hypot(end[0], end[1]) - free) / block.mass;
    }
    2.0 * (energy - potential) / (block.i0 + offset * offset + h * h)
}

/// The lower frequency parameter of both corners (rad/s): `√(g R_I/(I0/M + R_I²))`.
fn slowest(block: &Block) -> f64 {
    if block.eccentricity == 0.0 {
        return block.p;
    }
    let [left, right] = Corner::each(|corner| {
        let radius = libm::hypot(block.offset(corner), block.h);
        (block.gravity * radius / (block.i0 + radius * radius)).sqrt()
    });
    left.min(right)
}

/// Checks a block every 1/p after the ground's rest, until its run is over.
#[derive(Clone, Copy, Debug)]
pub struct StoppingRule {
    /// Time from which the ground is at rest (s).
    ground_at_rest: f64,
    /// Whether the run continues until the block is at rest.
    until_rest: bool,
    /// Number of checks so far.
    checks: u64,
    /// The first check at which the outcome and the peaks are known.
    earliest: Option<u64>,
    /// Whether the last check found the block at rest after that.
    is_over: bool,
    /// Length of the foot's path on the ground at the last check (m).
    path: f64,
}

impl StoppingRule {
    /// Starts the rule for a ground that comes to rest at this time (s).
    ///
    /// The run continues `until_rest`, or until its outcome is known.
    pub fn new(ground_at_rest: f64, until_rest: bool) -> StoppingRule {
        StoppingRule { ground_at_rest, until_rest, checks: 0, earliest: None, is_over: false, path: 0.0 }
    }

    fn time_of(&self, block: &Block, check: u64) -> f64 {
        self.ground_at_rest + check as f64 / block.p
    }

    /// Time of the next check (s), at which the run has to stop.
    pub fn next_check(&self, block: &Block) -> f64 {
        self.time_of(block, self.checks)
    }

    /// Time at which the run is over (s), the latest possible one while unknown.
    pub fn end(&self, block: &Block) -> f64 {
        let decays = block.friction > 0.0 || self.until_rest && loses_energy(block);
        let longest = if decays { MAX_DECAY } else { MAX_TIME };
        let last = match self.earliest {
            Some(_) if self.is_over => self.checks - 1,
            Some(earliest) if !self.until_rest => earliest,
            _ => longest,
        };
        self.time_of(block, last.min(longest))
    }

    /// Checks the block, at the time of the next check.
    pub fn check(&mut self, simulation: &Simulation) {
        let (block, slip, slides) = (simulation.block(), simulation.slip(), simulation.slides());
        let restarts = self.earliest.is_none() || slides || slip.total != self.path;
        self.path = slip.total;
        if let (true, Some(fraction)) = (restarts, fraction_of_barrier(simulation)) {
            let mut ties = simulation.restraints();
            ties.plastic = ties.plastic.map(|_| simulation.plastic_elongations());
            let period = cycle(block, &ties, slip.now, simulation.state()[0], fraction);
            let further = (period * block.p).ceil() as u64;
            self.earliest = Some(self.checks + further.max(u64::from(slides)));
        }
        let is_known = self.earliest.is_some_and(|earliest| self.checks >= earliest);
        self.is_over = self.until_rest && is_known && is_at_rest(simulation);
        self.checks += 1;
    }
}

/// Energy over the barrier, for a block that will come to rest without further excitation.
///
/// `None` for a block that may overturn.
pub fn fraction_of_barrier(simulation: &Simulation) -> Option<f64> {
    let block = simulation.block();
    let barrier = overturning_barrier(block);
    let fraction = simulation.energies().total / (block.mass * barrier);
    let theta = simulation.state()[0];
    let is_below = is_within_balance(block, theta) && barrier > 0.0 && fraction < BELOW_THE_BARRIER;
    if !is_below && is_held_by_ties(simulation) {
        return Some(0.0);
    }
    is_below.then_some(fraction.max(0.0))
}

/// Whether a rotation lies between the unstable equilibria of the block on the rigid base.
fn is_within_balance(block: &Block, theta: f64) -> bool {
    -block.alpha_of(Corner::Left) < theta && theta < block.alpha_of(Corner::Right)
}

/// Whether a block with ties is at rest, upright or leaning on one. Without excitation it neither moves nor begins to.
fn is_held_by_ties(simulation: &Simulation) -> bool {
    /// Kinetic energy of a block at rest, as a part of the barrier. The accelerations are a part of g. On supports of η = 40 this is some 1
    /// % of the rotation of lift-off.
    const STILL: [f64; 2] = [1e-6, 1e-2];
    /// [`STILL`] beyond the balance. There a tie has to hold the block, and a block that merely lingers is not at rest.
    const STILL_BEYOND_BALANCE: [f64; 2] = [1e-12, 1e-6];
    let block = simulation.block();
    if block.ties().is_empty() {
        return false;
    }
    let is_within = is_within_balance(block, simulation.state()[0]);
    if !is_within && !simulation.restraints().ties.into_iter().any(TieState::acts) {
        return false;
    }
    let [kinetic, most_acceleration] = if is_within { STILL } else { STILL_BEYOND_BALANCE };
    let seen = simulation.observe(&Inputs { time: simulation.time(), ..Inputs::default() });
    let acceleration = (seen.theta_ddot * block.r0).abs() + seen.u_ddot.abs() + seen.v_ddot.abs();
    let still = simulation.energies().kinetic <= kinetic * block.mass * overturning_barrier(block);
    still && acceleration <= most_acceleration * block.gravity
}

/// Whether a block is at rest and does not slide. It is on both corners, with too little energy to lift one without excitation; with ties,
/// it may also lean on one.
pub fn is_at_rest(simulation: &Simulation) -> bool {
    let block = simulation.block();
    if simulation.slides() {
        return false;
    }
    if is_held_by_ties(simulation) {
        return true;
    }
    let quiet = match block.foundation {
        Foundation::Rigid => true,
        Foundation::Viscoelastic => {
            // A corner lifts at a deflection of δ_s from equilibrium: ½ K δ_s² = M g δ_s/4.
            let lifting = 0.25 * block.mass * block.gravity * block.static_deflection();
            simulation.energies().total <= AT_REST * lifting
        }
    };
    simulation.regime() == Regime::FullContact && quiet
}

/// Whether dashpots, or impacts on the rigid base, dissipate energy.
pub fn loses_energy(block: &Block) -> bool {
    match block.foundation {
        Foundation::Rigid => block.restitution() < 1.0,
        Foundation::Viscoelastic => block.damping > 0.0,
    }
}
