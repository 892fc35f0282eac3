//! The trajectories of tests/reference_space: motion, forces, events of each foot, energies.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::run::{OnOverturning, OnSeparation, Settings};
use rocking_block::space::excitation::{DirectedPulses, MAX_PULSES};
use rocking_block::space::outputs::{FootObservation, SpaceObservation};
use rocking_block::space::{
    Base, BaseSize, DirectedPulse, FootPlace, SpaceBody, SpaceEventKind, SpaceGround, SpaceInitial, SpaceInputs,
    SpaceParameters, SpacePeaks, SpaceRun, SpaceSetup, SpaceSupports,
};
use rocking_records::{ReadOptions, Record};
use serde::Deserialize;

use crate::skipped::skip;

#[derive(Debug, Deserialize)]
struct Case {
    name: String,
    parameters: CaseParameters,
    numbers: CaseNumbers,
    excitation: BTreeMap<String, Option<CaseMotion>>,
    initial: CaseInitial,
    end: String,
    t_asked: f64,
    t_final: f64,
    peak_tilt: f64,
    flight: bool,
    energy: BTreeMap<String, f64>,
    events: Vec<CaseEvent>,
}

#[derive(Debug, Deserialize)]
struct CaseParameters {
    base: String,
    feet: Option<usize>,
    alpha: f64,
    p: f64,
    eta: f64,
    xi_v: f64,
    kappa: f64,
    friction: f64,
    depth_ratio: Option<f64>,
    #[serde(default)]
    eccentricity_x: f64,
    #[serde(default)]
    eccentricity_y: f64,
}

#[derive(Debug, Deserialize)]
#[allow(non_snake_case, reason = "names of the file")]
struct CaseNumbers {
    M: f64,
    g: f64,
    inertia: [[f64; 3]; 3],
    feet: Vec<[f64; 2]>,
    foot_gap: Vec<f64>,
    center_height: f64,
    R0: f64,
    omega_v: f64,
    K: f64,
    C: f64,
    K_h: f64,
    C_h: f64,
    N_0: Vec<f64>,
    f: Vec<f64>,
}

#[derive(Debug, Deserialize)]
struct CaseMotion {
    #[serde(default)]
    a: f64,
    #[serde(default)]
    omega: f64,
    start: f64,
    file: Option<String>,
    #[serde(default)]
    scale: f64,
}

#[derive(Debug, Deserialize)]
#[allow(non_snake_case, reason = "names of the file")]
struct CaseInitial {
    given: CaseGiven,
    X: [f64; 3],
    q: [f64; 4],
    V: [f64; 3],
}

#[derive(Debug, Deserialize)]
struct CaseGiven {
    tilt_x: Option<f64>,
    #[serde(default)]
    tilt_y: f64,
    #[serde(default)]
    omega: [f64; 3],
}

#[derive(Debug, Deserialize)]
struct CaseEvent {
    t: f64,
    kind: String,
    foot: i32,
}

fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference_space")
}

fn cases() -> Vec<Case> {
    serde_json::from_str(&std::fs::read_to_string(folder().join("cases.json")).unwrap()).unwrap()
}

fn close(name: &str, found: f64, expected: f64, scale: f64, tolerance: f64) {
    let error = (found - expected).abs() / scale;
    assert!(error <= tolerance, "{name}: {found}, not {expected}: {error:e} > {tolerance:e}");
}

