//! Ties and dampers that yield: closed forms, energy, mirror images and limits.

use rocking_block::block::restraints::{self, LinkKind, ObservedRestraint, States, Tie, TieState, tie};
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Kinematics, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind, ROUNDING};

use super::random_number;
use crate::cases::cases;

/// Returns a block of α = 0.25 on supports or on the rigid base.
fn plain(foundation: Foundation) -> Block {
    let supports = Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 });
    Block::from_dimensionless(&Dimensionless { alpha: 0.25, p: 1.0, supports }, &Common::default()).unwrap()
}

/// Returns a damper under the corner on this side, with stiffness, yield force and hardening in parts of the weight.
fn damper(block: &Block, side: f64, [stiffness, yield_force, hardening]: [f64; 3]) -> Tie {
    let (b, weight) = (block.b, block.mass * block.gravity);
    Tie {
        block: [side * b, 0.0],
        ground: [side * b, -b],
        stiffness: stiffness * weight / b,
        yield_force: yield_force * weight,
        hardening,
        kind: LinkKind::Damper,
        ..Tie::default()
    }
}

/// Runs a block under a one-sine pulse; returns the run and its events.
fn run(block: Block, amplitude: f64, end: f64) -> (Simulation, Vec<Event>) {
    let settings = Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, ..Settings::default() };
    let pulse = Pulse {
        shape: PulseShape::OneSine,
        amplitude: amplitude * block.gravity * libm::tan(block.alpha),
        period: 1.2,
        start: 0.1,
        ..Pulse::NONE
    };
    let inputs = Inputs::default();
    let mut run = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
    let mut events = Vec::new();
    run.advance(end, &inputs, &mut |event| events.push(*event)).unwrap();
    (run, events)
}

fn of_link(event: &Event) -> Option<(u8, tie::TieEvent)> {
    match event.kind {
        EventKind::Restraint(restraints::RestraintEvent::Tie(_, link, event)) => Some((link, event)),
        _ => None,
    }
}

/// A prescribed motion follows Prager's bilinear loop: from a turning point the force changes by `k Δs` as far as the lines
/// `r k s ± (1 − r) F_y`. A closed loop of amplitude A takes `4 (1 − r) F_y (A − F_y/k)`, and the work of the force is stored or taken.
///
/// All elongations are multiples of a power of 2, so that corners of the loop lie on samples and all sums are exact to round-off.
#[test]
fn a_prescribed_motion_follows_pragers_loop() {
    const BY: f64 = 1.0 / 4096.0;
    const CLOSE: f64 = 1e-13;
    for hardening in [0.0, 0.0625, 0.5] {
        let plain = plain(Foundation::Viscoelastic);
        let (stiffness, amplitude) = (32768.0, 0.25);
        let yield_force = stiffness / 32.0;
        let tie = Tie { block: [0.0, plain.h], ground: [-2.0, plain.h], stiffness, ..Tie::default() };
        let tie = Tie { yield_force, hardening, kind: LinkKind::Damper, ..tie };
        let block = plain.with_ties(&[tie]).unwrap();
        let mut states = States { plastic: Some(Default::default()), ..States::NONE };
        states.ties[0] = TieState::Taut;
        let line = |s: f64, sign: f64| hardening * stiffness * s + sign * (1.0 - hardening) * yield_force;
        let (mut s, mut force, mut events) = (0.0, 0.0, Vec::new());
        let [mut work, mut stored, mut taken, mut taken_in_loop] = [0.0; 4];
        for (turn, to) in [amplitude, -amplitude, amplitude, -amplitude].into_iter().enumerate() {
            let (from, force_there) = (s, force);
            let by = BY.copysign(to - from);
            // The first sample is the turning point, where the rate changes its sign.
            for step in 0..=((to - from) / by) as u32 {
                s = from + f64::from(step) * by;
                let [sin_cos, center, velocity] = [[0.0, 1.0], [s, 0.0], [by, 0.0]];
                let kinematics = Kinematics { sin_cos, theta_dot: 0.0, center, velocity };
                for function in restraints::watched(&block, &states.modes()).into_iter().flatten() {
                    if function.value(&block, &states, &kinematics) < 0.0 {
                        events.extend(function.switch(&block, &mut states, || kinematics, ROUNDING));
                    }
                }
                let exact = (force_there + stiffness * (s - from)).clamp(line(s, -1.0), line(s, 1.0));
                let [ObservedRestraint { pull: found, .. }, ..] = restraints::observe(&block, &states, &kinematics);
                assert!((found - exact).abs() <= CLOSE * yield_force, "{hardening} {turn} {s}: {found}, not {exact}");
                if step > 0 {
                    let loss = restraints::powers(&block, &states, &kinematics).dampers * block.mass;
                    work += 0.5 * (force + found) * by;
                    taken += loss;
                    taken_in_loop += if turn >= 2 { loss } else { 0.0 };
                }
                if turn == 0 {
                    let link = tie::Link { tie: &tie, state: TieState::Taut, plastic: Some(0.0) };
                    assert!((tie::pull::work_to(link, s) - work).abs() <= CLOSE * yield_force * amplitude);
                }
                force = found;
                stored = restraints::energy(&block, &states, &kinematics) * block.mass;
                let rest: f64 = work - taken - stored;
                assert!(rest.abs() <= CLOSE * yield_force * amplitude, "{hardening} {turn} {s}: {rest} J");
            }
        }
        let exact = 4.0 * (1.0 - hardening) * yield_force * (amplitude - yield_force / stiffness);
        assert!((taken_in_loop - exact).abs() <= 1e-12 * exact, "{hardening}: {taken_in_loop}, not {exact}");
        let words: Vec<_> = events.iter().map(|event| event.word()).collect();
        assert_eq!(words, ["yield", "unload", "yield", "unload", "yield", "unload", "yield"]);
        assert!(stored > 0.0);
    }
}

