//! A record, a building → the absolute accelerations of its floors.

use crate::building::{Building, Mode};
use crate::intensity::{OscillatorStep, pga};
use rocking_records::Record;

/// The horizontal motion of a floor.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorMotion {
    /// Number of the floor; 0 is the ground.
    pub floor: usize,
    /// Absolute acceleration, exact at its samples.
    pub record: Record,
    /// Peak floor acceleration PFA (m/s²): greatest absolute acceleration of a sample; see [`Building::undersampled`].
    pub pfa: f64,
    /// Peak floor velocity PFV (m/s): greatest absolute velocity, that of the ground included.
    pub pfv: f64,
}

/// Fraction of PGA (1) at which the free vibration after a record ends.
const REST: f64 = 1e-3;

impl Building {
    /// Returns the motions of all floors from rest, that of the ground first.
    ///
    /// Each mode's oscillator takes steps that are exact for an acceleration that is linear between the samples of the record. A floor
    /// follows the ground as far as the modes do not describe its motion: `a = a_g (1 − Σ Γφ) + Σ Γφ a_mode`. The motions of the
    /// floors last until the free vibration after the record has decayed.
    pub fn floor_motions(&self, ground: &Record) -> Vec<FloorMotion> {
        let step = ground.time_step;
        let steps: Vec<OscillatorStep> =
            self.modes().iter().map(|mode| OscillatorStep::new(mode.omega(), mode.damping, step)).collect();
        let weights: Vec<Vec<f64>> = (0..self.floors())
            .map(|floor| self.modes().iter().map(|mode| mode.participation * mode.shape[floor]).collect())
            .collect();
        let ground_weights: Vec<f64> = weights.iter().map(|weights| 1.0 - weights.iter().sum::<f64>()).collect();
        let mut states = vec![[0.0; 2]; self.modes().len()];
        let mut histories = vec![History::default(); self.floors()];
        let mut velocity = 0.0;
        let mut observe = |states: &[[f64; 2]], a: f64, velocity: f64| {
            for ((history, weights), ground_weight) in histories.iter_mut().zip(&weights).zip(&ground_weights) {
                let mut sum = [ground_weight * a, velocity];
                for ((mode, state), weight) in self.modes().iter().zip(states).zip(weights) {
                    sum[0] += weight * acceleration(mode, *state);
                    sum[1] += weight * state[1];
                }
                history.push(sum, step);
            }
        };
        observe(&states, ground.acceleration[0], 0.0);
        for pair in ground.acceleration.windows(2) {
            let slope = (pair[1] - pair[0]) / step;
            for (state, step) in states.iter_mut().zip(&steps) {
                *state = step.advance(*state, pair[0], slope);
            }
            velocity += 0.5 * (pair[0] + pair[1]) * step;
            observe(&states, pair[1], velocity);
        }
        let envelope = |states: &[[f64; 2]]| -> f64 {
            let bound = |(number, (mode, [u, u_dot])): (usize, (&Mode, &[f64; 2]))| {
                let weight = weights.iter().map(|weights| weights[number].abs()).fold(0.0, f64::max);
                weight * mode.omega() * libm::hypot(mode.omega() * u, *u_dot)
            };
            self.modes().iter().zip(states).enumerate().map(bound).sum()
        };
        let largest = ground.acceleration.iter().fold(0.0, |largest: f64, a| largest.max(a.abs()));
        while envelope(&states) > REST * largest {
            for (state, step) in states.iter_mut().zip(&steps) {
                *state = step.advance(*state, 0.0, 0.0);
            }
            observe(&states, 0.0, velocity);
        }
        let ground_motion =
            FloorMotion { floor: 0, record: ground.clone(), pfa: pga(ground), pfv: crate::intensity::pgv(ground) };
        let floors = histories.into_iter().zip(1..).map(|(History { acceleration, pfv, .. }, floor)| {
            let title = format!("{}, floor {floor}", ground.title);
            let record = Record { title, acceleration: acceleration.into(), ..ground.clone() };
            FloorMotion { floor, pfa: pga(&record), pfv, record }
        });
        std::iter::once(ground_motion).chain(floors).collect()
    }
}

