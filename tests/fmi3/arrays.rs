//! A record as arrays, whose size is a structural parameter.

use crate::functions::OK;
use crate::host::{Instance, Wanted, call, reference};
use crate::unit::name;

fn samples(count: usize) -> Vec<f64> {
    (0..count).map(|i| 3.0 * (0.3 * i as f64).sin()).collect()
}

fn new() -> Instance {
    let instance = Instance::new(Wanted::default());
    instance.set_all(&[("on_separation", 3.0), ("record.dt", 0.01)]);
    instance
}

fn resize(instance: &Instance, count: usize) {
    instance.ok(call!(instance, enter_configuration_mode));
    instance.set("record.samples", count as f64);
    instance.ok(call!(instance, exit_configuration_mode));
}

fn array(instance: &Instance, name: &str, samples: &[f64]) {
    instance.ok(call!(instance, set_float64, &reference(name), 1, samples.as_ptr(), samples.len()));
}

#[test]
fn a_record_in_arrays_acts_like_one_in_a_file() {
    let (horizontal, vertical) = (samples(300), samples(300).iter().map(|a| 0.5 * a).collect::<Vec<_>>());
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, values: &[f64]| {
        let path = folder.path().join(name);
        std::fs::write(&path, values.iter().map(|a| format!("{a:?}\n")).collect::<String>()).unwrap();
        std::ffi::CString::new(path.to_str().unwrap()).unwrap()
    };
    let by_file = new();
    for (name, text) in [
        ("record.horizontal", file("horizontal", &horizontal)),
        ("record.vertical", file("vertical", &vertical)),
        ("record.horizontal_unit", c"m/s2".into()),
    ] {
        by_file.ok(call!(by_file, set_string, &reference(name), 1, &text.as_ptr(), 1));
    }
    let by_arrays = new();
    resize(&by_arrays, 300);
    array(&by_arrays, "record.horizontal_samples", &horizontal);
    array(&by_arrays, "record.vertical_samples", &vertical);
    for instance in [&by_file, &by_arrays] {
        instance.set_all(&[("record.scale", 1.5), ("record.start", 0.25)]);
        instance.initialize(false);
        for i in 0..40 {
            instance.step(f64::from(i) * 0.1, 0.1);
        }
    }
    assert!(by_file.get("events.impacts") > 0.0);
    assert_eq!(by_file.output_bits(), by_arrays.output_bits());
    assert_eq!(by_arrays.get("record.PGA"), by_file.get("record.PGA"));
    assert_eq!(by_arrays.get("record.end"), 0.25 + 2.99);
}

