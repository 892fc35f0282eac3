//! Blocks and pulses → remarks on numbers beyond reason, mostly slips of units.

use nalgebra::Matrix2;
use rocking_block::block::{Block, Foundation};
use rocking_block::excitation::{Pulse, PulseShape};
use rocking_block::space::{Base, SpaceBody, SpaceParameters};

use crate::statistics::range;

/// Least and greatest width and height of a block (m).
const SIZES: [f64; 2] = [1e-3, 200.0];
/// Greatest vertical damping ratio of supports (1).
const MAX_XI_V: f64 = 50.0;
/// Least and greatest depth of a base over its width (1).
const DEPTHS: [f64; 2] = [0.02, 50.0];
/// Greatest half width of a base over the height of the centre of mass (1).
const STOCKIEST: f64 = 2.0;
/// Least and greatest mass over the volume of a body in space (kg/m³): of an empty tank, and of heavy metal.
const DENSITIES: [f64; 2] = [5.0, 25e3];
/// Least and greatest radius of gyration over R0 (1); that of a homogeneous slender block is 0.58.
const GYRATIONS: [f64; 2] = [0.1, 3.0];
/// Greatest amplitude of a pulse over gravity (1), that of records in files.
const MAX_AMPLITUDE: f64 = 20.0;

/// Returns the first remark of each kind on blocks. Kinds are supports too soft to keep them upright, sizes, proportions, and
/// damping.
pub fn of_blocks(blocks: impl IntoIterator<Item = Block>) -> Vec<String> {
    first_of_each(blocks, [&Block::soft_supports, &size, &stocky, &damping])
}

/// A kind of remark.
type Kind<'a, T> = &'a dyn Fn(&T) -> Option<String>;

/// Returns the first remark of each kind on some items.
fn first_of_each<T, const N: usize>(items: impl IntoIterator<Item = T>, kinds: [Kind<T>; N]) -> Vec<String> {
    let mut found = [const { None }; N];
    for item in items {
        for (found, kind) in found.iter_mut().zip(kinds).filter(|(found, _)| found.is_none()) {
            *found = kind(&item);
        }
        if found.iter().all(Option::is_some) {
            break;
        }
    }
    found.into_iter().flatten().collect()
}

/// Rounds a number to four significant digits.
pub(crate) fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn size(block: &Block) -> Option<String> {
    let [width, height] = [2.0 * block.b, 2.0 * block.h];
    let [least, greatest] = SIZES;
    let is_plausible = least <= width && width <= greatest && least <= height && height <= greatest;
    (!is_plausible).then(|| {
        format!(
            "the block is {} m wide and {} m high (2h), with p = {} rad/s; expected {least} to {greatest} m",
            short(width),
            short(height),
            short(block.p)
        )
    })
}

fn stocky(block: &Block) -> Option<String> {
    (block.b > block.h).then(|| {
        format!(
            "the block is {} m wide and {} m high (2h), with alpha = {} rad; expected a height above the width: they may be swapped",
            short(2.0 * block.b),
            short(2.0 * block.h),
            short(block.alpha)
        )
    })
}

fn damping(block: &Block) -> Option<String> {
    let (damping, xi_v) = (block.damping, block.xi_v);
    (block.foundation == Foundation::Viscoelastic && xi_v > MAX_XI_V).then(|| {
        format!(
            "the supports have xi_v = {}, C = {damping:.4e} N.s/m; expected xi_v of at most {MAX_XI_V}",
            short(xi_v)
        )
    })
}

/// A block in space: its parameters, the block, and whether its mass is given and no default.
pub type SizedInSpace = (SpaceParameters, SpaceBody, bool);

/// Returns the first remark of each kind on blocks in space. Kinds are feet too soft to keep them upright, sizes, gaps, masses and damping.
pub fn of_blocks_in_space(blocks: impl IntoIterator<Item = SizedInSpace>) -> Vec<String> {
    first_of_each(blocks, [&soft_feet, &size_in_space, &gap, &density, &gyration, &damping_of_feet])
}

