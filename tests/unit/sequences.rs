//! Random sequences of calls through the C interface.
//!
//! Legal calls give the same bits in every equivalent order; illegal calls in between are refused and leave no trace.

mod run;

use proptest::collection::vec;
use proptest::prelude::*;

use crate::cases::cases;
use crate::fmu::{self, DISCARD, ERROR, Fmu, OK};
use crate::misuse::{self, Phase};
use crate::sealed;
use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use run::{Act, Bad, Run, acts, experiments, gentle};

fn misuses() -> impl Strategy<Value = Vec<Bad>> {
    vec((0..misuse::KINDS, any::<u32>()), 1..40)
}

/// Returns the acts that use no saved states.
fn going(acts: &[Act]) -> Vec<Act> {
    acts.iter().copied().filter(|act| matches!(act, Act::Inputs(_) | Act::Rates(_) | Act::Step(_))).collect()
}

/// Returns the status of `fmi2Terminate`.
fn terminated(phase: Phase) -> i32 {
    if phase == Phase::Error { ERROR } else { OK }
}

proptest! {
    #![proptest_config(cases(500))]

    #[test]
    fn two_instances_in_turn_give_the_bits_of_each_alone(
        first in experiments(), second in experiments(), one in acts(), other in acts(),
    ) {
        let alone = [Run::start(&first).follow(&one), Run::start(&second).follow(&other)];
        let (mut a, mut b) = (Run::start(&first), Run::start(&second));
        let mut seen = [Vec::new(), Vec::new()];
        for i in 0..one.len().max(other.len()) {
            seen[0].extend(one.get(i).into_iter().flat_map(|&act| a.act(act)));
            seen[1].extend(other.get(i).into_iter().flat_map(|&act| b.act(act)));
        }
        seen[0].extend(a.follow(&[]));
        seen[1].extend(b.follow(&[]));
        prop_assert_eq!(&alone, &seen);
    }

    #[test]
    fn two_threads_at_once_give_the_bits_of_one(experiment in experiments(), acts in acts()) {
        let alone = Run::start(&experiment).follow(&acts);
        let both = std::thread::scope(|scope| {
            [(); 2].map(|()| scope.spawn(|| Run::start(&experiment).follow(&acts))).map(|thread| thread.join().unwrap())
        });
        prop_assert_eq!(&both[0], &alone);
        prop_assert_eq!(&both[1], &alone);
    }

    #[test]
    fn a_reset_instance_is_a_new_one(
        past in experiments(), before in acts(), next in experiments(), after in acts(), terminate in any::<bool>(),
    ) {
        let mut run = Run::start(&past);
        run.follow(&before);
        if terminate {
            prop_assert_eq!(run.fmu.terminate(), terminated(run.phase));
        }
        run.again(&next);
        // States saved before the reset still exist, so acts with saved states would differ.
        prop_assert_eq!(run.follow(&going(&after)), Run::start(&next).follow(&going(&after)));
    }

    #[test]
    fn a_restored_state_goes_on_with_the_same_bits(
        experiment in experiments(), before in acts(), meanwhile in acts(), after in acts(),
    ) {
        let going = going(&after);
        let mut run = Run::start(&experiment);
        run.follow(&before);
        const KEPT: usize = 100;
        let slot = run.fmu.states.len();
        run.act(Act::Save(KEPT));
        let bytes = run.fmu.serialize(slot).unwrap();
        let (time, phase) = (run.time, run.phase);
        let straight_on = run.follow(&going);

        // In the same instance, after other acts.
        run.follow(&meanwhile.into_iter().filter(|act| !matches!(act, Act::Save(_) | Act::Free(_))).collect::<Vec<_>>());
        prop_assert_eq!(run.fmu.restore(slot), OK);
        (run.time, run.phase) = (time, phase);
        prop_assert_eq!(run.follow(&going), straight_on.clone());

        // From the bytes, in another instance that was never initialized.
        let mut other = Run::start(&experiment);
        other.fmu = Fmu::new();
        prop_assert_eq!(other.fmu.deserialize(&bytes), OK);
        prop_assert_eq!(other.fmu.restore(0), OK);
        prop_assert_eq!(other.fmu.save(0), OK);
        prop_assert_eq!(other.fmu.serialize(0).unwrap(), bytes);
        (other.time, other.phase) = (time, phase);
        prop_assert_eq!(other.follow(&going), straight_on);
    }

    #[test]
    fn reading_changes_nothing(experiment in experiments(), acts in acts()) {
        let mut observed = Run::start_with(&experiment, &mut Run::look);
        let mut blind = Run::start(&experiment);
        for &act in &acts {
            observed.act(act);
            observed.look();
            if let Act::Step(size) = act {
                if blind.phase == Phase::Complete {
                    let status = blind.fmu.step(blind.time, size);
                    prop_assert!([OK, DISCARD, ERROR].contains(&status));
                    (blind.time, blind.phase) = (observed.time, observed.phase);
                }
            } else {
                blind.act(act);
            }
        }
        prop_assert_eq!(observed.follow(&[]), blind.follow(&[]));
    }

    #[test]
    fn refused_calls_leave_no_trace(experiment in experiments(), acts in acts(), bad in misuses()) {
        let mut twin = Run::start(&experiment);
        let mut next = bad.iter().copied().cycle();
        let mut run = Run::start_with(&experiment, &mut |run| run.misuse(next.next().unwrap()));
        for &act in &acts {
            for bad in next.by_ref().take(3) {
                run.misuse(bad);
            }
            prop_assert_eq!(run.act(act), twin.act(act));
        }
        prop_assert_eq!(run.follow(&[]), twin.follow(&[]));
        for end in [&mut run, &mut twin] {
            prop_assert_eq!(end.fmu.terminate(), terminated(end.phase));
            if end.phase != Phase::Error {
                end.phase = Phase::Terminated;
            }
        }
        for &bad in &bad {
            run.misuse(bad);
        }
        prop_assert_eq!(run.follow(&[]), twin.follow(&[]));
    }

    #[test]
    fn damped_supports_never_fail((experiment, acts) in gentle()) {
        let mut run = Run::start(&experiment);
        run.follow(&acts);
        prop_assert_ne!(run.phase, Phase::Error);
    }

    /// Bytes with a valid checksum and length around random content are refused or can be stepped.
    #[test]
    fn a_forged_state_is_refused_or_can_be_stepped(
        experiment in experiments(), acts in acts(), forged in vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut run = Run::start(&experiment);
        run.follow(&acts);
        let slot = run.fmu.states.len();
        run.act(Act::Save(slot));
        let bytes = run.fmu.serialize(slot).unwrap();
        let mut content = sealed::content(&bytes).to_vec();
        prop_assert_eq!(&sealed::seal(&content), &bytes);
        for (at, byte) in &forged {
            let at = at.index(content.len());
            content[at] = *byte;
        }
        let mut other = Fmu::new();
        match other.deserialize(&sealed::seal(&content)) {
            OK => {
                prop_assert_eq!(other.restore(0), OK);
                sealed::go_on(&mut other);
            }
            status => prop_assert_eq!(status, ERROR),
        }
    }
}