impl Building {
    /// Says that the samples of a record are too far apart for the peaks of floors, which are those of their samples.
    pub fn undersampled(&self, ground: &Record) -> Option<String> {
        /// Least participation at a floor of a mode that counts.
        const NOTABLE: f64 = 0.1;
        /// Fewest samples in a period: the peak of a sine between ten of them is at most 5 % higher.
        const FEWEST: f64 = 10.0;
        let counts = |mode: &&Mode| mode.shape.iter().any(|at| (mode.participation * at).abs() >= NOTABLE);
        let fastest = self.modes().iter().filter(counts).map(|mode| mode.frequency).fold(0.0, f64::max);
        let step = ground.time_step;
        let samples = 1.0 / (fastest * step);
        (samples < FEWEST).then(|| {
            let missed = 100.0 * (1.0 - libm::cos(std::f64::consts::PI / samples.max(2.0)));
            format!(
                "{}: a step of {step} s for a mode of the building with {fastest:.3} Hz; peaks of floors between samples may be up to \
                 {missed:.0} % higher than PFA; expected a step of at most {:.2e} s, as by resample",
                ground.title,
                1.0 / (FEWEST * fastest)
            )
        })
    }
}

/// Absolute acceleration of a mode's oscillator (m/s²): that of its spring and dashpot.
fn acceleration(mode: &Mode, [u, u_dot]: [f64; 2]) -> f64 {
    let omega = mode.omega();
    -omega * (omega * u + 2.0 * mode.damping * u_dot)
}

/// The motion of a floor so far.
#[derive(Clone, Default)]
struct History {
    acceleration: Vec<f64>,
    /// Absolute velocity at the last sample (m/s).
    velocity: f64,
    pfv: f64,
}

