//! End of runs without a duration, and the rule that counts a separation as overturning.

use rocking_block::block::restraints::Tie;
use rocking_block::block::{Block, Common, Corner, Dimensionless, Foundation, Ratios, Regime, Supports};
use rocking_block::excitation::records::Ground;
use rocking_block::excitation::{Forcing, Inputs, Pulse, PulseShape};
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Ending, Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::dynamics::instant;
use rocking_block::system::events::EventKind;
use rocking_block::system::forces::energy;
use rocking_block::system::instant::Footing;
use rocking_studies::run::outcome::{Count, End};
use rocking_studies::run::stopping_rule::{fraction_of_barrier, overturning_barrier, tied_rocking_period};
use rocking_studies::run::{History, Run};
use rocking_studies::statistics::sampling::LatinHypercube;

fn block(alpha: f64, eta: f64, epsilon: f64, foundation: Foundation) -> Block {
    let common = Common { epsilon, ..Common::default() };
    Block::from_dimensionless(
        &Dimensionless { alpha, p: 1.3, supports: Supports::of(foundation, Ratios { eta, xi_v: 0.1 }) },
        &common,
    )
    .unwrap()
}

fn run(block: Block, initial: Initial, pulse: Pulse, on_separation: OnSeparation) -> Run {
    let settings = Settings { on_separation, ..Settings::default() };
    let ground = Ground::default();
    Run { block, settings, initial, pulse, ground, duration: None, output_step: f64::INFINITY }
}

/// The barrier is the least potential energy at |θ| = α, here searched over the height of the block.
#[test]
fn the_barrier_is_the_least_potential_energy_at_alpha() {
    let potential = |block: &Block, regime, height| {
        let footing = Footing::AT_START;
        energy(
            block,
            regime,
            &Forcing::<f64>::default(),
            &instant(block, regime, [block.alpha, 0.0, height, 0.0], footing, Forcing::default()),
        )
        .1
    };
    // Under the last block both supports bear at α.
    for (alpha, eta) in [(0.1, 80.0), (0.25, 40.0), (0.3, 20.0), (0.25, 4.63)] {
        let block = block(alpha, eta, 0.0, Foundation::Viscoelastic);
        let both = block.b * alpha.sin() < block.static_deflection();
        assert_eq!(both, eta < 5.0);
        let regime = if both { Regime::FullContact } else { Regime::TiltingRight };
        let deflection = block.static_deflection();
        let heights = (-4000..4000).map(|i| deflection * f64::from(i) / 1000.0);
        let least = heights.map(|height| potential(&block, regime, height)).fold(f64::INFINITY, f64::min);
        let barrier = overturning_barrier(&block);
        assert!((least - barrier).abs() < 1e-9 * block.gravity * block.r0, "{barrier}, searched {least}");
    }
    let rigid = block(0.25, 40.0, 0.0, Foundation::Rigid);
    let exact = potential(&rigid, Regime::TiltingRight, 0.0);
    assert!((overturning_barrier(&rigid) / exact - 1.0).abs() < 1e-14);
}

/// With an eccentric centre of mass the barrier is the lower one of both sides. There both supports of the last block bear load.
#[test]
fn the_barrier_of_an_uneven_block_is_the_lower_one_of_both_sides() {
    for (eta, uneven) in [(80.0, 0.3), (40.0, -0.5), (20.0, 0.1), (4.63, 0.02)] {
        let even = block(0.25, eta, 0.0, Foundation::Viscoelastic);
        let common = Common { eccentricity: uneven * even.b, ..Common::default() };
        let block = Block::from_dimensionless(
            &Dimensionless { alpha: 0.25, p: 1.3, supports: Supports::Viscoelastic(Ratios { eta, xi_v: 0.1 }) },
            &common,
        )
        .unwrap();
        let deflection = block.static_deflection();
        let least = |corner: Corner, tilting: Regime| {
            let theta = -corner.sign() * block.alpha_of(corner);
            let regime = if eta < 5.0 { Regime::FullContact } else { tilting };
            let heights = (-8000..8000).map(|i| deflection * f64::from(i) / 2000.0);
            let potentials = heights.map(|height| {
                let x = instant(&block, regime, [theta, 0.0, height, 0.0], Footing::AT_START, Forcing::default());
                energy(&block, regime, &Forcing::<f64>::default(), &x).1
            });
            potentials.fold(f64::INFINITY, f64::min)
        };
        let sides = [least(Corner::Left, Regime::TiltingLeft), least(Corner::Right, Regime::TiltingRight)];
        let (searched, barrier) = (sides[0].min(sides[1]), overturning_barrier(&block));
        assert!((searched - barrier).abs() < 1e-7 * block.gravity * block.r0, "{barrier}, searched {sides:?}");
    }
}

