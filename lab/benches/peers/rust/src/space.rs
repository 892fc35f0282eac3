//! The block in space of `space/compare.py` with this project's core: `space CASE - TOLERANCE END SECONDS`, as `space/cvode_space.c`.

use std::path::Path;
use std::str::FromStr;

use rocking_block::excitation::{Pulse, PulseShape, Ramp};
use rocking_block::simulation::{OnSeparation, Settings};
use rocking_block::space::{
    Base, DirectedPulse, FootPlace, SpaceBody, SpaceInitial, SpaceInputs, SpaceParameters, SpaceRun, SpaceSetup,
    SpaceSupports,
};
use rustix::time::{ClockId, clock_gettime};

/// A case of the file that both programs read.
struct Case {
    setup: SpaceSetup,
    initial: SpaceInitial,
    time_step: f64,
    records: [Vec<f64>; 2],
}

impl Case {
    fn read(path: &Path, tolerance: f64) -> Case {
        let text = std::fs::read_to_string(path).expect("a case");
        let mut numbers = text.split_whitespace().map(|word| f64::from_str(word).expect("a number"));
        let mut take = |count: usize| -> Vec<f64> { numbers.by_ref().take(count).collect() };
        let head = take(14);
        let [n, mass, gravity, stiffness, damping, kh, ch, friction, _, _, _, omega_v, samples, time_step] = head[..]
        else {
            panic!("the case is too short")
        };
        let n = n as usize;
        let [xx, xy, xz, _, yy, yz, _, _, zz] = take(9)[..] else { panic!("no inertia") };
        take(9);
        let sines = take(9);
        let start = take(13);
        let feet = take(4 * n);
        let center_height = -feet[2];
        let records = [take(samples as usize), take(samples as usize)];
        let kappa = kh / stiffness;
        let parameters = SpaceParameters {
            base: Base::List {
                feet: feet.chunks(4).map(|foot| FootPlace { x: foot[0], y: foot[1], gap: 0.0 }).collect(),
                center_height,
            },
            supports: SpaceSupports::OfFoot { stiffness, damping },
            kappa,
            xi_h: Some(ch / (2.0 * kappa.sqrt() * omega_v * mass / n as f64)),
            friction,
            mass,
            gravity,
            inertia: Some([xx, yy, zz, xy, xz, yz]),
            ..SpaceParameters::default()
        };
        let pulse = |axis: usize| {
            let [amplitude, omega, start] = sines[3 * axis..3 * axis + 3] else { panic!("no sine") };
            if amplitude == 0.0 {
                return DirectedPulse::NONE;
            }
            let period = std::f64::consts::TAU / omega;
            let pulse = Pulse { shape: PulseShape::OneSine, amplitude, period, start, ..Pulse::NONE };
            let direction = std::array::from_fn(|i| if i == axis { 1.0 } else { 0.0 });
            DirectedPulse { pulse, direction }
        };
        assert!(start[3] == 1.0, "the block starts upright and at rest");
        let settings = Settings { tolerance, on_separation: OnSeparation::Fly, ..Settings::default() };
        let body = SpaceBody::new(&parameters).expect("a block");
        let initial = SpaceInitial { vertical: Some([0.0; 2]), ..SpaceInitial::default() };
        Case { setup: SpaceSetup { body, settings, pulses: std::array::from_fn(pulse) }, initial, time_step, records }
    }

    /// Runs from the start to a time, in as few calls as the records allow.
    fn run_to(&self, end: f64) -> SpaceRun {
        let mut run = SpaceRun::new(self.setup.clone(), &self.initial, 0.0);
        let mut sample = 0;
        while run.time() < end {
            let time = sample as f64 * self.time_step;
            let mut inputs = SpaceInputs { time, ..SpaceInputs::default() };
            let mut next = end;
            if sample + 1 < self.records[0].len() {
                next = (sample + 1) as f64 * self.time_step;
                for (ramp, record) in inputs.ground.iter_mut().zip(&self.records) {
                    let [value, after] = [record[sample], record[sample + 1]];
                    *ramp = Ramp { value, rate: (after - value) / self.time_step };
                }
            }
            run.advance(next.min(end), &inputs, &mut |_| ()).expect("the case runs");
            sample += 1;
        }
        run
    }
}

fn cpu_time() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, _, tolerance, end, seconds] = &arguments[..] else {
        panic!("usage: space CASE - TOLERANCE END SECONDS")
    };
    let number = |text: &String| f64::from_str(text).expect("a number");
    let case = Case::read(path.as_ref(), number(tolerance));
    let (begin, mut least) = (cpu_time(), f64::INFINITY);
    let run = loop {
        let before = cpu_time();
        let run = case.run_to(number(end));
        least = least.min(cpu_time() - before);
        if cpu_time() - begin >= number(seconds) {
            break run;
        }
    };
    let counts = run.state().counts;
    let state = run.state().numbers[..13].iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let events = counts.lift_offs + counts.landings + counts.slides + counts.sticks;
    println!("{state} {least:e} {} {} {events}", counts.evaluations, counts.steps);
}
