//! The block stepped from outside, as in Model Exchange: sizes of its states, peaks between them, events and energies; derivatives in a file of their own.

mod derivatives;
mod links;

use rocking_block::block::restraints::{self, Tie};
use rocking_block::block::{Block, Common, Dimensionless, Foundation, Ratios, Regime, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::exchange::{ContinuousStates, STATES, nominals};
use rocking_block::simulation::outputs::Observation;
use rocking_block::simulation::peaks::Peaks;
use rocking_block::simulation::{Energies, Initial, OnOverturning, OnSeparation, Settings, Simulation};
use rocking_block::system::events::{Event, EventKind};

use crate::blocks::on;

fn block(foundation: Foundation, alpha: f64, eta: f64, xi_v: f64) -> Block {
    on(foundation, alpha, 8.0, eta, xi_v)
}

fn start(block: Block, initial: &Initial) -> Simulation {
    let settings = Settings { tolerance: 1e-12, ..Settings::default() };
    Simulation::new(block, settings, Pulse::NONE, initial, 0.0, &Inputs::default())
}

fn go(simulation: &mut Simulation, until: f64) -> Observation<f64> {
    let inputs = Inputs::default();
    simulation.advance(until, &inputs, &mut |_| ()).unwrap();
    simulation.observe(&inputs)
}

/// The nominal values by which an importer's solver weighs errors agree, within a factor of ten, with a block that rocks almost
/// up to α, whether slender or broad; the nominal values of the vertical motion, with a block that bounces on its supports.
#[test]
fn nominal_states_match_the_size_of_the_motion() {
    let greatest = |mut simulation: Simulation| {
        let energy = simulation.energies().total;
        let mut greatest = [0.0_f64; STATES];
        for i in 1..=2000 {
            go(&mut simulation, 0.0005 * f64::from(i));
            let states = simulation.states(&Inputs::default());
            greatest = std::array::from_fn(|i| greatest[i].max(states[i].abs()));
        }
        // The energy that the block can lose, and the work of the ground.
        [greatest[0], greatest[1], greatest[2], greatest[3], greatest[4], greatest[5], energy, energy]
    };
    for foundation in [Foundation::Viscoelastic, Foundation::Rigid] {
        for alpha in [0.02, 0.3] {
            let block = block(foundation, alpha, 12.0 / alpha, 0.1);
            let mut sizes = greatest(start(block, &Initial { theta: 0.9 * alpha, ..Initial::default() }));
            if foundation == Foundation::Viscoelastic {
                let lifted = Some((0.9 * block.static_deflection(), 0.0));
                let bounces = greatest(start(block, &Initial { vertical: lifted, ..Initial::default() }));
                (sizes[2], sizes[3]) = (bounces[2], bounces[3]);
            }
            for (i, (nominal, size)) in nominals(&block).into_iter().zip(sizes).enumerate() {
                let ratio = nominal / size;
                assert!((0.1..10.0).contains(&ratio), "state {i}, α = {alpha}, {foundation:?}: {nominal}, {size}");
            }
        }
    }
}

/// For long external steps, peaks between their ends come from cubics, accurate to `(ω h)⁴/384` of a motion of circular frequency
/// ω and amplitude 1; the ends alone miss `(ω h)²/8`. The motions begin at each seventh of a step.
#[test]
fn peaks_between_external_states_match_the_motion() {
    // The vertical motion in full contact is the fastest one.
    const TURN: f64 = 0.4;
    let bounces = block(Foundation::Viscoelastic, 0.25, 20.0, 0.02);
    let vertical = Some((0.0, 0.3 * bounces.static_deflection() * bounces.omega_v));
    let theta_dot = 0.3 * bounces.separation_angle() * bounces.p;
    let in_full_contact = Initial { theta: 0.0, theta_dot, vertical };
    let on_a_corner = |theta: f64| Initial { theta, theta_dot: 0.25 * theta * bounces.p, vertical: None };
    for (initial, steps) in [(in_full_contact, 30), (on_a_corner(0.12), 24), (on_a_corner(-0.12), 24)] {
        let h = TURN / bounces.omega_v;
        for seventh in 0..7 {
            let mut motion = start(bounces, &initial);
            let mut outside = motion.clone();
            outside.begin_exchange();
            outside.pass_events(&Inputs::default(), f64::INFINITY, &mut |_| ()).unwrap();
            let (mut peaks, mut least) = (Peaks::<f64>::default(), [f64::INFINITY; 2]);
            for step in 0..steps {
                let end = h * (f64::from(step) + f64::from(seventh + 1) / 7.0);
                let begin = motion.time();
                for i in 0..=200 {
                    let seen = go(&mut motion, begin + (end - begin) * f64::from(i) / 200.0);
                    let greater = |a: f64, values: [f64; 2]| a.max(values[0]).max(values[1]);
                    peaks.theta = peaks.theta.max(seen.theta.abs());
                    peaks.reaction = greater(peaks.reaction, seen.reaction);
                    peaks.uplift = greater(peaks.uplift, seen.uplift);
                    least = std::array::from_fn(|i| least[i].min(seen.reaction[i]));
                }
                outside.set_states(end, &motion.states(&Inputs::default()));
                outside.complete_step(&Inputs::default());
            }
            assert_eq!(motion.counts().liftoffs + motion.counts().impacts, 0, "the regime lasts");
            let share = 2.0 * TURN.powi(4) / 384.0;
            let found = outside.peaks();
            let close = |a: f64, b: f64, range: f64| (a - b).abs() <= share * range;
            assert!(close(found.theta, peaks.theta, peaks.theta), "{found:?}, {peaks:?}");
            assert!(close(found.reaction, peaks.reaction, peaks.reaction), "{found:?}, {peaks:?}");
            assert!(close(found.uplift, peaks.uplift, peaks.uplift), "{found:?}, {peaks:?}");
        }
    }
}

/// Steps of an importer longer than the block's own count by their ends: no peak exceeds that of the motion.
#[test]
fn peaks_of_coarse_external_steps_are_no_greater_than_those_of_the_motion() {
    let block = block(Foundation::Viscoelastic, 0.25, 20.0, 0.02);
    let bounce = Some((0.0, 0.3 * block.static_deflection() * block.omega_v));
    let initial = Initial { theta: 0.0, theta_dot: 0.3 * block.separation_angle() * block.p, vertical: bounce };
    let h = 4.0 / block.omega_v;
    let mut sum = 0.0;
    for seventh in 0..7 {
        let mut motion = start(block, &initial);
        let mut outside = motion.clone();
        outside.begin_exchange();
        outside.pass_events(&Inputs::default(), f64::INFINITY, &mut |_| ()).unwrap();
        for step in 0..3 {
            let end = h * (f64::from(step) + f64::from(seventh + 1) / 7.0);
            go(&mut motion, end);
            outside.set_states(end, &motion.states(&Inputs::default()));
            outside.complete_step(&Inputs::default());
        }
        assert_eq!(motion.counts().liftoffs + motion.counts().impacts, 0, "the regime lasts");
        let (found, most) = (outside.peaks(), motion.peaks());
        for (found, most) in [(found.theta, most.theta), (found.reaction, most.reaction)] {
            assert!(found <= most * (1.0 + 1e-12), "{found}, not {most}, from {seventh}/7 of a step");
        }
        sum += found.reaction / most.reaction;
    }
    assert!(sum > 6.0, "the ends count: {sum}");
}

/// In flight under a ground acceleration linear in time, the height is a cubic, which one external step reproduces exactly. It
/// peaks where `v̇ = v̇₀ − (g + c) t − d t²/2` is zero.
#[test]
fn one_external_step_finds_the_top_of_a_flight() {
    let block = block(Foundation::Viscoelastic, 0.25, 40.0, 0.1);
    let settings = Settings { on_separation: OnSeparation::Fly, ..Settings::default() };
    for (c, d) in [(-2.0, 30.0), (1.0, -25.0), (0.0, 0.0)] {
        let inputs = Inputs { a_gz: Ramp { value: c, rate: d }, ..Inputs::default() };
        let (above, rate, fall) = (0.01, 1.5, block.gravity + c);
        let initial = Initial { vertical: Some((block.static_deflection() + above, rate)), ..Initial::default() };
        let mut flight = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
        let height = |t: f64| above + rate * t - 0.5 * fall * t * t - d / 6.0 * t * t * t;
        // d t²/2 + fall t − rate = 0, without loss where d is small.
        let top = 2.0 * rate / (fall + (fall * fall + 2.0 * d * rate).sqrt());
        flight.begin_exchange();
        flight.pass_events(&inputs, f64::INFINITY, &mut |_| ()).unwrap();
        let mut states = flight.states(&inputs);
        let end = 1.3 * top;
        (states[2], states[3]) = (states[2] + height(end) - above, rate - fall * end - 0.5 * d * end * end);
        flight.set_states(end, &states);
        flight.complete_step(&inputs);
        let (found, exact) = (flight.peaks().uplift, height(top));
        assert!((found / exact - 1.0).abs() < 1e-12, "a_gz = {c} + {d} t: {found} m, not {exact} m");
    }
}

/// The importer's side: classical Runge–Kutta with steps of one length, and bisection of a step that holds an event.
struct Outside {
    simulation: Simulation,
    inputs: Inputs,
    events: Vec<Event>,
}

impl Outside {
    fn begin(simulation: &Simulation, inputs: Inputs) -> Outside {
        let mut outside = Outside { simulation: simulation.clone(), inputs, events: Vec::new() };
        outside.pass_events();
        outside
    }

    fn pass_events(&mut self) {
        self.simulation.pass_events(&self.inputs, f64::INFINITY, &mut |event| self.events.push(*event)).unwrap();
    }

    /// Returns the result of a step, and whether an event follows it.
    fn attempt(&mut self, time: f64, states: &ContinuousStates, h: f64) -> bool {
        let mut rate = |elapsed: f64, k: &ContinuousStates| {
            let moved = std::array::from_fn(|i| states[i] + elapsed * k[i]);
            self.simulation.set_states(time + elapsed, &moved);
            self.simulation.derivatives(&self.inputs)
        };
        let k1 = rate(0.0, &[0.0; STATES]);
        let k2 = rate(0.5 * h, &k1);
        let k3 = rate(0.5 * h, &k2);
        let k4 = rate(h, &k3);
        let mean: ContinuousStates = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
        rate(h, &mean);
        self.simulation.indicators(&self.inputs).iter().any(|&indicator| indicator <= 0.0)
    }

    fn go(&mut self, until: f64, h: f64) {
        while self.simulation.time() < until && self.simulation.ending().is_none() {
            self.go_to_event(until, h);
        }
    }

    /// Steps until a time, or to the first event.
    fn go_to_event(&mut self, until: f64, h: f64) {
        while self.simulation.time() < until {
            let (time, states) = (self.simulation.time(), self.simulation.states(&self.inputs));
            let next = self.simulation.next_stop().map_or(until, |kink| kink.min(until));
            let h = h.min(next - time);
            if !self.attempt(time, &states, h) {
                self.simulation.complete_step(&self.inputs);
                if time + h < next {
                    continue;
                }
                return self.pass_events();
            }
            let (mut before, mut after) = (0.0, h);
            for _ in 0..60 {
                let middle = 0.5 * (before + after);
                if self.attempt(time, &states, middle) { after = middle } else { before = middle }
            }
            self.attempt(time, &states, after);
            return self.pass_events();
        }
    }
}

/// In external steps, too, a block on the rigid base rocks until it rests, after the same number of impacts for any size: each
/// impact takes the same fraction of the velocity.
#[test]
fn externally_stepped_blocks_of_any_size_come_to_rest() {
    for p in [0.1, 8.0, 1000.0] {
        let common = Common::default();
        let dimensionless = Dimensionless { alpha: 0.3, p, supports: Supports::HOUSNER };
        let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
        let mut inside = start(block, &Initial { theta: 0.2, ..Initial::default() });
        let mut outside = Outside::begin(&inside, Inputs::default());
        let end = 30.0 / p;
        outside.go(end, 0.02 / p);
        go(&mut inside, end);
        let counts = [&inside, &outside.simulation].map(|simulation| simulation.counts().impacts);
        assert_eq!(counts[0], counts[1], "p = {p}");
        assert!(counts[0] > 50, "{counts:?}");
        assert_eq!(outside.simulation.observe(&Inputs::default()).theta_dot, 0.0);
    }
}

/// On every foundation, states that are set are read back.
#[test]
fn states_are_read_back_as_set() {
    for (theta, regime) in [(0.12, Regime::TiltingRight), (-0.12, Regime::TiltingLeft), (0.0, Regime::FullContact)] {
        let block = block(Foundation::Viscoelastic, 0.3, 40.0, 0.1);
        let mut simulation = start(block, &Initial { theta, ..Initial::default() });
        assert_eq!(simulation.regime(), regime);
        let inputs = Inputs::default();
        let now = simulation.states(&inputs);
        let deflection = block.static_deflection();
        let put = [0.9 * theta + 1e-4, -0.7, now[2] + 0.1 * deflection, 2.0, now[4], now[5], 0.3, 0.2, 0.5, 0.4, 0.6];
        simulation.set_states(0.0, &put);
        let read = simulation.states(&inputs);
        // The horizontal motion of a gripping foot follows from the others.
        for i in [0, 1, 2, 3, 6, 7, 8, 9, 10] {
            assert!(
                (read[i] - put[i]).abs() <= 1e-14 * (1.0 + put[i].abs()),
                "{regime:?}, state {i}: {read:?}, {put:?}"
            );
        }
    }
}

/// Flights over the rigid base, stepped from outside, have the events of those that are stepped inside, and lead to the same place.
#[test]
fn external_steps_reproduce_flights_over_the_rigid_base() {
    let common = Common { epsilon: 0.5, ..Common::default() };
    let dimensionless = Dimensionless { alpha: 0.3, p: 2.0, supports: Supports::HOUSNER };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let settings = Settings { tolerance: 1e-12, on_separation: OnSeparation::Fly, ..Settings::default() };
    // The ground drops away and returns.
    let inputs = Inputs { a_gx: Ramp::held(0.5), a_gz: Ramp { value: -14.0, rate: 30.0 }, ..Inputs::default() };
    let initial = Initial { theta: 0.1, theta_dot: -0.3, vertical: None };
    let mut inside = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &inputs);
    let mut outside = Outside::begin(&inside, inputs);
    let mut events = Vec::new();
    inside.advance(1.0, &inputs, &mut |event| events.push(*event)).unwrap();
    outside.go(1.0, 1e-3);
    let kinds = |events: &[Event]| events.iter().map(|event| (event.kind, event.after)).collect::<Vec<_>>();
    assert_eq!(kinds(&events), kinds(&outside.events));
    // The last bounces take some 1e-6 s each.
    for (a, b) in events.iter().zip(&outside.events) {
        assert!((a.time - b.time).abs() < 1e-6, "{a}, {b}");
    }
    assert!(events.iter().any(|event| event.after == Regime::Separated), "{events:?}");
    let [a, b] = [&inside, &outside.simulation].map(|simulation| simulation.observe(&inputs.moved_to(1.0)));
    for (a, b) in [(a.theta, b.theta), (a.v, b.v), (a.u, b.u)] {
        assert!((a - b).abs() < 1e-6, "{a}, {b}");
    }
}