/// The rocking period with ties is that of a block that loses no energy, measured over three landings.
#[test]
fn the_rocking_period_with_ties_is_the_measured_one() {
    let plain = block(0.25, 40.0, 0.0, Foundation::Rigid);
    let common = Common::default();
    let elastic = |ties: &[Tie]| {
        let dimensionless = Dimensionless {
            alpha: 0.25,
            p: 1.3,
            supports: Supports::Rigid { restitution_factor: 1.0 / plain.restitution() },
        };
        Block::from_dimensionless(&dimensionless, &common).unwrap().with_ties(ties).unwrap()
    };
    let (b, weight) = (plain.b, plain.mass * plain.gravity);
    let tie = Tie { stiffness: 0.4 * weight / b, ..Tie::default() };
    let tendon = Tie { ground: [0.0, -2.0 * b], pretension: 0.05 * weight, ..tie };
    let guy = Tie { block: [b, 4.0 * b], ground: [6.0 * b, 0.0], ..tie };
    let slack = Tie { block: [-b, 5.0 * b], ground: [-7.0 * b, 0.0], slack: 0.05 * b, ..tie };
    // Hardly any stiffness: a constant force to the right.
    let pulls = Tie { stiffness: 0.01 * weight / b, pretension: 0.01 * weight, slack: 0.0, ..guy };
    let [without, stiff, ..] = [&[][..], &[tendon], &[guy], &[slack], &[tendon, slack], &[pulls]].map(|ties| {
        let (block, inputs) = (elastic(ties), Inputs::default());
        let settings = Settings { tolerance: 1e-10, ..Settings::default() };
        let initial = Initial { theta: 0.08, ..Initial::default() };
        let mut simulation = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
        let fraction = fraction_of_barrier(&simulation).unwrap();
        let rule = tied_rocking_period(&block, &simulation.restraints(), 0.0, 0.08, fraction);
        let mut landings = vec![];
        let take = &mut |event: &_| {
            let &rocking_block::system::events::Event { time, kind, .. } = event;
            landings.extend(matches!(kind, EventKind::Landing(_)).then_some(time));
        };
        simulation.advance(20.0, &inputs, take).unwrap();
        let measured = landings[2] - landings[0];
        assert!((rule / measured - 1.0).abs() < 2e-4, "{ties:?}: {rule} s, measured {measured} s");
        rule
    });
    let exact = 4.0 / plain.p * (1.0 / (1.0 - 0.08 / 0.25_f64)).acosh();
    assert!(stiff < 0.96 * without, "{without} s, with a tendon {stiff} s");
    // Housner's formula, for a slender block.
    assert!((without / exact - 1.0).abs() < 0.02, "{without} s, Housner's {exact} s");
}

/// Released at rest on either side of α, one block comes down and the other overturns, after a long time.
#[test]
fn a_block_that_lingers_near_alpha_is_followed_to_its_outcome() {
    for (theta, end) in [(0.25 * (1.0 - 1e-9), End::Completed), (0.25 * (1.0 + 1e-9), End::Overturned)] {
        let rigid = block(0.25, 40.0, 0.0, Foundation::Rigid);
        let initial = Initial { theta, ..Initial::default() };
        let outcome = run(rigid, initial, Pulse::NONE, OnSeparation::Terminate).outcome();
        assert_eq!(outcome.end, end);
        // It departs from α as 1e-9 α cosh(p t).
        assert!(outcome.end_time > 2e9_f64.ln() / 1.3, "{}", outcome.end_time);
    }
}

