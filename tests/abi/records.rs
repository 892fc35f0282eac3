//! The FMU's own accelerograms: followed exactly, resumed from any state, refused with a reason.

use std::path::Path;

use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_records::ReadOptions;

use crate::functions::*;
use crate::host::{Instance, call};

const HORIZONTAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/records/0111a.smc");
const VERTICAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/records/np01002p_4225a_a.smc");

/// A slender block under scaled records, which rocks with impacts and flights.
const BLOCK: [(&str, f64); 5] = [
    ("dimensionless.alpha", 0.15),
    ("dimensionless.p", 2.0),
    ("dimensionless.eta", 30.0),
    ("record.scale", 4.0),
    ("on_separation", 3.0),
];

fn driven() -> Instance {
    let instance = Instance::new("block");
    for (name, value) in BLOCK {
        instance.set(name, value);
    }
    instance.set_text("record.horizontal", HORIZONTAL);
    instance.set_text("record.vertical", VERTICAL);
    instance
}

/// Runs the same block under the same records without the FMU.
fn simulation(ground: &Ground) -> Simulation {
    let dimensionless =
        Dimensionless { alpha: 0.15, p: 2.0, supports: Supports::Viscoelastic(Ratios { eta: 30.0, xi_v: 0.1 }) };
    let block = Block::from_dimensionless(&dimensionless, &Common { mass: 1000.0, ..Common::default() }).unwrap();
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    Simulation::new(block, settings, Pulse::NONE, &Initial::default(), 0.0, &ground.inputs_from(0.0).0)
}

/// The step is a power of two, so that times are exact.
const STEP: f64 = 1.0 / 64.0;

#[test]
fn the_fmu_follows_a_record_like_the_solver() {
    let read = |path| Some(rocking_records::read(Path::new(path), &ReadOptions::default()).unwrap());
    let ground = Ground { horizontal: read(HORIZONTAL), vertical: read(VERTICAL) }.scaled(4.0);
    let mut simulation = simulation(&ground);
    let (mut inputs, mut until) = ground.inputs_from(0.0);
    let instance = driven();
    instance.initialize(None);
    for i in 0..=1280 {
        let time = f64::from(i) * STEP;
        while simulation.time() < time {
            simulation.advance(until.min(time), &inputs, &mut |_| ()).unwrap();
            if simulation.time() == until {
                (inputs, until) = ground.inputs_from(until);
            }
        }
        let alone = simulation.observe(&inputs);
        let seen = ["theta", "theta_dot", "v", "H", "N_L", "energy.total"].map(|name| instance.get(name).to_bits());
        let energy = simulation.energies().total;
        let expected = [alone.theta, alone.theta_dot, alone.v, alone.horizontal, alone.reaction[0], energy];
        assert_eq!(seen, expected.map(f64::to_bits), "at t = {time}");
        instance.step(time, STEP);
    }
    let counts = simulation.counts();
    assert!(counts.impacts > 5 && counts.liftoffs > 5, "{counts:?}");
}

/// The communication step and the record's source change the motion only within round-off and tolerance.
#[test]
fn any_communication_step_gives_the_same_motion() {
    let follow = |step: f64| {
        let instance = driven();
        instance.initialize(Some(1e-11));
        instance.go(0.0, 6.0, step);
        ["theta", "theta_dot", "v"].map(|name| instance.get(name))
    };
    let fine = follow(0.001);
    for step in [0.0125, 0.5, 6.0] {
        for (a, b) in follow(step).iter().zip(fine) {
            assert!((a - b).abs() < 1e-8, "{a} with a step of {step} s, {b} with one of 0.001 s");
        }
    }
}

/// The horizontal reaction includes the ground's acceleration, of the record and of the input.
#[test]
fn inputs_are_added() {
    let instance = driven();
    instance.set("a_gx", 1.0);
    instance.initialize(None);
    let record = rocking_records::read(Path::new(HORIZONTAL), &ReadOptions::default()).unwrap();
    let ground = |input: f64, time: f64| input + 4.0 * record.at(time);
    let held = |instance: &Instance| instance.get("H") / 1000.0 - instance.get("u_ddot");
    assert!((held(&instance) - ground(1.0, 0.0)).abs() < 1e-12);
    for step in 0..40 {
        let (time, input) = (0.13 * f64::from(step), if step % 2 == 0 { -1.0 } else { 0.5 });
        instance.set("a_gx", input);
        let next = 0.13 * f64::from(step + 1);
        instance.step(time, next - time);
        if instance.get("regime") != 2.0 {
            assert!((held(&instance) - ground(input, next)).abs() < 1e-11, "at t = {next}");
        }
    }
}

