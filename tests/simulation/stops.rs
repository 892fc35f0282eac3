//! Stopping at each event, before its transition, changes no bit of a run.

use proptest::prelude::*;
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::{Initial, OnOverturning, OnSeparation, Progress, Settings, Simulation};
use rocking_block::system::events::Event;

use crate::cases;

#[derive(Clone, Debug)]
struct Case {
    alpha: f64,
    eta: f64,
    epsilon: f64,
    rigid: bool,
    on_separation: OnSeparation,
    on_overturning: OnOverturning,
    amplitude: f64,
    shape: PulseShape,
    theta: f64,
    vertical: f64,
}

fn cases() -> impl Strategy<Value = Case> {
    let separation = prop_oneof![Just(OnSeparation::Fly), Just(OnSeparation::Hold), Just(OnSeparation::Terminate)];
    let overturning = prop_oneof![Just(OnOverturning::Hold), Just(OnOverturning::Terminate)];
    let shape = prop_oneof![
        Just(PulseShape::OneSine),
        Just(PulseShape::OneCosine),
        Just(PulseShape::C1),
        Just(PulseShape::Rectangular),
        Just(PulseShape::SymmetricRicker),
        Just(PulseShape::Gabor)
    ];
    let block = (0.1..0.5, 15.0..100.0, 0.0..1.0, any::<bool>());
    (block, separation, overturning, 1.0..12.0, shape, -0.9..0.9, -3.0..3.0).prop_map(
        |((alpha, eta, epsilon, rigid), on_separation, on_overturning, amplitude, shape, theta, vertical)| Case {
            alpha,
            eta,
            epsilon,
            rigid,
            on_separation,
            on_overturning,
            amplitude,
            shape,
            theta,
            vertical,
        },
    )
}

fn simulation(case: &Case) -> (Simulation, Inputs) {
    let foundation = if case.rigid { Foundation::Rigid } else { Foundation::Viscoelastic };
    let common = Common { epsilon: case.epsilon, ..Common::default() };
    let dimensionless = Dimensionless {
        alpha: case.alpha,
        p: 2.0,
        supports: Supports::of(foundation, Ratios { eta: case.eta, xi_v: 0.1 }),
    };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let Case { on_separation, on_overturning, .. } = *case;
    let settings = Settings { on_separation, on_overturning, ..Settings::default() };
    let pulse = Pulse { shape: case.shape, amplitude: case.amplitude, period: 0.6, start: 0.31, ..Pulse::NONE };
    let initial = Initial { theta: case.theta * case.alpha, theta_dot: 0.0, vertical: None };
    let inputs = Inputs { a_gz: Ramp { value: 0.0, rate: case.vertical }, ..Inputs::default() };
    (Simulation::new(block, settings, pulse, &initial, 0.0, &inputs), inputs)
}

/// Returns the results of a run without the evaluations: each continuation takes one more.
fn bits(simulation: &Simulation, inputs: &Inputs) -> String {
    let counts = simulation.counts();
    let counts = (counts.impacts, counts.liftoffs, counts.steps, counts.rejected);
    format!(
        "{:?} {:?} {:?} {:?} {counts:?} {:?} {:?}",
        simulation.time(),
        simulation.observe(inputs),
        simulation.energies(),
        simulation.peaks(),
        simulation.last_event(),
        simulation.ending()
    )
}

proptest! {
    #![proptest_config(cases::cases(200))]
    #[test]
    fn stopping_at_events_changes_no_bit(case in cases()) {
        let (mut whole, inputs) = simulation(&case);
        let mut stopped = whole.clone();
        let (mut events, mut stops) = (Vec::<Event>::new(), Vec::new());
        for until in [0.7, 1.4, 2.1, 2.8] {
            let end = whole.advance(until, &inputs, &mut |event| events.push(*event)).unwrap();
            let mut seen = Vec::new();
            let stopped_end = loop {
                let after = stopped.time();
                let progress = stopped.advance_to_event(until, after, &inputs, &mut |event| seen.push(*event)).unwrap();
                if let Some(progress) = progress {
                    prop_assert!(!stopped.is_at_event());
                    break progress;
                }
                // The transition has not been applied yet.
                let (time, theta_dot) = (stopped.time(), stopped.state()[1]);
                prop_assert!(stopped.is_at_event() && stopped.last_event() < time);
                stops.push(time);
                let before = seen.len();
                if stops.len() % 2 == 0 {
                    stopped.apply_pending_event(&inputs, &mut |event| seen.push(*event)).unwrap();
                    prop_assert_eq!(seen[before].time, time);
                    prop_assert_eq!(stopped.last_event(), time);
                } else {
                    prop_assert_eq!(stopped.state()[1], theta_dot);
                }
            };
            prop_assert_eq!(end, stopped_end);
            prop_assert_eq!(bits(&whole, &inputs), bits(&stopped, &inputs));
            if let Progress::Ended(..) = end {
                break;
            }
        }
        // There is a stop at each event, except at the start and at the end of the run.
        let mut instants: Vec<f64> = events.iter().map(|event| event.time).collect();
        instants.dedup();
        instants.retain(|&time| time > 0.0 && whole.ending().is_none_or(|(_, end)| time < end));
        stops.retain(|&time| whole.ending().is_none_or(|(_, end)| time < end));
        prop_assert_eq!(instants, stops);
    }
}

/// Only an event that ends the run is applied without a stop; if the block is held afterwards, the run stops first.
#[test]
fn the_event_that_ends_the_run_is_not_a_stop() {
    let case = |rigid: bool, theta: f64, vertical: f64| Case {
        alpha: 0.25,
        eta: 40.0,
        epsilon: 0.0,
        rigid,
        on_separation: OnSeparation::Terminate,
        on_overturning: OnOverturning::Terminate,
        amplitude: 0.0,
        shape: PulseShape::None,
        theta,
        vertical,
    };
    // Overturning, or ground that falls away.
    for falls in [case(true, 1.2, 0.0), case(false, 0.0, -20.0)] {
        let held = Case { on_separation: OnSeparation::Hold, on_overturning: OnOverturning::Hold, ..falls.clone() };
        for (case, holds) in [(falls, false), (held, true)] {
            let (mut run, inputs) = simulation(&case);
            let mut last_stop = f64::NAN;
            while run.advance_to_event(20.0, run.time(), &inputs, &mut |_| ()).unwrap().is_none() {
                last_stop = run.time();
            }
            let (_, ended) = run.ending().expect("it ends");
            assert_eq!(last_stop == ended, holds, "{case:?}: ended at {ended} s, last stop at {last_stop} s");
        }
    }
}