impl Case {
    fn body(&self) -> SpaceBody {
        let &CaseParameters { alpha, p, eta, xi_v, kappa, friction, depth_ratio, .. } = &self.parameters;
        let numbers = &self.numbers;
        let size = BaseSize::Slenderness { alpha, p };
        // The file has eccentricities over half the width and half the depth.
        let (b, depth) = (numbers.R0 * alpha.sin(), depth_ratio.unwrap_or(1.0));
        let is_list = self.parameters.base == "List";
        let base = match self.parameters.base.as_str() {
            "Rectangle" => Base::Rectangle { size, depth_ratio: depth },
            "Circle" => Base::Circle { size, feet: self.parameters.feet.unwrap() },
            "List" => {
                let places = numbers.feet.iter().zip(&numbers.foot_gap);
                let feet = places.map(|(&[x, y], &gap)| FootPlace { x, y, gap }).collect();
                Base::List { feet, center_height: numbers.center_height }
            }
            other => panic!("unknown base {other}"),
        };
        let supports = if is_list {
            SpaceSupports::OfHeave { omega_v: numbers.omega_v, xi_v }
        } else {
            SpaceSupports::OfRocking { eta, xi_v }
        };
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = numbers.inertia;
        let body = SpaceBody::new(&SpaceParameters {
            base,
            supports,
            kappa,
            friction,
            mass: numbers.M,
            gravity: numbers.g,
            eccentricity: [self.parameters.eccentricity_x * b, self.parameters.eccentricity_y * b * depth],
            inertia: is_list.then_some([xx, yy, zz, xy, xz, yz]),
            ..SpaceParameters::default()
        })
        .unwrap();
        self.check_numbers(&body);
        body
    }

    /// The numbers that follow from the parameters are those of the file.
    fn check_numbers(&self, body: &SpaceBody) {
        const ROUNDING: f64 = 1e-13;
        let numbers = &self.numbers;
        for (name, found, expected) in [
            ("h", body.center_height, numbers.center_height),
            ("omega_v", body.omega_v, numbers.omega_v),
            ("K", body.stiffness, numbers.K),
            ("C", body.damping, numbers.C),
            ("K_h", body.horizontal_stiffness, numbers.K_h),
            ("C_h", body.horizontal_damping, numbers.C_h),
        ] {
            close(name, found, expected, expected, ROUNDING);
        }
        if self.parameters.base != "List" {
            close("R0", body.r0, numbers.R0, numbers.R0, ROUNDING);
        }
        for (i, row) in numbers.inertia.iter().enumerate() {
            for (j, &expected) in row.iter().enumerate() {
                close("I", body.inertia[(i, j)], expected, numbers.inertia[0][0], ROUNDING);
            }
        }
        for (i, foot) in body.feet.iter().enumerate() {
            close("x", foot.place.x, numbers.feet[i][0], numbers.R0, ROUNDING);
            close("y", foot.place.y, numbers.feet[i][1], numbers.R0, ROUNDING);
            close("N_0", foot.static_load, numbers.N_0[i], numbers.M * numbers.g, ROUNDING);
            close("f", foot.free_height, numbers.f[i], numbers.M * numbers.g / numbers.K, ROUNDING);
        }
    }

    fn pulses(&self) -> DirectedPulses {
        let mut pulses = [DirectedPulse::NONE; MAX_PULSES];
        for (axis, name) in ["a_gx", "a_gy", "a_gz"].into_iter().enumerate() {
            if let Some(motion) = &self.excitation[name]
                && motion.file.is_none()
            {
                let mut direction = [0.0; 3];
                direction[axis] = 1.0;
                let &CaseMotion { a, omega, start, .. } = motion;
                let pulse =
                    Pulse { shape: PulseShape::OneSine, amplitude: a, period: TAU / omega, start, ..Pulse::NONE };
                pulses[axis] = DirectedPulse { pulse, direction };
            }
        }
        pulses
    }

    /// The ground motion, or a missing record.
    fn ground(&self) -> Result<SpaceGround, String> {
        let record = |name: &str| -> Result<Option<Record>, String> {
            let Some(CaseMotion { file: Some(file), scale, start, .. }) = &self.excitation[name] else {
                return Ok(None);
            };
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/records").join(file);
            if !path.exists() {
                return Err(file.clone());
            }
            let options = ReadOptions { gravity: self.numbers.g, ..ReadOptions::default() };
            let record = rocking_records::read(&path, &options).unwrap().scaled(*scale);
            Ok(Some(Record { start_time: record.start_time - start, ..record }))
        };
        let records = [record("a_gx")?, record("a_gy")?, record("a_gz")?];
        Ok(SpaceGround { records, azimuth: 0.0 })
    }

