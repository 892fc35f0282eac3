//! The block in Cartesian coordinates: an independent implementation of docs/unit/model.md, for comparison with the solver.
//!
//! It shares only the block's parameters with the solver. Coordinates are the position of the centre of mass and θ in all
//! regimes; forces and impulses are unknowns of linear systems, together with the accelerations and velocities; lifted supports
//! and the horizontal motion in flight are integrated, not put in closed form. Steps are those of a Gauss method of order 6,
//! short compared with all periods; an event is bisected by repeating its step.

mod rules;

use std::collections::BTreeSet;

use nalgebra::{Matrix4, SMatrix, SVector, Vector2};
use rocking_block::block::Block;

/// x, z of the centre of mass, θ, their rates, and the heights of both supports' tops.
type State = SVector<f64, 8>;

/// Accelerations of x, z, θ, and H per unit mass.
type Forces = SVector<f64, 4>;

/// Kind of an event, in the words of the solver's log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    LiftOff(usize),
    Landing(usize),
    Slip,
    Grip,
}

/// A rule that only some flights need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// A corner lands while the other one stands.
    Impact,
    /// A support reaches a corner that moves up.
    RisingSupport,
    /// Both corners land at once.
    LandingOnBoth,
    /// Both corners meet their supports, but one of the impulses would pull.
    OtherLandsAlone,
    /// A landing whose support would have to pull.
    NoPull,
    Slip,
    Grip,
    /// A corner lands while the other one slides.
    LandingBesideSlide,
}

impl Rule {
    pub const ALL: [Rule; 8] = [
        Rule::Impact,
        Rule::RisingSupport,
        Rule::LandingOnBoth,
        Rule::OtherLandsAlone,
        Rule::NoPull,
        Rule::Slip,
        Rule::Grip,
        Rule::LandingBesideSlide,
    ];
}

/// An event: its time (s), its kind, and the touching corners before and after.
#[derive(Clone, Copy, Debug)]
pub struct IndependentEvent {
    pub time: f64,
    pub kind: Kind,
    pub before: [bool; 2],
    pub after: [bool; 2],
}

pub struct Run<'a> {
    block: Block,
    /// a_gx and a_gz (m/s²) over time.
    ground: &'a dyn Fn(f64) -> [f64; 2],
    pub time: f64,
    pub state: State,
    pub touching: [bool; 2],
    /// Position at which the middle of the base is held, or the held corner offset by its distance from the middle; `None` in
    /// flight and in a slide.
    foot: Option<f64>,
    held: Option<usize>,
    pub events: Vec<IndependentEvent>,
    /// The rules applied so far.
    pub used: BTreeSet<Rule>,
    /// Numbers of landings and lift-offs of corners.
    pub impacts: u32,
    pub liftoffs: u32,
}

const BOTH: [usize; 2] = [0, 1];