#[test]
fn peaks_and_end_of_a_record_are_variables() {
    let instance = driven();
    instance.set("record.start", 2.5);
    instance.initialize(None);
    let [horizontal, vertical] =
        [HORIZONTAL, VERTICAL].map(|path| rocking_records::read(Path::new(path), &ReadOptions::default()).unwrap());
    assert_eq!(instance.get("record.PGA"), (4.0 * horizontal.peak().acceleration).abs());
    assert_eq!(instance.get("record.PGA_vertical"), (4.0 * vertical.peak().acceleration).abs());
    let end =
        [&horizontal, &vertical].map(|record| record.start_time + record.duration()).into_iter().fold(0.0, f64::max);
    assert!((instance.get("record.end") - (end + 2.5)).abs() < 1e-12);
    assert_eq!(instance.text("record.horizontal"), HORIZONTAL);
    assert_eq!(instance.text("record.horizontal_unit"), "");
}

/// A shifted record gives the shifted motion.
#[test]
fn a_record_begins_at_its_start_time() {
    let motion = |start: f64| {
        let instance = driven();
        instance.set("record.start", start);
        instance.initialize(Some(1e-11));
        instance.go(0.0, 4.0 + start, 0.5);
        instance.get("theta")
    };
    let (at_once, later) = (motion(0.0), motion(1.0));
    assert!(at_once.abs() > 1e-4 && (at_once - later).abs() < 1e-8, "{at_once}, {later}");
}

#[test]
fn states_resume_with_the_same_bits_and_without_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a record, 100 % größer.smc");
    std::fs::copy(HORIZONTAL, &path).unwrap();
    let instance = driven();
    instance.set_text("record.horizontal", path.to_str().unwrap());
    instance.initialize(None);
    instance.go(0.0, 3.0, 0.3);
    let state = instance.save();
    let bytes = instance.serialize(state);
    instance.go(3.0, 9.0, 0.3);
    let expected = instance.bits();
    std::fs::remove_file(&path).unwrap();

    instance.restore(state);
    instance.go(3.0, 9.0, 0.3);
    assert_eq!(instance.bits(), expected);
    instance.free(state);

    let other = Instance::new("other");
    let mut state = std::ptr::null_mut();
    assert_eq!(call!(other, deserialize, bytes.as_ptr(), bytes.len(), &mut state), OK, "{:?}", other.messages());
    other.restore(state);
    other.free(state);
    other.go(3.0, 9.0, 0.3);
    assert_eq!(other.bits(), expected);
    assert_eq!(other.text("record.horizontal"), path.to_str().unwrap());
}

#[test]
fn a_record_that_cannot_be_read_fails_the_initialization_and_can_be_corrected() {
    let instance = driven();
    instance.set_text("record.horizontal", "no such file.AT2");
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    let words = ["fmi2ExitInitializationMode", "record.horizontal", "no such file.AT2"];
    instance.refuses(call!(instance, exit_initialization_mode), &words);
    instance.set_text("record.horizontal", HORIZONTAL);
    instance.set_text("record.horizontal_unit", "furlongs");
    let words = ["record.horizontal_unit", "furlongs", "expected one of g, m/s2, cm/s2"];
    instance.refuses(call!(instance, exit_initialization_mode), &words);
    instance.set_text("record.horizontal_unit", "");
    assert_eq!(call!(instance, exit_initialization_mode), OK, "{:?}", instance.messages());
    instance.refuses(instance.try_set_text("record.horizontal", ""), &["record.horizontal", "fixed parameter"]);
}

/// Importers that keep files as URLs pass these.
#[test]
fn the_path_of_a_record_may_be_a_url() {
    let path = std::fs::canonicalize(HORIZONTAL).unwrap();
    let [by_path, by_url] = [path.display().to_string(), format!("file://{}", path.display())].map(|text| {
        let instance = Instance::new("block");
        instance.set_text("record.horizontal", &text);
        instance.initialize(None);
        instance.go(0.0, 3.0, 0.3);
        (instance.bits(), instance.get("record.PGA"))
    });
    assert!(by_path.1 > 0.0);
    assert_eq!(by_url, by_path);
}