    fn initial(&self) -> SpaceInitial {
        let CaseGiven { tilt_x, tilt_y, omega } = self.initial.given;
        let vertical = if tilt_x.is_some() { None } else { Some([0.0, 0.0]) };
        SpaceInitial { tilt: [tilt_x.unwrap_or(0.0), tilt_y], twist: 0.0, omega, vertical }
    }

    fn run(&self) -> SpaceRun {
        let settings =
            Settings { tolerance: 1e-10, on_separation: OnSeparation::Fly, on_overturning: OnOverturning::Terminate };
        let setup = SpaceSetup { body: self.body(), settings, pulses: self.pulses() };
        let run = SpaceRun::new(setup, &self.initial(), 0.0);
        let numbers = &run.state().numbers;
        let expected = self.initial.X.iter().chain(&self.initial.q).chain(&self.initial.V);
        for (i, &expected) in expected.enumerate() {
            close("initial", numbers[i], expected, 1.0, 1e-13);
        }
        run
    }

    fn compare(&self, ground: &SpaceGround) {
        let alpha = self.parameters.alpha;
        let weight = self.numbers.M * self.numbers.g;
        let mut run = self.run();
        let mut events = Vec::new();
        let mut worst = [0.0_f64; 5];
        let mut rows_peaks = RowsPeaks::default();
        let mut rows = csv::Reader::from_path(folder().join(format!("{}.csv", self.name))).unwrap();
        let headers = rows.headers().unwrap().clone();
        for row in rows.records() {
            let row = row.unwrap();
            let value =
                |name: &str| -> f64 { row[headers.iter().position(|header| header == name).unwrap()].parse().unwrap() };
            let t = value("t").min(self.t_final);
            let mut inputs = ground.inputs_from(run.time()).0;
            while run.time() < t && run.state().ending.is_none() {
                let (now, end) = ground.inputs_from(run.time());
                inputs = now;
                run.advance(t.min(end), &inputs, &mut |event| events.push(*event)).unwrap();
            }
            let seen = run.observe(&inputs);
            let attitude = [seen.attitude.tilt_x, seen.attitude.tilt_y, seen.attitude.twist];
            for (found, name) in attitude.into_iter().zip(["tilt_x", "tilt_y", "twist"]) {
                worst[0] = worst[0].max((found - value(name)).abs() / alpha);
            }
            for (i, name) in ["u", "w", "v"].into_iter().enumerate() {
                worst[1] = worst[1].max((seen.displacement[i] - value(name)).abs() / (alpha * self.numbers.R0));
            }
            for (i, name) in ["omega_x", "omega_y", "omega_z"].into_iter().enumerate() {
                worst[2] = worst[2].max((seen.omega[i] - value(name)).abs() / (alpha * self.parameters.p));
            }
            for (i, foot) in seen.feet.iter().enumerate() {
                worst[3] = worst[3].max((foot.normal - value(&format!("N_{i}"))).abs() / weight);
            }
            assert_eq!(seen.touching(), value("touching") as usize, "{} at {t}", self.name);
            assert_eq!(seen.sliding(), value("sliding") as usize, "{} at {t}", self.name);
            worst[4] = worst[4].max(run.energies().residual.abs() / run.body().energy_scale());
            rows_peaks.include(&seen);
        }
        rows_peaks.compare(run.peaks());
        if self.end == "overturned" {
            run.advance(self.t_final + 0.01, &SpaceInputs::default(), &mut |event| events.push(*event)).unwrap();
        }
        let counts = run.state().counts;
        println!("{}: tilt, place, omega, N, residual {worst:?}; {counts:?}", self.name);
        self.compare_events(&events);
        assert!(worst[0] <= 1e-7, "{}: tilt off by {:e} alpha", self.name, worst[0]);
        assert!(worst[1..3].iter().all(|&error| error <= 1e-6), "{}: {worst:?}", self.name);
        assert!(worst[3] <= 1e-5, "{}: N off by {:e} M g", self.name, worst[3]);
        assert!(worst[4] <= 1e-9, "{}: a residual of {:e} M g R0", self.name, worst[4]);
        assert_eq!(run.state().separated, self.flight, "{}", self.name);
        assert_eq!(run.state().ending.is_some(), self.end == "overturned", "{}", self.name);
        close("end", run.time(), self.t_final, 1.0, 1e-7);
        assert!(self.t_final <= self.t_asked);
        // The file has the greatest of its rows' tilts.
        assert!(run.peak_tilt() >= self.peak_tilt - 1e-7 * alpha, "{}: {}", self.name, run.peak_tilt());
        let expected = if self.end == "overturned" { FRAC_PI_2 } else { self.peak_tilt };
        close("peak", run.peak_tilt(), expected, alpha, 1e-3);
        let energies = run.energies();
        for (name, found) in [
            ("dashpots", energies.dashpots),
            ("slip", energies.slip),
            ("input", energies.input),
            ("lift_off", energies.lift_off),
        ] {
            close(name, found, self.energy[name], run.body().energy_scale(), 1e-7);
        }
        close("E", energies.stored.total(), self.energy["E"], run.body().energy_scale(), 1e-7);
    }

