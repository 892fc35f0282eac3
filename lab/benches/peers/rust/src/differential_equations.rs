//! Solves a case with the crate `differential-equations`, as an engineer would: its Dormand-Prince 8(5,3) or one of Verner's
//! pairs with dense output, restarted after each event.
//!
//! METHOD is dop853, verner76 or verner98; for records followed by -restart (stop and restart at each sample) or -through (step
//! over the kinks). State: θ, θ̇, v, v̇; on the rigid base the last two stay zero. Forces are per mass.
//!
//! A `Solout` of this file locates events on the crate's dense output. The crate's own events watch a single function each, and
//! of two in the same step they report the one added first, not the earlier one.

mod equations;

use std::cell::Cell;
use std::f64::consts::PI;

use differential_equations::control::ControlFlag;
use differential_equations::interpolate::Interpolation;
use differential_equations::ode::{OrdinaryNumericalMethod, solve_ode};
use differential_equations::prelude::{ExplicitRungeKutta, ODE};
use differential_equations::solout::Solout;
use differential_equations::solution::Solution;
use equations::{Block, Contact, Equations, Ground, Regime, SIGNS, State};
use rocking_peers::{Case, Solver, Work, program};

/// Looks for the first event in each step, and collects rows.
struct Watch<'a> {
    equations: &'a Equations,
    contact: &'a Contact,
    before: Option<[f64; 2]>,
    event: Option<(f64, State, usize)>,
    end: (f64, State),
    rows: Option<&'a mut Rows>,
    next_step: &'a Cell<f64>,
}

/// The rotation at the rows so far.
struct Rows {
    times: Vec<f64>,
    theta: Vec<f64>,
}

impl Watch<'_> {
    fn surfaces(&self, t: f64, y: &State) -> [f64; 2] {
        self.contact.surfaces(&self.equations.block, self.equations.regime, t, y)
    }

    /// Returns a time at which surface `i` is positive, and its value: the start of the step, or a time inside it if the surface
    /// starts at zero (as a gap does after lift-off) and returns within the step.
    fn positive<I: Interpolation<f64, State> + ?Sized>(
        &self,
        i: usize,
        (start, g): (f64, f64),
        end: f64,
        inside: &mut I,
    ) -> Option<(f64, f64)> {
        const LOOKS: u32 = 16;
        let block = &self.equations.block;
        let rounding = if block.rigid { 0.0 } else { 1e-12 * block.delta_s };
        if g > rounding || self.contact.touching[i] {
            return (g > 0.0).then_some((start, g));
        }
        (1..LOOKS).find_map(|look| {
            let t = start + (end - start) * f64::from(look) / f64::from(LOOKS);
            let g = self.surfaces(t, &inside.interpolate(t).ok()?)[i];
            (g > rounding).then_some((t, g))
        })
    }

    /// Returns the zero of surface `i` between `a`, where it is positive, and `b`, where it is not. Regula falsi with Illinois
    /// weights.
    fn root<I: Interpolation<f64, State> + ?Sized>(
        &self,
        i: usize,
        (mut a, mut g_a): (f64, f64),
        (mut b, mut g_b): (f64, f64),
        inside: &mut I,
    ) -> f64 {
        let resolution = 4.0 * f64::EPSILON * b.abs();
        let mut last = 0.0;
        while b - a > resolution && g_b != 0.0 {
            let t = (b - g_b * (b - a) / (g_b - g_a)).clamp(a + 0.5 * resolution, b - 0.5 * resolution);
            let y = inside.interpolate(t).expect("inside the step");
            let g = self.surfaces(t, &y)[i];
            let side = if g > 0.0 { 1.0 } else { -1.0 };
            if g > 0.0 {
                (a, g_a) = (t, g);
                g_b = if last == side { 0.5 * g_b } else { g_b };
            } else {
                (b, g_b) = (t, g);
                g_a = if last == side { 0.5 * g_a } else { g_a };
            }
            last = side;
        }
        b
    }
}

impl Solout<f64, State> for Watch<'_> {
    fn solout<I: Interpolation<f64, State> + ?Sized>(
        &mut self,
        t: f64,
        t_before: f64,
        y: &State,
        _: &State,
        inside: &mut I,
        _: &mut Solution<f64, State>,
    ) -> ControlFlag<f64, State> {
        let after = self.surfaces(t, y);
        let before = self.before.replace(after).unwrap_or(after);
        let mut end = t;
        for i in 0..2 {
            if after[i] > 0.0 {
                continue;
            }
            if let Some(above) = self.positive(i, (t_before, before[i]), t, inside) {
                let root = self.root(i, above, (t, after[i]), inside);
                if self.event.is_none_or(|(earlier, ..)| root < earlier) {
                    self.event = Some((root, inside.interpolate(root).expect("inside the step"), i));
                    end = root;
                }
            }
        }
        if let Some(rows) = &mut self.rows {
            while let Some(&time) = rows.times.get(rows.theta.len()).filter(|&&time| time <= end + 1e-12) {
                let at = time.min(end);
                let y = if at <= t_before { *y } else { inside.interpolate(at).expect("inside the step") };
                rows.theta.push(y[0]);
            }
        }
        self.end = (t, *y);
        if self.event.is_some() {
            self.next_step.set(t - t_before);
            return ControlFlag::Terminate;
        }
        ControlFlag::Continue
    }
}