#[test]
fn arrays_are_read_as_they_were_set_among_scalars() {
    let block = new();
    assert_eq!(block.get("record.samples"), 2.0);
    resize(&block, 3);
    let names = ["mass", "record.vertical_samples", "time", "record.horizontal_samples", "intermediate.interval"];
    let references = names.map(reference);
    let mut values = [f64::NAN; 9];
    assert_eq!(call!(block, get_float64, references.as_ptr(), 5, values.as_mut_ptr(), 9), OK);
    assert_eq!(values, [1000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.005]);
    let settable = ["mass", "record.vertical_samples", "record.horizontal_samples"].map(reference);
    let given = [500.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    assert_eq!(call!(block, set_float64, settable.as_ptr(), 3, given.as_ptr(), 7), OK);
    assert_eq!(call!(block, get_float64, references.as_ptr(), 5, values.as_mut_ptr(), 9), OK);
    assert_eq!(values, [500.0, 1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0, 0.005]);
    // One wrong element: none is set.
    for (wrong, words) in [
        ([700.0, 7.0, f64::NAN, 7.0, 7.0, 7.0, 7.0], [name("record.vertical_samples"), "= NaN"]),
        ([-1.0, 7.0, 7.0, 7.0, 7.0, 7.0, 7.0], ["mass", "= -1"]),
    ] {
        block.refuses(call!(block, set_float64, settable.as_ptr(), 3, wrong.as_ptr(), 7), &words);
        assert_eq!(
            (block.get("mass"), call!(block, get_float64, &settable[1], 1, values.as_mut_ptr(), 3)),
            (500.0, OK)
        );
        assert_eq!(values[..3], [1.0, 2.0, 3.0]);
    }
    // A new size empties the arrays, and so does a reset.
    resize(&block, 2);
    assert_eq!(call!(block, get_float64, &settable[1], 1, values.as_mut_ptr(), 2), OK);
    assert_eq!(values[..2], [0.0, 0.0]);
}

#[test]
fn arrays_that_do_not_fit_are_refused() {
    let block = new();
    let horizontal = reference("record.horizontal_samples");
    let three = [1.0, 2.0, 3.0];
    block.refuses(call!(block, set_float64, &horizontal, 1, three.as_ptr(), 3), &["nValues = 3", "expected 2"]);
    let mut room = [f64::NAN; 3];
    block.refuses(call!(block, get_float64, &horizontal, 1, room.as_mut_ptr(), 3), &["nValues = 3", "expected 2"]);
    block.refuses(block.try_set("record.samples", 5.0), &["fmi3SetUInt64", "Instantiated", "Configuration Mode"]);
    assert_eq!(call!(block, enter_configuration_mode), OK);
    block.refuses(block.try_set("record.samples", 1.0), &["record.samples = 1", "expected 2 to 10000000"]);
    block.refuses(block.try_set("record.samples", 1e18), &["record.samples", "expected 2 to 10000000"]);
    block.refuses(block.try_set("mass", 2.0), &["fmi3SetFloat64", "Configuration Mode"]);
    block.refuses(call!(block, enter_initialization_mode, false, 0.0, 0.0, false, 0.0), &["Configuration Mode"]);
    assert_eq!(call!(block, exit_configuration_mode), OK);
    // Without a time step, and beside a file.
    block.set("record.dt", 0.0);
    array(&block, "record.horizontal_samples", &[1.0, 2.0]);
    assert_eq!(call!(block, enter_initialization_mode, false, 0.0, 0.0, false, 0.0), OK);
    block.refuses(call!(block, exit_initialization_mode), &["record.dt = 0 s", "expected a time step"]);
    block.set("record.dt", 0.01);
    let path = c"/nowhere";
    assert_eq!(call!(block, set_string, &reference("record.vertical"), 1, &path.as_ptr(), 1), OK);
    block.refuses(call!(block, exit_initialization_mode), &[name("record.horizontal_samples"), "expected one of both"]);
    let none = c"";
    assert_eq!(call!(block, set_string, &reference("record.vertical"), 1, &none.as_ptr(), 1), OK);
    assert_eq!(call!(block, exit_initialization_mode), OK);
    block.refuses(call!(block, set_float64, &horizontal, 1, three.as_ptr(), 2), &["fixed parameter"]);
    block.refuses(call!(block, enter_configuration_mode), &["fmi3EnterConfigurationMode", "Step Mode"]);
}

#[test]
fn a_saved_state_has_its_record_inside() {
    let [block, other] = [(), ()].map(|()| new());
    resize(&block, 300);
    array(&block, "record.horizontal_samples", &samples(300));
    block.initialize(false);
    block.step(0.0, 1.0);
    let mut state = std::ptr::null_mut();
    assert_eq!(call!(block, get_fmu_state, &mut state), OK);
    let mut size = 0;
    assert_eq!(call!(block, serialized_fmu_state_size, state, &mut size), OK);
    let mut bytes = vec![0; size];
    assert_eq!(call!(block, serialize_fmu_state, state, bytes.as_mut_ptr(), size), OK);
    assert_eq!(call!(block, free_fmu_state, &mut state), OK);
    assert!(state.is_null());
    assert_eq!(call!(other, deserialize_fmu_state, bytes.as_ptr(), size, &mut state), OK);
    assert_eq!(call!(other, set_fmu_state, state), OK);
    assert_eq!(call!(other, free_fmu_state, &mut state), OK);
    for instance in [&block, &other] {
        instance.step(1.0, 2.0);
    }
    assert_eq!(other.get("record.samples"), 300.0);
    assert_eq!(block.output_bits(), other.output_bits());
}