/// Extreme numbers anywhere in a saved state are refused or can be stepped.
///
/// Fuzzing once found a step size of 8e-320 s, which made a step endless.
#[test]
fn forged_numbers_are_refused_or_can_be_stepped() {
    let mut fmu = Fmu::new();
    assert_eq!(fmu.set(fmu::reference("initial.theta"), 0.1), OK);
    assert_eq!([fmu.setup(None, 0.0, None), fmu.enter(), fmu.exit(), fmu.step(0.0, 0.5)], [OK; 4]);
    assert_eq!(fmu.save(0), OK);
    let content = sealed::content(&fmu.serialize(0).unwrap()).to_vec();
    let mut taken = 0;
    for forged in [8e-320_f64, -0.0, -1.0, f64::MAX, f64::INFINITY, f64::NAN] {
        for at in 0..content.len() - 8 {
            let mut content = content.clone();
            content[at..at + 8].copy_from_slice(&forged.to_le_bytes());
            let mut other = Fmu::new();
            match other.deserialize(&sealed::seal(&content)) {
                OK => {
                    assert_eq!(other.restore(0), OK);
                    sealed::go_on(&mut other);
                    taken += 1;
                }
                status => assert_eq!(status, ERROR),
            }
        }
    }
    assert!(taken > 100, "{taken} states were taken");
}