/// The peak of a damper is the greatest force on the way in either sense, also inside a step. Dampers above the corners are pressed.
#[test]
fn the_peak_of_a_damper_counts_its_pushes() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = plain(foundation);
        let above = [-1.0, 1.0].map(|side| {
            let below = damper(&plain, side, [1.0, 0.0, 0.0]);
            Tie { ground: [side * plain.b, 3.0 * plain.b], ..below }
        });
        let block = plain.with_ties(&above).unwrap();
        let (once, _) = run(block, 2.5, 6.0);
        let (mut fine, _) = run(block, 2.5, 0.0);
        let (inputs, mut pushes, mut pulls) = (Inputs::default(), [0.0_f64; 2], [0.0_f64; 2]);
        for millisecond in 1..=6000 {
            fine.advance(1e-3 * f64::from(millisecond), &inputs, &mut |_| ()).unwrap();
            for (i, of) in fine.observe(&inputs).restraints[..2].iter().enumerate() {
                (pushes[i], pulls[i]) = (pushes[i].max(-of.pull), pulls[i].max(of.pull));
            }
        }
        for i in 0..2 {
            let found = once.peaks().pull[i];
            assert!(pushes[i] > 1.5 * pulls[i], "{foundation:?}: {pushes:?} N pushed, {pulls:?} N pulled");
            assert!((found / pushes[i] - 1.0).abs() < 1e-4, "{foundation:?}: {found} N, not {} N", pushes[i]);
        }
    }
}

/// The ends of a tie approach by the greatest shortening on the way, inside a step, slack and after it has broken as well.
#[test]
fn the_shortening_of_a_tie_is_the_approach_of_its_ends() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = plain(foundation);
        let (b, weight) = (plain.b, plain.mass * plain.gravity);
        let tie = |side: f64, strength: f64| Tie {
            block: [side * b, 2.0 * plain.h],
            ground: [2.0 * side * b, 2.0 * plain.h],
            stiffness: 0.5 * weight / b,
            strength: strength * weight,
            ..Tie::default()
        };
        let block = plain.with_ties(&[tie(-1.0, 0.05), tie(1.0, 0.0)]).unwrap();
        let (once, events) = run(block, 2.5, 6.0);
        assert!(events.iter().any(|event| matches!(of_link(event), Some((_, tie::TieEvent::Break)))), "{foundation:?}");
        let (mut fine, _) = run(block, 2.5, 0.0);
        let (inputs, mut greatest) = (Inputs::default(), [0.0_f64; 2]);
        for millisecond in 1..=6000 {
            fine.advance(1e-3 * f64::from(millisecond), &inputs, &mut |_| ()).unwrap();
            for (greatest, link) in greatest.iter_mut().zip(fine.observe(&inputs).restraints) {
                *greatest = greatest.max(-link.elongation);
            }
        }
        for (found, sampled) in once.peaks().elongation.iter().zip(greatest) {
            assert!((found - sampled).abs() < 1e-5 * sampled, "{foundation:?}: {found}, not {sampled}");
        }
        assert!(greatest.iter().all(|shortening| *shortening > 1e-3), "{foundation:?}: {greatest:?}");
    }
}