/// The feet without a gap are too soft if those about their weakest axis cannot hold the block upright, K Σ d² ≤ M g h.
fn soft_feet((_, body, _): &SizedInSpace) -> Option<String> {
    let standing = || body.feet.iter().filter(|foot| foot.static_load > 0.0).map(|foot| foot.place.xy());
    let middle = standing().sum::<nalgebra::Vector2<f64>>() / standing().count() as f64;
    let moments: Matrix2<f64> = standing().map(|place| (place - middle) * (place - middle).transpose()).sum();
    let (stiffness, omega_v) = (body.stiffness, body.omega_v);
    let least = body.mass * body.gravity * body.center_height / moments.symmetric_eigenvalues().min();
    (stiffness <= least).then(|| {
        format!(
            "the block falls over by itself on feet of omega_v = {omega_v:.4} rad/s, K = {stiffness:.4e} N/m; expected omega_v > {:.4} rad/s, \
             K > {least:.4e} N/m",
            omega_v * (least / stiffness).sqrt()
        )
    })
}

/// Width and depth between the feet, and twice the height of the centre of mass (m).
fn sizes(body: &SpaceBody) -> [f64; 3] {
    let between = |axis: usize| {
        let [low, high] = range(body.feet.iter().map(|foot| foot.place[axis])).unwrap_or_default();
        high - low
    };
    [between(0), between(1), 2.0 * body.center_height]
}

fn size_in_space((_, body, _): &SizedInSpace) -> Option<String> {
    let ([least, greatest], [shallow, deep]) = (SIZES, DEPTHS);
    let sizes @ [width, depth, height] = sizes(body);
    let block =
        || format!("the block is {} m wide, {} m deep and {} m high (2h)", short(width), short(depth), short(height));
    let is_within = |value: f64, [low, high]: [f64; 2]| low <= value && value <= high;
    if !sizes.iter().all(|&size| is_within(size, SIZES)) {
        return Some(format!("{}, with p = {} rad/s; expected {least} to {greatest} m", block(), short(body.p)));
    }
    if !is_within(depth / width, DEPTHS) {
        return Some(format!("{}; expected a depth of {shallow} to {deep} times the width", block()));
    }
    let slope = body.edge_distance / body.center_height;
    (slope > STOCKIEST)
        .then(|| format!("{} and lifts a foot beyond {} g only; expected a more slender one", block(), short(slope)))
}

fn gap((_, body, _): &SizedInSpace) -> Option<String> {
    let [width, depth, _] = sizes(body);
    let gap = |place: f64| place + body.center_height;
    let wide = body.feet.iter().position(|foot| gap(foot.place.z) > width.max(depth))?;
    let found = short(gap(body.feet[wide].place.z));
    Some(format!("foot {} has a gap of {found} m, more than the base is long; expected metres", wide + 1))
}

fn density((parameters, body, is_given): &SizedInSpace) -> Option<String> {
    let [least, greatest] = DENSITIES;
    let area = match &parameters.base {
        Base::Rectangle { depth_ratio, .. } => 4.0 * body.half_width * body.half_width * depth_ratio,
        Base::Circle { .. } => std::f64::consts::PI * body.half_width * body.half_width,
        // Feet need not be at the edge of the body.
        Base::List { .. } => return None,
    };
    let density = body.mass / (area * 2.0 * body.center_height);
    (*is_given && !(least..=greatest).contains(&density)).then(|| {
        format!(
            "the mass of {} kg makes a density of {} kg/m3 with the size of the block; expected {least} to {greatest} kg/m3",
            short(body.mass),
            short(density)
        )
    })
}

fn gyration((parameters, body, _): &SizedInSpace) -> Option<String> {
    let [least, greatest] = GYRATIONS;
    parameters.inertia?;
    let radius = (body.inertia.symmetric_eigenvalues().max() / body.mass).sqrt();
    (!(least..=greatest).contains(&(radius / body.r0))).then(|| {
        format!(
            "the moments of inertia make a radius of gyration of {} m, {} R0; expected {least} to {greatest} R0",
            short(radius),
            short(radius / body.r0)
        )
    })
}

fn damping_of_feet((parameters, body, _): &SizedInSpace) -> Option<String> {
    let ratios = [("xi_v", body.xi_v), ("xi_h", parameters.xi_h.unwrap_or_default())];
    let (name, found) = ratios.into_iter().find(|(_, ratio)| *ratio > MAX_XI_V)?;
    Some(format!("the feet have {name} = {}; expected at most {MAX_XI_V}", short(found)))
}