/// A saved state with a NaN in the motion, in its sums or in its peaks is refused.
#[test]
fn a_state_with_a_nan_is_refused() {
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    let common = Common::default();
    let dimensionless =
        Dimensionless { alpha: 0.3, p: 1.7, supports: Supports::Viscoelastic(Ratios { eta: 31.0, xi_v: 0.13 }) };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 7.1, period: 0.37, start: 0.11, ..Pulse::NONE };
    let initial = Initial { theta: 0.05, theta_dot: 0.2, vertical: Some((0.19, 1.3)) };
    let mut simulation = Simulation::new(block, settings, pulse, &initial, 0.07, &Inputs::default());
    simulation.advance(0.23, &Inputs::default(), &mut |_| ()).unwrap();
    simulation.begin_exchange();
    assert!(simulation.is_valid());
    let bytes = postcard::to_allocvec(&simulation).unwrap();
    let mut refused = std::collections::BTreeSet::new();
    for (at, number) in (0..bytes.len() - 8).flat_map(|at| [(at, f64::NAN), (at, 0.0)]) {
        let mut bytes = bytes.clone();
        bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
        let Ok(forged) = postcard::from_bytes::<Simulation>(&bytes) else { continue };
        // A change outside a number affects other fields too.
        let [was, is] = [&simulation, &forged].map(|simulation| fields(&serde_json::to_value(simulation).unwrap()));
        let changed: Vec<&String> = was.iter().zip(&is).filter(|(was, is)| was != is).map(|(_, is)| &is.0).collect();
        let [place] = changed[..] else { continue };
        // The caller checks the parameters of the block.
        if is.iter().any(|(of, value)| of == place && value.is_null()) && !place.starts_with("/setup/system/") {
            assert!(!forged.is_valid(), "{place}");
            refused.insert(place.clone());
        }
        // A step or pulse of zero length makes no progress.
        if number == 0.0 && ["/run/control/short_size", "/setup/pulse/period"].contains(&place.as_str()) {
            assert!(!forged.is_valid(), "{place} is zero");
            refused.insert(format!("{place} of zero"));
        }
    }
    for place in ["/run/control/short_size of zero", "/setup/pulse/period of zero"] {
        assert!(refused.contains(place), "{place} is not among {refused:?}");
    }
    for place in [
        "/run/pose/time",
        "/run/pose/footing/Free/u",
        "/run/pose/contacts/0/Lifted/depth",
        "/run/piece/offsets/3",
        "/setup/pulse/period",
        "/run/peaks/theta",
        "/run/peaks/friction_demand",
    ] {
        assert!(refused.contains(place), "{place} is not among {refused:?}");
    }
}

/// Returns all scalar values with their paths.
fn fields(value: &serde_json::Value) -> Vec<(String, serde_json::Value)> {
    let within = |key: &str, value: &serde_json::Value| {
        fields(value).into_iter().map(|(way, value)| (format!("/{key}{way}"), value)).collect::<Vec<_>>()
    };
    match value {
        serde_json::Value::Object(map) => map.iter().flat_map(|(key, value)| within(key, value)).collect(),
        serde_json::Value::Array(list) => {
            list.iter().enumerate().flat_map(|(i, value)| within(&i.to_string(), value)).collect()
        }
        other => vec![(String::new(), other.clone())],
    }
}

/// A peak of NaN would stay for ever, since no value is above it.
#[test]
fn forged_peaks_are_refused() {
    let mut fmu = Fmu::new();
    assert_eq!(fmu.set(fmu::reference("initial.theta"), 0.1), OK);
    assert_eq!([fmu.setup(None, 0.0, None), fmu.enter(), fmu.exit(), fmu.step(0.0, 0.5)], [OK; 4]);
    assert_eq!(fmu.save(0), OK);
    let content = sealed::content(&fmu.serialize(0).unwrap()).to_vec();
    for name in ["peak.theta", "peak.N", "peak.H", "peak.uplift", "peak.friction_demand"] {
        let mut peak = [0.0];
        assert_eq!(fmu.reals(&[fmu::reference(name)], &mut peak), OK);
        let places = (0..content.len() - 8).filter(|&at| content[at..at + 8] == peak[0].to_le_bytes());
        let refused = |forged: f64| {
            places.clone().any(|at| {
                let mut content = content.clone();
                content[at..at + 8].copy_from_slice(&forged.to_le_bytes());
                Fmu::new().deserialize(&sealed::seal(&content)) == ERROR
            })
        };
        assert!(places.clone().count() > 0 && refused(f64::NAN) && refused(f64::INFINITY), "{name} = {}", peak[0]);
    }
}
