//! Parameters of a block: relations and refusals.

use std::f64::consts::FRAC_PI_2;

use rocking_block::block::restraints::MAX_TIES;
use rocking_block::block::restraints::Tie;
use rocking_block::block::{
    Block, BlockError, BlockParameters, Body, Common, Corner, Dimensionless, Foundation, KelvinVoigt, Outline, Ratios,
    Springs, Supports,
};

const PAPER: Dimensionless =
    Dimensionless { alpha: 0.3, p: 1.7, supports: Supports::Viscoelastic(Ratios { eta: 35.0, xi_v: 0.15 }) };
const SIZES: Outline = Outline::Sizes { width: 1.3, height: 3.1, inertia: None };
const SPRINGS: Springs = Springs { stiffness: 2.0e4, damping: 150.0 };

/// The paper's block on other supports.
fn on(eta: f64, xi_v: f64) -> Dimensionless {
    Dimensionless { supports: Supports::Viscoelastic(Ratios { eta, xi_v }), ..PAPER }
}

/// The paper's block on a rigid base.
fn rigid(restitution_factor: f64) -> Dimensionless {
    Dimensionless { supports: Supports::Rigid { restitution_factor }, ..PAPER }
}

/// A block of these lengths on these supports.
fn sized(outline: Outline, springs: Springs) -> Result<Block, BlockError> {
    let supports = Supports::Viscoelastic(KelvinVoigt::Springs(springs));
    Block::new(&BlockParameters { outline, supports, common: common() })
}

fn common() -> Common {
    Common { mass: 7.0, gamma: 2.3, epsilon: 0.35, gravity: 9.7, ..Common::default() }
}

/// Both parameterizations of outline and supports satisfy the relations of docs/unit/model.md, in any combination.
#[test]
fn parameters_satisfy_the_relations_of_the_paper() {
    let paper = Block::from_dimensionless(&PAPER, &common()).unwrap();
    let slender_on_springs = sized(PAPER.with(&common()).outline, SPRINGS).unwrap();
    let sized_on_ratios = Block::new(&BlockParameters { outline: SIZES, ..PAPER.with(&common()) }).unwrap();
    let sized = sized(SIZES, SPRINGS).unwrap();
    assert_eq!((slender_on_springs.alpha, slender_on_springs.damping), (PAPER.alpha, 150.0));
    assert_eq!((2.0 * sized_on_ratios.b, sized_on_ratios.xi_v), (1.3, 0.15));
    assert_eq!((paper.alpha, paper.p, paper.xi_v), (PAPER.alpha, PAPER.p, 0.15));
    assert_eq!((2.0 * sized.b, 2.0 * sized.h, sized.stiffness, sized.damping), (1.3, 3.1, 2.0e4, 150.0));
    for block in [paper, sized, slender_on_springs, sized_on_ratios] {
        let Block {
            gamma,
            epsilon,
            alpha,
            stiffness,
            damping,
            body: Body { mass, gravity, r0, b, h, p, omega_v, xi_v, .. },
            ..
        } = block;
        let cos = (2.0 * alpha).cos();
        for (name, found, exact) in [
            ("b", b, r0 * alpha.sin()),
            ("h", h, r0 * alpha.cos()),
            ("I0", block.inertia(), mass * r0 * r0 / gamma),
            ("p", p, (gamma / (1.0 + gamma) * gravity / r0).sqrt()),
            ("K", stiffness, 0.5 * mass * omega_v * omega_v),
            ("C", damping, xi_v * mass * omega_v),
            ("eta", block.eta(), omega_v / p),
            ("delta_s", block.static_deflection(), mass * gravity / (2.0 * stiffness)),
            ("K/C", block.creep_rate, stiffness / damping),
            ("e_max", block.max_restitution(), (1.0 + gamma * cos) / (1.0 + gamma)),
            ("e", block.restitution(), (1.0 + gamma * epsilon + (1.0 - epsilon) * gamma * cos) / (1.0 + gamma)),
            ("theta_sep", block.separation_angle().sin(), (1.0 + gamma) / (gamma * block.eta().powi(2) * alpha.sin())),
        ] {
            assert!((found / exact - 1.0).abs() < 1e-14, "{name}: {found}, not {exact}");
        }
    }
    let soft = Block::from_dimensionless(&on(1.0, 0.15), &common()).unwrap();
    assert_eq!(soft.separation_angle(), FRAC_PI_2);
    let undamped = Block::from_dimensionless(&on(35.0, 0.0), &common()).unwrap();
    assert_eq!(undamped.creep_rate, f64::INFINITY);
}

/// Another damping ratio gives the block that has it from the beginning.
#[test]
fn the_damping_ratio_changes_alone() {
    let paper = Block::from_dimensionless(&PAPER, &common()).unwrap();
    for xi_v in [0.0, 0.3] {
        let expected = Block::from_dimensionless(&on(35.0, xi_v), &common()).unwrap();
        assert_eq!(paper.with_damping_ratio(xi_v), Ok(expected));
    }
    let rigid = Block::from_dimensionless(&rigid(1.0), &common()).unwrap();
    assert_eq!(rigid.with_damping_ratio(0.3), Ok(rigid));
    refused("xi_v", -0.1, paper.with_damping_ratio(-0.1));
    refused("xi_v", f64::NAN, paper.with_damping_ratio(f64::NAN));
}