/// Returns the first remark of each kind on pulses with their gravity (m/s²). Kinds are amplitudes, and those of [`of_end`].
pub fn of_pulses(pulses: impl IntoIterator<Item = (Pulse, f64)>, has_record: bool) -> Vec<String> {
    let pulses = pulses.into_iter().filter(|(pulse, _)| pulse.shape != PulseShape::None);
    first_of_each(pulses, [&|(pulse, gravity)| amplitude(pulse, *gravity), &|(pulse, _)| of_end(pulse, has_record)])
}

fn amplitude(pulse: &Pulse, gravity: f64) -> Option<String> {
    let amplitude = pulse.amplitude;
    (amplitude.abs() > MAX_AMPLITUDE * gravity).then(|| {
        format!(
            "the amplitude of the pulse, {amplitude} m/s2, is {} g; expected at most {MAX_AMPLITUDE} g",
            short(amplitude / gravity)
        )
    })
}

/// Returns a remark on a pulse that ends before the run starts.
///
/// A run without a record starts at 0; one with a record starts no later than its pulse.
pub fn of_end(pulse: &Pulse, has_record: bool) -> Option<String> {
    let end = pulse.end();
    (!has_record && pulse.shape != PulseShape::None && end <= 0.0).then(|| {
        format!(
            "the pulse ends at {} s, before the run starts at 0 s, and does nothing; expected a later start",
            short(end)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::block::{BlockParameters, Body, Common, KelvinVoigt, Outline, Springs, Supports};

    /// A block of 0.6 m × 2.4 m on stiff supports, with other sizes and damping.
    fn block(width: f64, height: f64, damping: f64, foundation: Foundation) -> Block {
        let outline = Outline::Sizes { width, height, inertia: None };
        let supports = Supports::of(foundation, KelvinVoigt::Springs(Springs { stiffness: 1e7, damping }));
        Block::new(&BlockParameters { outline, supports, common: Common::default() }).unwrap()
    }

    #[test]
    fn each_kind_is_said_once() {
        let plain = block(0.6, 2.4, 4e4, Foundation::Viscoelastic);
        assert_eq!(of_blocks([plain]), Vec::<String>::new());
        let in_mm = block(600.0, 2400.0, 4e4, Foundation::Rigid);
        let in_km = block(0.6e-3, 2.4e-3, 4e4, Foundation::Rigid);
        let damped = block(0.6, 2.4, 4e7, Foundation::Viscoelastic);
        let found = of_blocks([plain, in_mm, in_km, damped, damped]);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].starts_with("the block is 600 m wide and 2400 m high (2h), with p = "), "{found:?}");
        assert!(found[1].starts_with("the supports have xi_v = 282.8, C = 4.0000e7 N.s/m"), "{found:?}");
        assert_eq!(of_blocks([in_km]).len(), 1);
        let swapped = of_blocks([block(2.4, 0.6, 4e4, Foundation::Rigid)]);
        assert!(
            swapped.len() == 1 && swapped[0].starts_with("the block is 2.4 m wide and 0.6 m high (2h), with alpha")
        );
        assert_eq!(of_blocks([block(1.0, 1.0, 4e4, Foundation::Rigid)]), [""; 0]);
        assert_eq!(
            of_blocks([Block { body: Body { foundation: Foundation::Rigid, ..damped.body }, ..damped }]).len(),
            0
        );
    }

    #[test]
    fn blocks_in_space_are_doubted_by_their_sizes_feet_and_masses() {
        use rocking_block::space::{BaseSize, FootPlace, SpaceSupports};
        let of = |width: f64, depth_ratio: f64, center_height: f64, others: SpaceParameters| {
            let base = Base::Rectangle { size: BaseSize::Lengths { width, center_height }, depth_ratio };
            SpaceParameters { base, ..others }
        };
        let plain = || SpaceParameters { mass: 2000.0, ..SpaceParameters::default() };
        let doubts = |parameters: SpaceParameters, is_given: bool| {
            let body = SpaceBody::new(&parameters).unwrap();
            of_blocks_in_space([(parameters.clone(), body.clone(), is_given), (parameters, body, is_given)])
        };
        assert_eq!(doubts(of(0.6, 1.5, 1.2, plain()), true), [""; 0]);
        let far = (0..3).map(|i| FootPlace { x: [-0.3, 0.3, 0.0][i], y: [-0.3, -0.3, 0.4][i], gap: 0.0 });
        let list = SpaceParameters {
            base: Base::List {
                feet: far.chain([FootPlace { x: 0.1, y: 0.1, gap: 2.0 }]).collect(),
                center_height: 1.2,
            },
            supports: SpaceSupports::OfHeave { omega_v: 100.0, xi_v: 0.2 },
            inertia: Some([1e3, 1e3, 2e2, 0.0, 0.0, 0.0]),
            ..plain()
        };
        let soft = SpaceSupports::OfRocking { eta: 3.0, xi_v: 0.2 };
        let damped = SpaceSupports::OfRocking { eta: 60.0, xi_v: 60.0 };
        for (parameters, expected) in [
            (of(600.0, 1.5, 1200.0, plain()), "the block is 600 m wide, 900 m deep and 2400 m high (2h), with p = "),
            (
                of(0.6, 133.0, 1.2, plain()),
                "the block is 0.6 m wide, 79.8 m deep and 2.4 m high (2h); expected a depth of 0.02 to 50",
            ),
            (
                of(60.0, 1.0, 1.2, plain()),
                "the block is 60 m wide, 60 m deep and 2.4 m high (2h) and lifts a foot beyond 25 g only;",
            ),
            (
                of(0.6, 1.5, 1.2, SpaceParameters { mass: 2.0, ..plain() }),
                "the mass of 2 kg makes a density of 1.543 kg/m3 with",
            ),
            (
                of(0.6, 1.5, 1.2, SpaceParameters { supports: soft, ..plain() }),
                "the block falls over by itself on feet of omega_v = ",
            ),
            (
                of(0.6, 1.5, 1.2, SpaceParameters { supports: damped, ..plain() }),
                "the feet have xi_v = 60; expected at most 50",
            ),
            (
                SpaceParameters { inertia: Some([1.0, 1.0, 0.2, 0.0, 0.0, 0.0]), ..of(0.6, 1.5, 1.2, plain()) },
                "the moments of inertia make a radius of gyration of 0.02236 m, 0.01808 R0; expected 0.1 to 3 R0",
            ),
            (list, "foot 4 has a gap of 2 m, more than the base is long; expected metres"),
        ] {
            let found = doubts(parameters, true);
            assert!(found.iter().any(|doubt| doubt.starts_with(expected)), "{expected}: {found:?}");
        }
        // The default mass belongs to no size.
        assert_eq!(doubts(of(30.0, 1.0, 60.0, SpaceParameters::default()), false), [""; 0]);
    }

    #[test]
    fn an_amplitude_in_cm_per_second_squared_is_doubted() {
        let pulse = |amplitude: f64| Pulse { shape: PulseShape::OneSine, amplitude, ..Pulse::NONE };
        let of_pulse = |pulse: Pulse| of_pulses([(pulse, 9.81); 2], false);
        assert_eq!(of_pulse(pulse(-196.0)), [""; 0]);
        assert_eq!(of_pulse(Pulse { shape: PulseShape::None, ..pulse(400.0) }), [""; 0]);
        let expected = "the amplitude of the pulse, -400 m/s2, is -40.77 g; expected at most 20 g";
        assert_eq!(of_pulse(pulse(-400.0)), [expected]);
    }

    #[test]
    fn a_pulse_before_the_start_is_doubted_without_a_record() {
        let pulse =
            |start| (Pulse { shape: PulseShape::OneSine, amplitude: 3.0, period: 0.5, start, ..Pulse::NONE }, 9.81);
        let early = of_pulses([pulse(-0.4), pulse(-2.0), pulse(-1.0)], false);
        assert!(
            early.len() == 1 && early[0].starts_with("the pulse ends at -1.5 s, before the run starts"),
            "{early:?}"
        );
        assert_eq!(of_pulses([pulse(-2.0)], true), [""; 0]);
    }
}
