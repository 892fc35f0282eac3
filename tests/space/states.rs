//! Saved states continue with the same bits.

use rocking_block::space::{SpaceBody, SpaceInputs, SpaceRun, SpaceState};

use crate::{advance, run, two_axis};

#[test]
fn a_saved_state_continues_with_the_same_bits() {
    let (parameters, pulses) = two_axis(0.4);
    let mut run = run(SpaceBody::new(&parameters).unwrap(), 1e-9, pulses, &crate::AT_REST);
    for part in 1..=20 {
        advance(&mut run, 0.1 * f64::from(part), &SpaceInputs::default());
        let saved = postcard::to_allocvec(run.state()).unwrap();
        let state: SpaceState = postcard::from_bytes(&saved).unwrap();
        assert_eq!(&state, run.state());
        let mut resumed = SpaceRun::resume(run.setup().clone(), state).unwrap();
        let mut original = run.clone();
        for run in [&mut resumed, &mut original] {
            let until = run.time() + 0.7;
            advance(run, until, &SpaceInputs::default());
        }
        assert_eq!(resumed.state(), original.state());
    }
    assert!(run.state().counts.landings > 2);
}

#[test]
fn a_state_of_another_block_is_refused() {
    let (parameters, pulses) = two_axis(0.4);
    let run = run(SpaceBody::new(&parameters).unwrap(), 1e-9, pulses, &crate::AT_REST);
    let broken = |change: &dyn Fn(&mut SpaceState)| {
        let mut state = run.state().clone();
        change(&mut state);
        SpaceRun::resume(run.setup().clone(), state).map(|_| ()).unwrap_err()
    };
    assert_eq!(broken(&|state| state.contacts.truncate(3)), "the state has 3 feet; expected 4");
    assert_eq!(broken(&|state| state.numbers[5] = f64::NAN), "the state has the number NaN; expected finite ones");
}
