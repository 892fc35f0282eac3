//! Model Exchange of the block in space with any number of feet: sizes follow the structural parameter.

use std::ptr::null_mut;

use crate::functions::OK;
use crate::host::{FMU, Instance, Wanted, call, reference};

/// A cylinder that rocks under a pulse.
const SHAKEN: [(&str, f64); 9] = [
    ("dimensionless.alpha", 0.25),
    ("dimensionless.p", 1.5),
    ("dimensionless.xi_v", 0.2),
    ("friction", 0.4),
    ("base", 2.0),
    ("pulse.shape", 2.0),
    ("pulse.amplitude", 4.0),
    ("pulse.period", 1.0),
    ("pulse.azimuth", 0.6),
];

fn resize(block: &Instance, feet: usize) {
    block.ok(call!(block, enter_configuration_mode));
    block.set("foot_count", feet as f64);
    block.ok(call!(block, exit_configuration_mode));
}

fn configured(block: Instance, feet: usize) -> Instance {
    resize(&block, feet);
    block.set_all(&SHAKEN);
    block.set("feet", feet as f64);
    block.ok(call!(block, enter_initialization_mode, true, 1e-11, 0.0, false, 0.0));
    block.ok(call!(block, exit_initialization_mode));
    block
}

struct Solver {
    block: Instance,
    time: f64,
    states: Vec<f64>,
    indicators: usize,
    next: Option<f64>,
}

impl Solver {
    fn begin(feet: usize) -> Solver {
        let block = configured(Instance::exchanged(), feet);
        let (mut states, mut indicators) = (0, 0);
        block.ok(call!(block, get_number_of_continuous_states, &mut states));
        block.ok(call!(block, get_number_of_event_indicators, &mut indicators));
        assert_eq!((states, indicators), (16 + 3 * feet, 2 * feet + 1));
        let mut solver = Solver { block, time: 0.0, states: vec![0.0; states], indicators, next: None };
        solver.update();
        solver
    }

    fn update(&mut self) {
        let [mut more, mut terminates, mut nominals, mut values, mut defined] = [true; 5];
        let mut next = f64::NAN;
        let block = &self.block;
        block.ok(call!(
            block,
            update_discrete_states,
            &mut more,
            &mut terminates,
            &mut nominals,
            &mut values,
            &mut defined,
            &mut next
        ));
        assert!(!more && !nominals && !terminates && values);
        self.next = defined.then_some(next);
        block.ok(call!(block, enter_continuous_time_mode));
        block.ok(call!(block, get_continuous_states, self.states.as_mut_ptr(), self.states.len()));
    }

    fn derivatives(&self, time: f64, states: &[f64]) -> Vec<f64> {
        let block = &self.block;
        block.ok(call!(block, set_time, time));
        block.ok(call!(block, set_continuous_states, states.as_ptr(), states.len()));
        let mut derivatives = vec![f64::NAN; states.len()];
        block.ok(call!(block, get_continuous_state_derivatives, derivatives.as_mut_ptr(), states.len()));
        derivatives
    }

    fn attempt(&self, h: f64) -> (Vec<f64>, bool) {
        let plus = |k: &[f64], part: f64| -> Vec<f64> {
            self.states.iter().zip(k).map(|(state, k)| state + part * h * k).collect()
        };
        let k1 = self.derivatives(self.time, &self.states);
        let k2 = self.derivatives(self.time + 0.5 * h, &plus(&k1, 0.5));
        let k3 = self.derivatives(self.time + 0.5 * h, &plus(&k2, 0.5));
        let k4 = self.derivatives(self.time + h, &plus(&k3, 1.0));
        let sum: Vec<f64> = (0..k1.len()).map(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0).collect();
        let end = plus(&sum, 1.0);
        self.derivatives(self.time + h, &end);
        let mut indicators = vec![f64::NAN; self.indicators];
        self.block.ok(call!(self.block, get_event_indicators, indicators.as_mut_ptr(), self.indicators));
        (end, indicators.iter().any(|&z| z <= 0.0))
    }

    fn accept(&mut self, h: f64, end: Vec<f64>) {
        self.time += h;
        self.derivatives(self.time, &end);
        self.states = end;
        let (mut enter, mut terminate) = (true, true);
        self.block.ok(call!(self.block, completed_integrator_step, true, &mut enter, &mut terminate));
        assert!(!enter && !terminate);
    }

    fn event(&mut self) {
        self.block.ok(call!(self.block, enter_event_mode));
        self.update();
    }