/// Damping alone makes a dashpot: the limit of soft springs. Its stroke is the greatest elongation on the way, also inside a step.
#[test]
fn damping_alone_makes_a_dashpot() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = plain(foundation);
        let with = |stiffness: f64| {
            let tie = |side: f64| Tie { damping: 0.1 * plain.mass, ..damper(&plain, side, [stiffness, 0.0, 0.0]) };
            plain.with_ties(&[tie(-1.0), tie(1.0)]).unwrap()
        };
        let [(dashpot, _), (soft, _)] = [0.0, 1e-14].map(|stiffness| run(with(stiffness), 2.0, 4.0));
        assert!((dashpot.peaks().theta - soft.peaks().theta).abs() < 1e-9, "{foundation:?}");
        let [taken, expected] = [&dashpot, &soft].map(|run| run.energies().restraints.dampers);
        assert!(taken > 1.0 && (taken - expected).abs() < 1e-7 * expected, "{foundation:?}: {taken}, not {expected} J");
        assert!(dashpot.energies().residual.abs() < 1e-6 * taken, "{foundation:?}: {}", dashpot.energies().residual);
        let inputs = Inputs::default();
        let (mut sampled, mut greatest) = (run(with(0.0), 2.0, 0.0).0, [0.0_f64; 2]);
        for step in 1..=4000 {
            sampled.advance(f64::from(step) * 1e-3, &inputs, &mut |_| ()).unwrap();
            for (greatest, link) in greatest.iter_mut().zip(sampled.observe(&inputs).restraints) {
                *greatest = greatest.max(link.elongation.abs());
            }
        }
        for (found, sampled) in dashpot.peaks().elongation.iter().zip(greatest) {
            assert!((found - sampled).abs() < 1e-5 * sampled, "{foundation:?}: {found}, not {sampled}");
        }
        assert!(greatest[0] > 1e-3);
        assert_eq!(dashpot.peaks().elongation[2..], [0.0; 6]);
    }
}

/// An error on steps that are too many names the number that asks for them.
#[test]
fn a_stiff_link_is_named() {
    let plain = plain(Foundation::Rigid);
    let stiff = |number: fn(&mut Tie) -> &mut f64| {
        let mut tie = damper(&plain, 1.0, [1.0, 0.0, 0.0]);
        *number(&mut tie) = 1e18;
        let block = plain.with_ties(&[damper(&plain, -1.0, [1.0, 0.0, 0.0]), tie]).unwrap();
        let (inputs, initial) = (Inputs::default(), Initial { theta: 0.1, ..Initial::default() });
        let mut run = Simulation::new(block, Settings::default(), Pulse::NONE, &initial, 0.0, &inputs);
        run.advance(1e9, &inputs, &mut |_| ()).unwrap_err().to_string()
    };
    let error = stiff(|tie| &mut tie.stiffness);
    assert!(error.contains("a slower motion than that of damper_2.stiffness"), "{error}");
    let error = stiff(|tie| &mut tie.damping);
    assert!(error.contains("a slower motion than that of damper_2.damping"), "{error}");
}

/// Elastic links lose nothing but their springs' energy `S²/2k` as they break at their strength S.
#[test]
fn links_that_break_lose_the_energy_of_their_springs() {
    for (foundation, kind) in [Foundation::Viscoelastic, Foundation::Rigid]
        .into_iter()
        .flat_map(|foundation| LinkKind::ALL.map(|kind| (foundation, kind)))
    {
        let plain = plain(foundation);
        let weight = plain.mass * plain.gravity;
        let links =
            [-1.0, 1.0].map(|side| Tie { strength: 0.1 * weight, kind, ..damper(&plain, side, [1.0, 0.0, 0.0]) });
        let (run, events) = run(plain.with_ties(&links).unwrap(), 2.5, 6.0);
        let broken = events.iter().filter(|event| matches!(of_link(event), Some((_, tie::TieEvent::Break)))).count();
        assert!(broken > 0, "{events:?}");
        let (energies, [link, _]) = (run.energies(), links);
        let exact = broken as f64 * link.strength * link.strength / (2.0 * link.stiffness);
        let restraints::RestraintEnergies { ties, dampers } = energies.restraints;
        let [lost, none] = if kind == LinkKind::Tie { [ties, dampers] } else { [dampers, ties] };
        assert!((lost / exact - 1.0).abs() < 1e-9, "{foundation:?} {kind:?}: {lost} J, not {exact} J");
        assert!(none == 0.0 && energies.residual.abs() < 1e-8 * weight * plain.r0, "{energies:?}");
    }
}