/// The first steps of a solver after an event are of first order, and an error of theirs may close a gap that opens. Here they are backward
/// Euler's, from nanoseconds on; no event follows from them.
#[test]
fn first_steps_after_an_event_contain_no_event() {
    let settings = Settings { tolerance: 1e-12, on_separation: OnSeparation::Fly, ..Settings::default() };
    let dimensionless =
        Dimensionless { alpha: 0.25, p: 2.0, supports: Supports::Viscoelastic(Ratios { eta: 40.0, xi_v: 0.1 }) };
    let block = Block::from_dimensionless(&dimensionless, &Common::default()).unwrap();
    let pulse = Pulse { shape: PulseShape::OneSine, amplitude: 15.0, period: 1.25, start: 0.0, ..Pulse::NONE };
    let inputs = Inputs::default();
    let inside = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
    let mut outside = Outside::begin(&inside, inputs);
    let (mut seen, mut flights) = (0, 0);
    for i in 1..1200 {
        outside.go(1e-3 * f64::from(i), 1e-3);
        if outside.events.len() == seen {
            continue;
        }
        // Back to the last event, and on from there.
        seen = outside.events.len();
        let mut again = Outside::begin(&inside, inputs);
        while again.events.len() < seen {
            let until = again.simulation.time() + 1e-3;
            again.go_to_event(until, 1e-3);
        }
        let (time, states) = (again.simulation.time(), again.simulation.states(&inputs));
        flights += u32::from(again.simulation.regime() == Regime::Separated);
        for nanoseconds in [0.01, 0.1, 1.0, 10.0, 100.0, 1000.0] {
            let h = 1e-9 * nanoseconds;
            let mut end = states;
            for _ in 0..8 {
                again.simulation.set_states(time + h, &end);
                let rates = again.simulation.derivatives(&inputs);
                end = std::array::from_fn(|i| states[i] + h * rates[i]);
            }
            again.simulation.set_states(time + h, &end);
            let indicators = again.simulation.indicators(&inputs);
            let event = again.events.last();
            assert!(indicators.iter().all(|&z| z > 0.0), "{event:?}, {h:e} s later: {indicators:?}");
        }
    }
    assert!(flights > 0 && seen > 5, "{:?}", outside.events);
}