    fn go(&mut self, until: f64, h: f64) {
        while self.time < until - 1e-12 {
            let stop = self.next.map_or(until, |next| next.min(until));
            let h = h.min(stop - self.time);
            let (end, fallen) = self.attempt(h);
            if fallen {
                let (mut before, mut after) = (0.0, h);
                for _ in 0..60 {
                    let middle = 0.5 * (before + after);
                    if self.attempt(middle).1 { after = middle } else { before = middle }
                }
                let end = self.attempt(after).0;
                self.accept(after, end);
                self.event();
            } else {
                self.accept(h, end);
            }
            if self.next.is_some_and(|next| (next - self.time).abs() < 1e-13) {
                self.time = stop;
                self.block.ok(call!(self.block, set_time, stop));
                self.event();
            }
        }
    }

    fn array(&self, name: &str, count: usize) -> Vec<f64> {
        let mut values = vec![f64::NAN; count];
        self.block.ok(call!(self.block, get_float64, &reference(name), 1, values.as_mut_ptr(), count));
        values
    }

    fn derivative(&self, unknown: &str, known: &str, seed: &[f64], count: usize) -> Vec<f64> {
        let mut found = vec![f64::NAN; count];
        let (unknown, known) = (reference(unknown), reference(known));
        let status = call!(
            self.block,
            get_directional_derivative,
            &unknown,
            1,
            &known,
            1,
            seed.as_ptr(),
            seed.len(),
            found.as_mut_ptr(),
            count
        );
        self.block.ok(status);
        found
    }
}

const COUNTS: [&str; 4] = ["events.lift_offs", "events.landings", "events.slides", "events.sticks"];

#[test]
fn any_number_of_feet_has_the_events_of_co_simulation() {
    for feet in [3, 4, 7] {
        let slave = configured(Instance::new(Wanted::default()), feet);
        let mut solver = Solver::begin(feet);
        solver.go(1.5, 1e-3);
        slave.step(0.0, 1.5);
        assert!(slave.get("events.landings") > 1.0);
        for name in COUNTS {
            assert_eq!(solver.block.get(name), slave.get(name), "{name} on {feet} feet");
        }
        for name in ["tilt", "tilt_x", "tilt_y", "twist", "peak.tilt", "peak.uplift"] {
            let (a, b) = (solver.block.get(name), slave.get(name));
            assert!((a - b).abs() < 1e-5, "{name} on {feet} feet: {a}, in Co-Simulation {b}");
        }
    }
}

/// The states are the variables of `ModelStructure`, arrays element by element; indicators too.
#[test]
fn states_and_indicators_are_the_declared_arrays() {
    let (feet, text) = (6, std::str::from_utf8(&FMU.files["modelDescription.xml"]).unwrap());
    let document = roxmltree::Document::parse(text).unwrap();
    let unknowns = |element: &str| -> Vec<String> {
        let found = document.descendants().filter(|node| node.has_tag_name(element));
        let name = |reference: &str| {
            let of = |variable: &&crate::host::Variable| variable.attributes["valueReference"] == reference;
            FMU.variables.values().find(of).unwrap().attributes["name"].clone()
        };
        found.map(|node| name(node.attribute("valueReference").unwrap())).collect()
    };
    let mut solver = Solver::begin(feet);
    solver.go(0.8, 1e-3);
    let moved: Vec<f64> = solver.states.iter().map(|state| state * 1.001 + 1e-7).collect();
    let rates = solver.derivatives(solver.time, &moved);
    let size = |name: &str| if FMU.variables[name].is_array { feet } else { 1 };
    let values =
        |names: &[String]| -> Vec<f64> { names.iter().flat_map(|name| solver.array(name, size(name))).collect() };
    let derivatives = unknowns("ContinuousStateDerivative");
    let of_state = |name: &String| {
        let reference = &FMU.variables[name].attributes["derivative"];
        let found = FMU.variables.iter().find(|(_, variable)| variable.attributes["valueReference"] == *reference);
        found.unwrap().0.clone()
    };
    assert_eq!(values(&derivatives), rates);
    assert_eq!(values(&derivatives.iter().map(of_state).collect::<Vec<_>>()), moved);
    let mut indicators = vec![f64::NAN; solver.indicators];
    solver.block.ok(call!(solver.block, get_event_indicators, indicators.as_mut_ptr(), indicators.len()));
    assert_eq!(values(&unknowns("EventIndicator")), indicators);
    // No scalar of a foot is a state or a known.
    let references: Vec<&str> = document
        .descendants()
        .filter(|node| node.has_tag_name("Output"))
        .flat_map(|node| node.attribute("dependencies").unwrap_or("").split_whitespace())
        .collect();
    let of_foot = FMU.variables["stretch_x_SW"].attributes["valueReference"].as_str();
    assert!(!references.contains(&of_foot));
    assert!(references.contains(&FMU.variables["stretch_x"].attributes["valueReference"].as_str()));
}

