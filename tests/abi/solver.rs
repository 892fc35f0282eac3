//! An importer's solver for Model Exchange.

use crate::functions::*;
use crate::host::{Instance, call};

pub const STATES: usize = 11;
pub const INDICATORS: usize = 22;
pub const NAMES: [&str; STATES] = [
    "theta",
    "theta_dot",
    "v",
    "v_dot",
    "u",
    "u_dot",
    "energy.input",
    "energy.dashpots",
    "energy.friction",
    "energy.ties",
    "energy.dampers",
];
pub const DERIVATIVES: [&str; STATES] = [
    "theta_dot",
    "theta_ddot",
    "v_dot",
    "v_ddot",
    "u_dot",
    "u_ddot",
    "power.input",
    "power.dashpots",
    "power.friction",
    "power.ties",
    "power.dampers",
];

pub type States = [f64; STATES];

/// Ground accelerations that are not linear in time.
pub fn ground(time: f64) -> [f64; 2] {
    [7.5 * (4.0 * time).sin(), 14.0 * (17.0 * time).cos()]
}

/// The importer: classical Runge–Kutta with constant steps, and bisection of a step that contains an event.
pub struct Solver {
    pub instance: Instance,
    pub time: f64,
    pub states: States,
    pub events: u32,
    pub ended: bool,
    pub last: EventInfo,
    /// Whether the inputs are constant.
    pub still: bool,
    /// Whether steps are not completed.
    pub quiet: bool,
}

impl Solver {
    pub fn begin(values: &[(&str, f64)]) -> Solver {
        let instance = Instance::of(MODEL_EXCHANGE, "block", None, false);
        for &(name, value) in values {
            instance.set(name, value);
        }
        instance.initialize(None);
        Solver::of(instance, false)
    }

    /// Wraps an initialized instance; `still` if its inputs are constant.
    pub fn of(instance: Instance, still: bool) -> Solver {
        let (states, last) = ([f64::NAN; STATES], EventInfo::default());
        let mut solver = Solver { instance, time: 0.0, states, events: 0, ended: false, last, still, quiet: false };
        solver.set(0.0, None);
        solver.pass_events();
        solver.events = 0;
        solver
    }

    /// Sets time, inputs and, if given, states.
    pub fn set(&self, time: f64, states: Option<&States>) {
        assert_eq!(call!(self.instance, set_time, time), OK);
        if !self.still {
            for (name, value) in ["a_gx", "a_gz"].into_iter().zip(ground(time)) {
                self.instance.set(name, value);
            }
        }
        if let Some(states) = states {
            assert_eq!(call!(self.instance, set_continuous_states, states.as_ptr(), STATES), OK);
        }
    }

    pub fn pass_events(&mut self) -> EventInfo {
        let mut info = EventInfo::default();
        assert_eq!(call!(self.instance, new_discrete_states, &mut info), OK, "{:?}", self.instance.messages());
        assert_eq!(info.new_discrete_states_needed, 0);
        self.last = info;
        self.ended = info.terminate_simulation != 0;
        self.events += 1;
        assert_eq!(call!(self.instance, enter_continuous_time_mode), OK);
        assert_eq!(call!(self.instance, get_continuous_states, self.states.as_mut_ptr(), STATES), OK);
        info
    }

    pub fn derivatives(&self, time: f64, states: &States) -> States {
        self.set(time, Some(states));
        let mut derivatives = [f64::NAN; STATES];
        assert_eq!(call!(self.instance, get_derivatives, derivatives.as_mut_ptr(), STATES), OK);
        derivatives
    }

    pub fn indicators(&self) -> [f64; INDICATORS] {
        let mut indicators = [f64::NAN; INDICATORS];
        assert_eq!(call!(self.instance, get_event_indicators, indicators.as_mut_ptr(), INDICATORS), OK);
        indicators
    }

    /// Returns the end of a step, and whether an event lies within it.
    pub fn attempt(&self, h: f64) -> (States, bool) {
        let plus = |k: &States, part: f64| -> States { std::array::from_fn(|i| self.states[i] + part * h * k[i]) };
        let k1 = self.derivatives(self.time, &self.states);
        let k2 = self.derivatives(self.time + 0.5 * h, &plus(&k1, 0.5));
        let k3 = self.derivatives(self.time + 0.5 * h, &plus(&k2, 0.5));
        let k4 = self.derivatives(self.time + h, &plus(&k3, 1.0));
        let end = std::array::from_fn(|i| self.states[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        self.set(self.time + h, Some(&end));
        (end, self.indicators().iter().any(|&z| z <= 0.0))
    }

    pub fn accept(&mut self, h: f64, end: States) {
        (self.time, self.states) = (self.time + h, end);
        self.set(self.time, Some(&end));
        if self.quiet {
            return;
        }
        let (mut event, mut terminate) = (1, 1);
        assert_eq!(call!(self.instance, completed_integrator_step, 1, &mut event, &mut terminate), OK);
        assert_eq!((event, terminate), (0, 0));
    }

    /// Does a step, or its part up to an event and the event.
    pub fn step(&mut self, h: f64) {
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
        assert_eq!(call!(self.instance, enter_event_mode), OK);
        self.pass_events();
    }

    pub fn go(&mut self, until: f64, h: f64) {
        while self.time < until - 1e-12 && !self.ended {
            self.step(h.min(until - self.time));
        }
    }
}
