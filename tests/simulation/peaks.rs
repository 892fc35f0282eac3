//! Peaks: found inside steps of any length, and independently of each other.

use std::f64::consts::FRAC_PI_3;

use rocking_block::block::Block;
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::peaks::{self, Peaks};
use rocking_block::simulation::{Initial, Simulation};

use crate::blocks::{rigid, supported as block};
use crate::physics::{go, one_sine, seen, start};

/// A millisecond jolt of the ground: H peaks right after the jump, at `M a_x i0/(i0 + h²)` in full contact.
#[test]
fn a_peak_right_after_a_jump_counts() {
    let block = block(0.25, 1.0, 40.0, 0.1, 0.0);
    let exact = block.mass * 2.0 * block.i0 / (block.i0 + block.h * block.h);
    let mut simulation = start(block, Pulse::NONE, Initial::default(), 1e-8);
    go(&mut simulation, 1.0);
    let jolt = Inputs { time: 1.0, a_gx: Ramp { value: 2.0, rate: -2000.0 }, ..Inputs::default() };
    simulation.advance(1.001, &jolt, &mut |_| ()).unwrap();
    let peak = simulation.peaks().horizontal;
    assert!((peak / exact - 1.0).abs() < 1e-12, "{peak} N instead of {exact} N");
}

const NAMES: [&str; 5] = ["theta", "N", "H", "uplift", "friction demand"];

fn peaks_of(simulation: &Simulation) -> [f64; 5] {
    let Peaks { theta, reaction, horizontal, uplift, friction_demand, .. } = simulation.peaks();
    [theta, reaction, horizontal, uplift, friction_demand]
}

/// The greatest values among samples of a run to `until` (s), with both sides of every event among them.
///
/// They come from the motion alone: no search for peaks takes part.
fn greatest_of_samples(block: Block, pulse: Pulse, until: f64) -> [f64; 5] {
    const SAMPLES: u32 = 50_000;
    let begin = || start(block, pulse, Initial::default(), 1e-10);
    let mut times: Vec<f64> = (1..=SAMPLES).map(|i| until * f64::from(i) / f64::from(SAMPLES)).collect();
    times.extend(go(&mut begin(), until).iter().flat_map(|event| [event.time - 1e-10, event.time + 1e-10]));
    times.sort_by(f64::total_cmp);
    let mut fine = begin();
    let mut greatest = [0.0_f64; 5];
    for time in times.into_iter().filter(|time| *time > 0.0) {
        go(&mut fine, time);
        let x = seen(&fine);
        let now = [
            x.theta.abs(),
            x.reaction[0].max(x.reaction[1]),
            x.horizontal.abs(),
            x.uplift[0].max(x.uplift[1]),
            x.friction_demand,
        ];
        greatest = std::array::from_fn(|i| greatest[i].max(now[i]));
    }
    greatest
}

/// Peaks do not depend on the steps: one long call gives those of a fine history.
#[test]
fn peaks_come_from_inside_the_steps() {
    let (block, pulse) = (block(0.25, 1.0, 20.0, 0.05, 0.1), one_sine(5.0, 1.25));
    let mut whole = start(block, pulse, Initial::default(), 1e-10);
    go(&mut whole, 5.0);
    for (name, (peak, sampled)) in NAMES.iter().zip(peaks_of(&whole).iter().zip(greatest_of_samples(block, pulse, 5.0)))
    {
        let excess = peak / sampled - 1.0;
        assert!((-1e-9..1e-5).contains(&excess), "{name}: peak {peak}, from samples {sampled}");
    }
}

/// Peaks do not depend on stops so close that most steps are short.
#[test]
fn peaks_come_from_between_the_stops() {
    let pulse = one_sine(5.0, 1.25);
    for block in [block(0.25, 1.0, 20.0, 0.05, 0.1), rigid(0.25, 1.0, 0.0)] {
        let sampled = greatest_of_samples(block, pulse, 5.0);
        for stop in [0.011, 0.017, 0.023, 0.029] {
            let mut simulation = start(block, pulse, Initial::default(), 1e-6);
            let mut time = 0.0;
            while time < 5.0 {
                time += stop;
                go(&mut simulation, f64::min(time, 5.0));
            }
            for (name, (found, sampled)) in NAMES.iter().zip(peaks_of(&simulation).into_iter().zip(sampled)) {
                let off = found / sampled - 1.0;
                assert!(off.abs() < 1e-4, "{name}: {found} with stops every {stop} s, from samples {sampled}");
            }
        }
    }
}

