//! Initial derivatives declared by ModelStructure/InitialUnknowns, against differences of values.
//!
//! The host is the model itself or an FMU through one of its interfaces.

pub mod draw;

use std::collections::{BTreeMap, BTreeSet};

use draw::Draw;

/// An instance in Initialization Mode.
pub trait Host {
    fn set(&mut self, name: &str, value: f64);
    fn get(&mut self, name: &str) -> f64;
    /// Returns the derivatives of several unknowns with respect to one known.
    fn derivatives(&mut self, unknowns: &[&str], known: &str) -> Vec<f64>;
}

/// Names of the dependencies of each unknown in InitialUnknowns.
pub type Declared = BTreeMap<String, BTreeSet<String>>;

/// Reads InitialUnknowns from a modelDescription.xml of FMI 2.0.
pub fn declared(xml: &str) -> Declared {
    let document = roxmltree::Document::parse(xml).unwrap();
    let names: Vec<&str> = document
        .descendants()
        .filter(|node| node.has_tag_name("ScalarVariable"))
        .map(|node| node.attribute("name").unwrap())
        .collect();
    let name = |index: &str| names[index.parse::<usize>().unwrap() - 1].to_string();
    let list = document.descendants().find(|node| node.has_tag_name("InitialUnknowns")).unwrap();
    list.children()
        .filter(|node| node.is_element())
        .map(|node| {
            let dependencies = node.attribute("dependencies").unwrap().split_whitespace().map(name);
            (name(node.attribute("index").unwrap()), dependencies.collect())
        })
        .collect()
}

/// Returns the unknowns that have derivatives.
pub fn real_unknowns(declared: &Declared) -> Vec<&str> {
    const OTHERS: [&str; 10] = [
        "regime",
        "events.impacts",
        "events.liftoffs",
        "separated",
        "overturned",
        "slides",
        "tie_1.broken",
        "tie_2.broken",
        "damper_1.broken",
        "damper_2.broken",
    ];
    declared.keys().map(String::as_str).filter(|name| !OTHERS.contains(name)).collect()
}

/// Magnitudes of the terms of unknowns, to which round-off is relative.
pub struct Sizes {
    mass: f64,
    r0: f64,
    half_width: f64,
    force: f64,
    rate: f64,
    energy: f64,
}

impl Sizes {
    pub fn of(host: &mut impl Host) -> Sizes {
        let [mass, r0, width, g] = ["mass", "derived.R0", "derived.width", "g"].map(|name| host.get(name));
        let greatest = |host: &mut dyn FnMut(&str) -> f64, names: &[&str], least: f64| {
            names.iter().map(|name| host(name).abs()).fold(least, f64::max)
        };
        let mut get = |name: &str| host.get(name);
        let force = greatest(&mut get, &["N_L", "N_R", "H"], mass * g);
        let rate = greatest(&mut get, &["v_dot", "u_dot"], (g * r0).sqrt());
        let energy = greatest(&mut get, &["energy.kinetic", "energy.potential"], mass * g * r0);
        Sizes { mass, r0, half_width: 0.5 * width, force, rate, energy }
    }

    pub fn unknown(&self, name: &str, value: f64) -> f64 {
        let Sizes { mass, r0, force, rate, energy, .. } = *self;
        match name {
            "N_L" | "N_R" | "H" | "peak.N" | "peak.H" => force,
            _ if name.ends_with(".tension") || name.ends_with(".force") => force,
            _ if name.ends_with(".elongation") || name.ends_with(".plastic") => r0,
            "slip_rate" => rate,
            "M_base" => force * r0,
            "theta_ddot" => force / mass / r0 * 10.0,
            "v_ddot" | "u_ddot" => force / mass,
            "v_dot" | "u_dot" => rate,
            "v" | "u" | "v_L" | "v_R" | "uplift_L" | "uplift_R" | "peak.uplift" => r0,
            "friction_demand" | "peak.friction_demand" => value.abs().max(1.0),
            _ if name.starts_with("energy") => energy,
            _ if name.starts_with("power") => force * rate,
            _ => value.abs().max(0.1),
        }
    }
}

/// Returns the stretch of a tie (m), from the place of the block; zero without a tie.
fn stretch(get: &mut impl FnMut(&str) -> f64, tie: &str) -> f64 {
    let mut of = |name: &str| get(&format!("{tie}.{name}"));
    let stiffness = of("stiffness");
    let [pretension, slack] = if tie.starts_with("tie") { ["pretension", "slack"].map(&mut of) } else { [0.0; 2] };
    let [block, ground] = [["block_x", "block_z"], ["ground_x", "ground_z"]].map(|ends| ends.map(&mut of));
    if stiffness == 0.0 {
        return 0.0;
    }
    let [eccentricity, r0, alpha, u, v] = ["eccentricity", "derived.R0", "derived.alpha", "u", "v"].map(&mut *get);
    let (sin, cos) = libm::sincos(get("theta"));
    let h = r0 * libm::cos(alpha);
    let (x, z) = (block[0] - eccentricity, block[1] - h);
    let [x, z] = [eccentricity + u + x * cos + z * sin, h + v + z * cos - x * sin];
    let rest = libm::hypot(block[0] - ground[0], block[1] - ground[1]) + slack - pretension / stiffness;
    libm::hypot(x - ground[0], z - ground[1]) - rest
}

/// Values that show whether a function is smooth between two points.
struct Side {
    regime: [f64; 3],
    /// Whether the foot slides and to which side.
    slides: f64,
    /// For each tie and damper, whether it is stretched, pulls, has broken, and has yielded.
    links: [[f64; 4]; 4],
    shear: f64,
    /// N_L + N_R, in units of the force.
    pressed: f64,
    /// θ_sep (rad).
    separation: f64,
    /// Whether each damper is longer or shorter than at rest.
    strokes: [f64; 2],
    /// Side of the centre of mass.
    uneven: f64,
    lean: f64,
    heavier: f64,
    higher: f64,
}

