//! Random blocks with friction, ties, dampers, yielding and an eccentric centre of mass: energy, mirror images, and limits.

use proptest::prelude::*;
use rocking_block::block::restraints::{LinkKind, Tie};
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::{Counts, Initial, OnSeparation, Progress, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};

use crate::cases::cases;

/// A block with its excitation.
#[derive(Clone, Debug)]
struct Draw {
    dimensionless: [f64; 4],
    gamma: f64,
    epsilon: f64,
    eccentricity: f64,
    friction: f64,
    links: Vec<[f64; 12]>,
    rigid: bool,
    flies: bool,
    amplitude: f64,
    period: f64,
    vertical: f64,
    theta: f64,
}

fn draws() -> impl Strategy<Value = Draw> {
    // Those below zero are no yield force, no strength, and no damper.
    let link = [
        -1.0..1.0,
        0.0..2.0,
        -4.0..4.0,
        -2.0..0.5,
        0.05..20.0,
        0.0..0.3,
        0.0..0.03,
        0.0..0.05,
        -2.0..3.0,
        -0.3..0.6,
        0.0..0.9,
        -1.0..1.0_f64,
    ];
    (
        ([0.08..0.6, 0.7..5.0, 10.0..150.0, 0.02..1.0], 1.5..5.0, 0.0..0.9, -0.8..0.8, 0.05..1.2_f64),
        proptest::collection::vec(link, 0..4),
        (any::<bool>(), any::<bool>()),
        (0.5..4.0, 0.1..2.0, -0.6..0.6, -0.3..0.3_f64),
    )
        .prop_map(
            |(
                (dimensionless, gamma, epsilon, eccentricity, friction),
                links,
                (rigid, flies),
                (amplitude, period, vertical, theta),
            )| {
                Draw {
                    dimensionless,
                    gamma,
                    epsilon,
                    eccentricity,
                    friction,
                    links,
                    rigid,
                    flies,
                    amplitude,
                    period,
                    vertical,
                    theta,
                }
            },
        )
}

impl Draw {
    /// Returns the block, or its mirror image.
    fn block(&self, side: f64) -> Option<Block> {
        let [alpha, p, eta, xi_v] = self.dimensionless;
        let foundation = if self.rigid { Foundation::Rigid } else { Foundation::Viscoelastic };
        let common = Common { gamma: self.gamma, epsilon: self.epsilon, ..Common::default() };
        let dimensionless = Dimensionless { alpha, p, supports: Supports::of(foundation, Ratios { eta, xi_v }) };
        let plain = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let friction = if self.rigid { self.friction.min(0.9 * plain.jamming_friction()) } else { self.friction };
        let common = Common { eccentricity: side * self.eccentricity * plain.b, friction: 0.8 * friction, ..common };
        let (b, h, weight) = (plain.b, plain.h, plain.mass * plain.gravity);
        let link =
            |&[x, z, ground_x, ground_z, k, pretension, slack, damping, strength, yields, hardening, kind]: &[f64;
                  12]| {
                let kind = if kind > 0.0 { LinkKind::Damper } else { LinkKind::Tie };
                let of_tie = f64::from(u8::from(kind == LinkKind::Tie));
                Tie {
                    block: [side * x * b, z * h],
                    ground: [side * ground_x * b, (ground_z - 0.1) * h],
                    stiffness: k * weight / b,
                    pretension: of_tie * pretension * weight,
                    slack: of_tie * slack * b,
                    damping: damping * weight / (p * b),
                    strength: strength.max(0.0) * weight,
                    yield_force: yields.max(0.0) * weight,
                    hardening: if yields > 0.0 { hardening } else { 0.0 },
                    kind,
                }
            };
        let ties: Vec<Tie> = self.links.iter().map(link).collect();
        Block::from_dimensionless(&dimensionless, &common).ok()?.with_ties(&ties).ok()
    }

    fn start(&self, side: f64, tolerance: f64) -> Option<(Simulation, Inputs)> {
        let block = self.block(side)?;
        let on_separation = if self.flies { OnSeparation::Fly } else { OnSeparation::Terminate };
        let settings = Settings { tolerance, on_separation, ..Settings::default() };
        let scale = block.gravity * libm::tan(block.alpha);
        let pulse = Pulse {
            shape: PulseShape::OneSine,
            amplitude: side * self.amplitude * scale,
            period: self.period / block.p,
            start: 0.1,
            ..Pulse::NONE
        };
        let inputs = Inputs { a_gz: Ramp::held(self.vertical * block.gravity), ..Inputs::default() };
        let initial = Initial { theta: side * self.theta * block.alpha, ..Initial::default() };
        Some((Simulation::new(block, settings, pulse, &initial, 0.0, &inputs), inputs))
    }
}

macro_rules! ensure {
    ($holds:expr, $($message:tt)*) => {
        let holds: bool = $holds;
        if !holds {
            return Err(format!($($message)*));
        }
    };
}

/// How often a foot slides or grips, or a link tightens, slackens, yields or unloads, again and again in no time.
#[derive(Default)]
struct Repetitions {
    last: Vec<(EventKind, f64)>,
    kind: Option<EventKind>,
    now: u32,
    most: u32,
}

