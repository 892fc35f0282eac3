//! Random initial conditions and parameters, in ranges with all regimes.

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::Sizes;

/// A Real input or parameter.
pub struct Known {
    pub name: &'static str,
    /// Lower bound, if it is zero; otherwise `None`.
    pub least: Option<f64>,
}

/// All known variables of FMI 2.0.
pub const KNOWNS: [Known; 74] = {
    const fn free(name: &'static str) -> Known {
        Known { name, least: None }
    }
    const fn from_zero(name: &'static str) -> Known {
        Known { name, least: Some(0.0) }
    }
    [
        free("a_gx"),
        free("a_gz"),
        free("F_x"),
        free("F_z"),
        free("M_y"),
        free("dimensionless.alpha"),
        free("dimensionless.p"),
        free("dimensionless.eta"),
        from_zero("dimensionless.xi_v"),
        free("physical.width"),
        free("physical.height"),
        from_zero("physical.center_height"),
        from_zero("physical.inertia"),
        free("physical.K"),
        from_zero("physical.C"),
        free("mass"),
        free("gamma"),
        free("eccentricity"),
        from_zero("friction"),
        from_zero("epsilon"),
        free("g"),
        from_zero("restitution_factor"),
        free("initial.theta"),
        free("initial.theta_dot"),
        free("initial.v"),
        free("initial.v_dot"),
        free("pulse.amplitude"),
        free("pulse.period"),
        free("pulse.start"),
        free("pulse.phase"),
        free("pulse.cycles"),
        free("record.scale"),
        free("record.start"),
        from_zero("record.dt"),
        free("tie_1.block_x"),
        free("tie_1.block_z"),
        free("tie_1.ground_x"),
        free("tie_1.ground_z"),
        from_zero("tie_1.stiffness"),
        from_zero("tie_1.pretension"),
        from_zero("tie_1.slack"),
        from_zero("tie_1.damping"),
        from_zero("tie_1.strength"),
        from_zero("tie_1.yield_force"),
        from_zero("tie_1.hardening"),
        free("tie_2.block_x"),
        free("tie_2.block_z"),
        free("tie_2.ground_x"),
        free("tie_2.ground_z"),
        from_zero("tie_2.stiffness"),
        from_zero("tie_2.pretension"),
        from_zero("tie_2.slack"),
        from_zero("tie_2.damping"),
        from_zero("tie_2.strength"),
        from_zero("tie_2.yield_force"),
        from_zero("tie_2.hardening"),
        free("damper_1.block_x"),
        free("damper_1.block_z"),
        free("damper_1.ground_x"),
        free("damper_1.ground_z"),
        from_zero("damper_1.stiffness"),
        from_zero("damper_1.damping"),
        from_zero("damper_1.strength"),
        from_zero("damper_1.yield_force"),
        from_zero("damper_1.hardening"),
        free("damper_2.block_x"),
        free("damper_2.block_z"),
        free("damper_2.ground_x"),
        free("damper_2.ground_z"),
        from_zero("damper_2.stiffness"),
        from_zero("damper_2.damping"),
        from_zero("damper_2.strength"),
        from_zero("damper_2.yield_force"),
        from_zero("damper_2.hardening"),
    ]
};

/// Names of the parameters of a tie, or of a damper, which has neither pretension nor slack.
macro_rules! link {
    ($link:literal, $($name:literal),*) => {
        &[$(concat!($link, ".", $name)),*]
    };
    (tie $link:literal) => {
        link!($link, "block_x", "block_z", "ground_x", "ground_z", "stiffness", "damping", "strength", "yield_force", "hardening", "pretension", "slack")
    };
    (damper $link:literal) => {
        link!($link, "block_x", "block_z", "ground_x", "ground_z", "stiffness", "damping", "strength", "yield_force", "hardening")
    };
}

/// Parameters of the ties and dampers.
const LINKS: [&[&str]; 4] =
    [link!(tie "tie_1"), link!(tie "tie_2"), link!(damper "damper_1"), link!(damper "damper_2")];

