//! The packed FMU of FMI 3.0 of the block in space through its C interface: the tests of main.rs that do not depend on the unit.

mod arrays;
mod exchange_in_space;
#[allow(dead_code, reason = "not all functions are called")]
mod functions;
#[allow(dead_code, reason = "the planar unit's own tests use the rest")]
mod host;
mod life_cycle;
#[path = "../common/functions.rs"]
#[allow(dead_code, reason = "the exports are those of the planar unit")]
mod loading;
mod stops;
#[path = "unit_in_space.rs"]
mod unit;

use host::{Instance, Wanted, call, reference};

/// Samples along y act as those along x of a record that is turned by a quarter turn. Neither array sizes the feet.
#[test]
fn samples_of_all_directions_act() {
    let samples: Vec<f64> = (0..300).map(|i| 3.0 * (0.3 * f64::from(i)).sin()).collect();
    let tilts =
        [("record.x_samples", std::f64::consts::FRAC_PI_2), ("record.y_samples", 0.0)].map(|(name, azimuth)| {
            let block = Instance::new(Wanted::default());
            block.ok(call!(block, enter_configuration_mode));
            block.set_all(&[("record.samples", 300.0), ("foot_count", 5.0)]);
            block.ok(call!(block, exit_configuration_mode));
            assert_eq!((block.get("record.samples"), block.get("foot_count")), (300.0, 5.0));
            block.ok(call!(block, set_float64, &reference(name), 1, samples.as_ptr(), samples.len()));
            block.set_all(&[("record.dt", 0.01), ("record.scale", 3.0), ("record.azimuth", azimuth)]);
            block.initialize(false);
            (0..20).for_each(|i| _ = block.step(f64::from(i) * 0.1, 0.1));
            assert!(block.get("events.lift_offs") > 0.0);
            assert_eq!(block.get("record.end"), 2.99);
            [block.get("tilt_x"), block.get("tilt_y")]
        });
    let [turned, along] = tilts;
    assert!(along[0].abs() < 1e-9 && along[1].abs() > 1e-4, "{along:?}");
    assert!((turned[0] - along[0]).abs() + (turned[1] - along[1]).abs() < 1e-9, "{turned:?}, {along:?}");
}