/// Released beyond α, a block leans out into a guy that holds it, and its run ends there; without the guy it overturns.
#[test]
fn a_block_that_a_guy_holds_beyond_alpha_is_at_rest() {
    let plain = block(0.25, 40.0, 0.0, Foundation::Rigid);
    let (b, h, weight) = (plain.b, plain.h, plain.mass * plain.gravity);
    let guy = Tie {
        block: [0.0, 2.0 * h],
        ground: [-3.0 * h, 2.0 * h],
        stiffness: 2.0 * weight / b,
        slack: 2.2 * b,
        damping: weight / (b * plain.p),
        ..Tie::default()
    };
    let initial = Initial { theta: 0.27, ..Initial::default() };
    let of = |block| run(block, initial, Pulse::NONE, OnSeparation::Terminate).outcome();
    let held = of(plain.with_ties(&[guy]).unwrap());
    assert_eq!(held.end, End::Completed);
    assert!(held.peaks.theta > 1.05 * plain.alpha && held.end_time < 60.0 / plain.p, "{held:?}");
    assert_eq!(of(plain).end, End::Overturned);
}

/// A block that never moves is at rest with the ground; one that cannot lose energy is followed for 100/p.
#[test]
fn the_shortest_and_the_longest_run() {
    let rigid = block(0.25, 40.0, 0.0, Foundation::Rigid);
    let weak = Pulse { shape: PulseShape::OneSine, amplitude: 1.0, period: 1.0, start: 0.5, ..Pulse::NONE };
    let outcome = run(rigid, Initial::default(), weak, OnSeparation::Terminate).outcome();
    assert_eq!((outcome.end, outcome.end_time, outcome.peaks.theta), (End::Completed, 1.5, 0.0));
    let elastic = block(0.25, 40.0, 1.0, Foundation::Rigid);
    let high = Initial { theta: 0.24, ..Initial::default() };
    let outcome = run(elastic, high, Pulse::NONE, OnSeparation::Terminate).outcome();
    // Above 95 % of the barrier its future is uncertain.
    assert_eq!((outcome.end, outcome.end_time), (End::Undecided, 100.0 / 1.3));
    assert!(outcome.counts.impacts > 10);
    let lower = Initial { theta: 0.1, ..Initial::default() };
    let history = run(elastic, lower, Pulse::NONE, OnSeparation::Terminate).history(|_| ()).unwrap();
    assert_eq!((history.end, history.is_at_rest), (End::Completed, false));
    assert_eq!(history.rows.last().map(|row| row.time), Some(100.0 / 1.3));
}

/// A released block is followed until no corner lifts any more; another 100/p bring no event.
#[test]
fn free_motion_is_followed_until_the_block_is_at_rest() {
    for (alpha, eta, theta, foundation) in [
        (0.25, 80.0, 0.2, Foundation::Viscoelastic),
        (0.25, 40.0, -0.2, Foundation::Viscoelastic),
        (0.1, 40.0, 0.09, Foundation::Viscoelastic),
        (0.3, 20.0, 0.28, Foundation::Viscoelastic),
        (0.25, 40.0, 0.2, Foundation::Rigid),
        (0.08, 40.0, 0.07, Foundation::Rigid),
    ] {
        let block = block(alpha, eta, 0.0, foundation);
        let run = run(block, Initial { theta, ..Initial::default() }, Pulse::NONE, OnSeparation::Terminate);
        let history = run.history(|_| ()).unwrap();
        assert!(history.end == End::Completed && history.is_at_rest, "{alpha} {eta} {:?}", history.end);
        let last = history.rows.last().unwrap();
        let lifts = if foundation == Foundation::Rigid { 0.0 } else { block.separation_angle() };
        assert!(last.observation.theta.abs() <= 0.011 * lifts && last.regime == Regime::FullContact, "{last:?}");
        let longer = Run { duration: Some(last.time + 100.0 / block.p), ..run.clone() }.history(|_| ()).unwrap();
        // Other stops change the last digits.
        let kinds = |history: &History| history.events.iter().map(|event| event.kind).collect::<Vec<_>>();
        assert_eq!(kinds(&history), kinds(&longer));
        assert!(history.counts.impacts > 3);
        let outcome = run.outcome();
        assert_eq!((outcome.end, outcome.end_time, outcome.counts), (history.end, last.time, history.counts));
    }
}

