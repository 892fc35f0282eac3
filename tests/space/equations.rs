//! Derivatives of the equations of motion, and their balance of power.

use rocking_block::numerics::dual::Dual;
use rocking_block::space::equations::SpaceEquations;
use rocking_block::space::excitation::SpaceExcitation;
use rocking_block::space::motion::{Turn, dimension, moving as moving_numbers, works};
use rocking_block::space::{SpaceBody, SpaceInitial, SpaceInputs, SpaceRun};

use crate::{STILL, advance, held, run, two_axis};

/// A block in the middle of its motion, with feet that slide, stick and are lifted.
fn moving() -> (SpaceRun, SpaceInputs) {
    let (parameters, pulses) = two_axis(0.4);
    let mut run = run(SpaceBody::new(&parameters).unwrap(), 1e-9, pulses, &crate::AT_REST);
    advance(&mut run, 0.9, &SpaceInputs::default());
    (run, held([0.3, -0.2, 0.4]))
}

fn rates(run: &SpaceRun, inputs: &SpaceInputs, state: &[f64]) -> Vec<f64> {
    let excitation = SpaceExcitation::new(run.time(), inputs, &STILL, run.body().mass);
    let equations = SpaceEquations { body: run.body(), contacts: &run.state().contacts, excitation: &excitation };
    let mut rates = vec![0.0; state.len()];
    equations.rates(run.time(), state, &mut rates);
    rates
}

/// Duals give the derivatives with respect to each number of the state that differences approach.
#[test]
fn duals_are_the_derivatives_with_respect_to_states() {
    let (run, inputs) = moving();
    let state = &run.state().numbers;
    let excitation = SpaceExcitation::new(run.time(), &inputs, &STILL, run.body().mass);
    let equations = SpaceEquations { body: run.body(), contacts: &run.state().contacts, excitation: &excitation };
    let touching = run.state().contacts.iter().filter(|contact| contact.touches()).count();
    assert!((1..4).contains(&touching), "{touching} feet touch");
    for number in 0..state.len() {
        let duals: Vec<_> =
            state.iter().enumerate().map(|(i, &x)| Dual::new(x, if i == number { 1.0 } else { 0.0 })).collect();
        let mut exact = vec![Dual::default(); state.len()];
        equations.rates(Dual::from(run.time()), &duals, &mut exact);
        const STEP: f64 = 1e-6;
        let [below, above] = [-STEP, STEP].map(|step| {
            let mut moved = state.clone();
            moved[number] += step;
            rates(&run, &inputs, &moved)
        });
        for i in 0..state.len() {
            let difference = (above[i] - below[i]) / (2.0 * STEP);
            let scale = 1.0 + difference.abs();
            assert!(
                (exact[i].eps - difference).abs() < 1e-5 * scale,
                "rate {i} by {number}: {:?}, {difference}",
                exact[i]
            );
            // Duals divide by multiplying with the inverse.
            let plain = rates(&run, &inputs, state)[i];
            assert!((exact[i].re - plain).abs() <= 1e-13 * (1.0 + plain.abs()), "rate {i}: {:?}, {plain}", exact[i]);
        }
    }
}

/// The rates do not depend on the length of the quaternion.
#[test]
fn the_norm_of_the_quaternion_has_no_effect() {
    let (run, inputs) = moving();
    let state = &run.state().numbers;
    let mut longer = state.clone();
    longer[3..7].iter_mut().for_each(|x| *x *= 4.0);
    let (found, expected) = (rates(&run, &inputs, &longer), rates(&run, &inputs, state));
    assert_eq!(found[7..], expected[7..]);
    assert_eq!(Turn::of(&longer).half_tilt_square(), Turn::of(state).half_tilt_square());
}

/// Works and slips are sums over time, on which no rate depends: steps leave them out of their stages.
#[test]
fn sums_over_time_have_no_effect() {
    let (run, inputs) = moving();
    let state = &run.state().numbers;
    let mut other = state.clone();
    other[moving_numbers(4)..].iter_mut().for_each(|sum| *sum += 7.0);
    assert_eq!(other[moving_numbers(4)..].len(), 3 + 4);
    assert_eq!(rates(&run, &inputs, &other), rates(&run, &inputs, state));
}

/// The block that stands on its supports has no rates.
#[test]
fn the_standing_block_is_in_equilibrium() {
    let (mut parameters, _) = two_axis(0.4);
    parameters.eccentricity = [0.2, -0.3];
    let body = SpaceBody::new(&parameters).unwrap();
    for initial in [crate::AT_REST, SpaceInitial { vertical: None, ..crate::AT_REST }] {
        let run = run(body.clone(), 1e-9, STILL, &initial);
        assert_eq!(run.state().numbers.len(), dimension(4));
        for (i, rate) in rates(&run, &SpaceInputs::default(), &run.state().numbers).into_iter().enumerate() {
            assert!(rate.abs() < 1e-12, "rate {i} is {rate:e}");
        }
        assert!(run.energies().stored.total().abs() < 1e-12);
    }
}

/// The energy changes at the rate of the works.
#[test]
fn energy_changes_by_the_works() {
    let (run, inputs) = moving();
    let mut next = run.clone();
    let before = run.energies();
    next.advance(run.time() + 1e-4, &SpaceInputs { time: run.time(), ..inputs }, &mut |event| panic!("{event:?}"))
        .unwrap();
    let after = next.energies();
    let balance = |run: &SpaceRun| {
        let [input, dashpots, slip] = works(&run.state().numbers, 4);
        input - dashpots - slip
    };
    let (change, expected) = (after.stored.total() - before.stored.total(), balance(&next) - balance(&run));
    assert!((change - expected).abs() < 1e-10, "{change:e}, not {expected:e}");
    assert!(change.abs() > 1e-8);
}