    /// The events of each foot are those of the file.
    fn compare_events(&self, found: &[rocking_block::space::SpaceEvent]) {
        for foot in -1..self.numbers.feet.len() as i32 {
            let expected = self.events.iter().filter(|event| event.foot == foot);
            let expected: Vec<_> = expected.map(|event| (event.kind.as_str(), event.t)).collect();
            let name = |kind: SpaceEventKind| match kind {
                SpaceEventKind::LiftOff(i) => ("lift-off", i as i32),
                SpaceEventKind::Landing(i) => ("landing", i as i32),
                SpaceEventKind::Slides(i) => ("slides", i as i32),
                SpaceEventKind::Sticks(i) => ("sticks", i as i32),
                SpaceEventKind::Overturning => ("overturning", -1),
            };
            let found = found.iter().filter(|event| name(event.kind).1 == foot);
            let found: Vec<_> = found.map(|event| (name(event.kind).0, event.time)).collect();
            let kinds = |events: &[(&str, f64)]| events.iter().map(|event| event.0.to_owned()).collect::<Vec<_>>();
            assert_eq!(kinds(&found), kinds(&expected), "{}, foot {foot}: {found:?}, not {expected:?}", self.name);
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found.1 - expected.1).abs() < 1e-7, "{}, foot {foot}: {found:?}, not {expected:?}", self.name);
            }
        }
    }
}

/// The greatest values of the rows, twist, drift, N, uplift and slip.
#[derive(Default)]
struct RowsPeaks([f64; 5]);

impl RowsPeaks {
    fn include(&mut self, seen: &SpaceObservation) {
        let of_feet = |value: fn(&FootObservation) -> f64| seen.feet.iter().map(value).fold(0.0, f64::max);
        let [x, y] = seen.drift;
        let values = [
            seen.attitude.twist.abs(),
            x.hypot(y),
            of_feet(|foot| foot.normal),
            of_feet(|foot| foot.uplift),
            of_feet(|foot| foot.slip),
        ];
        self.0.iter_mut().zip(values).for_each(|(peak, value)| *peak = peak.max(value));
    }

    /// Peaks of a run are at least those of its rows, 10 ms apart, and hardly more.
    fn compare(&self, peaks: &SpacePeaks) {
        let found = [peaks.twist(), peaks.drift(), peaks.normal, peaks.uplift, peaks.slip];
        // N jumps and swings between rows.
        for ((found, of_rows), excess) in found.into_iter().zip(self.0).zip([0.01, 0.01, 0.3, 0.01, 0.01]) {
            assert!(
                found >= of_rows * (1.0 - 1e-14) && found <= of_rows * (1.0 + excess),
                "{peaks:?}, not {:?}",
                self.0
            );
        }
    }
}

fn compare(name: &str) {
    let case = cases().into_iter().find(|case| case.name == name).unwrap();
    match case.ground() {
        Ok(ground) => case.compare(&ground),
        Err(record) => skip(&format!("reference in space {name}: {record} is missing")),
    }
}

macro_rules! references {
    ($($name:ident)*) => {$(
        #[test]
        fn $name() {
            compare(stringify!($name));
        }
    )*};
}
references!(two_axis diagonal_overturns corner_release eccentric_flight friction six_feet cylinder_16 rinaldi);
