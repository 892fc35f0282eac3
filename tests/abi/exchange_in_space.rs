//! Model Exchange of the block in space: a simple solver of the importer steps it.

use roxmltree::{Document, Node};

use crate::functions::*;
use crate::host::{FMU, Instance, call};
use crate::unit::{INDICATOR_COUNT, STATE_COUNT};

type States = [f64; STATE_COUNT];

/// A block that rocks, slides and flies.
pub const SHAKEN: [(&str, f64); 9] = [
    ("dimensionless.alpha", 0.25),
    ("dimensionless.p", 1.5),
    ("dimensionless.depth_ratio", 1.3),
    ("dimensionless.xi_v", 0.2),
    ("friction", 0.4),
    ("pulse.shape", 2.0),
    ("pulse.amplitude", 4.0),
    ("pulse.period", 1.0),
    ("pulse.azimuth", 0.6),
];

/// Ground accelerations (m/s²) that are not linear in time.
fn ground(time: f64) -> [f64; 3] {
    [1.5 * (9.0 * time).sin(), 1.2 * (11.0 * time).sin(), 3.0 * (17.0 * time).cos()]
}

/// Names of states and their derivatives, in the order of the description.
pub fn names() -> Vec<(String, String)> {
    let document = Document::parse(&FMU.xml).unwrap();
    let nodes: Vec<Node> = document.descendants().filter(|node| node.has_tag_name("ScalarVariable")).collect();
    let name = |index: usize| nodes[index - 1].attribute("name").unwrap().to_string();
    let derivatives = document.descendants().find(|node| node.has_tag_name("Derivatives")).unwrap();
    let unknowns = derivatives.children().filter(Node::is_element);
    unknowns
        .map(|unknown| {
            let index: usize = unknown.attribute("index").unwrap().parse().unwrap();
            let of = nodes[index - 1].first_element_child().unwrap().attribute("derivative").unwrap();
            (name(of.parse().unwrap()), name(index))
        })
        .collect()
}

/// Classical Runge–Kutta with constant steps, and bisection of a step that contains an event.
pub struct Solver {
    pub instance: Instance,
    pub time: f64,
    pub states: States,
    next: Option<f64>,
    ended: bool,
    still: bool,
}

impl Solver {
    pub fn begin(values: &[(&str, f64)], still: bool) -> Solver {
        let instance = Instance::with_start_values(MODEL_EXCHANGE, "block", None, false);
        values.iter().for_each(|&(name, value)| instance.set(name, value));
        instance.initialize(None);
        let mut solver =
            Solver { instance, time: 0.0, states: [f64::NAN; STATE_COUNT], next: None, ended: false, still };
        solver.set(0.0, None);
        solver.pass_events();
        solver
    }

    pub fn set(&self, time: f64, states: Option<&States>) {
        assert_eq!(call!(self.instance, set_time, time), OK);
        if !self.still {
            ["a_gx", "a_gy", "a_gz"].into_iter().zip(ground(time)).for_each(|(name, a)| self.instance.set(name, a));
        }
        if let Some(states) = states {
            assert_eq!(call!(self.instance, set_continuous_states, states.as_ptr(), STATE_COUNT), OK);
        }
    }

    fn pass_events(&mut self) {
        let mut info = EventInfo::default();
        assert_eq!(call!(self.instance, new_discrete_states, &mut info), OK, "{:?}", self.instance.messages());
        assert_eq!((info.new_discrete_states_needed, info.values_of_continuous_states_changed), (0, 1));
        self.next = (info.next_event_time_defined != 0).then_some(info.next_event_time);
        self.ended = info.terminate_simulation != 0;
        assert_eq!(call!(self.instance, enter_continuous_time_mode), OK);
        self.states = self.read();
    }

    fn read(&self) -> States {
        let mut states = [f64::NAN; STATE_COUNT];
        assert_eq!(call!(self.instance, get_continuous_states, states.as_mut_ptr(), STATE_COUNT), OK);
        states
    }