/// Peaks are found in the longest steps, at a loose tolerance and with slow motion.
#[test]
fn peaks_come_from_inside_the_longest_steps() {
    for (block, amplitude) in [
        (block(0.25, 1.0, 20.0, 0.05, 0.1), 5.0),
        (block(0.4, 1.0, 10.0, 0.3, 0.0), 3.0),
        (block(0.1, 1.0, 6.0, 0.05, 0.0), 0.4),
        (rigid(0.25, 1.0, 0.0), 5.0),
        (rigid(0.5, 1.0, 0.0), 4.0),
        (rigid(0.1, 1.0, 0.0), 1.4),
    ] {
        for period in [0.6, 1.1, 2.3, 4.1] {
            let pulse = Pulse { shape: PulseShape::C2, amplitude, period, start: 0.1, ..Pulse::NONE };
            let mut simulation = start(block, pulse, Initial::default(), 1e-3);
            go(&mut simulation, 2.0 * period);
            let sampled = greatest_of_samples(block, pulse, 2.0 * period);
            // At a separation H and N vanish, and no sample shows their ratio, the friction demand.
            let compared = if simulation.ending().is_some() { 4 } else { 5 };
            for (name, (found, sampled)) in
                NAMES.iter().zip(peaks_of(&simulation).into_iter().zip(sampled)).take(compared)
            {
                let off = if sampled == 0.0 { found } else { found / sampled - 1.0 };
                assert!(
                    off.abs() < 3e-3,
                    "{name} under {amplitude} m/s² of {period} s: {found}, from samples {sampled}"
                );
            }
        }
    }
}

/// Under pulses faster than the block, long swings on the rigid base have the peaks of many short ones.
///
/// Samples would not show a peak this exactly. Short swings have it near an end, where its search has little to find.
#[test]
fn peaks_come_from_inside_swings() {
    for (alpha, p, shape, amplitude, period, tolerance) in [
        (0.3066477904115929, 2.160311420563528, PulseShape::OneCosine, 18.314583954296598, 0.5541557294984868, 1e-8),
        (0.3277136645014785, 4.447703736445783, PulseShape::C2, 18.9598916266903, 0.2570104893195696, 1e-6),
    ] {
        let pulse = Pulse { shape, amplitude, period, start: 0.0, ..Pulse::NONE };
        let peaks = |stops: u32| {
            let mut simulation = start(rigid(alpha, p, 0.0), pulse, Initial::default(), tolerance);
            for stop in 1..=stops {
                go(&mut simulation, 12.0 / p * f64::from(stop) / f64::from(stops));
            }
            peaks_of(&simulation)
        };
        for (name, (long, short)) in NAMES.iter().zip(peaks(1).into_iter().zip(peaks(3000))) {
            assert!((long / short - 1.0).abs() < 10.0 * tolerance, "{name}: {long}, in short swings {short}");
        }
    }
}

/// Where the reaction nearly vanishes inside a swing, the friction demand has a sharp peak in the hundreds or thousands. Long swings
/// find it as many short ones do.
#[test]
fn a_sharp_peak_of_the_friction_demand_is_found() {
    for (p, shape, least) in [
        (3.235_436_893_203_883_3, PulseShape::OneSine, 1000.0),
        (2.909_950_882_299_436, PulseShape::OneCosine, 1000.0),
        (3.155_029_585_798_817, PulseShape::C2, 200.0),
    ] {
        let pulse = Pulse { shape, amplitude: 4.375, period: FRAC_PI_3, start: 0.0, ..Pulse::NONE };
        let demand = |stops: u32| {
            let mut simulation = start(rigid(0.2, p, 0.0), pulse, Initial::default(), 1e-9);
            for stop in 1..=stops {
                go(&mut simulation, 6.0 * f64::from(stop) / f64::from(stops));
            }
            simulation.peaks().friction_demand
        };
        let [long, short] = [1, 3000].map(demand);
        assert!(
            short > least && (long / short - 1.0).abs() < 1e-7,
            "p = {p}, {shape:?}: {long}, in short swings {short}"
        );
    }
}