impl Run<'_> {
    /// Starts from a state without contact.
    pub fn in_flight<'a>(
        block: &Block,
        [theta, theta_dot, v, v_dot]: [f64; 4],
        ground: &'a dyn Fn(f64) -> [f64; 2],
    ) -> Run<'a> {
        let free = block.gravity / block.omega_v.powi(2);
        let x = block.h * theta.sin();
        let x_dot = block.h * theta.cos() * theta_dot;
        let state = State::from([x, block.h + v, theta, x_dot, v_dot, theta_dot, free, free]);
        let run = Run {
            block: *block,
            ground,
            time: 0.0,
            state,
            touching: [false; 2],
            foot: None,
            held: None,
            events: Vec::new(),
            used: BTreeSet::new(),
            impacts: 0,
            liftoffs: 0,
        };
        assert!(BOTH.iter().all(|&i| run.gap(&state, i) > 0.0), "a corner touches at the start");
        run
    }

    /// Starts from rest on both supports.
    pub fn at_rest<'a>(block: &Block, ground: &'a dyn Fn(f64) -> [f64; 2]) -> Run<'a> {
        let state = State::from([0.0, block.h, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        Run {
            block: *block,
            ground,
            time: 0.0,
            state,
            touching: [true; 2],
            foot: Some(0.0),
            held: None,
            events: Vec::new(),
            used: BTreeSet::new(),
            impacts: 0,
            liftoffs: 0,
        }
    }

    /// A corner in the block: L is 0, R is 1.
    fn corner(&self, i: usize) -> Vector2<f64> {
        Vector2::new(if i == 0 { -self.block.b } else { self.block.b }, -self.block.h)
    }

    /// The point held in full contact.
    fn middle(&self) -> Vector2<f64> {
        Vector2::new(0.0, -self.block.h)
    }

    /// The point held while these corners touch.
    fn foothold(&self, touching: [bool; 2]) -> Vector2<f64> {
        match touching {
            [true, false] => self.corner(0),
            [false, true] => self.corner(1),
            [true, true] | [false, false] => self.middle(),
        }
    }

    /// Vector from the centre to a point of the block, turned clockwise by θ.
    fn arm(state: &State, point: Vector2<f64>) -> Vector2<f64> {
        let (sin, cos) = state[2].sin_cos();
        Vector2::new(point.x * cos + point.y * sin, -point.x * sin + point.y * cos)
    }

    /// Height of a corner above its position at rest, and its rate.
    fn height(&self, state: &State, i: usize) -> [f64; 2] {
        let arm = Self::arm(state, self.corner(i));
        [state[1] + arm.y, state[4] - arm.x * state[5]]
    }

    pub fn gap(&self, state: &State, i: usize) -> f64 {
        self.height(state, i)[0] - state[6 + i]
    }

    /// The force of a support per mass, from its corner's height and rate.
    fn support(&self, [height, rate]: [f64; 2]) -> f64 {
        let (k, c) = (self.block.stiffness / self.block.mass, self.block.damping / self.block.mass);
        k * (0.5 * self.block.gravity / k - height) - c * rate
    }

    /// The rate of that force, from the corner's rate and acceleration.
    fn support_rate(&self, rate: f64, acceleration: f64) -> f64 {
        -(self.block.stiffness * rate + self.block.damping * acceleration) / self.block.mass
    }

    /// The rate at which the top of a lifted support creeps back.
    fn top_rate(&self, state: &State, i: usize) -> f64 {
        let depth = self.block.static_deflection() - state[6 + i];
        if depth == 0.0 { 0.0 } else { self.creep() * depth }
    }

    /// K/C of a support.
    fn creep(&self) -> f64 {
        self.block.stiffness / self.block.damping
    }

    /// Accelerations of x, z, θ, and H, while these corners touch, held by their foothold if `grips`.
    fn forces(&self, time: f64, state: &State, touching: [bool; 2], grips: bool) -> Forces {
        let [a_gx, a_gz] = (self.ground)(time);
        let arms = BOTH.map(|i| Self::arm(state, self.corner(i)));
        let n = BOTH.map(|i| if touching[i] { self.support(self.height(state, i)) } else { 0.0 });
        let foothold = Self::arm(state, self.foothold(touching));
        // The held point keeps its velocity; without a grip no point is held.
        let (hold, held) = match grips {
            true => ([1.0, 0.0, foothold.y, 0.0], foothold.x * state[5].powi(2)),
            false => ([0.0, 0.0, 0.0, 1.0], 0.0),
        };
        // Newton and Euler; the moment of (F_x, F_z) at (x, z) is z F_x − x F_z clockwise.
        #[rustfmt::skip]
        let matrix = Matrix4::new(
            1.0, 0.0, 0.0, -1.0,
            0.0, 1.0, 0.0, 0.0,
            0.0, 0.0, self.block.i0, -foothold.y,
            hold[0], hold[1], hold[2], hold[3],
        );
        let turning = -arms[0].x * n[0] - arms[1].x * n[1];
        let right = Forces::new(-a_gx, n[0] + n[1] - self.block.gravity - a_gz, turning, held);
        matrix.lu().solve(&right).expect("forces that balance")
    }

    /// The same while corner `i` is held: it bears no load and moves with its support, while the middle of the base stands still.
    fn forces_held(&self, time: f64, state: &State, i: usize) -> Forces {
        let [a_gx, a_gz] = (self.ground)(time);
        let n = self.support(self.height(state, 1 - i));
        let (arm, foothold) = (Self::arm(state, self.corner(i)), Self::arm(state, self.middle()));
        let turning = state[5].powi(2);
        #[rustfmt::skip]
        let matrix = Matrix4::new(
            1.0, 0.0, 0.0, -1.0,
            0.0, 1.0, 0.0, 0.0,
            0.0, 1.0, -arm.x, 0.0,
            1.0, 0.0, foothold.y, 0.0,
        );
        let rises = arm.y * turning + self.top_acceleration(self.top_rate(state, i));
        let right = Forces::new(-a_gx, n - self.block.gravity - a_gz, rises, foothold.x * turning);
        matrix.lu().solve(&right).expect("forces that balance")
    }

    /// Acceleration of the top of a support that creeps at this rate.
    fn top_acceleration(&self, rate: f64) -> f64 {
        if rate == 0.0 { 0.0 } else { -self.creep() * rate }
    }

    /// Vertical acceleration of a corner.
    fn corner_acceleration(&self, state: &State, forces: &Forces, i: usize) -> f64 {
        let arm = Self::arm(state, self.corner(i));
        forces[1] - arm.x * forces[2] - arm.y * state[5].powi(2)
    }

    fn rate(&self, time: f64, state: &State) -> State {
        let forces = match self.held {
            Some(i) => self.forces_held(time, state, i),
            None => self.forces(time, state, self.touching, self.foot.is_some()),
        };
        let mut rate = State::zeros();
        for i in 0..3 {
            (rate[i], rate[3 + i]) = (state[3 + i], forces[i]);
        }
        let creeps = |i: usize| !self.touching[i] || self.held == Some(i);
        for i in BOTH.into_iter().filter(|&i| creeps(i) && self.block.damping > 0.0) {
            rate[6 + i] = self.top_rate(state, i);
        }
        rate
    }

    /// Returns the state after a step of Gauss' method with three stages.
    fn step(&self, size: f64) -> State {
        let root = 15.0_f64.sqrt();
        let nodes = [0.5 - root / 10.0, 0.5, 0.5 + root / 10.0];
        let a = [
            [5.0 / 36.0, 2.0 / 9.0 - root / 15.0, 5.0 / 36.0 - root / 30.0],
            [5.0 / 36.0 + root / 24.0, 2.0 / 9.0, 5.0 / 36.0 - root / 24.0],
            [5.0 / 36.0 + root / 30.0, 2.0 / 9.0 + root / 15.0, 5.0 / 36.0],
        ];
        let mut stages = [self.rate(self.time, &self.state); 3];
        for _ in 0..60 {
            let before = stages;
            stages = std::array::from_fn(|i| {
                let state = (0..3).fold(self.state, |state, j| state + before[j] * (a[i][j] * size));
                self.rate(self.time + nodes[i] * size, &state)
            });
            let change: f64 = stages.iter().zip(&before).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
            if change * size < 1e-16 {
                break;
            }
        }
        self.state + (stages[0] * 5.0 + stages[1] * 8.0 + stages[2] * 5.0) * (size / 18.0)
    }

    /// Acceleration of the gap under a corner if it left its support now, moving with `rate`: the corner's acceleration without
    /// the support, minus that of the recovering support's top.
    fn opening(&self, time: f64, state: &State, i: usize, rate: f64) -> f64 {
        let mut touching = self.touching;
        touching[i] = false;
        let grips = touching != [false; 2] && self.foot.is_some();
        let state = if grips { self.held_by(state, touching) } else { *state };
        let forces = self.forces(time, &state, touching, grips);
        self.corner_acceleration(&state, &forces, i) - self.top_acceleration(rate)
    }

    /// Returns the state with the horizontal velocity at which the held point of these corners stands still.
    fn held_by(&self, state: &State, touching: [bool; 2]) -> State {
        let mut held = *state;
        held[3] = -Self::arm(state, self.foothold(touching)).y * state[5];
        held
    }

    /// The smaller support force right after a horizontal impulse that stops the held point.
    fn pressure(&self, state: &State) -> f64 {
        let foothold = self.foothold(self.touching);
        let (after, _) = self.strike(state, Some([foothold, foothold]), [None; 2]);
        let touching = BOTH.into_iter().filter(|&i| self.touching[i]);
        let pressed = touching.map(|i| {
            let [height, rate] = self.height(&after, i);
            self.support([height, rate]) - (self.block.stiffness / self.block.mass).sqrt() * rate.max(0.0)
        });
        pressed.fold(f64::INFINITY, f64::min)
    }

    /// Returns the velocities after impulses, and the impulses at L and R per mass: an optional horizontal impulse at the first
    /// of two points, which stops the second, and a vertical one at each corner with a prescribed rate.
    fn strike(&self, state: &State, hold: Option<[Vector2<f64>; 2]>, rates: [Option<f64>; 2]) -> (State, [f64; 2]) {
        let arms = BOTH.map(|i| Self::arm(state, self.corner(i)));
        let [pushed, stopped] = hold.unwrap_or_default().map(|point| Self::arm(state, point));
        let i0 = self.block.i0;
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        matrix.fixed_view_mut::<1, 6>(0, 0).copy_from_slice(&[1.0, 0.0, 0.0, -1.0, 0.0, 0.0]);
        matrix.fixed_view_mut::<1, 6>(1, 0).copy_from_slice(&[0.0, 1.0, 0.0, 0.0, -1.0, -1.0]);
        matrix.fixed_view_mut::<1, 6>(2, 0).copy_from_slice(&[0.0, 0.0, i0, -pushed.y, arms[0].x, arms[1].x]);
        let mut right = SVector::<f64, 6>::from([state[3], state[4], i0 * state[5], 0.0, 0.0, 0.0]);
        if hold.is_some() {
            matrix.fixed_view_mut::<1, 6>(3, 0).copy_from_slice(&[1.0, 0.0, stopped.y, 0.0, 0.0, 0.0]);
        } else {
            matrix[(3, 3)] = 1.0;
        }
        for i in BOTH {
            match rates[i] {
                Some(rate) => {
                    (matrix[(4 + i, 1)], matrix[(4 + i, 2)]) = (1.0, -arms[i].x);
                    right[4 + i] = rate;
                }
                None => matrix[(4 + i, 4 + i)] = 1.0,
            }
        }
        let after = matrix.lu().solve(&right).expect("impulses that balance");
        let mut struck = *state;
        for i in 0..3 {
            struck[3 + i] = after[i];
        }
        (struck, [after[4], after[5]])
    }
}