/// Only the rigid base uses the restitution factor.
#[test]
fn the_restitution_factor_is_that_of_the_rigid_base() {
    let [supports, rigid] = [PAPER, rigid(0.9)].map(|given| Block::from_dimensionless(&given, &common()).unwrap());
    assert_eq!(supports.restitution(), supports.housner_restitution(Corner::Left));
    assert_eq!(rigid.restitution(), 0.9 * rigid.housner_restitution(Corner::Left));
}

#[track_caller]
fn refused(name: &str, value: f64, result: Result<Block, BlockError>) {
    let error = result.expect_err(&format!("{name} = {value}"));
    assert_eq!(error.name(), name, "{error}");
    assert!(error.to_string().contains(&value.to_string()), "{error}");
}

/// An error names each parameter at the end of its range, beyond it, or not a number.
#[test]
fn errors_name_the_invalid_parameter() {
    let paper = |given: Dimensionless| Block::from_dimensionless(&given, &common());
    let lengths = |width: f64, height: f64| sized(Outline::Sizes { width, height, inertia: None }, SPRINGS);
    let springs = |stiffness: f64, damping: f64| sized(SIZES, Springs { stiffness, damping });
    let with = |given: Common| Block::from_dimensionless(&PAPER, &given);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused("alpha", value, paper(Dimensionless { alpha: value, ..PAPER }));
        refused("p", value, paper(Dimensionless { p: value, ..PAPER }));
        refused("eta", value, paper(on(value, 0.15)));
        refused("width", value, lengths(value, 3.1));
        refused("height", value, lengths(1.3, value));
        refused("K", value, springs(value, 150.0));
        refused("mass", value, with(Common { mass: value, ..common() }));
        refused("gamma", value, with(Common { gamma: value, ..common() }));
        refused("g", value, with(Common { gravity: value, ..common() }));
        if value != 0.0 {
            refused("xi_v", value, paper(on(35.0, value)));
            refused("C", value, springs(2e4, value));
            refused("epsilon", value, with(Common { epsilon: value, ..common() }));
            refused("restitution_factor", value, paper(rigid(value)));
        }
    }
    for alpha in [FRAC_PI_2, 2.0] {
        refused("alpha", alpha, paper(Dimensionless { alpha, ..PAPER }));
    }
    let above = 1.0_f64.next_up();
    refused("epsilon", above, with(Common { epsilon: above, ..common() }));
    for epsilon in [0.0, 1.0] {
        assert!(with(Common { epsilon, ..common() }).is_ok());
    }
}

/// Valid parameters may give derived values out of range.
#[test]
fn derived_values_are_checked() {
    let infinite = Block::from_dimensionless(&on(35.0, 1e308), &Common { mass: 1e5, ..common() });
    assert_eq!(infinite.expect_err("an infinite damping").name(), "C");
    let ratio = sized(SIZES, Springs { stiffness: 1e-300, damping: 1e200 });
    assert_eq!(ratio.expect_err("an infinite damping ratio").name(), "C");
    let thin = Block::from_dimensionless(&Dimensionless { alpha: f64::MIN_POSITIVE, p: 1e3, ..PAPER }, &common());
    assert_eq!(thin.expect_err("a width that vanishes").name(), "b = R0 sin(alpha)");
    let light = Block::from_dimensionless(&Dimensionless { p: 1e60, ..PAPER }, &Common { mass: 1e-200, ..common() });
    assert_eq!(light.expect_err("an inertia that vanishes").name(), "I0");
}

/// A factor of 1/e makes impacts elastic, however 1/e was rounded; anything clearly greater is refused.
#[test]
fn a_factor_of_one_over_e_is_elastic() {
    for number in 1..2000_u32 {
        let (alpha, epsilon) = (0.5 * f64::from(number) / 2000.0, f64::from(number % 7) / 7.0);
        let with = |restitution_factor| {
            let given = Dimensionless { alpha, p: 1.0, supports: Supports::Rigid { restitution_factor } };
            Block::from_dimensionless(&given, &Common { epsilon, ..Common::default() })
        };
        let e = with(1.0).unwrap().restitution();
        for factor in [1.0 / e, (1.0 / e).next_up(), (1.0 / e).next_down()] {
            let elastic = with(factor).unwrap();
            assert!((1.0 - 1e-15..=1.0).contains(&elastic.restitution()), "{alpha} {}", elastic.restitution());
        }
        assert!(with((1.0 + 1e-9) / e).is_err());
    }
}

