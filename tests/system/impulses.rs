//! Landings, grips and changes of pivot, against conservation of momentum and prescribed velocities.

use rocking_block::block::{Block, Corner, Foot, Foundation, Regime};
use rocking_block::excitation::Forcing;
use rocking_block::system::dynamics::instant;
use rocking_block::system::impact::{self, Velocities};
use rocking_block::system::instant::Footing;

use crate::blocks::uneven;

const BEFORE: [Velocities; 3] = [
    Velocities { u_dot: 0.7, v_dot: -1.1, theta_dot: 0.5 },
    Velocities { u_dot: -0.4, v_dot: -0.6, theta_dot: -1.2 },
    Velocities { u_dot: 1.3, v_dot: 0.2, theta_dot: 0.3 },
];

const ANGLES: [f64; 4] = [0.0, 0.02, -0.2, 0.35];

/// Returns a point of the base, `along` to the right of its middle, relative to the centre of mass.
fn arm(block: &Block, theta: f64, along: f64) -> [f64; 2] {
    let (sin, cos) = theta.sin_cos();
    [along * cos - block.h * sin, -along * sin - block.h * cos]
}

/// Returns the velocity of a point: to the right, and up. θ̇ is clockwise.
fn velocity(of: Velocities, [x, z]: [f64; 2]) -> [f64; 2] {
    [of.u_dot + z * of.theta_dot, of.v_dot - x * of.theta_dot]
}

fn corner(block: &Block, corner: Corner) -> f64 {
    match corner {
        Corner::Left => -block.b,
        Corner::Right => block.b,
    }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-13
}

/// Returns the impulses per mass of a change, and the rotation that they leave unexplained.
///
/// The horizontal impulse acts at `h_at`, the vertical one at `n_at`.
fn impulses(block: &Block, [before, after]: [Velocities; 2], h_at: [f64; 2], n_at: [f64; 2]) -> ([f64; 2], f64) {
    let (h, n) = (after.u_dot - before.u_dot, after.v_dot - before.v_dot);
    let turn = h_at[1] * h - n_at[0] * n;
    ([h, n], block.i0 * (after.theta_dot - before.theta_dot) - turn)
}

/// Calls `check` for corners, rotations and velocities before an impact.
fn for_every_landing(mut check: impl FnMut(&Block, Corner, f64, Velocities)) {
    let block = uneven(Foundation::Viscoelastic, 0.2);
    for on in Corner::BOTH {
        for theta in ANGLES {
            BEFORE.into_iter().for_each(|before| check(&block, on, theta, before));
        }
    }
}

#[test]
fn a_landing_with_grip_stops_the_corner_horizontally() {
    for_every_landing(|block, on, theta, before| {
        let at = arm(block, theta, corner(block, on));
        for rate in [0.0, 0.4, -0.1] {
            let after = impact::landing_with_grip(block, on, theta, before, rate);
            let [along, up] = velocity(after, at);
            assert!(close(along, 0.0) && close(up, rate), "{on:?} {theta} {before:?}: {along} {up}");
            let (_, rest) = impulses(block, [before, after], at, at);
            assert!(close(rest, 0.0), "{on:?} {theta} {before:?}: {rest}");
        }
    });
}

#[test]
fn a_landing_without_grip_has_a_vertical_impulse_only() {
    for_every_landing(|block, on, theta, before| {
        let at = arm(block, theta, corner(block, on));
        for rate in [0.0, 0.4] {
            let after = impact::landing_without_grip(block, on, theta, before, rate);
            assert!(close(velocity(after, at)[1], rate), "{on:?} {theta} {before:?}");
            let ([horizontal, _], rest) = impulses(block, [before, after], at, at);
            assert!(horizontal == 0.0 && close(rest, 0.0), "{on:?} {theta} {before:?}: {horizontal} {rest}");
        }
    });
}

#[test]
fn a_landing_on_both_gives_each_corner_its_rate() {
    let block = uneven(Foundation::Viscoelastic, 0.2);
    for theta in ANGLES {
        for before in BEFORE {
            for rates in [[0.0, 0.0], [0.3, -0.2], [0.1, 0.4]] {
                let ([left, right], after) = impact::landing_on_both(&block, theta, before, rates);
                let arms = [-block.b, block.b].map(|along| arm(&block, theta, along));
                let middle = arm(&block, theta, 0.0);
                assert!(close(velocity(after, middle)[0], 0.0), "the middle of the base is held");
                for (at, rate) in arms.into_iter().zip(rates) {
                    assert!(close(velocity(after, at)[1], rate), "{theta} {before:?}");
                }
                assert!(close(left + right, after.v_dot - before.v_dot), "{theta} {before:?}");
                let horizontal = after.u_dot - before.u_dot;
                let turn = middle[1] * horizontal - arms[0][0] * left - arms[1][0] * right;
                assert!(close(block.i0 * (after.theta_dot - before.theta_dot), turn), "{theta} {before:?}");
            }
        }
    }
}

#[test]
fn a_grip_is_a_horizontal_impulse_that_stops_the_foot() {
    let block = uneven(Foundation::Viscoelastic, 0.2);
    for (regime, along) in
        [(Regime::FullContact, 0.0), (Regime::TiltingLeft, -block.b), (Regime::TiltingRight, block.b)]
    {
        for theta in ANGLES {
            for before in BEFORE {
                let after = impact::grip(&block, regime, theta, before);
                let at = arm(&block, theta, along);
                assert!(close(velocity(after, at)[0], 0.0), "{regime} {theta} {before:?}");
                let ([_, vertical], rest) = impulses(&block, [before, after], at, at);
                assert!(vertical == 0.0 && close(rest, 0.0), "{regime} {theta} {before:?}");
            }
        }
    }
}