/// Without dashpots, the energy that dampers take is the plastic work: their yield force times the path of the plastic elongation.
#[test]
fn dampers_without_dashpots_take_the_plastic_work() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let plain = plain(foundation);
        let links = [-1.0, 1.0].map(|side| damper(&plain, side, [3.0, 0.05, 0.1]));
        let (run, _) = run(plain.with_ties(&links).unwrap(), 2.5, 6.0);
        let (taken, works) = (run.energies().restraints.dampers, [0, 1].map(|number| run.plastic_work(number)));
        let sum: f64 = works.iter().sum();
        assert!(works.iter().all(|work| *work > 0.1 * sum), "{foundation:?}: {works:?} J");
        assert!((taken / sum - 1.0).abs() < 1e-8, "{foundation:?}: {taken} J taken, {works:?} J of plastic work");
    }
}

/// Dampers of equal sides under a block that only bounces yield in the same instants.
#[test]
fn two_dampers_yield_in_one_instant() {
    let block = plain(Foundation::Viscoelastic);
    let links = [-1.0, 1.0].map(|side| damper(&block, side, [20.0, 0.1, 0.05]));
    let block = block.with_ties(&links).unwrap();
    let drop = Initial { vertical: Some((0.02 * block.b, 0.0)), ..Initial::default() };
    let settings = Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, ..Settings::default() };
    let inputs = Inputs::default();
    let mut run = Simulation::new(block, settings, Pulse::NONE, &drop, 0.0, &inputs);
    let mut events = Vec::new();
    run.advance(2.0, &inputs, &mut |event| events.push(*event)).unwrap();
    let of = |wanted: u8| -> Vec<(tie::TieEvent, f64)> {
        let found = events.iter().filter_map(|event| of_link(event).map(|link| (link, event.time)));
        found.filter(|((link, _), _)| *link == wanted).map(|((_, event), time)| (event, time)).collect()
    };
    let (left, right) = (of(0), of(1));
    assert!(left.len() >= 2 && left.len() == right.len(), "{left:?} {right:?}");
    for ((event, time), (other, at)) in left.iter().zip(&right) {
        assert!(event == other && (time - at).abs() < 1e-9, "{left:?} {right:?}");
    }
    assert!(run.state()[0].abs() < 1e-12, "{:?}", run.state());
    assert!(run.energies().residual.abs() < 1e-8 * block.mass * block.gravity * block.r0);
}

/// A damper that never reaches its yield force is a spring, and one with r near 1 nearly so.
#[test]
fn a_damper_that_hardly_yields_is_a_spring() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let block = plain(foundation);
        let tied = |law: [f64; 3]| {
            let links = [-1.0, 1.0].map(|side| damper(&block, side, law));
            run(block.with_ties(&links).unwrap(), 2.5, 6.0)
        };
        let (spring, events) = tied([3.0, 0.0, 0.0]);
        assert!(events.iter().all(|event| of_link(event).is_none()));
        let (strong, _) = tied([3.0, 1e6, 0.1]);
        assert_eq!(spring.state(), strong.state());
        assert_eq!(spring.peaks(), strong.peaks());
        let away = |hardening: f64| {
            let (hard, events) = tied([3.0, 0.05, hardening]);
            assert!(events.iter().any(|event| of_link(event).is_some()));
            (hard.peaks().theta - spring.peaks().theta).abs()
        };
        let (near, nearer) = (away(1.0 - 1e-4), away(1.0 - 1e-6));
        assert!(near < 1e-3 && nearer < 0.02 * near + 1e-9, "{foundation:?}: {near} {nearer}");
    }
}