/// How records are followed.
#[derive(PartialEq)]
enum AtSamples {
    Restart,
    Through,
}

struct Peer<S> {
    equations: Equations,
    contact: Contact,
    at_samples: AtSamples,
    method: S,
    /// Sets the first step size of the method.
    set_first_step: fn(&mut S, f64),
    work: Work,
}

impl<S: OrdinaryNumericalMethod<f64, State> + Interpolation<f64, State>> Peer<S> {
    /// Returns state and time of the start; on the rigid base, the start of rocking under a sine.
    fn start(&mut self) -> (f64, State) {
        let block = self.equations.block;
        let case = &self.equations.case;
        self.work = Work::default();
        let (theta, theta_dot) = (case.theta, case.theta_dot);
        if block.rigid {
            let onset = (block.gravity * block.alpha.tan() / case.a_p).asin() / case.omega_p;
            self.equations.regime = Regime::RigidBase(1.0);
            return (onset, [0.0; 4]);
        }
        let settled = case.settled != 0.0;
        let middle = ((block.b * theta.sin()).abs() - block.delta_s).max(0.0);
        let v = if settled { middle - block.h * (1.0 - theta.cos()) } else { 0.0 };
        let y = [theta, theta_dot, v, 0.0];
        let touching = SIGNS.map(|s| block.corner(s, &y, theta.sin_cos()).0 <= block.delta_s);
        self.contact = Contact { touching, creep: Default::default() };
        self.settle(0.0, &y);
        (0.0, y)
    }

    /// Sets the excitation from `t` on, and returns the time of the next kink at which to stop.
    fn next_piece(&mut self, t: f64, sample: usize) -> f64 {
        let case = &self.equations.case;
        let t_end = case.t_end;
        let (ground, end) = match (case.shape, case.record.len()) {
            (0.0, 0) => (Ground::Ramp { t0: 0.0, value: 0.0, slope: 0.0 }, t_end),
            (0.0, _) if self.at_samples == AtSamples::Through => (Ground::Record, t_end),
            (0.0, samples) => {
                let (value, slope) = case.ramp(sample);
                let end = if sample + 1 < samples { case.sample_time(sample + 1) } else { t_end };
                (Ground::Ramp { t0: case.sample_time(sample), value, slope }, end)
            }
            (shape, _) => {
                let (amplitude, omega) = (case.a_p, case.omega_p);
                let end = 2.0 * PI / omega;
                let wave =
                    if shape == 1.0 { Ground::Sine { amplitude, omega } } else { Ground::Cosine { amplitude, omega } };
                if t < end { (wave, end) } else { (Ground::Ramp { t0: 0.0, value: 0.0, slope: 0.0 }, t_end) }
            }
        };
        self.equations.ground = ground;
        end.min(t_end)
    }

    /// Releases corners whose supports would have to pull, now or in the next moment.
    fn settle(&mut self, t: f64, y: &State) {
        let block = self.equations.block;
        let rounding = 1e-12 * block.gravity;
        let sin_cos = y[0].sin_cos();
        loop {
            self.equations.regime = self.contact.regime();
            let mut rate = [0.0; 4];
            self.equations.diff(t, y, &mut rate);
            let cannot_stay = |&i: &usize| {
                let s = SIGNS[i];
                let corner = block.corner(s, y, sin_cos);
                let (reach, height) = block.arms(s, sin_cos);
                let n = block.reaction(corner);
                let acceleration = rate[3] + s * reach * rate[1] + height * y[1] * y[1];
                let falls = -block.k * corner.1 - block.c * acceleration < 0.0;
                self.contact.touching[i] && (n < -rounding || (n <= rounding && falls))
            };
            let Some(i) = (0..2).find(cannot_stay) else { break };
            self.contact.lift(&block, i, t, y);
        }
    }