#[test]
fn a_number_that_the_block_does_not_have_is_refused() {
    let block = Instance::exchanged();
    resize(&block, 5);
    block.set_all(&SHAKEN);
    block.set("feet", 6.0);
    block.ok(call!(block, enter_initialization_mode, false, 0.0, 0.0, false, 0.0));
    let words = ["the block has 6 feet; expected 5 in Model Exchange", "foot_count"];
    block.refuses(call!(block, exit_initialization_mode), &words);
    block.set("feet", 5.0);
    block.ok(call!(block, exit_initialization_mode));
}

#[test]
fn saved_states_resume_with_the_same_bits() {
    let mut solver = Solver::begin(5);
    solver.go(0.6, 1e-3);
    let (mut state, at) = (null_mut(), (solver.time, solver.states.clone(), solver.next));
    solver.block.ok(call!(solver.block, get_fmu_state, &mut state));
    let mut size = 0;
    solver.block.ok(call!(solver.block, serialized_fmu_state_size, state, &mut size));
    let mut bytes = vec![0; size];
    solver.block.ok(call!(solver.block, serialize_fmu_state, state, bytes.as_mut_ptr(), size));
    solver.go(1.2, 1e-3);
    let expected = (solver.block.output_bits(), solver.states.clone());
    solver.block.ok(call!(solver.block, set_fmu_state, state));
    (solver.time, solver.states, solver.next) = at.clone();
    solver.go(1.2, 1e-3);
    assert_eq!((solver.block.output_bits(), solver.states.clone()), expected);
    assert_eq!(call!(solver.block, free_fmu_state, &mut state), OK);

    let mut other = Solver::begin(5);
    other.block.ok(call!(other.block, deserialize_fmu_state, bytes.as_ptr(), size, &mut state));
    other.block.ok(call!(other.block, set_fmu_state, state));
    other.block.ok(call!(other.block, free_fmu_state, &mut state));
    (other.time, other.states, other.next) = at;
    other.go(1.2, 1e-3);
    assert_eq!((other.block.output_bits(), other.states.clone()), expected);
}

/// Arrays differentiate element by element, and adjoint derivatives are the transposed ones.
#[test]
fn arrays_have_derivatives() {
    let feet = 5;
    let mut solver = Solver::begin(feet);
    solver.go(0.5, 1e-3);
    let states = solver.states.clone();
    let mut sum = 0.0;
    for (known, first) in [("stretch_x", 16), ("stretch_y", 16 + feet), ("slip", 16 + 2 * feet), ("omega_y", 11)] {
        let count = if known == "omega_y" { 1 } else { feet };
        for unknown in ["stretch_x_rate", "slip_rate", "N", "uplift"] {
            let adjoint_seed: Vec<f64> = (0..feet).map(|i| 1.0 + 0.1 * i as f64).collect();
            let mut adjoint = vec![f64::NAN; count];
            let (output, input) = (reference(unknown), reference(known));
            solver.block.ok(call!(
                solver.block,
                get_adjoint_derivative,
                &output,
                1,
                &input,
                1,
                adjoint_seed.as_ptr(),
                feet,
                adjoint.as_mut_ptr(),
                count
            ));
            for element in 0..count {
                let mut seed = vec![0.0; count];
                seed[element] = 1.0;
                let exact = solver.derivative(unknown, known, &seed, feet);
                let weighted: f64 = exact.iter().zip(&adjoint_seed).map(|(a, b)| a * b).sum();
                assert!((weighted - adjoint[element]).abs() <= 1e-14 * weighted.abs().max(1.0));
                let h = 1e-7;
                let at = |places: f64| {
                    let mut moved = states.clone();
                    moved[first + element] += places * h;
                    solver.derivatives(solver.time, &moved);
                    solver.array(unknown, feet)
                };
                let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
                solver.derivatives(solver.time, &states);
                for i in 0..feet {
                    let difference = (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * h);
                    let rounding = 1e-14 * a[i].abs().max(1e-6) / h;
                    assert!(
                        (difference - exact[i]).abs() <= 1e-5 * exact[i].abs() + 100.0 * rounding,
                        "d {unknown}[{i}]/d {known}[{element}] = {}, by differences {difference}",
                        exact[i]
                    );
                    sum += exact[i].abs();
                }
            }
        }
    }
    assert!(sum > 0.0);
}