/// Stiff dampers without hardening are Coulomb's: a block that bounces on supports without damping loses `2 F/K` of its amplitude in each
/// half period, with the friction F = 2 F_y and the stiffness K of both supports.
#[test]
fn stiff_dampers_without_hardening_are_coulombs() {
    let supports = Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.0 });
    let dimensionless = Dimensionless { alpha: 0.25, p: 1.0, supports };
    let block = Block::from_dimensionless(&dimensionless, &Common::default()).unwrap();
    let sag = block.static_deflection();
    let error = |stiffness: f64| {
        // Stiffness in parts of the supports'.
        let links = [-1.0, 1.0].map(|side| damper(&block, side, [stiffness * block.b / sag, 0.025, 0.0]));
        let block = block.with_ties(&links).unwrap();
        let settings = Settings { tolerance: 1e-11, ..Settings::default() };
        let (inputs, amplitude) = (Inputs::default(), 0.85 * sag);
        let start = Initial { vertical: Some((amplitude, 0.0)), ..Initial::default() };
        let mut run = Simulation::new(block, settings, Pulse::NONE, &start, 0.0, &inputs);
        let mut most = 0.0_f64;
        for half in 1..=7 {
            run.advance(f64::from(half) * std::f64::consts::PI / block.omega_v, &inputs, &mut |_| ()).unwrap();
            let exact = (amplitude - 0.1 * f64::from(half) * sag) * if half % 2 == 0 { 1.0 } else { -1.0 };
            most = most.max((run.observe(&inputs).v - exact).abs() / sag);
        }
        assert!(run.energies().residual.abs() < 1e-9 * block.mass * block.gravity * sag);
        most
    };
    let errors = [1e3, 1e4, 1e5].map(error);
    println!("stiff dampers: {errors:?} of the static deflection");
    assert!(errors[2] < 1e-5 && errors[1] < 0.2 * errors[0] && errors[2] < 0.2 * errors[1], "{errors:?}");
}

/// Ties with slack, pretension, a dashpot and a strength that never reach their yield force move the block as those without one do.
#[test]
fn a_yield_force_that_is_not_reached_changes_no_bit() {
    for (foundation, friction) in
        [(Foundation::Viscoelastic, 0.0), (Foundation::Viscoelastic, 0.3), (Foundation::Rigid, 0.3)]
    {
        let supports = Supports::of(foundation, Ratios { eta: 40.0, xi_v: 0.1 });
        let dimensionless = Dimensionless { alpha: 0.25, p: 1.0, supports };
        let common = Common { friction, eccentricity: 0.1, ..Common::default() };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let (b, weight) = (block.b, block.mass * block.gravity);
        let tie = Tie { block: [-b, b], ground: [-2.0 * b, -b], stiffness: 3.0 * weight / b, ..Tie::default() };
        let guy = Tie { block: [b, 2.0 * b], ground: [4.0 * b, 0.0], slack: 0.05 * b, strength: 0.6 * weight, ..tie };
        let ties = [Tie { pretension: 0.05 * weight, damping: 0.5 * weight / b, ..tie }, guy];
        let with = |yield_force: f64| {
            let ties = ties.map(|tie| Tie { yield_force, hardening: 0.1, ..tie });
            run(block.with_ties(&ties).unwrap(), 2.5, 6.0)
        };
        let (plain, events) = run(block.with_ties(&ties).unwrap(), 2.5, 6.0);
        assert!(events.iter().filter(|event| of_link(event).is_some()).count() > 3, "{events:?}");
        for yield_force in [0.0, 1e3 * weight] {
            let (found, found_events) = with(yield_force);
            assert_eq!((found.state(), found.peaks(), &found_events), (plain.state(), plain.peaks(), &events));
            assert_eq!((found.energies(), found.counts()), (plain.energies(), plain.counts()));
        }
    }
}

/// A run that continues from its saved state while links yield has the bits of one that does not stop.
#[test]
fn a_state_saved_while_a_link_yields_continues_with_the_same_bits() {
    let block = plain(Foundation::Viscoelastic);
    let links = [-1.0, 1.0].map(|side| damper(&block, side, [3.0, 0.05, 0.1]));
    let block = block.with_ties(&links).unwrap();
    let bytes = |run: &Simulation| postcard::to_allocvec(run).unwrap();
    let mut yielding = 0;
    for tenths in [4, 6, 8, 10, 12] {
        let (mut run, _) = run(block, 2.5, f64::from(tenths) / 10.0);
        yielding += i32::from(run.restraints().ties.iter().any(|state| matches!(state, TieState::Yields(_))));
        let mut saved: Simulation = postcard::from_bytes(&bytes(&run)).unwrap();
        let inputs = Inputs::default();
        for simulation in [&mut run, &mut saved] {
            simulation.advance(6.0, &inputs, &mut |_| ()).unwrap();
        }
        assert_eq!(bytes(&run), bytes(&saved), "{tenths}");
    }
    assert!(yielding > 1, "{yielding}");
}