    /// Applies the fall of surface `i`; eqs. (14)–(19) and their mirror image for a landing.
    fn apply(&mut self, i: usize, t: f64, y: &mut State) {
        let block = self.equations.block;
        if let Regime::RigidBase(s) = self.equations.regime {
            (y[0], y[1]) = (0.0, block.restitution * y[1]);
            self.equations.regime = Regime::RigidBase(-s);
            return;
        }
        if self.contact.touching[i] {
            self.contact.lift(&block, i, t, y);
        } else {
            self.contact.touching[i] = true;
            let (s, sin_cos) = (SIGNS[i], y[0].sin_cos());
            if block.corner(s, y, sin_cos).1 < 0.0 {
                let Block { i0, h, epsilon: e, .. } = block;
                let ((reach, height), (_, before)) = (block.arms(s, sin_cos), block.arms(-s, sin_cos));
                let (a, bb, pp) = (h * sin_cos.1 * height, reach * reach, before * height);
                let d = i0 + a + bb;
                let [_, theta_dot, _, v_dot] = *y;
                y[3] = ((e * (i0 + a) + bb) * v_dot + s * ((e - 1.0) * i0 + e * a - pp) * reach * theta_dot) / d;
                y[1] = (s * (e - 1.0) * reach * v_dot + (i0 + e * bb + pp) * theta_dot) / d;
            }
        }
        self.settle(t, y);
    }

    fn simulate(&mut self, mut rows: Option<&mut Rows>) {
        let (mut t, mut y) = self.start();
        if let Some(rows) = &mut rows {
            let at_rest = rows.times.iter().filter(|&&time| time <= t).count();
            rows.theta.resize(at_rest, y[0]);
        }
        let t_end = self.equations.case.t_end;
        let mut sample = 0;
        let mut stop = self.next_piece(t, sample);
        // Zero lets the method choose.
        let next_step = Cell::new(0.0_f64);
        while t < t_end {
            (self.set_first_step)(&mut self.method, next_step.get().min(stop - t));
            let mut watch = Watch {
                equations: &self.equations,
                contact: &self.contact,
                before: None,
                event: None,
                end: (t, y),
                rows: rows.as_deref_mut(),
                next_step: &next_step,
            };
            let solution =
                solve_ode(&mut self.method, &self.equations, t, stop, &y, &mut watch).expect("the case runs");
            let (event, end) = (watch.event, watch.end);
            self.work.rhs += solution.evals.function as u64;
            self.work.steps += solution.steps.accepted as u64;
            match event {
                Some((time, state, i)) => {
                    (t, y) = (time, state);
                    self.apply(i, t, &mut y);
                    self.work.events += 1;
                }
                None => {
                    next_step.set(self.method.h());
                    (t, y) = (stop, end.1);
                    sample += 1;
                    stop = self.next_piece(t, sample);
                }
            }
        }
    }
}

/// A peer with any of its methods.
trait Runs {
    fn run(&mut self) -> Work;
    fn trace(&mut self) -> Vec<f64>;
}

impl<S: OrdinaryNumericalMethod<f64, State> + Interpolation<f64, State>> Runs for Peer<S> {
    fn run(&mut self) -> Work {
        self.simulate(None);
        self.work
    }

    fn trace(&mut self) -> Vec<f64> {
        let case = &self.equations.case;
        let times = (0..=case.rows()).map(|row| case.row_time(row)).collect();
        let mut rows = Rows { times, theta: Vec::new() };
        self.simulate(Some(&mut rows));
        rows.theta
    }
}

impl Solver for Box<dyn Runs> {
    fn new(case: Case, method: &str, tolerance: f64) -> Box<dyn Runs> {
        let block = Block::new(&case);
        // A height counts as the velocity that the supports would give it.
        let velocity = block.r0 * block.alpha * block.p;
        let scales = [block.alpha, block.alpha * block.p, velocity / block.omega_v.max(block.p), velocity];
        let atol = scales.map(|scale| tolerance * scale).to_vec();
        let contact = Contact::default();
        let ground = Ground::Ramp { t0: 0.0, value: 0.0, slope: 0.0 };
        let equations = Equations { block, regime: Regime::FullContact, ground, case };
        let (name, at_samples) = method.split_once('-').unwrap_or((method, "restart"));
        let at_samples = if at_samples == "through" { AtSamples::Through } else { AtSamples::Restart };
        macro_rules! peer {
            ($method:expr) => {
                Box::new(Peer {
                    equations,
                    contact,
                    at_samples,
                    method: $method.rtol(tolerance).atol(atol).max_steps(usize::MAX),
                    set_first_step: |method, h| method.h0 = h,
                    work: Work::default(),
                })
            };
        }
        match name {
            "dop853" => peer!(ExplicitRungeKutta::dop853()),
            "verner76" => peer!(ExplicitRungeKutta::rkv767e()),
            "verner98" => peer!(ExplicitRungeKutta::rkv988e()),
            other => panic!("no method {other}"),
        }
    }

    fn run(&mut self) -> Work {
        (**self).run()
    }

    fn trace(&mut self) -> Vec<f64> {
        (**self).trace()
    }
}

fn main() {
    program::<Box<dyn Runs>>();
}