/// Initial values and parameters by name.
#[derive(Clone, Debug)]
pub struct Draw {
    pub values: Vec<(&'static str, f64)>,
}

impl Draw {
    /// Draws the next values.
    pub fn next(runner: &mut TestRunner) -> Draw {
        strategy().new_tree(runner).unwrap().current()
    }

    /// Returns the value of a variable.
    pub fn of(&self, name: &str) -> f64 {
        self.values.iter().find(|(of, _)| *of == name).unwrap_or_else(|| panic!("no {name}")).1
    }

    /// Returns the scale of a known: a change by this amount is of order one.
    pub fn measure(&self, known: &str, sizes: &Sizes) -> f64 {
        let mass = self.of("mass");
        match known {
            "a_gx" | "a_gz" | "pulse.amplitude" | "pulse.phase" => 1.0,
            "F_x" | "F_z" => mass,
            "M_y" => mass * sizes.r0,
            // On stiff supports a displacement much smaller than the block changes a whole reaction.
            "initial.theta" | "initial.v" => 0.01,
            "physical.width" | "physical.height" => 0.1 * self.of(known),
            "physical.center_height" => 0.1 * self.of(known).max(1.0),
            "physical.inertia" => self.of(known).max(mass),
            "eccentricity" => 0.1 * sizes.half_width,
            "pulse.start" | "record.start" => 0.1,
            "initial.theta_dot" | "initial.v_dot" => 0.5,
            "epsilon" => 0.5,
            "friction" => 0.1,
            _ if known.starts_with("tie_") || known.starts_with("damper_") => {
                match known.split_once('.').map(|(_, of)| of) {
                    Some("slack") => 0.01,
                    Some("hardening") => 0.1,
                    Some("block_x" | "block_z" | "ground_x" | "ground_z") => 0.1,
                    _ => self.of(known).max(0.1 * mass),
                }
            }
            "dimensionless.xi_v" | "restitution_factor" | "record.scale" => self.of(known).max(0.1),
            "physical.C" => self.of(known).max(0.1 * mass),
            _ => self.of(known),
        }
    }
}

/// Numbers from 0 to 1 that determine a draw.
const NUMBERS: usize = 160;

#[expect(clippy::too_many_lines, reason = "a draw of all variables, in one order")]
fn strategy() -> impl Strategy<Value = Draw> {
    prop::collection::vec(0.0..1.0_f64, NUMBERS).prop_map(|numbers| {
        let mut numbers = numbers.into_iter();
        let mut next = || numbers.next().unwrap();
        let mut values = Vec::new();
        let mut between = |least: f64, most: f64| least + (most - least) * next();
        let alpha = between(0.1, 0.9);
        let mass = between(10.0, 1000.0);
        let mut item = |last: f64| between(1.0, last + 1.0).floor();
        values.extend([
            ("parameterization", item(2.0)),
            ("foundation", item(2.0)),
            ("on_separation", item(3.0)),
            ("on_overturning", item(2.0)),
            ("pulse.shape", item(10.0)),
            ("initial.settled", item(2.0) - 1.0),
        ]);
        // Some are sometimes exactly zero.
        let step = between(0.3, 0.4);
        let mut or_zero = |value: f64| if between(0.0, 1.0) < 0.15 { 0.0 } else { value };
        let theta = or_zero(1.0);
        let theta_dot = or_zero(1.0);
        let damping = or_zero(1.0);
        let [center_height, inertia] =
            [between(0.0, 1.0), between(0.0, 1.0)].map(|chance| if chance < 0.5 { 0.0 } else { 1.0 });
        let frequency = between(0.5, 2.5);
        let (gamma, g, width) = (between(0.5, 4.5), between(2.0, 12.0), between(0.5, 2.5));
        let half_width = if values[0].1 == 2.0 {
            0.5 * width
        } else {
            gamma / (gamma + 1.0) * g / (frequency * frequency) * alpha.sin()
        };
        let uneven = if between(0.0, 1.0) < 0.3 { 0.0 } else { between(-0.5, 0.5) };
        values.extend([
            ("physical.center_height", center_height * between(1.0, 4.0)),
            ("physical.inertia", inertia * mass * between(0.3, 4.0)),
            ("eccentricity", uneven * half_width),
            ("dimensionless.alpha", alpha),
            ("dimensionless.p", frequency),
            ("dimensionless.eta", between(3.0, 60.0)),
            ("dimensionless.xi_v", damping * between(0.01, 1.0)),
            ("physical.width", width),
            ("physical.height", between(2.5, 7.0)),
            ("physical.K", mass * between(20.0, 5000.0)),
            ("physical.C", damping * mass * between(0.1, 10.0)),
            ("mass", mass),
            ("gamma", gamma),
            ("epsilon", between(0.01, 0.99)),
            ("g", g),
            ("restitution_factor", between(0.3, 0.9)),
            ("initial.theta", theta * alpha * between(-0.5, 0.5)),
            ("initial.theta_dot", theta_dot * between(-0.5, 0.5)),
            ("initial.v", between(-0.2, 0.2)),
            ("initial.v_dot", between(-1.0, 1.0)),
            ("pulse.amplitude", between(-2.0, 2.0)),
            ("pulse.period", between(1.0, 2.0)),
            // Most pulses have begun, none at this instant.
            ("pulse.start", if between(0.0, 1.0) < 0.1 { 0.3 } else { between(-0.9, -0.02) }),
            ("record.scale", between(0.2, 1.2)),
            // Between two samples.
            ("record.start", -step * (between(0.0, 3.0).floor() + between(0.05, 0.95))),
            ("record.dt", step),
            ("a_gx", between(-1.5, 1.5)),
            ("a_gz", between(-1.5, 1.5)),
            ("F_x", mass * between(-0.5, 0.5)),
            ("F_z", mass * between(-0.5, 0.5)),
            ("M_y", mass * between(-0.5, 0.5)),
        ]);
        // Below that at which a corner may jam on the rigid base.
        let rough = if inertia > 0.0 { 0.24 } else { 0.7 };
        let plain = between(0.0, 1.0) < 0.4;
        let friction = if plain || between(0.0, 1.0) < 0.4 { 0.0 } else { between(0.02, rough) };
        values.push(("friction", friction));
        let ties = if plain { 0.0 } else { between(-1.0, 3.0).floor() };
        let dampers = if plain { 0.0 } else { between(-2.0, 3.0).floor() };
        let counts = [ties, ties, dampers, dampers];
        for ((names, i), count) in LINKS.into_iter().zip([0.0, 1.0, 0.0, 1.0]).zip(counts) {
            let [zero_or, slack, brittle, yields] = [1.0; 4].map(|most| between(0.0, most) < 0.5);
            let mut drawn = [
                between(-1.0, 1.0) * half_width,
                between(0.0, 4.0),
                between(-4.0, 4.0) * half_width,
                between(-3.0, -0.8),
                mass * between(0.5, 50.0),
                mass * between(0.05, 2.0),
                mass * between(0.5, 20.0),
                mass * between(0.05, 3.0),
                between(0.05, 0.6),
                mass * between(0.1, 3.0),
                between(0.0, 0.05),
            ];
            // A pretension above the strength is refused.
            drawn[6] = drawn[6].max(1.2 * drawn[9]);
            let has = [true, true, true, true, i < count, !zero_or, brittle, yields, yields, !slack, slack];
            for ((name, value), has) in names.iter().zip(drawn).zip(has) {
                values.push((name, if has { value } else { 0.0 }));
            }
        }
        values.extend([("pulse.phase", between(-3.0, 3.0)), ("pulse.cycles", between(1.2, 3.0))]);
        Draw { values }
    })
}
