//! Contents of serialized states: refused, as those of another interface or version are, or a state that can be restored and
//! stepped, without a panic, a leak or a long wait.

#![no_main]

#[path = "../../../tests/common/fmu.rs"]
#[allow(dead_code, reason = "each target uses its part")]
mod fmu;
#[path = "../../../tests/common/sealed.rs"]
mod sealed;
#[path = "../seeds.rs"]
mod seeds;

use fmu::{ERROR, Fmu, OK, reference};
use libfuzzer_sys::fuzz_target;
use rocking_block::unit::fmu::Fmu as _;
use rocking_block::unit::instance::Unit;
use rocking_block::unit::life_cycle::{Interface, Phase};
use rocking_block::unit::snapshot;

/// Contents of real states: before, during and after initialization, and under way in every regime and ending.
fn plant_seeds() {
    let rocking = [
        ("pulse.shape", 2.0),
        ("pulse.amplitude", 6.0),
        ("pulse.period", 1.2),
        ("dimensionless.alpha", 0.25),
        ("dimensionless.p", 1.0),
    ];
    let ways: [(&str, &[(&str, f64)]); 6] = [
        ("at_rest", &[]),
        ("rigid", &[("foundation", 2.0)]),
        ("physical", &[("parameterization", 2.0)]),
        ("damped", &[("dimensionless.xi_v", 0.3), ("epsilon", 0.5)]),
        ("held", &[("epsilon", 0.4), ("on_separation", 2.0), ("on_overturning", 2.0)]),
        ("overturning", &[("pulse.amplitude", 14.0), ("on_separation", 2.0)]),
    ];
    for (name, values) in ways {
        let mut fmu = Fmu::new();
        let plant = |fmu: &mut Fmu, when: &str| {
            assert_eq!(fmu.save(0), OK);
            seeds::plant(&format!("{name}-{when}"), sealed::content(&fmu.serialize(0).unwrap()));
        };
        let pulse: &[(&str, f64)] = if name == "at_rest" { &[] } else { &rocking };
        for &(name, value) in pulse.iter().chain(values) {
            assert_eq!(fmu.set(reference(name), value), OK, "{name}");
        }
        assert_eq!(fmu.setup(Some(1e-6), 0.0, Some(20.0)), OK);
        plant(&mut fmu, "new");
        assert_eq!(fmu.enter(), OK);
        plant(&mut fmu, "initializing");
        // A warning where a value is not read.
        assert!(fmu.exit() <= 1);
        for step in 0..100_u32 {
            let time = f64::from(step) * 0.05;
            if fmu.step(time, f64::from(step + 1) * 0.05 - time) != OK {
                break;
            }
            if step % 8 == 0 {
                plant(&mut fmu, &step.to_string());
            }
        }
        plant(&mut fmu, "at_the_end");
        fmu.terminate();
        plant(&mut fmu, "terminated");
    }
}

fuzz_target!(init: plant_seeds(), |content: &[u8]| {
    // As it is: mostly refused by the header.
    let _ = snapshot::deserialize::<Unit>(content);
    // Under a header that fits.
    let mut fmu = Fmu::new();
    let sealed = sealed::seal(content);
    if let Ok(unit) = snapshot::deserialize::<Unit>(&sealed) {
        let elsewhere = matches!(unit.life().phase, Phase::ConfigurationMode | Phase::EventMode);
        let own = unit.life().interface == Interface::CoSimulation && !elsewhere;
        assert_eq!(fmu.deserialize(&sealed), if own { OK } else { ERROR });
        if own {
            assert_eq!(fmu.restore(0), OK);
        }
        sealed::go_on(&mut fmu);
        assert_eq!(fmu.free(0), OK);
    }
});