/// A block on supports, bounced and shaken without lift-off, whose dampers at the corners yield early.
fn shaken_in_contact(period: f64) -> (Simulation, Vec<(u8, tie::TieEvent)>) {
    let block = plain(Foundation::Viscoelastic);
    let links = [-1.0, 1.0].map(|side| damper(&block, side, [20.0, 0.01, 0.1]));
    let block = block.with_ties(&links).unwrap();
    let settings = Settings { tolerance: 1e-12, ..Settings::default() };
    let amplitude = 0.3 * block.gravity * libm::tan(block.alpha);
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period, ..Pulse::NONE };
    let start = Initial { vertical: Some((0.15 * block.static_deflection(), 0.0)), ..Initial::default() };
    let inputs = Inputs::default();
    let mut run = Simulation::new(block, settings, pulse, &start, 0.0, &inputs);
    let mut events = Vec::new();
    run.advance(0.8, &inputs, &mut |event| events.extend(of_link(event))).unwrap();
    assert_eq!(run.counts().liftoffs, 0);
    (run, events)
}

/// Where a yielding damper's rate only just touches zero, it unloads and yields again, or flows on: both give the same motion.
#[test]
fn the_motion_is_continuous_where_a_rate_grazes_zero() {
    let mut grazes = 0;
    for i in 0..60 {
        let [mut low, mut high] = [i, i + 1].map(|i| 0.2 + 0.01 * f64::from(i));
        let count = |period: f64| shaken_in_contact(period).1.len();
        let (at_low, at_high) = (count(low), count(high));
        if at_low == at_high {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *if count(middle) == at_low { &mut low } else { &mut high } = middle;
        }
        let [(before, events), (after, others)] = [low, high].map(shaken_in_contact);
        let apart = (0..4).map(|i| (before.state()[i] - after.state()[i]).abs()).fold(0.0, f64::max);
        let plastic = before.plastic_elongations()[0] - after.plastic_elongations()[0];
        assert!(apart < 1e-9 && plastic.abs() < 1e-9, "{low} s: {apart} {plastic} m, {events:?} {others:?}");
        let size = before.block().mass * before.block().gravity * before.block().r0;
        assert!([before, after].iter().all(|run| run.energies().residual.abs() < 1e-10 * size));
        grazes += 1;
    }
    assert!(grazes > 2, "{grazes}");
}

/// A block whose dampers have yielded comes to rest and stays there, with locked forces and plastic elongations.
#[test]
fn a_block_rests_with_plastic_elongations() {
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        let block = plain(foundation);
        let links = [-1.0, 1.0].map(|side| damper(&block, side, [3.0, 0.05, 0.1]));
        let (mut run, events) = run(block.with_ties(&links).unwrap(), 2.5, 300.0);
        assert!(events.iter().any(|event| of_link(event).is_some()));
        let inputs = Inputs::default();
        run.advance(2000.0, &inputs, &mut |_| ()).unwrap();
        assert!(run.rests(&inputs), "{foundation:?}: {:?}", run.state());
        let (plastic, evaluations) = (run.plastic_elongations(), run.counts().evaluations);
        assert!(plastic[0].abs() > 1e-5, "{plastic:?}");
        let mut late = 0;
        run.advance(1e9, &inputs, &mut |_| late += 1).unwrap();
        assert_eq!((run.plastic_elongations(), late), (plastic, 0));
        assert!(run.counts().evaluations < evaluations + 10);
        let weight = run.block().mass * run.block().gravity;
        assert!(run.energies().residual.abs() < 1e-8 * weight * run.block().r0, "{:?}", run.energies());
    }
}