#[test]
fn a_landing_beside_a_standing_corner_conserves_momentum() {
    for_every_landing(|block, on, theta, before| {
        // The other corner stands, without horizontal velocity.
        let standing = arm(block, theta, -corner(block, on));
        let before = Velocities { u_dot: -standing[1] * before.theta_dot, ..before };
        let at = arm(block, theta, corner(block, on));
        let (v_dot, theta_dot) = impact::landing(block, on, theta, before.v_dot, before.theta_dot);
        let middle = arm(block, theta, 0.0);
        let after = Velocities { u_dot: -middle[1] * theta_dot, v_dot, theta_dot };
        let [rate, now] = [before, after].map(|velocities| velocity(velocities, at)[1]);
        assert!(close(now, block.epsilon * rate), "{on:?} {theta} {before:?}");
        let (_, rest) = impulses(block, [before, after], at, at);
        assert!(close(rest, 0.0), "{on:?} {theta} {before:?}: {rest}");
        assert!(close(impact::corner_rate(block, on, theta, v_dot, theta_dot), now));
        assert!(close(impact::height_over(block, Foot::Corner(on), theta), -at[1]));
    });
}

/// The landing loss of a corner guided vertically is the difference of kinetic energies.
#[test]
fn a_landing_of_a_guided_corner_takes_the_landing_loss() {
    for_every_landing(|block, on, theta, before| {
        let at = arm(block, theta, corner(block, on));
        let guided = |v_dot: f64, theta_dot: f64| Velocities { u_dot: -at[1] * theta_dot, v_dot, theta_dot };
        let before = guided(before.v_dot, before.theta_dot);
        let rate = velocity(before, at)[1];
        // J at the corner: Δv̇ = J, (i0 + z²) Δθ̇ = −x J, and the rate is multiplied by −ε.
        let turning = block.i0 + at[1] * at[1];
        let impulse = (block.epsilon - 1.0) * rate / (1.0 + at[0] * at[0] / turning);
        let after = guided(before.v_dot + impulse, before.theta_dot - at[0] * impulse / turning);
        assert!(close(velocity(after, at)[1], block.epsilon * rate));
        let lost = before.kinetic(block) - after.kinetic(block);
        assert!(close(impact::landing_loss(block, on, theta, rate), lost), "{on:?} {theta}: {lost}");
    });
}

/// A horizontal impulse that stops a corner sliding on the rigid base throws it up.
#[test]
fn a_grip_on_the_rigid_base_throws_the_corner_up() {
    let mut block = uneven(Foundation::Viscoelastic, 0.2);
    block.body.foundation = Foundation::Rigid;
    for on in Corner::BOTH {
        for theta in ANGLES {
            for before in BEFORE {
                let footing = Footing::Free { u: 0.3, u_dot: before.u_dot };
                let state = [theta, before.theta_dot, 0.0, 0.0];
                let x = instant(&block, Regime::on(on), state, footing, Forcing::default());
                let before = Velocities { v_dot: x.v_dot, ..before };
                let at = arm(&block, theta, corner(&block, on));
                assert!(close(velocity(before, at)[1], 0.0), "{on:?} {theta} {before:?}");
                let after = impact::grip(&block, Regime::on(on), theta, before);
                let thrown = impact::thrown_by_grip(&block, on, &x);
                assert!(close(velocity(after, at)[1], thrown), "{on:?} {theta} {before:?}: {thrown}");
            }
        }
    }
}

/// A landing with friction keeps the momenta, the vertical restitution and the limit of friction, and stops the foot if that allows it.
#[test]
fn landings_with_friction() {
    let (mut stopped, mut slid) = (0, 0);
    for friction in [0.05, 0.3, 1.0, 1e6] {
        for (on, at) in [(Corner::Left, -1.0), (Corner::Right, 1.0)] {
            for foot in [Foot::Middle, Foot::Corner(on)] {
                for theta in ANGLES {
                    for before in BEFORE {
                        let mut block = uneven(Foundation::Viscoelastic, 0.1);
                        block.body.friction = friction;
                        let landing = arm(&block, theta, at * block.b);
                        let rate = velocity(before, landing)[1];
                        if rate >= 0.0 {
                            continue;
                        }
                        let after = impact::landing_with_friction(&block, on, foot, theta, before, -0.3 * rate);
                        let [h, n] = [after.u_dot - before.u_dot, after.v_dot - before.v_dot];
                        let turn = block.i0 * (after.theta_dot - before.theta_dot);
                        let size = 1.0 + h.abs() + n.abs();
                        // The impulse acts at the corner.
                        assert!((turn - (landing[1] * h - landing[0] * n)).abs() < 1e-12 * size * block.r0);
                        assert!((velocity(after, landing)[1] + 0.3 * rate).abs() < 1e-12 * size);
                        assert!(h.abs() <= friction * n * (1.0 + 1e-12) + 1e-13, "{h} {n}");
                        let foot = if foot == Foot::Middle { arm(&block, theta, 0.0) } else { landing };
                        let [was, is] = [before, after].map(|velocities| velocity(velocities, foot)[0]);
                        if is.abs() < 1e-12 * size {
                            stopped += 1;
                        } else {
                            assert!((h.abs() - friction * n).abs() < 1e-12 * size, "it slides at less than the limit");
                            assert!(is * h < 0.0 || was * is < 0.0, "friction drives the foot: {was} {is} {h}");
                            slid += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(stopped > 20 && slid > 20, "{stopped} {slid}");
}