/// Each peak is found independently of the others.
///
/// A block that stands still on the rigid base under one sine has the peaks `M a_p` of H, `M g/2 + M a_p h/(2 b)` of the
/// reaction and `a_p/g` of the friction demand, each inside a step. Loads have raised one of them almost to its peak before,
/// and the others far above.
#[test]
fn each_peak_is_found_independently() {
    let block = rigid(0.25, 1.0, 0.0);
    let weight = block.mass * block.gravity;
    let shear = 0.5 * weight * block.b / block.h;
    let pulse = Pulse { start: 1.0, ..one_sine(shear / block.mass, 0.6) };
    let exact = [0.5 * weight + 0.5 * shear * block.h / block.b, shear, shear / weight];
    let loads = [
        [(0.0, weight - 2.0 * 0.99 * exact[0]), (10.0 * shear, 0.0)],
        [(0.99 * shear, -10.0 * weight), (0.5 * shear, 0.95 * weight)],
        [(0.99 * shear, 0.0), (10.0 * shear, -100.0 * weight)],
    ];
    for (looked_for, loads) in loads.into_iter().enumerate() {
        let mut simulation = start(block, pulse, Initial::default(), 1e-8);
        for forces in loads {
            load(&mut simulation, forces);
        }
        let before = forces(&simulation);
        // Three steps of nearly 2 rad; none ends at a quarter of the period.
        go(&mut simulation, pulse.start + 5.9 * pulse.period / std::f64::consts::TAU);
        for (i, (before, after)) in before.into_iter().zip(forces(&simulation)).enumerate() {
            if i == looked_for {
                assert!((before / exact[i] - 0.99).abs() < 1e-9, "{i}: {before}, {}", exact[i]);
                assert!((after / exact[i] - 1.0).abs() < 1e-9, "{i}: {after}, {}", exact[i]);
            } else {
                assert!(before > 4.0 * exact[i] && after == before, "{i}: {before}, {after}, {}", exact[i]);
            }
        }
    }
}

/// In a block that rocks under one sine, too: at each stop of the first arc, before and after the force peaks, the peak is the
/// greatest value so far. Loads have raised the other two far above.
#[test]
fn each_peak_of_a_swing_is_found_independently() {
    let block = rigid(0.25, 1.0, 0.0);
    let weight = block.mass * block.gravity;
    let shear = weight * block.b / block.h;
    let pulse = Pulse { start: 1.0, ..one_sine(5.0, 1.25) };
    let loads: [&[(f64, f64)]; 3] = [
        &[(10.0 * shear, 0.0)],
        &[(0.0, -10.0 * weight), (0.5 * shear, 0.95 * weight)],
        &[(10.0 * shear, -100.0 * weight)],
    ];
    for (looked_for, loads) in loads.into_iter().enumerate() {
        let mut long = start(block, pulse, Initial::default(), 1e-10);
        for &forces in loads {
            load(&mut long, forces);
        }
        let (mut short, before, mut greatest) = (long.clone(), forces(&long), 0.0);
        for stop in [1.15, 1.28, 1.6] {
            go(&mut long, stop);
            while short.time() < stop {
                let next = f64::min(short.time() + 1e-4, stop);
                go(&mut short, next);
                let x = seen(&short);
                greatest = f64::max(greatest, [x.reaction[0], x.horizontal.abs(), x.friction_demand][looked_for]);
            }
            let found = forces(&long);
            let excess = found[looked_for] / greatest - 1.0;
            assert!((-1e-9..1e-6).contains(&excess), "{looked_for} at {stop} s: {found:?}, from samples {greatest}");
            for i in (0..3).filter(|&i| i != looked_for) {
                assert!(found[i] == before[i], "{i} at {stop} s: {found:?}, before {before:?}");
            }
        }
    }
}

/// Loads a block at rest for half a second by forces that grow to these; their moment about the base is cancelled.
fn load(simulation: &mut Simulation, (f_x, f_z): (f64, f64)) {
    let (time, h) = (simulation.time(), simulation.block().h);
    let grows = |to: f64| Ramp { value: 0.0, rate: to / 0.5 };
    let inputs = Inputs { time, f_x: grows(f_x), f_z: grows(f_z), m_y: grows(-f_x * h), ..Inputs::default() };
    simulation.advance(time + 0.5, &inputs, &mut |event| panic!("{event}")).unwrap();
}

/// The peaks of N, H and the friction demand.
fn forces(simulation: &Simulation) -> [f64; 3] {
    let Peaks { reaction, horizontal, friction_demand, .. } = simulation.peaks();
    [reaction, horizontal, friction_demand]
}

/// The greater of two zeros with different signs is the first, on every processor.
#[test]
fn the_greater_of_two_zeros_is_the_first() {
    assert_eq!(peaks::greater(0.0, -0.0).to_bits(), 0.0_f64.to_bits());
    assert_eq!(peaks::greater(-0.0, 0.0).to_bits(), (-0.0_f64).to_bits());
}