/// A block that is held moves no more, however long an importer steps on.
#[test]
fn peaks_end_with_the_run() {
    let settings =
        Settings { on_overturning: OnOverturning::Hold, on_separation: OnSeparation::Hold, ..Settings::default() };
    let block = block(Foundation::Rigid, 0.25, 40.0, 0.1);
    let initial = Initial { theta: 0.2, theta_dot: 5.0, vertical: None };
    let inside = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
    let mut outside = Outside::begin(&inside, Inputs::default());
    outside.go(5.0, 1e-3);
    assert!(outside.simulation.is_frozen());
    let states = outside.simulation.states(&Inputs::default());
    assert_eq!([states[1], states[3], states[5]], [0.0; 3]);
    assert_eq!(outside.simulation.derivatives(&Inputs::default()), [0.0; STATES]);
    let (time, peaks, energies) =
        (outside.simulation.time(), outside.simulation.peaks(), outside.simulation.energies());
    for i in 1..10 {
        outside.simulation.set_states(time + 0.1 * f64::from(i), &states);
        outside.simulation.complete_step(&Inputs::default());
    }
    assert_eq!(outside.simulation.peaks(), peaks);
    assert!((peaks.theta - states[0].abs()).abs() < 1e-12, "{peaks:?}, {states:?}");
    let after = outside.simulation.energies();
    assert!((after.total - energies.total).abs() <= 1e-12 * energies.total.abs(), "{energies:?}, {after:?}");
}

