//! Solves a case with this project's core, as in the FMU, including its peaks and energy sums. It has one method.

use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::{Initial, Progress, Settings, Simulation};
use rocking_peers::{Case, Solver, Work, program};

struct Ours {
    case: Case,
    block: Block,
    settings: Settings,
    pulse: Pulse,
    initial: Initial,
    end: f64,
}

impl Ours {
    /// Returns the inputs from a sample of the record on.
    fn inputs(&self, sample: usize) -> Inputs {
        let (value, rate) = self.case.ramp(sample);
        Inputs { time: self.case.sample_time(sample), a_gx: Ramp { value, rate }, ..Inputs::default() }
    }

    /// Runs from the start to a time, in as few calls as the inputs allow.
    fn run_to(&self, end: f64) -> Simulation {
        let mut simulation =
            Simulation::new(self.block, self.settings, self.pulse, &self.initial, 0.0, &self.inputs(0));
        let mut sample = 0;
        while simulation.time() < end {
            let next = if sample + 1 < self.case.record.len() { self.case.sample_time(sample + 1) } else { end };
            let progress = simulation.advance(next.min(end), &self.inputs(sample), &mut |_| ()).expect("the case runs");
            assert_eq!(progress, Progress::Reached, "the run ends too early");
            sample += 1;
        }
        simulation
    }
}

impl Solver for Ours {
    fn new(case: Case, _: &str, tolerance: f64) -> Ours {
        let common = Common {
            gamma: case.gamma,
            epsilon: case.epsilon,
            gravity: case.gravity,
            ..Common::default()
        };
        let Case { alpha, p, xi_v, .. } = case;
        let supports = if case.rigid != 0.0 {
            Supports::Rigid { restitution_factor: 1.0 }
        } else {
            Supports::Viscoelastic(Ratios { eta: case.eta, xi_v })
        };
        let shape = match case.shape {
            1.0 => PulseShape::OneSine,
            2.0 => PulseShape::OneCosine,
            _ => PulseShape::None,
        };
        let period = if shape == PulseShape::None { 1.0 } else { std::f64::consts::TAU / case.omega_p };
        Ours {
            block: Block::from_dimensionless(&Dimensionless { alpha, p, supports }, &common).expect("a block"),
            settings: Settings { tolerance, ..Settings::default() },
            pulse: Pulse { shape, amplitude: case.a_p, period, start: 0.0, ..Pulse::NONE },
            initial: Initial {
                theta: case.theta,
                theta_dot: case.theta_dot,
                vertical: (case.settled == 0.0).then_some((0.0, 0.0)),
            },
            end: case.t_end,
            case,
        }
    }

    fn run(&mut self) -> Work {
        let counts = self.run_to(self.end).counts();
        Work { rhs: counts.evaluations, steps: counts.steps, events: (counts.impacts + counts.liftoffs).into() }
    }

    /// Each row is the end of a separate run: intermediate stops would shorten the steps and make this more accurate than the
    /// timed run.
    fn trace(&mut self) -> Vec<f64> {
        (0..=self.case.rows()).map(|row| self.run_to(self.case.row_time(row)).state()[0]).collect()
    }
}

fn main() {
    program::<Ours>();
}
