//! Parameters of a block: relations and refusals.

use std::f64::consts::FRAC_PI_2;

use rocking_block::block::{Block, BlockError, Common, Corner, Dimensionless, Foundation, Physical};

const PAPER: Dimensionless = Dimensionless { alpha: 0.3, p: 1.7, eta: 35.0, xi_v: 0.15 };
const SIZES: Physical = Physical { width: 1.3, height: 3.1, stiffness: 2.0e4, damping: 150.0, inertia: None };

fn common() -> Common {
    Common { mass: 7.0, gamma: 2.3, epsilon: 0.35, gravity: 9.7, ..Common::default() }
}

/// Both parametrizations satisfy the relations of docs/model.md.
#[test]
fn parameters_satisfy_the_relations_of_the_paper() {
    let paper = Block::from_dimensionless(&PAPER, &common()).unwrap();
    let sized = Block::from_physical(&SIZES, &common()).unwrap();
    assert_eq!((paper.alpha, paper.p, paper.xi_v), (PAPER.alpha, PAPER.p, PAPER.xi_v));
    assert_eq!((2.0 * sized.b, 2.0 * sized.h, sized.stiffness, sized.damping), (1.3, 3.1, 2.0e4, 150.0));
    for block in [paper, sized] {
        let Block { mass, gravity, gamma, epsilon, alpha, r0, b, h, p, omega_v, xi_v, stiffness, damping, .. } = block;
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
            ("K/C", block.creep_rate(), stiffness / damping),
            ("e_max", block.max_restitution(), (1.0 + gamma * cos) / (1.0 + gamma)),
            ("e", block.restitution(), (1.0 + gamma * epsilon + (1.0 - epsilon) * gamma * cos) / (1.0 + gamma)),
            ("theta_sep", block.separation_angle().sin(), (1.0 + gamma) / (gamma * block.eta().powi(2) * alpha.sin())),
        ] {
            assert!((found / exact - 1.0).abs() < 1e-14, "{name}: {found}, not {exact}");
        }
    }
    let soft = Block::from_dimensionless(&Dimensionless { eta: 1.0, ..PAPER }, &common()).unwrap();
    assert_eq!(soft.separation_angle(), FRAC_PI_2);
    let undamped = Block::from_dimensionless(&Dimensionless { xi_v: 0.0, ..PAPER }, &common()).unwrap();
    assert_eq!(undamped.creep_rate(), f64::INFINITY);
}

/// Only the rigid base uses the restitution factor.
#[test]
fn the_restitution_factor_is_that_of_the_rigid_base() {
    let [supports, rigid] = [Foundation::Viscoelastic, Foundation::Rigid].map(|foundation| {
        let common = Common { foundation, restitution_factor: 0.9, ..common() };
        Block::from_dimensionless(&PAPER, &common).unwrap()
    });
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
    let sizes = |given: Physical| Block::from_physical(&given, &common());
    let with = |given: Common| Block::from_dimensionless(&PAPER, &given);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused("alpha", value, paper(Dimensionless { alpha: value, ..PAPER }));
        refused("p", value, paper(Dimensionless { p: value, ..PAPER }));
        refused("eta", value, paper(Dimensionless { eta: value, ..PAPER }));
        refused("width", value, sizes(Physical { width: value, ..SIZES }));
        refused("height", value, sizes(Physical { height: value, ..SIZES }));
        refused("K", value, sizes(Physical { stiffness: value, ..SIZES }));
        refused("mass", value, with(Common { mass: value, ..common() }));
        refused("gamma", value, with(Common { gamma: value, ..common() }));
        refused("g", value, with(Common { gravity: value, ..common() }));
        if value != 0.0 {
            refused("xi_v", value, paper(Dimensionless { xi_v: value, ..PAPER }));
            refused("C", value, sizes(Physical { damping: value, ..SIZES }));
            refused("epsilon", value, with(Common { epsilon: value, ..common() }));
            refused("restitution_factor", value, with(Common { restitution_factor: value, ..common() }));
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
    let infinite =
        Block::from_dimensionless(&Dimensionless { xi_v: 1e308, ..PAPER }, &Common { mass: 1e5, ..common() });
    assert_eq!(infinite.expect_err("an infinite damping").name(), "C");
    let ratio = Block::from_physical(&Physical { stiffness: 1e-300, damping: 1e200, ..SIZES }, &common());
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
        let d = Dimensionless { alpha, p: 1.0, eta: 40.0, xi_v: 0.1 };
        let rigid = Common { epsilon, foundation: Foundation::Rigid, ..Common::default() };
        let e = Block::from_dimensionless(&d, &rigid).unwrap().restitution();
        for restitution_factor in [1.0 / e, (1.0 / e).next_up(), (1.0 / e).next_down()] {
            let elastic = Block::from_dimensionless(&d, &Common { restitution_factor, ..rigid }).unwrap();
            assert!((1.0 - 1e-15..=1.0).contains(&elastic.restitution()), "{alpha} {}", elastic.restitution());
        }
        let more = Common { restitution_factor: (1.0 + 1e-9) / e, ..rigid };
        assert!(Block::from_dimensionless(&d, &more).is_err());
    }
}