/// An outcome reached within a duration, standing or overturned, is that of the run without one.
#[test]
fn a_duration_that_is_too_short_leaves_the_outcome_undecided() {
    let cube = LatinHypercube::new(120, 4, 7);
    let (mut undecided, mut decided, mut beyond) = (0, 0, 0.0_f64);
    for number in 0..120 {
        let [alpha, strength, period, part] = [0, 1, 2, 3].map(|direction| cube.coordinate(number, direction));
        let foundation = if number % 3 == 0 { Foundation::Rigid } else { Foundation::Viscoelastic };
        let block = block(0.06 + 0.2 * alpha, 40.0, 0.1, foundation);
        let amplitude = (1.2 + 4.0 * strength) * block.gravity * block.alpha.tan();
        let pulse =
            Pulse { shape: PulseShape::OneCosine, amplitude, period: 0.3 + 2.0 * period, start: 0.0, ..Pulse::NONE };
        let run = run(block, Initial::default(), pulse, OnSeparation::Fly);
        let end = run.outcome().end;
        let short = Run { duration: Some(8.0 * part), ..run };
        let outcome = short.outcome();
        assert_eq!(short.history(|_| ()).unwrap().end, outcome.end);
        if outcome.end == End::Undecided {
            undecided += 1;
            beyond = beyond.max(outcome.peaks.theta / block.alpha);
        } else {
            decided += 1;
            assert_eq!(outcome.end, end, "block {number} after {} s", 8.0 * part);
        }
    }
    assert!(undecided > 20 && decided > 20 && beyond > 2.0, "{undecided}, {decided}, {beyond}");
}

/// A block that is bound to come to rest does so, with an unchanged peak; `examples/separations.rs` has more cases.
#[test]
fn nothing_happens_after_the_end() {
    let cube = LatinHypercube::new(60, 4, 3);
    let (mut stood, mut fell) = (0, 0);
    for number in 0..60 {
        let [alpha, eta, strength, period] = [0, 1, 2, 3].map(|direction| cube.coordinate(number, direction));
        let foundation = if number % 3 == 0 { Foundation::Rigid } else { Foundation::Viscoelastic };
        let block = block(0.06 + 0.2 * alpha, 20.0 + 60.0 * eta, 0.2, foundation);
        let amplitude = (1.2 + 4.0 * strength) * block.gravity * block.alpha.tan();
        let pulse =
            Pulse { shape: PulseShape::OneCosine, amplitude, period: 0.3 + 2.0 * period, start: 0.0, ..Pulse::NONE };
        let short = run(block, Initial::default(), pulse, OnSeparation::Fly);
        let outcome = short.outcome();
        fell += u32::from(outcome.end == End::Overturned);
        if outcome.end == End::Completed {
            stood += 1;
            let longer = Run { duration: Some(outcome.end_time + 60.0), ..short }.outcome();
            assert_eq!(longer.end, End::Completed, "block {number}");
            assert!((longer.peaks.theta / outcome.peaks.theta - 1.0).abs() < 1e-6, "block {number}");
        }
    }
    assert!(stood > 10 && fell > 10, "{stood} stood, {fell} fell");
}