/// Bounces that follow ever faster on each other, and rocking that dies out, are those of the block itself to the last, though the
/// solver's steps are longer than most of them.
#[test]
fn events_in_quick_succession_are_predicted() {
    let dimensionless = Dimensionless {
        alpha: 0.18780937236228806,
        p: 2.426103416172558,
        supports: Supports::Viscoelastic(Ratios { eta: 38.20537857603828, xi_v: 0.034088974393931985 }),
    };
    let flight = Initial { theta: 0.1, theta_dot: 1.0, vertical: Some((0.02, 0.1)) };
    let broad = Dimensionless { alpha: 0.5, supports: Supports::HOUSNER, ..dimensionless };
    let release = Initial { theta: 0.1, ..Initial::default() };
    for (dimensionless, initial, most) in [(dimensionless, flight, 0.78), (broad, release, 5.0)] {
        let block = Block::from_dimensionless(&dimensionless, &Common::default()).unwrap();
        let settings = Settings { tolerance: 1e-12, on_separation: OnSeparation::Fly, ..Settings::default() };
        let mut inside = Simulation::new(block, settings, Pulse::NONE, &initial, 0.0, &Inputs::default());
        let mut outside = Outside::begin(&inside, Inputs::default());
        let mut events = Vec::new();
        inside.advance(most, &Inputs::default(), &mut |event| events.push(*event)).unwrap();
        outside.go(most, 1e-3);
        let kinds = |events: &[Event]| events.iter().map(|event| (event.kind, event.after)).collect::<Vec<_>>();
        assert_eq!(kinds(&events), kinds(&outside.events));
        let last = events.last().unwrap();
        let fast = events.windows(2).filter(|pair| pair[1].time - pair[0].time < 1e-4).count();
        assert!(fast >= 5, "{fast} of {}", events.len());
        assert!((outside.events.last().unwrap().time - last.time).abs() < 1e-5, "{last}");
    }
}

/// Events predicted under inputs that have changed since are dropped: the solver searches anew.
#[test]
fn predicted_events_are_dropped_if_the_inputs_change() {
    let common = Common::default();
    let dimensionless = Dimensionless { alpha: 0.188, p: 2.43, supports: Supports::HOUSNER };
    let block = Block::from_dimensionless(&dimensionless, &common).unwrap();
    let inside = start(block, &Initial { theta: 1e-5, ..Initial::default() });
    let mut outside = Outside::begin(&inside, Inputs::default());
    let foreseen = outside.simulation.next_stop().unwrap();
    assert!(outside.simulation.indicators(&outside.inputs).iter().all(|indicator| *indicator == 1.0));
    outside.inputs.a_gx = Ramp::held(-0.1);
    outside.simulation.change_inputs(&outside.inputs);
    assert_eq!(outside.simulation.next_stop(), None);
    outside.go_to_event(1.0, 1e-4);
    assert!(outside.simulation.time() != foreseen && outside.events.len() == 1, "{:?}", outside.events);
}
