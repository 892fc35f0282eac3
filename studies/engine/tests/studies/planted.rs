//! Blocks with planted parameters, synthetic tests of them, and the problems of finding the parameters again.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use rocking_block::block::{Block, Common, Dimensionless, Ratios, Supports};
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_studies::fit::{Free, Options, Problem, Test};
use rocking_studies::run::{Row, Run};
use rocking_studies::statistics::normal::quantile;

/// Standard deviation of the errors over the tilt.
pub const NOISE: f64 = 0.01;

/// A block, its parameters, and the releases that are measured.
pub struct Planted {
    pub truth: Dimensionless,
    common: Common,
    /// Initial tilts (rad) and durations (s) of the releases.
    pub releases: &'static [[f64; 2]],
    step: f64,
    free: &'static [&'static str],
}

/// A block on the rigid base with restitution below Housner's.
pub fn rigid() -> Planted {
    Planted {
        truth: Dimensionless { alpha: 0.22, p: 3.1, supports: Supports::Rigid { restitution_factor: 0.96 } },
        common: Common::default(),
        releases: &[[0.17, 5.0]],
        step: 0.02,
        free: &["p", "alpha", "restitution_factor"],
    }
}

/// A block on supports that bounce.
pub fn supports() -> Planted {
    Planted {
        truth: Dimensionless {
            alpha: 0.25,
            p: 2.0,
            supports: Supports::Viscoelastic(Ratios { eta: 25.0, xi_v: 0.15 }),
        },
        common: Common { epsilon: 0.3, ..Common::default() },
        releases: &[[0.15, 3.0], [0.02, 1.5]],
        step: 0.005,
        free: &["eta", "xi_v", "epsilon"],
    }
}

impl Planted {
    /// The runs of the releases.
    pub fn runs(&self) -> Vec<Run> {
        let block = Block::from_dimensionless(&self.truth, &self.common).unwrap();
        let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
        let run = |&[theta, duration]: &[f64; 2]| Run {
            initial: Initial { theta, ..Initial::default() },
            duration: Some(duration),
            output_step: self.step,
            ..Run::at_rest(block, settings)
        };
        self.releases.iter().map(run).collect()
    }

    /// The rotations over time, with errors of 1 % of the tilt; none with seed 0.
    pub fn measured(&self, seed: u64) -> Vec<Test> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut error = || quantile((random.next_u64() >> 11) as f64 * 0.5_f64.powi(53) + 0.5_f64.powi(54));
        let mut test = |run: Run| {
            let theta = run.initial.theta;
            let rows = run.history(|_| ()).unwrap().rows;
            let noise = if seed == 0 { 0.0 } else { NOISE * theta };
            let measured = |row: &Row| (row.time, row.observation.theta + noise * error());
            let (times, values) = rows.iter().map(measured).unzip();
            Test { noise: Some(NOISE * theta), ..Test::release(theta, times, values) }
        };
        self.runs().into_iter().map(&mut test).collect()
    }

    /// The fit of a test from initial parameters that are wrong by up to 20 %, independently.
    pub fn problem(&self, tests: Vec<Test>) -> Problem {
        let Dimensionless { alpha, p, supports } = self.truth;
        let mut common = self.common;
        let wrong = match supports {
            Supports::Rigid { .. } => Dimensionless { alpha: 1.15 * alpha, p: 0.85 * p, supports: Supports::HOUSNER },
            Supports::Viscoelastic(Ratios { eta, xi_v }) => {
                common.epsilon = 0.1;
                let supports = Supports::Viscoelastic(Ratios { eta: 1.3 * eta, xi_v: 0.7 * xi_v });
                Dimensionless { alpha, p, supports }
            }
        };
        Problem {
            block: wrong.with(&common),
            ties: Vec::new(),
            free: self.free.iter().map(|name| Free::named(name)).collect(),
            tests,
            options: Options::default(),
        }
    }

    pub fn planted(&self, name: &str) -> f64 {
        match name {
            "p" => self.truth.p,
            "alpha" => self.truth.alpha,
            "eta" => self.truth.supports.viscoelastic().unwrap().eta,
            "xi_v" => self.truth.supports.viscoelastic().unwrap().xi_v,
            "epsilon" => self.common.epsilon,
            _ => self.truth.supports.restitution_factor().unwrap(),
        }
    }
}