impl Repetitions {
    fn count(&mut self, event: &Event, no_time: f64) {
        // Impacts on the rigid base come ever faster as the block comes to rest.
        if matches!(event.kind, EventKind::LiftOff(_) | EventKind::Landing(_)) {
            self.last.clear();
            return;
        }
        match self.last.iter_mut().find(|(kind, _)| *kind == event.kind) {
            Some((_, time)) => {
                self.now = if event.time - *time < no_time { self.now + 1 } else { 0 };
                *time = event.time;
            }
            None => self.last.push((event.kind, event.time)),
        }
        if self.now > self.most {
            (self.most, self.kind) = (self.now, Some(event.kind));
        }
    }
}

/// Runs a block; fails if its energies or forces are wrong.
fn check(draw: &Draw) -> Result<(), String> {
    let Some((mut simulation, inputs)) = draw.start(1.0, 1e-10) else { return Ok(()) };
    let block = *simulation.block();
    let barrier = block.mass * block.gravity * block.r0 * block.alpha * block.alpha;
    let end = 12.0 / block.p;
    let mut input = 0.0_f64;
    let mut progress = Some(Progress::Reached);
    let mut repeated = Repetitions::default();
    while simulation.time() < end && !matches!(progress, Some(Progress::Ended(..))) {
        let before = simulation.energies().kinetic;
        let [mut lands, mut lifts] = [false; 2];
        simulation
            .apply_pending_event(&inputs, &mut |event| {
                lands |= matches!(event.kind, EventKind::Landing(_));
                lifts |= matches!(event.kind, EventKind::LiftOff(_));
                repeated.count(event, 1e-9 / block.p);
            })
            .map_err(|error| error.to_string())?;
        let after = simulation.energies();
        input = input.max(after.input.abs()).max(after.total.abs());
        let size = barrier + input;
        // Where a corner lifts, its pivot changes, which may add energy (docs/unit/model.md).
        ensure!(
            !lands || lifts || after.kinetic - before <= 1e-12 * size,
            "a landing makes {} J",
            after.kinetic - before
        );
        let now = simulation.time();
        let until = (now + 0.05 / block.p).min(end);
        let reached =
            simulation.advance_to_event(until, now, &inputs, &mut |event| repeated.count(event, 1e-9 / block.p));
        progress = reached.map_err(|error| error.to_string())?;
        let energies = simulation.energies();
        ensure!(repeated.most < 2, "{:?} comes {} times at once, at {now} s", repeated.kind, repeated.most + 1);
        let size = barrier + input.max(energies.input.abs());
        ensure!(energies.residual.abs() < 1e-8 * size, "{energies:?} at {} s", simulation.time());
        let seen = simulation.observe(&inputs);
        let weight = block.mass * block.gravity;
        ensure!(seen.reaction.iter().all(|&n| n > -1e-9 * weight), "{seen:?}");
        let limit = block.friction * (seen.reaction[0] + seen.reaction[1]);
        let over = seen.horizontal.abs() - limit;
        ensure!(
            over <= 1e-6 * (weight + limit),
            "H = {} N, limit {limit} N at {} s",
            seen.horizontal,
            simulation.time()
        );
        let demand = simulation.peaks().friction_demand;
        ensure!(demand <= block.friction * (1.0 + 1e-12), "demand {demand}, friction {}", block.friction);
        ensure!(
            block
                .ties()
                .iter()
                .zip(&seen.restraints)
                .all(|(tie, seen)| tie.kind == LinkKind::Damper || seen.pull > -1e-9 * weight),
            "{seen:?}"
        );
        // A corner on a support lifts and lands without an impact hardly ever.
        let Counts { impacts, liftoffs, .. } = simulation.counts();
        ensure!(draw.rigid || liftoffs <= 2 * impacts + 20, "{liftoffs} lift-offs, {impacts} impacts at {now} s");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(300))]

    /// Energies balance, no landing from flight adds energy, no reaction pulls, and friction stays within its limit.
    #[test]
    fn energies_balance_and_forces_stay_possible(draw in draws()) {
        prop_assert_eq!(check(&draw), Ok(()));
    }

    /// The mirror image of a block moves as the mirror image.
    #[test]
    fn mirror_images_move_alike(draw in draws()) {
        let runs = [1.0, -1.0].map(|side| draw.start(side, 1e-9));
        let [Some((mut right, inputs)), Some((mut left, _))] = runs else { return Ok(()) };
        let block = *right.block();
        for i in 1..20 {
            let until = 0.1 * f64::from(i) / block.p;
            let ends = [&mut right, &mut left].map(|run| run.advance(until, &inputs, &mut |_| ()).unwrap());
            if right.counts().impacts > 3 || matches!(ends[0], Progress::Ended(..)) {
                break;
            }
            let [a, b] = [&right, &left].map(|run| run.observe(&inputs));
            prop_assert!((a.theta + b.theta).abs() < 1e-9 && (a.v - b.v).abs() < 1e-9 * block.r0, "{a:?} {b:?}");
            prop_assert!((right.slip().now + left.slip().now).abs() < 1e-9 * block.r0);
        }
    }
}