    fn derivatives(&self, time: f64, states: &States) -> States {
        self.set(time, Some(states));
        let mut derivatives = [f64::NAN; STATE_COUNT];
        assert_eq!(call!(self.instance, get_derivatives, derivatives.as_mut_ptr(), STATE_COUNT), OK);
        derivatives
    }

    fn indicators(&self) -> [f64; INDICATOR_COUNT] {
        let mut indicators = [f64::NAN; INDICATOR_COUNT];
        assert_eq!(call!(self.instance, get_event_indicators, indicators.as_mut_ptr(), INDICATOR_COUNT), OK);
        indicators
    }

    fn attempt(&self, h: f64) -> (States, bool) {
        let plus = |k: &States, part: f64| -> States { std::array::from_fn(|i| self.states[i] + part * h * k[i]) };
        let k1 = self.derivatives(self.time, &self.states);
        let k2 = self.derivatives(self.time + 0.5 * h, &plus(&k1, 0.5));
        let k3 = self.derivatives(self.time + 0.5 * h, &plus(&k2, 0.5));
        let k4 = self.derivatives(self.time + h, &plus(&k3, 1.0));
        let end = std::array::from_fn(|i| self.states[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        self.set(self.time + h, Some(&end));
        (end, self.indicators().iter().any(|&z| z <= 0.0))
    }

    fn accept(&mut self, h: f64, end: States) {
        (self.time, self.states) = (self.time + h, end);
        self.set(self.time, Some(&end));
        let (mut event, mut terminate) = (1, 1);
        assert_eq!(call!(self.instance, completed_integrator_step, 1, &mut event, &mut terminate), OK);
        assert_eq!((event, terminate), (0, 0));
    }

    fn step(&mut self, h: f64) {
        let (end, fallen) = self.attempt(h);
        if !fallen {
            return self.accept(h, end);
        }
        let (mut before, mut after) = (0.0, h);
        for _ in 0..60 {
            let middle = 0.5 * (before + after);
            if self.attempt(middle).1 { after = middle } else { before = middle }
        }
        let (end, _) = self.attempt(after);
        self.accept(after, end);
        self.event();
    }

    fn event(&mut self) {
        assert_eq!(call!(self.instance, enter_event_mode), OK);
        self.pass_events();
    }

    pub fn go(&mut self, until: f64, h: f64) {
        while self.time < until - 1e-12 && !self.ended {
            let stop = self.next.map_or(until, |next| next.min(until));
            self.step(h.min(stop - self.time));
            if self.next.is_some_and(|next| (next - self.time).abs() < 1e-13) {
                self.time = stop;
                self.set(stop, None);
                self.event();
            }
        }
    }
}

fn slave(values: &[(&str, f64)]) -> Instance {
    let slave = Instance::with_start_values(CO_SIMULATION, "slave", None, false);
    values.iter().for_each(|&(name, value)| slave.set(name, value));
    slave.initialize(Some(1e-11));
    slave
}

const COUNTS: [&str; 4] = ["events.lift_offs", "events.landings", "events.slides", "events.sticks"];
const PEAKS: [&str; 6] = ["peak.tilt", "peak.twist", "peak.drift", "peak.N", "peak.uplift", "peak.slip"];

/// Under a pulse, with events of all kinds: the events and greatest values of Co-Simulation, and its motion.
#[test]
fn a_simple_solver_has_the_events_of_co_simulation() {
    let slave = slave(&SHAKEN);
    let mut solver = Solver::begin(&SHAKEN, true);
    solver.go(2.5, 5e-4);
    slave.step(0.0, 2.5);
    for name in COUNTS {
        assert_eq!(solver.instance.get(name), slave.get(name), "{name}");
        assert!(slave.get(name) >= 4.0, "{name}: {}", slave.get(name));
    }
    for name in ["tilt", "tilt_x", "tilt_y", "twist", "u", "w", "q_w", "q_z"] {
        let (a, b) = (solver.instance.get(name), slave.get(name));
        assert!((a - b).abs() < 1e-6 * 0.25, "{name}: {a}, in Co-Simulation {b}");
    }
    for name in PEAKS.into_iter().chain(["energy.input", "energy.dashpots", "energy.slip", "energy.lift_off"]) {
        let (a, b) = (solver.instance.get(name), slave.get(name));
        assert!((a - b).abs() < 1e-5 * b.abs(), "{name}: {a}, in Co-Simulation {b}");
    }
    assert!(solver.instance.get("energy.residual").abs() < 1e-6 * slave.get("energy.input"));
    assert!((solver.instance.get("events.last_time") - slave.get("events.last_time")).abs() < 1e-6);
}

/// Under inputs that are no ramps, the motion matches Co-Simulation in steps short enough for ramps.
#[test]
fn inputs_may_be_any_functions_of_time() {
    let slave = slave(&SHAKEN);
    let mut solver = Solver::begin(&SHAKEN, false);
    let step = 1.0 / 2048.0;
    for i in 0..3072 {
        let time = f64::from(i) * step;
        for (j, name) in ["a_gx", "a_gy", "a_gz"].into_iter().enumerate() {
            let (here, there) = (ground(time)[j], ground(time + step)[j]);
            slave.set(name, here);
            slave.set_rate(name, (there - here) / step);
        }
        slave.step(time, step);
        solver.go(time + step, step);
        for name in ["tilt_x", "tilt_y", "u", "w", "v"] {
            let (a, b) = (slave.get(name), solver.instance.get(name));
            assert!((a - b).abs() < 1e-5, "{name} at t = {}: {a}, {b}", time + step);
        }
    }
    for name in COUNTS {
        assert_eq!(solver.instance.get(name), slave.get(name), "{name}");
    }
    assert!((solver.instance.get("energy.input") / slave.get("energy.input") - 1.0).abs() < 1e-3);
}

/// States, derivatives and nominal values are those of the variables named in the description.
#[test]
fn states_are_the_declared_variables() {
    let names = names();
    assert_eq!(names.len(), STATE_COUNT);
    assert!(FMU.xml.contains(&format!("numberOfEventIndicators=\"{INDICATOR_COUNT}\"")));
    let mut solver = Solver::begin(&SHAKEN, true);
    for i in 1..12 {
        solver.go(0.1 * f64::from(i), 1e-3);
        // A quaternion of any length, as solvers have them, and stretches of lifted feet.
        let set: States = std::array::from_fn(|i| solver.states[i] * (1.0 + 1e-3) + 1e-9);
        let derivatives = solver.derivatives(solver.time, &set);
        assert_eq!(solver.read(), set);
        for ((state, derivative), (x, rate)) in names.iter().zip(set.into_iter().zip(derivatives)) {
            assert_eq!(solver.instance.get(state), x, "{state}");
            assert_eq!(solver.instance.get(derivative), rate, "{derivative}");
        }
        solver.set(solver.time, Some(&solver.states));
    }
    let instance = Instance::with_start_values(MODEL_EXCHANGE, "block", None, false);
    let mut nominals = [f64::NAN; STATE_COUNT];
    assert_eq!(call!(instance, get_nominals, nominals.as_mut_ptr(), STATE_COUNT), OK);
    let xml = include_str!("../../modelDescriptionInSpace.xml");
    let document = Document::parse(xml).unwrap();
    for ((name, _), nominal) in names.iter().zip(nominals) {
        let node = document.descendants().find(|node| node.attribute("name") == Some(name)).unwrap();
        let documented: f64 = node.first_element_child().unwrap().attribute("nominal").unwrap().parse().unwrap();
        assert!((documented / nominal - 1.0).abs() < 0.03, "{name}: {documented}, {nominal}");
    }
}

/// A factor of the quaternion changes no derivative and no indicator.
#[test]
fn the_length_of_the_quaternion_has_no_effect() {
    let mut solver = Solver::begin(&SHAKEN, true);
    solver.go(0.7, 1e-3);
    let mut long = solver.states;
    long[3..7].iter_mut().for_each(|q| *q *= 2.0);
    let [mut expected, found] = [&solver.states, &long].map(|states| {
        let derivatives = solver.derivatives(solver.time, states);
        (derivatives, solver.indicators(), solver.instance.get("tilt"))
    });
    expected.0[3..7].iter_mut().for_each(|rate| *rate *= 2.0);
    assert_eq!(found, expected);
    // An event gives it the length 1.
    solver.set(solver.time, Some(&long));
    solver.event();
    assert!((solver.states[3..7].iter().map(|q| q * q).sum::<f64>() - 1.0).abs() < 1e-15);
}

#[test]
fn saved_states_resume_with_the_same_bits() {
    let mut solver = Solver::begin(&SHAKEN, true);
    solver.go(0.7, 1e-3);
    let saved = (solver.instance.save(), solver.time, solver.states, solver.next);
    let bytes = solver.instance.serialize(saved.0);
    solver.go(1.4, 1e-3);
    let expected = solver.instance.bits();
    (solver.time, solver.states, solver.next) = (saved.1, saved.2, saved.3);
    solver.instance.restore(saved.0);
    solver.go(1.4, 1e-3);
    assert_eq!(solver.instance.bits(), expected);

    // A state of the other interface type is refused.
    let slave = slave(&SHAKEN);
    slave.refuses(call!(slave, set_fmu_state, saved.0), &["ModelExchange", "CoSimulation"]);
    solver.instance.free(saved.0);

    let other = Solver::begin(&SHAKEN, true);
    let mut state = std::ptr::null_mut();
    assert_eq!(call!(other.instance, deserialize, bytes.as_ptr(), bytes.len(), &mut state), OK);
    other.instance.restore(state);
    other.instance.free(state);
    let mut other = Solver { time: saved.1, states: saved.2, next: saved.3, ..other };
    other.go(1.4, 1e-3);
    assert_eq!(other.instance.bits(), expected);
}

/// FMI 2.0 has the states of four feet.
#[test]
fn other_numbers_of_feet_are_refused() {
    let instance = Instance::with_start_values(MODEL_EXCHANGE, "block", None, false);
    instance.set("base", 2.0);
    instance.set("feet", 6.0);
    assert_eq!(instance.setup(None, 0.0, None), OK);
    assert_eq!(call!(instance, enter_initialization_mode), OK);
    let words = ["the block has 6 feet; expected 4 in Model Exchange", "Co-Simulation", "FMI 3.0", "foot_count"];
    instance.refuses(call!(instance, exit_initialization_mode), &words);
    let mut states = [f64::NAN; STATE_COUNT];
    instance.refuses(call!(instance, get_continuous_states, states.as_mut_ptr(), STATE_COUNT), &words);
    // The importer corrects it: four feet of another base are states.
    instance.set("feet", 4.0);
    instance.set("initial.tilt_x", 0.05);
    assert_eq!(call!(instance, exit_initialization_mode), OK);
    let mut solver = Solver { instance, time: 0.0, states, next: None, ended: false, still: true };
    solver.pass_events();
    solver.go(0.3, 1e-3);
    let (state, _) = &names()[16];
    assert_eq!(state, "stretch_x_SW");
    assert_eq!(solver.instance.get(state), solver.states[16]);
}

#[test]
fn arrays_of_wrong_length_and_non_finite_numbers_are_refused() {
    let solver = Solver::begin(&SHAKEN, true);
    let before = solver.instance.bits();
    let i = &solver.instance;
    i.refuses(call!(i, get_continuous_states, [0.0; 9].as_mut_ptr(), 9), &["9", "28"]);
    i.refuses(call!(i, get_derivatives, [0.0; 7].as_mut_ptr(), 7), &["7", "28"]);
    i.refuses(call!(i, get_event_indicators, [0.0; 3].as_mut_ptr(), 3), &["3", "9"]);
    i.refuses(call!(i, set_continuous_states, [0.0; 7].as_ptr(), 7), &["7", "28"]);
    i.refuses(call!(i, set_continuous_states, [f64::NAN; STATE_COUNT].as_ptr(), STATE_COUNT), &["state 0", "NaN"]);
    i.refuses(call!(i, set_time, f64::INFINITY), &["inf"]);
    assert_eq!(i.bits(), before);
}

/// The run ends, or is held, where Co-Simulation ends or holds it.
#[test]
fn a_run_ends_or_is_held_as_in_co_simulation() {
    let falls = [("initial.tilt_x", 0.2), ("initial.omega_y", 1.0), ("initial.omega_x", -0.4)];
    let thrown = [("initial.settled", 0.0), ("initial.v", 0.01), ("initial.v_dot", 1.0), ("initial.omega_z", 1.0)];
    for (start, kind) in [(&falls[..], "overturned"), (&thrown, "separated")] {
        for held in [false, true] {
            let choice = f64::from(u8::from(held)) + 1.0;
            let values = [start, &[("on_overturning", choice), ("on_separation", choice)]].concat();
            let slave = slave(&values);
            let mut solver = Solver::begin(&values, true);
            solver.go(2.0, 2e-4);
            let status = slave.try_step(0.0, 2.0);
            assert_eq!(status, if held { OK } else { DISCARD });
            assert_eq!((slave.get(kind), solver.instance.get(kind)), (1.0, 1.0));
            assert_eq!(solver.ended, !held);
            if !held {
                let ended = slave.real_status(LAST_SUCCESSFUL_TIME).unwrap();
                assert!((solver.time - ended).abs() < 1e-6, "{}, {ended}", solver.time);
                continue;
            }
            assert_eq!(solver.derivatives(solver.time, &solver.states), [0.0; STATE_COUNT]);
            assert!(solver.indicators().iter().all(|&indicator| indicator > 0.0));
            for name in ["u_dot", "v_dot", "omega_x", "omega_y", "u_ddot", "H_x", "N_SW", "q_w_dot", "power.input"] {
                assert_eq!(solver.instance.get(name), 0.0, "{name}");
                assert_eq!(slave.get(name), 0.0, "{name}");
            }
            for name in ["tilt", "energy.total", "energy.kinetic", "peak.tilt"] {
                let (a, b) = (solver.instance.get(name), slave.get(name));
                assert!((a - b).abs() <= 1e-5 * b.abs().max(0.1), "{kind}, {name}: {a}, in Co-Simulation {b}");
            }
        }
    }
}

/// The samples of a record and the kinks of a pulse are time events.
#[test]
fn records_are_followed_exactly() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str, axis: usize| {
        let path = folder.path().join(name);
        let line = |i: i32| format!("{},{}\n", 0.01 * f64::from(i), 3.0 * ground(0.01 * f64::from(i))[axis]);
        std::fs::write(&path, format!("t (s),a (m/s2)\n{}", (0..=120).map(line).collect::<String>())).unwrap();
        path.to_str().unwrap().to_string()
    };
    let [inside, outside] = [CO_SIMULATION, MODEL_EXCHANGE].map(|kind| {
        let instance = Instance::with_start_values(kind, "block", None, false);
        instance.set_text("record.x", &path("x.csv", 0));
        instance.set_text("record.y", &path("y.csv", 1));
        instance.set("record.start", 0.025);
        instance.initialize(Some(1e-11));
        instance
    });
    let states = [f64::NAN; STATE_COUNT];
    let mut solver = Solver { instance: outside, time: 0.0, states, next: None, ended: false, still: true };
    solver.pass_events();
    assert_eq!(solver.next, Some(0.025));
    solver.go(1.5, 5e-4);
    inside.step(0.0, 1.5);
    assert!(inside.get("events.landings") > 2.0);
    for name in COUNTS {
        assert_eq!(solver.instance.get(name), inside.get(name), "{name}");
    }
    for name in ["tilt", "twist", "u", "w"].into_iter().chain(PEAKS) {
        let (a, b) = (solver.instance.get(name), inside.get(name));
        assert!((a - b).abs() < 1e-5 * b.abs().max(1e-2), "{name}: {a}, in Co-Simulation {b}");
    }
}
