//! Random experiments with legal actions, and their execution on an instance.

use proptest::collection::vec;
use proptest::prelude::*;

use crate::fmu::{DISCARD, ERROR, Fmu, OK, WARNING, reference};
use crate::misuse::{Phase, misuse};

/// Parameters and the experiment.
#[derive(Clone, Debug)]
pub struct Experiment {
    values: Vec<(&'static str, f64)>,
    tolerance: Option<f64>,
    start: f64,
    /// Whether a set parameter is unused, which causes a warning.
    unread: bool,
}

/// An action of an importer between initialization and termination.
#[derive(Clone, Copy, Debug)]
pub enum Act {
    /// Sets the inputs.
    Inputs([f64; 5]),
    /// Sets derivatives of the ground accelerations for the next step.
    Rates([f64; 2]),
    /// A communication step (s).
    Step(f64),
    Save(usize),
    Restore(usize),
    Free(usize),
}

/// A call that must be refused: kind and variant.
pub type Bad = (u32, u32);

fn log_uniform(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

fn group() -> impl Strategy<Value = Vec<(&'static str, f64)>> {
    let damping = prop_oneof![Just(0.0), 0.001..0.5, 0.5..3.0];
    let dimensionless =
        (0.01..1.3, log_uniform(0.3, 10.0), log_uniform(1.0, 300.0), damping).prop_map(|(alpha, p, eta, xi_v)| {
            vec![
                ("dimensionless.alpha", alpha),
                ("dimensionless.p", p),
                ("dimensionless.eta", eta),
                ("dimensionless.xi_v", xi_v),
            ]
        });
    let physical =
        (0.1..5.0, 0.2..20.0, log_uniform(1e4, 1e9), log_uniform(1.0, 1e4)).prop_map(|(width, height, k, c)| {
            vec![
                ("parameterization", 2.0),
                ("physical.width", width),
                ("physical.height", height),
                ("physical.K", k),
                ("physical.C", c),
            ]
        });
    prop_oneof![3 => dimensionless, 1 => physical]
}

prop_compose! {
    pub fn experiments()(
        group in group(),
        common in (prop_oneof![Just(0.0), Just(1.0), 0.0..1.0], 0.3..5.0, prop_oneof![Just(9.81), Just(1.62)]),
        ways in (prop_oneof![3 => Just(1), 1 => Just(2)], 1..=3, 1..=2),
        start in (-0.3..0.3, -1.0..1.0, any::<bool>(), -0.05..0.05, -0.3..0.3),
        pulse in (1..=5, -15.0..15.0, log_uniform(0.05, 3.0), -1.0..2.0),
        still in any::<bool>(),
        tolerance in prop_oneof![Just(None), log_uniform(1e-12, 1e-3).prop_map(Some), Just(Some(1e-20)), Just(Some(0.5))],
        begin in prop_oneof![Just(0.0), -5.0..5.0],
    ) -> Experiment {
        let mut values = group;
        values.extend([
            ("epsilon", common.0),
            ("gamma", common.1),
            ("g", common.2),
            ("foundation", f64::from(ways.0)),
            ("on_separation", f64::from(ways.1)),
            ("on_overturning", f64::from(ways.2)),
            ("pulse.shape", f64::from(pulse.0)),
            ("pulse.amplitude", pulse.1),
            ("pulse.period", pulse.2),
            ("pulse.start", pulse.3),
        ]);
        let rigid = ways.0 == 2;
        let mut unread = pulse.0 == 1 && (pulse.1, pulse.2, pulse.3) != (0.0, 1.0, 0.0);
        if !still {
            values.extend([
                ("initial.theta", start.0),
                ("initial.theta_dot", start.1),
                ("initial.settled", f64::from(u8::from(start.2))),
                ("initial.v", start.3),
                ("initial.v_dot", start.4),
            ]);
            unread |= (start.2 || rigid) && (start.3 != 0.0 || start.4 != 0.0);
        }
        Experiment { values, tolerance, start: begin, unread }
    }
}

pub fn acts() -> impl Strategy<Value = Vec<Act>> {
    let accelerations = [-20.0..20.0, -15.0..15.0, -1e4..1e4, -1e3..1e3, -1e4..1e4];
    vec(
        prop_oneof![
            3 => accelerations.prop_map(Act::Inputs),
            2 => [-50.0..50.0, -50.0..50.0].prop_map(Act::Rates),
            10 => log_uniform(1e-7, 1.0).prop_map(Act::Step),
            2 => (0..4_usize).prop_map(Act::Save),
            1 => (0..4_usize).prop_map(Act::Restore),
            1 => (0..4_usize).prop_map(Act::Free),
        ],
        1..30,
    )
}

/// Slender blocks on damped supports, and gentle steps, which the integrator never refuses.
pub fn gentle() -> impl Strategy<Value = (Experiment, Vec<Act>)> {
    let experiment = (experiments(), 0.05..0.3, 0.3..3.0, log_uniform(20.0, 100.0), 0.1..0.5).prop_map(
        |(mut experiment, alpha, p, eta, xi_v)| {
            experiment.values.retain(|(name, _)| !name.contains("physical") && *name != "parameterization");
            experiment.values.extend([
                ("dimensionless.alpha", alpha),
                ("dimensionless.p", p),
                ("dimensionless.eta", eta),
                ("dimensionless.xi_v", xi_v),
                ("gamma", 3.0),
            ]);
            experiment
        },
    );
    (experiment, acts())
}

/// An instance during an experiment.
pub struct Run {
    pub fmu: Fmu,
    pub time: f64,
    pub phase: Phase,
    /// Time and phase of each saved state; `None` where it was freed.
    saved: Vec<Option<(f64, Phase)>>,
}

impl Run {
    /// A new instance, ready for steps.
    pub fn start(experiment: &Experiment) -> Run {
        Run::start_with(experiment, &mut |_| ())
    }

    /// Starts the same run with an irrelevant action in every state on the way.
    pub fn start_with(experiment: &Experiment, aside: &mut impl FnMut(&mut Run)) -> Run {
        let mut run = Run { fmu: Fmu::new(), time: experiment.start, phase: Phase::Instantiated, saved: Vec::new() };
        run.initialize(experiment, aside);
        run
    }

    /// Resets the instance and initializes it again. Saved states are unaffected.
    pub fn again(&mut self, experiment: &Experiment) {
        assert_eq!(self.fmu.reset(), OK);
        self.phase = Phase::Instantiated;
        self.initialize(experiment, &mut |_| ());
    }

    fn initialize(&mut self, experiment: &Experiment, aside: &mut impl FnMut(&mut Run)) {
        let Experiment { values, tolerance, start, unread } = experiment;
        aside(self);
        // Values may come before the experiment is set up, and in both states before initialization ends.
        let (early, late) = values.split_at(values.len() / 2);
        for &(name, value) in early {
            assert_eq!(self.fmu.set(reference(name), value), OK, "{name} = {value}");
        }
        aside(self);
        let followed = tolerance.is_none_or(|tolerance| (1e-14..=1e-1).contains(&tolerance));
        assert_eq!(self.fmu.setup(*tolerance, *start, Some(start + 1e3)), if followed { OK } else { WARNING });
        self.time = *start;
        aside(self);
        assert_eq!(self.fmu.enter(), OK);
        self.phase = Phase::Initialization;
        aside(self);
        for &(name, value) in late {
            assert_eq!(self.fmu.set(reference(name), value), OK, "{name} = {value}");
        }
        aside(self);
        assert_eq!(self.fmu.exit(), if *unread { WARNING } else { OK });
        self.phase = Phase::Complete;
        aside(self);
    }

    /// Performs an action if it is legal now; returns the outputs after a step.
    pub fn act(&mut self, act: Act) -> Vec<u64> {
        let going = self.phase == Phase::Complete;
        let [a_gx, a_gz, f_x, f_z, m_y] = ["a_gx", "a_gz", "F_x", "F_z", "M_y"].map(reference);
        match act {
            Act::Inputs(values) if going => {
                assert_eq!(self.fmu.set_reals(&[a_gx, a_gz, f_x, f_z, m_y], &values), OK);
            }
            Act::Rates(rates) if going => assert_eq!(self.fmu.set_rates(&[a_gx, a_gz], &[1, 1], &rates), OK),
            Act::Step(size) if going => return self.step(size),
            Act::Inputs(_) | Act::Rates(_) | Act::Step(_) => {}
            Act::Save(slot) => {
                assert_eq!(self.fmu.save(slot), OK);
                let now = Some((self.time, self.phase));
                match self.saved.get_mut(slot) {
                    Some(saved) => *saved = now,
                    None => self.saved.push(now),
                }
            }
            Act::Restore(slot) => {
                if let Some(&Some((time, phase))) = self.saved.get(slot) {
                    assert_eq!(self.fmu.restore(slot), OK);
                    (self.time, self.phase) = (time, phase);
                }
            }
            Act::Free(slot) => {
                assert_eq!(self.fmu.free(slot), OK);
                if let Some(saved) = self.saved.get_mut(slot) {
                    *saved = None;
                }
            }
        }
        Vec::new()
    }

    fn step(&mut self, size: f64) -> Vec<u64> {
        let status = self.fmu.step(self.time, size);
        let end = self.time + size;
        let reached = match status {
            OK => {
                assert_eq!(self.fmu.ended(), (false, end));
                end
            }
            DISCARD => {
                let (terminated, reached) = self.fmu.ended();
                assert!(terminated && (self.time..=end).contains(&reached), "{reached}");
                self.phase = Phase::Failed;
                reached
            }
            // The integrator reports that it cannot continue, which "damped_supports_never_fail" rules out where it must not
            // happen. No status is available then.
            ERROR => {
                self.phase = Phase::Error;
                self.time
            }
            other => panic!("step of {size:e} s at t = {} s: status {other}", self.time),
        };
        self.time = reached;
        let mut seen = vec![status as u64, reached.to_bits()];
        seen.extend(self.fmu.bits());
        seen
    }

    /// Performs all actions, and returns all outputs, with derivatives at the end.
    pub fn follow(&mut self, acts: &[Act]) -> Vec<u64> {
        let mut seen: Vec<u64> = acts.iter().flat_map(|&act| self.act(act)).collect();
        seen.extend(self.fmu.bits());
        seen.extend(self.fmu.derivative_bits(true));
        seen
    }

    /// Makes a call that must be refused.
    pub fn misuse(&mut self, (kind, choice): Bad) {
        misuse(&mut self.fmu, self.phase, self.time, kind, choice);
    }

    /// Reads everything that can be read now.
    pub fn look(&mut self) {
        if self.phase != Phase::Instantiated {
            self.fmu.bits();
            self.fmu.derivative_bits(self.phase != Phase::Initialization);
        }
    }
}