/// Ties and dampers of random blocks on supports and on the rigid base, with friction, eccentric, in flight: the energies add up, the
/// mirror image moves alike, and no link chatters.
#[test]
fn random_blocks_keep_energy_and_symmetry() {
    let cases = u64::from(cases(400).cases);
    let (mut most, mut yields, mut worst) = ([0.0_f64; 2], 0, 0_usize);
    for case in 0..cases {
        let mirrored = [1.0, -1.0].map(|side| {
            let mut seed = case;
            let mut draw = |low: f64, high: f64| low + (high - low) * random_number(&mut seed);
            let foundation = if draw(0.0, 1.0) < 0.5 { Foundation::Viscoelastic } else { Foundation::Rigid };
            let ratios = Ratios { eta: draw(20.0, 100.0), xi_v: draw(0.0, 0.4) };
            let dimensionless =
                Dimensionless { alpha: draw(0.1, 0.35), p: draw(0.5, 3.0), supports: Supports::of(foundation, ratios) };
            let common = Common { epsilon: draw(0.0, 0.5), ..Common::default() };
            let plain = Block::from_dimensionless(&dimensionless, &common).unwrap();
            let friction = if draw(0.0, 1.0) < 0.4 { draw(0.2, 0.9) } else { 0.0 };
            let common = Common { friction, eccentricity: side * draw(-0.2, 0.2) * plain.b, ..common };
            let (b, h, weight) = (plain.b, plain.h, plain.mass * plain.gravity);
            let links: Vec<Tie> = (0..4)
                .map(|i| {
                    let damper = i % 2 == 0;
                    let x = side * draw(-1.0, 1.0) * b;
                    let tie = Tie {
                        block: [x, draw(0.0, 2.0) * h],
                        ground: [x + side * draw(-0.5, 0.5) * b, -draw(0.3, 1.0) * h],
                        stiffness: draw(0.5, 10.0) * weight / b,
                        pretension: if damper { 0.0 } else { draw(0.0, 0.1) * weight },
                        damping: if draw(0.0, 1.0) < 0.3 { draw(0.0, 0.3) * weight / (plain.p * b) } else { 0.0 },
                        strength: if draw(0.0, 1.0) < 0.3 { draw(0.2, 1.0) * weight } else { 0.0 },
                        ..Tie::default()
                    };
                    let kind = if damper { LinkKind::Damper } else { LinkKind::Tie };
                    let hardening = if draw(0.0, 1.0) < 0.3 { 0.0 } else { draw(0.0, 0.6) };
                    Tie { kind, yield_force: draw(0.01, 0.3) * weight, hardening, ..tie }
                })
                .collect();
            let block = Block::from_dimensionless(&dimensionless, &common).unwrap().with_ties(&links).unwrap();
            let settings = Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, ..Settings::default() };
            let pulse = Pulse {
                shape: PulseShape::OneSine,
                amplitude: side * draw(0.8, 4.0) * block.gravity * libm::tan(block.alpha),
                period: draw(1.0, 8.0) / block.p,
                start: 0.1,
                ..Pulse::NONE
            };
            let vertical = if draw(0.0, 1.0) < 0.3 { draw(-0.5, 0.5) } else { 0.0 };
            let inputs = Inputs { a_gz: Ramp::held(vertical * block.gravity), ..Inputs::default() };
            let mut run = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
            let mut events = Vec::new();
            run.advance(6.0 / block.p, &inputs, &mut |event| events.push(*event)).unwrap_or_else(|error| {
                panic!("case {case}: {error}; {links:?} {dimensionless:?} {common:?}");
            });
            let residual = run.energies().residual.abs() / (weight * block.r0);
            (run.state()[0] * side / block.alpha, residual, events)
        });
        let [(theta, residual, events), (mirrored, ..)] = &mirrored;
        assert!(theta.is_finite() && *residual < 1e-8, "case {case}: residual {residual:e}, {} events", events.len());
        most[0] = most[0].max(*residual);
        most[1] = most[1].max((theta - mirrored).abs());
        yields += events.iter().filter(|e| matches!(of_link(e), Some((_, tie::TieEvent::Yield)))).count() as u64;
        let links: Vec<&Event> = events.iter().filter(|event| of_link(event).is_some()).collect();
        let at_once = links.windows(12).filter(|w| w[11].time - w[0].time < 1e-9).count();
        worst = worst.max(at_once);
    }
    println!("residual ≤ {:.1e} M g R0, mirror images within {:.1e} α, {yields} yields", most[0], most[1]);
    assert!(most[1] < 1e-6 && yields > 2 * cases && worst == 0, "{most:?} {yields} {worst}");
}
