//! Random blocks under violent ground motion: no tension, no gain of energy, mirror symmetry, similarity.

use proptest::prelude::*;
use rocking_block::block::{Block, Common, Corner, Dimensionless, Regime, Supports};
use rocking_block::excitation::{Inputs, Pulse, PulseShape, Ramp};
use rocking_block::simulation::{Initial, OnSeparation, Settings, Simulation};
use rocking_block::system::events::Event;

use super::{G, start};
use crate::cases::cases;

/// Time between two values of the ground accelerations, in 1/p.
const SEGMENT: f64 = 0.2;

/// A block, its initial rotation and rate over α and α p, and ground accelerations `[a_gx, a_gz]` over g.
///
/// The ground acceleration is piecewise linear or piecewise constant.
#[derive(Clone, Debug)]
struct Shaken {
    alpha: f64,
    p: f64,
    gamma: f64,
    epsilon: f64,
    initial: [f64; 2],
    ground: Vec<[f64; 2]>,
    jumps: bool,
}

prop_compose! {
    fn shaken()(
        alpha in 0.03..0.9,
        p in 0.5..5.0,
        gamma in 1.0..5.0,
        epsilon in prop_oneof![4 => Just(0.0), 1 => 0.0..0.9],
        initial in prop_oneof![Just([0.0; 2]), [-1.0..1.0, -1.0..1.0]],
        ground in prop::collection::vec([-1.5..1.5, -3.0..3.0], 12),
        jumps: bool,
    ) -> Shaken {
        Shaken { alpha, p, gamma, epsilon, initial, ground, jumps }
    }
}

impl Shaken {
    fn block(&self) -> Block {
        let Shaken { alpha, p, gamma, epsilon, .. } = *self;
        let common = Common { gamma, epsilon, ..Common::default() };
        Block::from_dimensionless(&Dimensionless { alpha, p, supports: Supports::HOUSNER }, &common).unwrap()
    }

    /// Returns the same block in another size: times divided by the factor, accelerations unchanged.
    fn smaller(&self, factor: f64) -> Shaken {
        Shaken { p: self.p * factor, ..self.clone() }
    }

    fn mirrored(&self) -> Shaken {
        let ground = self.ground.iter().map(|&[x, z]| [-x, z]).collect();
        Shaken { ground, initial: self.initial.map(|x| -x), ..self.clone() }
    }

    fn inputs(&self, segment: usize) -> Inputs {
        let duration = SEGMENT / self.p;
        let ramp = |i: usize| {
            let [from, to] = [0, 1].map(|next| G * self.ground[(segment + next).min(self.ground.len() - 1)][i]);
            Ramp { value: from, rate: if self.jumps { 0.0 } else { (to - from) / duration } }
        };
        Inputs { time: segment as f64 * duration, a_gx: ramp(0), a_gz: ramp(1), ..Inputs::default() }
    }

    fn start(&self, on_separation: OnSeparation) -> Simulation {
        let block = self.block();
        let [theta, theta_dot] = [self.initial[0] * self.alpha, self.initial[1] * self.alpha * self.p];
        let initial = Initial { theta, theta_dot, ..Initial::default() };
        start(block, on_separation, Pulse::NONE, &initial, &self.inputs(0))
    }