/// A file without a header needs unit and time step; the message names their variables.
#[test]
fn units_and_time_steps_of_bare_files_come_from_variables() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bare.txt");
    std::fs::write(&path, "0.0\n0.1\n0.3\n-0.2\n0.0\n").unwrap();
    let instance = Instance::new("block");
    instance.set_text("record.horizontal", path.to_str().unwrap());
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    for (name, text) in [("record.dt", ""), ("record.horizontal_unit", "g")] {
        let status = call!(instance, exit_initialization_mode);
        instance.refuses(status, &["bare.txt", name]);
        if text.is_empty() {
            instance.set(name, 0.01);
        } else {
            instance.set_text(name, text);
        }
    }
    assert_eq!(call!(instance, exit_initialization_mode), OK, "{:?}", instance.messages());
    assert_eq!(instance.get("record.PGA"), 0.3 * 9.81);
    assert_eq!(instance.get("record.end"), 0.04);
}

#[test]
fn settings_without_a_record_warn() {
    let instance = Instance::new("block");
    instance.set("record.scale", 2.0);
    instance.set("record.vertical_channel", 2.0);
    instance.set_text("record.vertical_unit", "g");
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    assert_eq!(call!(instance, exit_initialization_mode), WARNING);
    let messages = instance.messages();
    assert_eq!(messages.len(), 1);
    for words in [
        "record.scale needs record.horizontal or record.vertical",
        "record.vertical_channel needs record.vertical",
        "record.vertical_unit needs record.vertical",
    ] {
        assert!(messages[0].text.contains(words), "{messages:?}");
    }
}

#[test]
fn texts_are_utf8() {
    let instance = Instance::new("block");
    let latin = c"gr\xf6\xdfer.AT2".as_ptr();
    let status = call!(instance, set_string, &crate::host::reference("record.horizontal"), 1, &latin);
    instance.refuses(status, &["fmi2SetString", "expected UTF-8"]);
}

/// Opening a pipe waits for a writer, and a device never ends.
#[cfg(unix)]
#[test]
fn only_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let url = format!("file://{}", pipe.display());
    for path in [pipe.to_str().unwrap(), &url, "/dev/zero", "/dev/null", "file:///dev/zero"] {
        let instance = Instance::new("block");
        instance.set_text("record.horizontal", path);
        assert_eq!(instance.setup(None, 0.0, None), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        instance.refuses(call!(instance, exit_initialization_mode), &["record.horizontal", path, "512 MiB"]);
    }
}

/// Messages are one line of text, where # would begin a variable's number.
#[test]
fn names_of_files_are_printed_in_one_line() {
    let instance = Instance::new("block");
    instance.set_text("record.horizontal", "/nowhere/#1\n\u{1b}[2J.csv");
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    instance.refuses(call!(instance, exit_initialization_mode), &["/nowhere/##1", "[2J.csv"]);
    let messages = instance.messages();
    assert!(messages.iter().all(|message| !message.text.contains(char::is_control)), "{messages:?}");
}

#[test]
fn numbers_are_printed_with_all_their_digits() {
    let instance = Instance::new("block");
    instance.refuses(instance.try_set("mass", -1e300), &["mass = -1e300;"]);
    instance.refuses(instance.try_set("dimensionless.alpha", 5.0), &["dimensionless.alpha = 5;"]);
    instance.refuses(instance.setup(None, 1e300, Some(-1e300)), &["stopTime = -1e300;"]);
}

/// A file of a format without channels has one channel.
#[test]
fn a_missing_channel_is_refused() {
    let ready = |channel: f64| {
        let instance = driven();
        instance.set("record.horizontal_channel", channel);
        assert_eq!(instance.setup(None, 0.0, None), OK);
        assert_eq!(call!(instance, enter_initialization_mode), OK);
        let status = call!(instance, exit_initialization_mode);
        (instance, status)
    };
    let (instance, status) = ready(1000.0);
    instance.refuses(status, &["record.horizontal_channel = 1000", "expected 0 or 1", "SMC", "one channel"]);
    for channel in [0.0, 1.0] {
        assert_eq!(ready(channel).1, OK, "{channel}");
    }
}