/// A block that separates beyond α on its way over also overturns if it flies on; its end has both flags.
#[test]
fn a_block_that_separates_on_its_way_over_has_overturned() {
    let block = block(0.2, 60.0, 0.0, Foundation::Viscoelastic);
    let amplitude = 5.0;
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period: 1.2, start: 0.0, ..Pulse::NONE };
    let paper = run(block, Initial::default(), pulse, OnSeparation::Terminate);
    let history = paper.history(|_| ()).unwrap();
    let Some((ending, time)) = history.ending else { panic!("{:?}", history.events) };
    assert_eq!(ending, Ending::Toppled);
    assert!(ending.is_separation() && ending.is_overturning());
    let last = history.rows.last().unwrap().observation;
    assert!(last.theta.abs() >= 0.2 && last.theta.abs() < 1.5 && last.theta * last.theta_dot > 0.0);
    let outcome = paper.outcome();
    assert_eq!((outcome.end, outcome.end_time), (End::Overturned, time));
    assert_eq!(outcome.flights, Count { count: 1, first: Some(time) });
    let flying = run(block, Initial::default(), pulse, OnSeparation::Fly).outcome();
    assert_eq!(flying.end, End::Overturned);
    assert!(flying.end_time > time && (flying.peaks.theta - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
}

/// Both sides of the rule: below α, at α, and on the way back.
#[test]
fn only_a_block_beyond_alpha_with_growing_rotation_is_on_its_way_over() {
    for (theta, theta_dot, ending) in [
        (0.19, 1.0, Ending::Separated),
        (0.2, 1.0, Ending::Toppled),
        (-0.2, -1.0, Ending::Toppled),
        (0.3, -1.0, Ending::Separated),
        (-0.3, 1.0, Ending::Separated),
        (0.3, 0.0, Ending::Separated),
    ] {
        assert_eq!(Ending::at_separation(0.2, theta, theta_dot), ending, "{theta} {theta_dot}");
    }
}

/// A held block stays in the history until the duration is over; without a duration the run ends.
#[test]
fn a_held_block_stays_in_the_history() {
    let block = block(0.25, 80.0, 0.8, Foundation::Viscoelastic);
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 6.0, period: 1.0, start: 0.0, ..Pulse::NONE };
    let run = Run { output_step: 0.125, ..run(block, Initial::default(), pulse, OnSeparation::Hold) };
    let over = run.history(|_| ()).unwrap();
    let Some((Ending::Separated, time)) = over.ending else { panic!("{:?}", over.ending) };
    assert_eq!(over.rows.last().map(|row| row.regime), Some(Regime::Separated));
    let seen = Run { duration: Some(4.0), ..run.clone() }.history(|_| ()).unwrap();
    assert_eq!(seen.ending, over.ending);
    assert_eq!(seen.rows.len(), 33);
    let held: Vec<_> = seen.rows.iter().filter(|row| row.time > time).collect();
    assert!(held.len() > 10);
    assert!(
        held.iter().all(|row| row.observation.theta == held[0].observation.theta && row.observation.theta_dot == 0.0)
    );
    let outcome = Run { duration: Some(4.0), ..run }.outcome();
    assert_eq!((outcome.end, outcome.end_time), (End::Separated, time));
}

/// A run ends only once the foot slides no more: neither the slip nor any other peak rises afterwards.
#[test]
fn nothing_rises_after_the_end_of_a_run_with_friction() {
    let cube = LatinHypercube::new(400, 6, 11);
    let mut slid = 0;
    for number in 0..400 {
        let [alpha, friction, strength, period, eta, epsilon] =
            std::array::from_fn(|direction| cube.coordinate(number, direction));
        let foundation = if number % 2 == 0 { Foundation::Rigid } else { Foundation::Viscoelastic };
        let friction = 0.02 * 25.0_f64.powf(friction);
        let common = Common { epsilon: 0.5 * epsilon, friction, ..Common::default() };
        let dimensionless = Dimensionless {
            alpha: 0.1 + 0.5 * alpha,
            p: 2.0,
            supports: Supports::of(foundation, Ratios { eta: 10.0 + 60.0 * eta, xi_v: 0.2 }),
        };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let amplitude = (0.5 + 3.0 * strength) * block.gravity * block.alpha.tan();
        let shape = [PulseShape::HalfSine, PulseShape::OneSine, PulseShape::OneCosine][number as usize % 3];
        let pulse = Pulse { shape, amplitude, period: 0.3 + 1.5 * period, start: 0.0, ..Pulse::NONE };
        let short = run(block, Initial::default(), pulse, OnSeparation::Fly);
        let outcome = short.outcome();
        if outcome.end != End::Completed {
            continue;
        }
        slid += u32::from(outcome.peaks.slip > 0.01);
        let longer = Run { duration: Some(outcome.end_time + 60.0), ..short }.outcome();
        // A late landing on supports may leave the foot sliding for less than a microsecond, in which H is μ N.
        let (supported, shear) = (foundation == Foundation::Viscoelastic, 1.1 * friction * block.mass * block.gravity);
        let brief = if supported { [0.0, 0.0, shear, 0.0, friction] } else { [0.0; 5] };
        let peaks = |peaks: Peaks| {
            let Peaks { theta, slip, horizontal, reaction, friction_demand, .. } = peaks;
            [theta, slip, horizontal, reaction, friction_demand]
        };
        for (peak, (early, late)) in peaks(outcome.peaks).into_iter().zip(peaks(longer.peaks)).enumerate() {
            let bound = (1.001 * early + 1e-6).max(brief[peak]);
            assert!(late <= bound, "block {number}, peak {peak}: {early}, then {late}");
        }
    }
    assert!(slid > 40, "{slid}");
}