impl Side {
    fn of(host: &mut impl Host, sizes: &Sizes) -> Side {
        let sign = |value: f64, size: f64| if value.abs() <= 1e-9 * size { 0.0 } else { value.signum() };
        let mut get = |name: &str| host.get(name);
        Side {
            regime: ["regime", "separated", "overturned"].map(&mut get),
            slides: get("slides") * sign(get("H"), sizes.force),
            links: [("tie_1", "tension"), ("tie_2", "tension"), ("damper_1", "force"), ("damper_2", "force")].map(
                |(link, force)| {
                    [
                        stretch(&mut get, link).signum(),
                        sign(get(&format!("{link}.{force}")), sizes.force),
                        get(&format!("{link}.broken")),
                        sign(get(&format!("{link}.plastic")), sizes.r0),
                    ]
                },
            ),
            shear: sign(get("H"), sizes.force),
            pressed: (get("N_L") + get("N_R")) / sizes.force,
            separation: get("derived.theta_separation"),
            strokes: ["damper_1", "damper_2"].map(|damper| sign(get(&format!("{damper}.elongation")), sizes.r0)),
            uneven: sign(get("eccentricity"), sizes.half_width),
            lean: sign(get("theta"), 1.0),
            heavier: sign(get("N_L") - get("N_R"), sizes.force),
            higher: sign(get("uplift_L") - get("uplift_R"), sizes.r0),
        }
    }

    /// Returns true if an unknown is smooth between the two sides, as far as these values show.
    fn joins(&self, other: &Side, unknown: &str) -> bool {
        let same = |a: f64, b: f64| a == b && a != 0.0;
        // The difference of a quotient by q has an error of (δq/q)⁴/64 of its derivative, if q changes by δq between the sides.
        let pressed = self.pressed.min(other.pressed);
        let steady = pressed > 0.3 && (self.pressed - other.pressed).abs() < 0.01 * pressed;
        self.regime == other.regime
            && self.slides == other.slides
            && self.links == other.links
            && match unknown {
                "friction_demand" | "peak.friction_demand" => same(self.shear, other.shear) && steady,
                // The smaller of two, which are equal without eccentricity.
                "derived.e" => self.uneven == other.uneven,
                // An arc sine, steep near its end at a quarter turn.
                "derived.theta_separation" => self.separation < 0.8,
                // Separated blocks remember which corner lifted first.
                "u" | "u_dot" if self.regime[0] == 2.0 => same(self.lean, other.lean),
                "peak.damper_1.elongation" => same(self.strokes[0], other.strokes[0]),
                "peak.damper_2.elongation" => same(self.strokes[1], other.strokes[1]),
                "peak.H" => same(self.shear, other.shear),
                "peak.theta" => same(self.lean, other.lean),
                "peak.N" => same(self.heavier, other.heavier),
                "peak.uplift" => same(self.higher, other.higher),
                _ => true,
            }
    }
}

/// Results for a pair of unknown and known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Number of comparisons of derivative and difference.
    pub compared: u32,
    /// Number of derivatives above round-off.
    pub nonzero: u32,
}

/// Results by the names of a pair.
pub type Pairs = BTreeMap<(String, String), Found>;

/// Compares all derivatives in a random initial state with differences.
///
/// The differences are central, over 1e-3 and 5e-4 of the scale of the known, and extrapolated. Relative to the magnitude of the
/// unknown, round-off contributes 1e-16/1e-3 times some ten sums, about 1e-12, and the fifth derivative a similar amount. On stiff
/// supports both are up to 50 times greater, because reactions are differences of larger numbers.
pub fn compare(host: &mut impl Host, draw: &Draw, declared: &Declared, pairs: &mut Pairs) {
    let unknowns = real_unknowns(declared);
    let sizes = Sizes::of(host);
    let values: Vec<f64> = unknowns.iter().map(|name| host.get(name)).collect();
    for known in draw::KNOWNS {
        let exact = host.derivatives(&unknowns, known.name);
        let (at, by) = (host.get(known.name), draw.measure(known.name, &sizes));
        if known.least.is_some_and(|least| at - 1e-3 * by < least) {
            continue;
        }
        let mut look = |shift: f64| {
            host.set(known.name, at + shift * by);
            (Side::of(host, &sizes), unknowns.iter().map(|name| host.get(name)).collect::<Vec<f64>>())
        };
        let [ahead, behind, near_ahead, near_behind] = [1e-3, -1e-3, 5e-4, -5e-4].map(&mut look);
        host.set(known.name, at);
        for (i, unknown) in unknowns.iter().enumerate() {
            let size = sizes.unknown(unknown, values[i]);
            let found = exact[i] * by;
            if !declared[*unknown].contains(known.name) {
                assert_eq!(exact[i], 0.0, "InitialUnknowns says that {unknown} does not depend on {}", known.name);
            }
            if !ahead.0.joins(&behind.0, unknown) {
                continue;
            }
            let wide = (ahead.1[i] - behind.1[i]) / 2e-3;
            let near = (near_ahead.1[i] - near_behind.1[i]) / 1e-3;
            let expected = (4.0 * near - wide) / 3.0;
            assert!(
                (found - expected).abs() <= 1e-9 * expected.abs() + 1e-10 * size,
                "d{unknown}/d{} times {by} is {found:e}, not {expected:e}, in units of {size:e}: {draw:?}",
                known.name
            );
            let pair = pairs.entry((unknown.to_string(), known.name.to_string())).or_default();
            pair.compared += 1;
            pair.nonzero += u32::from(found.abs() > 1e-9 * size);
        }
    }
}
