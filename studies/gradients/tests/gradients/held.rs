//! Blocks whose run has ended.

use rocking_block::simulation::{OnOverturning, Settings, Simulation};
use rocking_gradients::{Follower, Varied, advance};

use crate::cases::reference;

/// A block that overturns is held, and waits, or its run ends there.
#[test]
fn a_held_block_waits() {
    const UNTIL: f64 = 60.0;
    let mut run = reference("reference", "free_rigid");
    run.parameters.initial.theta = 1.01 * run.value("alpha");
    let at_end = [OnOverturning::Hold, OnOverturning::Terminate].map(|on_overturning| {
        let (settings, ground) = (Settings { on_overturning, ..Settings::default() }, &run.ground);
        let inputs = ground.inputs_from(0.0).0;
        let parameters = &run.parameters;
        let mut plain = Simulation::new(run.block(), settings, parameters.pulse, &parameters.initial, 0.0, &inputs);
        let mut simulation = plain.clone();
        let varied = Varied::with_respect_to(parameters, simulation.block(), &["initial.theta"]).unwrap();
        let mut follower = Follower::new(&simulation, varied, &inputs);
        advance(&mut simulation, std::slice::from_mut(&mut follower), UNTIL, &inputs).unwrap();
        plain.advance(UNTIL, &inputs, &mut |_| ()).unwrap();
        assert!(plain.ending().is_some(), "{plain:?}");
        assert_eq!((simulation.ending(), simulation.pose()), (plain.ending(), plain.pose()));
        assert_eq!(follower.pose().time.re, plain.time());
        plain.time()
    });
    assert!(at_end[0] == UNTIL && at_end[1] < UNTIL, "{at_end:?}");
}