/// With increasing friction and softening ties, the motion tends to that of the plain block.
#[test]
fn infinite_friction_and_soft_ties_give_the_plain_block() {
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 6.0, period: 1.2, start: 0.0, ..Pulse::NONE };
    let theta = |foundation, friction, stiffness: f64, eccentricity| {
        let common = Common { friction, eccentricity, ..Common::default() };
        let supports = Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 });
        let block = Block::from_dimensionless(&Dimensionless { alpha: 0.25, p: 1.0, supports }, &common).unwrap();
        let tie = Tie {
            block: [block.b, block.h],
            ground: [4.0 * block.b, 0.0],
            stiffness: stiffness * block.mass * block.gravity / block.b,
            ..Tie::default()
        };
        let block = if stiffness > 0.0 { block.with_ties(&[tie]).unwrap() } else { block };
        let settings = Settings { tolerance: 1e-11, ..Settings::default() };
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
        simulation.advance(4.5, &inputs, &mut |_| ()).unwrap();
        simulation.observe(&inputs).theta
    };
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = theta(foundation, 0.0, 0.0, 0.0);
        assert!(plain.abs() > 0.01, "it rocks: {plain}");
        for (part, close) in [(1e-4, 1e-2), (1e-6, 1e-4), (1e-8, 1e-6)] {
            let tied = theta(foundation, 0.0, part, 0.0);
            assert!((tied - plain).abs() < close, "{foundation:?}: k of {part}: {tied}, not {plain}");
            let uneven = theta(foundation, 0.0, 0.0, part);
            assert!((uneven - plain).abs() < close, "{foundation:?}: e_x = {part} m: {uneven}, not {plain}");
        }
        let most = if foundation == Foundation::Rigid { 1.3 } else { 1e6 };
        let rough = theta(foundation, most, 0.0, 0.0);
        assert!((rough - plain).abs() < 1e-9, "{foundation:?}: with friction {rough}, not {plain}");
    }
}

/// A foot that slides may be stopped by a landing: it then grips, without a velocity.
#[test]
fn landings_stop_feet_that_slide() {
    let mut stopped = 0;
    for i in 0..60 {
        let part = f64::from(i) / 60.0;
        let dimensionless = Dimensionless {
            alpha: 0.25,
            p: 1.0,
            supports: Supports::Viscoelastic(Ratios { eta: 20.0 + 60.0 * part, xi_v: 0.1 }),
        };
        let common = Common { friction: 0.18 + 0.01 * f64::from(i % 12), ..Common::default() };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let pulse =
            Pulse { shape: PulseShape::OneSine, amplitude: 6.0 + 6.0 * part, period: 1.26, start: 0.0, ..Pulse::NONE };
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, Settings::default(), pulse, &Initial::default(), 0.0, &inputs);
        let mut end = None;
        while simulation.time() < 6.0 && !matches!(end, Some(Progress::Ended(..))) {
            let (slid, mut landed) = (simulation.slides(), false);
            simulation
                .apply_pending_event(&inputs, &mut |event| landed = matches!(event.kind, EventKind::Landing(_)))
                .unwrap();
            if landed && slid && !simulation.slides() {
                stopped += 1;
                assert_eq!(simulation.observe(&inputs).slip_rate, 0.0);
            }
            let now = simulation.time();
            end = simulation.advance_to_event(6.0, now, &inputs, &mut |_| ()).unwrap();
        }
    }
    assert!(stopped > 0, "{stopped} landings stopped a foot");
}

/// Impacts come ever faster as this block comes to rest. In between, a tie at its yield surface shortens and elongates by less than the
/// round-off of its length: it yields once it turns, not while it still moves away from the surface.
#[test]
fn a_tie_does_not_yield_while_it_leaves_its_yield_surface() {
    let draw = Draw {
        dimensionless: [0.5100550009558513, 2.169196438693357, 10.0, 0.02],
        gamma: 4.393592072377291,
        epsilon: 0.22584039517829518,
        eccentricity: 0.7636679107448262,
        friction: 0.2295546387646302,
        links: vec![
            [
                -0.3868098345922278,
                0.24601804018515352,
                -1.0105887229290984,
                -1.6228114739569444,
                14.389692727465842,
                0.0,
                0.0,
                0.04450184224720462,
                0.0,
                0.03238726977644694,
                0.8454713918430455,
                0.0,
            ],
            [
                -0.2594613885500677,
                0.000625860492305625,
                1.9558241744791014,
                -0.4177172062275499,
                16.187941787361897,
                0.26870778261428613,
                0.006041024241989974,
                0.0482169906358314,
                0.0,
                0.0,
                0.0,
                0.0,
            ],
        ],
        rigid: true,
        flies: false,
        amplitude: 3.3472226331719144,
        period: 1.5643785420945155,
        vertical: -0.016050090031793366,
        theta: 0.19028685570555043,
    };
    assert_eq!(check(&draw), Ok(()));
}