    /// Runs to the end in steps of 0.02/p and checks both sides of each communication point.
    fn run(
        &self,
        on_separation: OnSeparation,
        mut look: impl FnMut(&Simulation, &Inputs) -> Result<(), TestCaseError>,
    ) -> Result<Vec<Event>, TestCaseError> {
        let mut simulation = self.start(on_separation);
        let mut events = Vec::new();
        for segment in 0..self.ground.len() {
            let inputs = self.inputs(segment);
            look(&simulation, &inputs)?;
            for step in 1..=10 {
                let until = inputs.time + 0.1 * SEGMENT * f64::from(step) / self.p;
                let result = simulation.advance(until, &inputs, &mut |event| events.push(*event));
                prop_assert!(result.is_ok(), "{result:?}");
                look(&simulation, &inputs)?;
                if simulation.ending().is_some() {
                    return Ok(events);
                }
            }
        }
        Ok(events)
    }
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn no_corner_pulls_and_no_energy_is_gained(shaken in shaken()) {
        for on_separation in [OnSeparation::Fly, OnSeparation::Terminate] {
            let block = shaken.block();
            let mut largest = block.mass * (block.r0 * block.alpha * block.p).powi(2);
            let mut lost = 0.0;
            shaken.run(on_separation, |simulation, inputs| {
                let seen = simulation.observe(inputs);
                prop_assert!(seen.reaction.iter().all(|&n| n >= 0.0), "{seen:?} at {}", simulation.time());
                for corner in Corner::BOTH {
                    let (i, touches) = (corner.index(), seen.regime.touches(corner));
                    prop_assert!(touches || seen.reaction[i] == 0.0, "{seen:?}");
                    prop_assert!(seen.corner[i] >= -1e-11 * block.r0, "{seen:?} at {}", simulation.time());
                }
                prop_assert!(seen.regime != Regime::Separated || seen.horizontal == 0.0, "{seen:?}");
                let energies = simulation.energies();
                largest = f64::max(largest, energies.total.abs().max(energies.input.abs()));
                prop_assert!(energies.residual.abs() < 1e-8 * largest, "{energies:?} at {}", simulation.time());
                prop_assert!(energies.impacts >= lost - 1e-10 * largest, "{lost} -> {energies:?}");
                prop_assert_eq!((energies.constraint, energies.dashpots), (0.0, 0.0));
                lost = energies.impacts;
                Ok(())
            })?;
        }
    }

    #[test]
    fn the_mirror_image_of_a_run_is_a_run(shaken in shaken()) {
        let images = [shaken.clone(), shaken.mirrored()].map(|shaken| {
            let mut images = Vec::new();
            let run = shaken.run(OnSeparation::Fly, |simulation, inputs| {
                images.push(simulation.observe(inputs));
                Ok(())
            });
            run.map(|_| images)
        });
        let [Ok(one), Ok(other)] = images else { panic!("{images:?}") };
        for (a, b) in one.iter().zip(&other) {
            prop_assert_eq!([a.theta, a.theta_dot, a.theta_ddot, a.u, a.u_dot, a.horizontal],
                [b.theta, b.theta_dot, b.theta_ddot, b.u, b.u_dot, b.horizontal].map(|x| -x));
            prop_assert_eq!([a.v, a.v_dot, a.v_ddot], [b.v, b.v_dot, b.v_ddot]);
            prop_assert_eq!(a.reaction, [b.reaction[1], b.reaction[0]]);
        }
    }

    /// Twice the frequency parameter halves all times; powers of two avoid round-off.
    #[test]
    fn a_run_of_a_block_of_another_size_is_similar(shaken in shaken()) {
        let images = [shaken.clone(), shaken.smaller(2.0)].map(|shaken| {
            let mut images = Vec::new();
            let run = shaken.run(OnSeparation::Fly, |simulation, inputs| {
                let (x, size) = (simulation.observe(inputs), simulation.block().r0);
                images.push([x.theta, x.theta_dot / shaken.p, x.u / size, x.v / size, x.reaction[0], x.reaction[1]]);
                Ok(())
            });
            run.map(|events| (events, images))
        });
        let [Ok((events, one)), Ok((others, other))] = images else { panic!("{images:?}") };
        prop_assert_eq!(events.len(), others.len());
        prop_assert_eq!(one, other);
    }
}

/// The uplift peaks with the rotation, even in a step that ends with a landing up to round-off.
#[test]
fn the_greatest_uplift_is_that_of_the_greatest_rotation() {
    let pulse = Pulse { shape: PulseShape::C1, amplitude: 2.645, period: 1.154, start: 0.0, ..Pulse::NONE };
    let settings =
        Settings { tolerance: Settings::OF_STUDIES, on_separation: OnSeparation::Fly, ..Settings::default() };
    for k in 0..100 {
        let block = super::block(0.253, 1.5 + 0.02 * f64::from(k), 0.0);
        let inputs = Inputs::default();
        let mut simulation = Simulation::new(block, settings, pulse, &Initial::default(), 0.0, &inputs);
        simulation.advance(pulse.end(), &inputs, &mut |_| ()).unwrap();
        let peaks = simulation.peaks();
        let width = 2.0 * block.b;
        super::close(peaks.uplift, width * libm::sin(peaks.theta), width * peaks.theta);
    }
}