/// The corner with the greater e decides whether a factor makes impacts gain energy, on either side.
#[test]
fn the_greater_restitution_limits_the_factor() {
    for eccentricity in [-0.2, 0.2] {
        let of = |factor: f64| Block::from_dimensionless(&rigid(factor), &Common { eccentricity, ..common() });
        let plain = of(1.0).unwrap();
        let [left, right] = [Corner::Left, Corner::Right].map(|corner| plain.housner_restitution(corner));
        assert!((left > right) == (eccentricity < 0.0) && (left / right - 1.0).abs() > 1e-3, "{left} {right}");
        let greater = left.max(right);
        assert!(of(0.999 / greater).is_ok() && of(1.001 / greater).is_err(), "{left} {right}");
    }
}

/// A corner may jam where the inertia that a sliding block shows at it vanishes, at any tilt: I0/M + X (X + μ Q), with the centre of mass Q
/// above and X beside the corner.
#[test]
fn friction_below_the_least_that_jams_is_accepted() {
    for eccentricity in [-0.2, 0.0, 0.2] {
        let of = |friction: f64| Block::from_dimensionless(&rigid(1.0), &Common { eccentricity, friction, ..common() });
        let block = of(0.0).unwrap();
        let radius = [block.b + eccentricity, block.b - eccentricity].map(|across| across.hypot(block.h));
        let jams = |radius: f64, phi: f64| {
            let (x, q) = (radius * phi.sin(), radius * phi.cos());
            (block.i0 + x * x) / (x * q)
        };
        let angles = (1..200_000).map(|i| FRAC_PI_2 * f64::from(i) / 200_000.0);
        let least = angles.flat_map(|phi| radius.map(|radius| jams(radius, phi))).fold(f64::INFINITY, f64::min);
        assert!((block.jamming_friction() / least - 1.0).abs() < 1e-8, "{} {least}", block.jamming_friction());
        assert!(of(0.999 * least).is_ok());
        assert_eq!(of(1.001 * least).expect_err("a corner that jams").name(), "friction");
    }
}

/// A block on supports whose centre of mass is not between its corners is refused.
#[test]
fn the_centre_of_mass_is_between_the_corners() {
    let b = Block::from_dimensionless(&PAPER, &common()).unwrap().b;
    for side in [-1.0, 1.0] {
        let of = |part: f64| Block::from_dimensionless(&PAPER, &Common { eccentricity: side * part * b, ..common() });
        assert!(of(0.999).is_ok());
        for part in [1.0, 1.001, 10.0] {
            assert_eq!(of(part).expect_err("it falls over").name(), "eccentricity");
        }
    }
}

/// A block has at most [`MAX_TIES`] ties, each between two different points.
#[test]
fn ties_are_counted_and_have_a_length() {
    let block = Block::from_dimensionless(&PAPER, &common()).unwrap();
    let tie = Tie { block: [0.5, 1.5], ground: [-2.0, 0.0], stiffness: 1e3, ..Tie::default() };
    assert_eq!(block.with_ties(&[tie; MAX_TIES]).unwrap().ties(), [tie; MAX_TIES]);
    assert!(block.with_ties(&[tie; MAX_TIES + 1]).is_err());
    assert!(block.with_ties(&[Tie { ground: tie.block, ..tie }]).is_err());
    for place in [[tie.block[0], 0.0], [0.0, tie.block[1]]] {
        assert!(block.with_ties(&[Tie { ground: place, ..tie }]).is_ok(), "{place:?}");
    }
}

/// A rectangle on supports falls over without excitation for η² ≤ 4/3 cos α / sin² α, unless a tie or a rigid base holds it.
#[test]
fn soft_supports_draw_a_warning() {
    let homogeneous = Common { mass: 7.0, ..Common::default() };
    for alpha in [0.1, 0.25, 0.6_f64] {
        let least = (4.0 / 3.0 * alpha.cos()).sqrt() / alpha.sin();
        let of = |part: f64, foundation: Foundation| {
            let dimensionless = Dimensionless {
                alpha,
                p: 1.7,
                supports: Supports::of(foundation, Ratios { eta: part * least, xi_v: 0.1 }),
            };
            Block::from_dimensionless(&dimensionless, &homogeneous).unwrap()
        };
        assert_eq!(of(1.0001, Foundation::Viscoelastic).soft_supports(), None);
        assert_eq!(of(0.5, Foundation::Rigid).soft_supports(), None);
        let soft = of(0.5, Foundation::Viscoelastic);
        let warning = soft.soft_supports().expect("a warning");
        for part in [
            format!("eta = {:.4}, K = {:.4e} N/m", 0.5 * least, soft.stiffness),
            format!("eta > {least:.4}, K > {:.4e} N/m", 4.0 * soft.stiffness),
        ] {
            assert!(warning.contains(&part), "{part} is not in: {warning}");
        }
        let tie = Tie { block: [0.0, 1.0], ground: [-2.0, 0.0], stiffness: 1.0, ..Tie::default() };
        assert_eq!(soft.with_ties(&[tie]).unwrap().soft_supports(), None);
    }
}
