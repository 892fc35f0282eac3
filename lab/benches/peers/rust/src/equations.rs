//! The block, its ground motion and its contacts → equations of motion and surfaces, for the crate `differential-equations`.

use differential_equations::ode::ODE;
use rocking_peers::Case;

pub type State = [f64; 4];

/// +1 for L, −1 for R.
pub const SIGNS: [f64; 2] = [1.0, -1.0];

/// Parameters in the equations; K and C per mass.
#[derive(Clone, Copy)]
pub struct Block {
    pub rigid: bool,
    pub alpha: f64,
    pub p: f64,
    pub epsilon: f64,
    pub gravity: f64,
    pub r0: f64,
    pub i0: f64,
    pub b: f64,
    pub h: f64,
    pub omega_v: f64,
    pub k: f64,
    pub c: f64,
    pub delta_s: f64,
    pub restitution: f64,
}

impl Block {
    pub fn new(case: &Case) -> Block {
        let Case { alpha, p, eta, xi_v, epsilon, gamma, gravity, .. } = *case;
        let r0 = gamma / (1.0 + gamma) * gravity / (p * p);
        let omega_v = eta * p;
        Block {
            rigid: case.rigid != 0.0,
            alpha,
            p,
            epsilon,
            gravity,
            r0,
            i0: r0 * r0 / gamma,
            b: r0 * alpha.sin(),
            h: r0 * alpha.cos(),
            omega_v,
            k: 0.5 * omega_v * omega_v,
            c: xi_v * omega_v,
            delta_s: gravity / (omega_v * omega_v),
            restitution: (1.0 + gamma * epsilon + (1.0 - epsilon) * gamma * (2.0 * alpha).cos()) / (1.0 + gamma),
        }
    }

    /// Returns `R0 sin φ` and `R0 cos φ`, `φ = α + sθ`.
    #[inline]
    pub fn arms(&self, s: f64, (sin, cos): (f64, f64)) -> (f64, f64) {
        (self.b * cos + s * self.h * sin, self.h * cos - s * self.b * sin)
    }

    /// Returns height and rate of a corner.
    #[inline]
    pub fn corner(&self, s: f64, y: &State, sin_cos: (f64, f64)) -> (f64, f64) {
        let (reach, height) = self.arms(s, sin_cos);
        (y[2] + self.h - height, y[3] + s * reach * y[1])
    }

    #[inline]
    pub fn reaction(&self, (height, rate): (f64, f64)) -> f64 {
        self.k * (self.delta_s - height) - self.c * rate
    }
}

#[derive(Clone, Copy, PartialEq)]
pub enum Regime {
    FullContact,
    /// On L (s = 1) or R (s = −1).
    OnCorner(f64),
    /// Housner's block on the corner s.
    RigidBase(f64),
}

/// The ground acceleration over an interval.
#[derive(Clone, Copy)]
pub enum Ground {
    Ramp { t0: f64, value: f64, slope: f64 },
    Sine { amplitude: f64, omega: f64 },
    Cosine { amplitude: f64, omega: f64 },
    Record,
}

pub struct Equations {
    pub block: Block,
    pub regime: Regime,
    pub ground: Ground,
    pub case: Case,
}

impl Equations {
    #[inline]
    pub fn ground(&self, t: f64) -> f64 {
        match self.ground {
            Ground::Ramp { t0, value, slope } => value + slope * (t - t0),
            Ground::Sine { amplitude, omega } => amplitude * (omega * t).sin(),
            Ground::Cosine { amplitude, omega } => amplitude * (omega * t).cos(),
            Ground::Record => {
                let sample = (t / self.case.record_dt) as usize;
                let (value, slope) = self.case.ramp(sample);
                value + slope * (t - self.case.sample_time(sample))
            }
        }
    }
}

impl ODE<f64, State> for Equations {
    #[inline]
    fn diff(&self, t: f64, y: &State, rate: &mut State) {
        let block = &self.block;
        let Block { i0, h, gravity, .. } = *block;
        let a_gx = self.ground(t);
        let (sin, cos) = y[0].sin_cos();
        let rotation = y[1] * y[1];
        *rate = match self.regime {
            // Eqs. (7)–(10).
            Regime::FullContact => {
                let [left, right] = SIGNS.map(|s| block.reaction(block.corner(s, y, (sin, cos))));
                let [reach_left, reach_right] = SIGNS.map(|s| block.arms(s, (sin, cos)).0);
                let arm = h * cos;
                let moment = left * reach_left - right * reach_right - arm * (a_gx - h * sin * rotation);
                [y[1], moment / (i0 + arm * arm), y[3], left + right - gravity]
            }
            // Eqs. (11)–(13).
            Regime::OnCorner(s) => {
                let n = block.reaction(block.corner(s, y, (sin, cos)));
                let (reach, height) = block.arms(s, (sin, cos));
                let moment = s * n * reach - height * (a_gx - s * reach * rotation);
                [y[1], moment / (i0 + height * height), y[3], n - gravity]
            }
            Regime::RigidBase(s) => {
                let (sin, cos) = (-s * block.alpha - y[0]).sin_cos();
                [y[1], -block.p * block.p * (sin + cos * a_gx / gravity), 0.0, 0.0]
            }
        };
    }
}

/// A lifted support that creeps back.
#[derive(Clone, Copy, Default)]
pub struct Creep {
    pub depth: f64,
    pub since: f64,
}

/// The corners that touch, and the supports of the others.
#[derive(Clone, Copy, Default)]
pub struct Contact {
    pub touching: [bool; 2],
    pub creep: [Creep; 2],
}

impl Contact {
    pub fn top(&self, block: &Block, i: usize, t: f64) -> f64 {
        let Creep { depth, since } = self.creep[i];
        block.delta_s - depth * (-(t - since) * block.k / block.c).exp()
    }

    /// Returns the reaction of each touching corner and the gap of each other one; a fall through zero ends the regime.
    pub fn surfaces(&self, block: &Block, regime: Regime, t: f64, y: &State) -> [f64; 2] {
        if let Regime::RigidBase(s) = regime {
            return [-s * y[0], 1.0];
        }
        let sin_cos = y[0].sin_cos();
        [0, 1].map(|i| {
            let corner = block.corner(SIGNS[i], y, sin_cos);
            if self.touching[i] { block.reaction(corner) } else { corner.0 - self.top(block, i, t) }
        })
    }

    pub fn lift(&mut self, block: &Block, i: usize, t: f64, y: &State) {
        let (height, _) = block.corner(SIGNS[i], y, y[0].sin_cos());
        self.touching[i] = false;
        self.creep[i] = Creep { depth: block.delta_s - height, since: t };
    }

    pub fn regime(&self) -> Regime {
        match self.touching {
            [true, true] => Regime::FullContact,
            [true, false] => Regime::OnCorner(1.0),
            [false, true] => Regime::OnCorner(-1.0),
            [false, false] => panic!("complete separation"),
        }
    }
}
