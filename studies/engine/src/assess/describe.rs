//! A plan → the object, its building, its ground motions and its hazard in numbers.

use crate::assess::plan::{Hazard, Plan};
use crate::assess::results::{BuildingResult, HazardResult, MotionResult, ObjectResult, SupportsResult};
use crate::intensity::Measure;
use crate::spec::words::{Words, friction};
use crate::statistics::range;
use crate::sweep::Sweep;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::ParameterValues;
use crate::sweep::strength::Strengths;
use rocking_block::block::Block;
use rocking_block::block::restraints::LinkKind;

/// Returns the quasi-static horizontal acceleration (m/s²) that lifts a corner. `None` for a block with ties.
pub(super) fn static_threshold(block: &Block) -> Option<f64> {
    block.ties().is_empty().then(|| block.gravity * (block.b - block.eccentricity.abs()) / block.h)
}

pub(super) fn object(plan: &Plan) -> ObjectResult {
    let Plan { sweep, block, .. } = plan;
    let blocks = || {
        (0..sweep.combinations().unwrap_or(0))
            .filter_map(|number| sweep.values(&sweep.combination(number)).block().ok())
    };
    let range = |value: fn(&Block) -> f64| range(blocks().map(|block| value(&block))).unwrap_or([value(block); 2]);
    let supports = block.ratios().viscoelastic().map(|ratios| SupportsResult {
        stiffness: block.stiffness,
        damping: block.damping,
        ratios,
        delta_s: block.static_deflection(),
    });
    let links = |kind| block.ties().iter().filter(|tie| tie.kind == kind && tie.is_present()).count();
    let e = supports.is_none().then(|| block.restitution());
    ObjectResult {
        foundation: block.foundation.word(),
        width: 2.0 * block.b,
        center_height: block.h,
        mass: block.mass,
        alpha: block.alpha,
        alpha_range: range(|block| block.alpha),
        p: block.p,
        p_range: range(|block| block.p),
        r0: block.r0,
        gamma: block.gamma,
        g: block.gravity,
        epsilon: block.epsilon,
        supports,
        e,
        friction: friction::to_user(block.friction),
        friction_range: range(|block| block.friction).map(friction::to_user),
        eccentricity: block.eccentricity,
        ties: links(LinkKind::Tie),
        dampers: links(LinkKind::Damper),
        is_beside_the_middle: sweep
            .parameters
            .iter()
            .any(|swept| matches!(&swept.values, ParameterValues::List(values) if values.len() % 2 == 0)),
        static_threshold: static_threshold(block),
    }
}

pub(super) fn building(plan: &Plan) -> Option<BuildingResult> {
    let building = plan.sweep.building.as_ref()?;
    let threshold = static_threshold(&plan.block);
    let pga = |motion: &GroundMotion| {
        let [pga, pfa] =
            [Measure::Pga, Measure::Pfa].map(|measure| motion.intensity(measure, 1.0, (&plan.block).into()));
        Some(threshold? * pga? / pfa?)
    };
    let modes = building.modes();
    Some(BuildingResult {
        floors: building.floors(),
        stands_on: plan.floors(),
        periods: modes.iter().map(|mode| 1.0 / mode.frequency).collect(),
        damping: modes.iter().map(|mode| mode.damping).collect(),
        least_pga: plan.sweep.motions.iter().filter_map(pga).reduce(f64::min),
    })
}

pub(super) fn motions(plan: &Plan) -> Vec<MotionResult> {
    let Plan { sweep, block, .. } = plan;
    let motion = |number: usize| {
        let motion = &sweep.motions[number];
        let scales = (0..sweep.strengths.count()).map(|strength| sweep.strengths.scale(strength, motion, block.into()));
        let floor = motion.floor.map(|floor| format!(", floor {floor}")).unwrap_or_default();
        MotionResult {
            name: motion.name() + &floor,
            pga: motion.intensity(Measure::Pga, 1.0, block.into()),
            pgv: motion.intensity(Measure::Pgv, 1.0, block.into()),
            pfa: motion.intensity(Measure::Pfa, 1.0, block.into()),
            pfv: motion.intensity(Measure::Pfv, 1.0, block.into()),
            scales: range(scales).unwrap_or([1.0; 2]),
        }
    };
    // A reversed motion is listed with the one that it reverses, whose measures and factors it has.
    (0..sweep.motions.len()).filter(|&number| !sweep.motions[number].is_reversed).map(motion).collect()
}

pub(super) fn strengths(sweep: &Sweep) -> Vec<String> {
    match &sweep.strengths {
        Strengths::Scales(scales) => scales.iter().map(|scale| format!("{scale} times the record")).collect(),
        Strengths::Levels(measure, levels) => {
            levels.iter().map(|level| format!("{measure} = {level} {}", measure.unit())).collect()
        }
        Strengths::Least(..) | Strengths::Hunt(..) => Vec::new(),
    }
}

pub(super) fn hazard_result(Hazard { file, curve, .. }: &Hazard) -> HazardResult {
    let levels = curve.levels();
    HazardResult { file: file.clone(), levels: levels.len(), range: [levels[0], levels[levels.len() - 1]] }
}
