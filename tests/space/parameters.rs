//! Each invalid parameter is refused with its name, its value and the valid ones.

use rocking_block::space::{Base, BaseSize, FootPlace, SpaceBody, SpaceGround, SpaceParameters, SpaceSupports};
use rocking_records::{ReadOptions, Unit, parse};

fn error(change: impl Fn(&mut SpaceParameters)) -> String {
    let mut parameters = SpaceParameters::default();
    change(&mut parameters);
    SpaceBody::new(&parameters).unwrap_err().to_string()
}

fn list(places: &[[f64; 3]]) -> Base {
    let feet = places.iter().map(|&[x, y, gap]| FootPlace { x, y, gap }).collect();
    Base::List { feet, center_height: 2.0 }
}

const INERTIA: Option<[f64; 6]> = Some([3.0, 3.0, 1.0, 0.0, 0.0, 0.0]);
const OF_HEAVE: SpaceSupports = SpaceSupports::OfHeave { omega_v: 50.0, xi_v: 0.2 };

#[test]
fn invalid_parameters_are_refused_with_name_value_and_range() {
    let size = BaseSize::Slenderness { alpha: 0.25, p: 1.5 };
    let of_list = |places: &[[f64; 3]]| {
        let base = list(places);
        error(|parameters| {
            (parameters.base, parameters.supports, parameters.inertia) = (base.clone(), OF_HEAVE, INERTIA);
        })
    };
    for (found, expected) in [
        (error(|p| p.mass = 0.0), "mass = 0 is not valid; expected a finite number > 0"),
        (error(|p| p.friction = -0.1), "friction = -0.1 is not valid; expected a finite number >= 0"),
        (error(|p| p.kappa = 0.0), "kappa = 0 is not valid; expected a finite number > 0"),
        (error(|p| p.xi_h = Some(0.0)), "xi_h = 0 is not valid; expected a finite number > 0"),
        (
            error(|p| p.supports = SpaceSupports::OfRocking { eta: 40.0, xi_v: 0.0 }),
            "xi_v = 0 is not valid; expected a finite number > 0",
        ),
        (
            error(|p| p.supports = SpaceSupports::OfFoot { stiffness: 1.0, damping: 0.0 }),
            "C = 0 is not valid; expected a finite number > 0",
        ),
        (
            error(|p| p.base = Base::Rectangle { size, depth_ratio: 0.0 }),
            "depth_ratio = 0 is not valid; expected a finite number > 0",
        ),
        (
            error(|p| {
                p.base = Base::Rectangle { size: BaseSize::Slenderness { alpha: 2.0, p: 1.0 }, depth_ratio: 1.0 }
            }),
            "alpha = 2 is not valid; expected 0 < alpha < pi/2 rad",
        ),
        (error(|p| p.base = Base::Circle { size, feet: 2 }), "feet = 2 is not valid; expected 3 to 64"),
        (error(|p| p.base = Base::Circle { size, feet: 65 }), "feet = 65 is not valid; expected 3 to 64"),
        (error(|p| p.eccentricity = [f64::NAN, 0.0]), "eccentricity_x = NaN is not valid; expected a finite number"),
        (
            error(|p| (p.base, p.supports) = (list(&[[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]]), OF_HEAVE)),
            "inertia is missing; expected it for a block with a list of feet",
        ),
        (
            error(|p| {
                (p.base, p.inertia) = (list(&[[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]]), INERTIA);
            }),
            "omega_v, or K and C is missing; expected it for a block with a list of feet",
        ),
        (
            of_list(&[[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.1]]),
            "foot_gap leaves 2 feet without a gap; expected at least 3",
        ),
        (
            of_list(&[[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, -0.1]]),
            "foot_gap = -0.1 is not valid; expected a finite number >= 0",
        ),
        (
            of_list(&[[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [0.5, 0.5, 0.0]]),
            "feet: the 3 feet without a gap stand on a line; expected a base with an area",
        ),
        (
            of_list(&[[2.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, -1.0, 0.0]]),
            "feet: foot 1 at (2 m, 0 m) from the centre of mass carries -3270 N at rest; expected a centre of mass so far inside the base \
             that all feet without a gap carry",
        ),
        (
            error(|p| p.inertia = Some([1.0, 1.0, 3.0, 0.0, 0.0, 0.0])),
            "inertia has the principal moments [1.0, 1.0, 3.0] kg.m2; expected positive ones, none greater than the sum of the others",
        ),
    ] {
        assert_eq!(found, expected);
    }
    assert!(
        error(|p| p.inertia = Some([1.0, 1.0, 1.0, 2.0, 0.0, 0.0])).starts_with("inertia has the principal moments")
    );
    assert!(error(|p| p.inertia = Some([f64::NAN; 6])).starts_with("inertia has the principal moments"));
    assert!(error(|p| p.eccentricity = [10.0, 0.0]).starts_with("feet: foot 1 at"));
}

#[test]
fn records_of_other_steps_or_lengths_are_no_pair() {
    let record = |text: &str, step: f64| {
        let unit = Some(Unit::MetrePerSecondSquared);
        let options = ReadOptions { unit, time_step: Some(step), ..ReadOptions::default() };
        Some(parse("record", text.as_bytes(), &options).unwrap())
    };
    let pair = |other| SpaceGround { records: [record("0\n1\n2\n", 0.01), other, None], azimuth: 0.0 }.checked();
    assert!(pair(record("0\n-1\n-2\n", 0.01)).is_ok());
    let errors = [record("0\n1\n2\n", 0.02), record("0\n1\n", 0.01)].map(|other| pair(other).unwrap_err());
    assert_eq!(errors[0], "record.y has a time step of 0.02 s; expected that of record.x, 0.01 s");
    assert_eq!(errors[1], "record.y has 2 samples; expected the 3 samples of record.x");
}