impl History {
    /// Appends a sample: absolute acceleration and velocity.
    fn push(&mut self, [acceleration, velocity]: [f64; 2], step: f64) {
        // The velocity has an extremum where the acceleration changes its sign between two samples.
        if let Some(&last) = self.acceleration.last().filter(|&last| last * acceleration < 0.0) {
            let extremum = self.velocity + 0.5 * last * step * last / (last - acceleration);
            self.pfv = self.pfv.max(extremum.abs());
        }
        self.pfv = self.pfv.max(velocity.abs());
        self.velocity = velocity;
        self.acceleration.push(acceleration);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::Damping;
    use crate::intensity::{near, record_of};

    fn tower(damping: &Damping) -> Building {
        Building::shear(&[3e5, 2e5, 2e5, 1e5], &[4e8, 3e8, 2e8, 1e8], damping).unwrap()
    }

    /// Stiffnesses in kN/m, and masses in tonnes.
    #[test]
    fn a_period_beyond_reason_is_doubted() {
        let of = |masses: f64, stiffnesses: f64| {
            let [masses, stiffnesses] = [[3e5, 2e5].map(|m| masses * m), [4e8, 3e8].map(|k| stiffnesses * k)];
            Building::shear(&masses, &stiffnesses, &Damping::All(0.05)).unwrap().doubt()
        };
        assert_eq!(of(1.0, 1.0), None);
        assert_eq!(of(1.0, 1e-2), None);
        let soft = of(1.0, 1e-3).unwrap();
        assert!(
            soft.starts_with("the building of 2 floors has a first period of 7.96 s")
                && soft.contains("expected 0.03 to 3.4 s"),
            "{soft}"
        );
        assert!(of(1e-3, 1.0).unwrap().contains("of 0.00796 s; expected 0.03"));
    }

    /// The floor of one storey follows the closed form under a sudden constant acceleration a. It moves with
    /// `a [1 − exp(−ζωt) (cos ω_d t − ζ/√(1−ζ²) sin ω_d t)]`.
    #[test]
    fn samples_too_far_apart_for_a_mode_are_doubted() {
        // 12 Hz in steps of 0.02 s: a cosine between two samples has 1/cos(0.24 π) their value.
        let doubt = |hertz: f64| {
            let building = Building::of_modes(&[hertz], &[1.0], &[vec![1.0]], &Damping::All(0.05)).unwrap();
            building.undersampled(&record_of(&[1.0, 2.0], 0.02))
        };
        assert_eq!(doubt(4.9), None);
        let found = doubt(12.0).unwrap();
        assert!(found.contains("may be up to 27 % higher than PFA; expected a step of at most 8.33e-3 s"), "{found}");
    }

    #[test]
    fn one_storey_under_a_step_has_the_closed_form() {
        let (zeta, omega, step) = (0.08_f64, 12.0, 0.02);
        let building = Building::shear(&[2.0], &[2.0 * omega * omega], &Damping::All(zeta)).unwrap();
        let floor = &building.floor_motions(&record_of(&[3.0; 200], step))[1];
        let root = (1.0 - zeta * zeta).sqrt();
        for (i, a) in floor.record.acceleration[..200].iter().enumerate() {
            let t = i as f64 * step;
            let (sin, cos) = (root * omega * t).sin_cos();
            let exact = 3.0 * (1.0 - (-zeta * omega * t).exp() * (cos - zeta / root * sin));
            assert!((a - exact).abs() < 1e-12, "{t} s: {a}, exactly {exact}");
        }
    }

    /// The effective masses add up to the mass of the building. Σ Γφ = 1 at each floor, and modes are orthogonal.
    #[test]
    fn participation_adds_up() {
        let building = tower(&Damping::All(0.05));
        let masses = [3e5, 2e5, 2e5, 1e5];
        for floor in 0..4 {
            near(building.modes().iter().map(|mode| mode.participation * mode.shape[floor]).sum(), 1.0, 1e-13);
        }
        let effective_mass =
            |mode: &Mode| mode.participation * mode.shape.iter().zip(masses).map(|(x, mass)| x * mass).sum::<f64>();
        near(building.modes().iter().map(effective_mass).sum(), 8e5, 1e-13);
        let frequencies: Vec<f64> = building.modes().iter().map(|mode| mode.frequency).collect();
        assert!(frequencies.is_sorted(), "{frequencies:?}");
    }

    /// A very stiff building moves like the ground. Given modes make the same floors as the shear building that has them.
    #[test]
    fn stiff_buildings_follow_the_ground_and_given_modes_repeat_their_building() {
        let samples: Vec<f64> = (0..400).map(|i| (0.05 * f64::from(i)).sin() * (0.011 * f64::from(i)).cos()).collect();
        let ground = record_of(&samples, 0.01);
        let stiff = Building::shear(&[1.0; 3], &[1e10; 3], &Damping::All(0.05)).unwrap();
        for motion in stiff.floor_motions(&ground) {
            let exact = ground.acceleration.iter().zip(motion.record.acceleration.iter());
            assert!(
                exact.clone().count() == 400 && exact.clone().all(|(a, b)| (a - b).abs() < 1e-4),
                "{}",
                motion.floor
            );
            near(motion.pfv, crate::intensity::pgv(&ground), 1e-4);
        }
        let building = tower(&Damping::Rayleigh(0.04, [1, 3]));
        near(building.modes()[0].damping, 0.04, 1e-14);
        near(building.modes()[2].damping, 0.04, 1e-14);
        let list = |property: fn(&Mode) -> f64| building.modes().iter().map(property).collect::<Vec<f64>>();
        let shapes: Vec<Vec<f64>> = building.modes().iter().map(|mode| mode.shape.clone()).collect();
        let damping = Damping::Each(list(|mode| mode.damping));
        let repeated =
            Building::of_modes(&list(|mode| mode.frequency), &list(|mode| mode.participation), &shapes, &damping);
        assert_eq!(repeated.unwrap().floor_motions(&ground), building.floor_motions(&ground));
    }

    #[test]
    fn invalid_buildings_are_refused() {
        let all = Damping::All(0.05);
        for (found, expected) in [
            (Building::shear(&[], &[], &all), "floor_masses has 0 floors; expected 1 to 500"),
            (Building::shear(&[1.0, -1.0], &[1.0; 2], &all), "floor_masses has the value -1; expected masses > 0 kg"),
            (
                Building::shear(&[1.0], &[1.0; 2], &all),
                "storey_stiffnesses has 2 values; expected 1, one below each floor",
            ),
            (
                Building::shear(&[1.0], &[1.0], &Damping::All(1.0)),
                "damping gives mode 1 the ratio 1; expected 0.001 to less than 1",
            ),
            (
                Building::shear(&[1.0; 2], &[1.0; 2], &Damping::Rayleigh(0.05, [1, 3])),
                "rayleigh has modes = [1, 3]; expected two different modes, 1 to 2",
            ),
            (
                Building::of_modes(&[1.0, 2.0], &[1.0, 0.2], &[vec![1.0], vec![1.0, 2.0]], &all),
                "shapes has lists of 1 and 2 values; expected one value per floor",
            ),
        ] {
            assert_eq!(found.unwrap_err().to_string(), expected);
        }
    }
}
