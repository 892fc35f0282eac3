//! A plan → the object, its building, its ground motions and its hazard in numbers.

use crate::assess::object::{AssessedObject, ObjectInSpace, ObjectValues};
use crate::assess::plan::{Hazard, Plan};
use crate::assess::results::{
    BodyResult, BuildingResult, HazardResult, MotionResult, ObjectResult, PlaneResult, SpaceResult, SupportsResult,
};
use crate::intensity::{ComponentMeasure, Measure, OverDirections};
use crate::space::facts;
use crate::spec::words::Words;
use crate::statistics::range;
use crate::sweep::Sweep;
use crate::sweep::ground_motion::GroundMotion;
use crate::sweep::parameters::ParameterValues;
use crate::sweep::strength::Strengths;
use rocking_block::block::restraints::LinkKind;
use rocking_block::block::{Block, Foundation};
use rocking_block::space::Base;

pub(super) fn object(plan: &Plan) -> ObjectResult {
    let Plan { sweep, object, .. } = plan;
    let objects = || {
        let of = |number: u64| ObjectValues::of(sweep, &sweep.combination(number)).object(sweep).ok();
        (0..sweep.combinations().unwrap_or(0)).filter_map(of)
    };
    let over_all =
        |value: fn(&AssessedObject) -> f64| range(objects().map(|object| value(&object))).unwrap_or([value(object); 2]);
    let (width, center_height, mass, r0, eccentricity) = match object {
        AssessedObject::Plane(block) => (2.0 * block.b, block.h, block.mass, block.r0, block.eccentricity),
        AssessedObject::Space(object) => {
            let ObjectInSpace { parameters, body } = &**object;
            (2.0 * body.half_width, body.center_height, body.mass, body.r0, parameters.eccentricity[0])
        }
    };
    ObjectResult {
        foundation: object.in_plane().map_or(Foundation::Viscoelastic, |block| block.foundation).word(),
        width,
        center_height,
        mass,
        alpha: object.alpha(),
        alpha_range: over_all(AssessedObject::alpha),
        p: object.scales().p,
        p_range: over_all(|object| object.scales().p),
        r0,
        g: object.scales().gravity,
        friction: object.friction(),
        friction_range: over_all(AssessedObject::friction),
        eccentricity,
        body: match object {
            AssessedObject::Plane(block) => BodyResult::Plane(in_plane(block)),
            AssessedObject::Space(object) => BodyResult::Space(Box::new(in_space(object))),
        },
        is_beside_the_middle: sweep
            .parameters
            .iter()
            .any(|swept| matches!(&swept.values, ParameterValues::List(values) if values.len() % 2 == 0)),
        static_threshold: object.static_threshold(),
    }
}

fn in_plane(block: &Block) -> PlaneResult {
    let supports = block.ratios().viscoelastic().map(|ratios| SupportsResult {
        stiffness: block.stiffness,
        damping: block.damping,
        ratios,
        delta_s: block.static_deflection(),
    });
    let links = |kind| block.ties().iter().filter(|tie| tie.kind == kind && tie.is_present()).count();
    PlaneResult {
        gamma: block.gamma,
        epsilon: block.epsilon,
        e: supports.is_none().then(|| block.restitution()),
        supports,
        ties: links(LinkKind::Tie),
        dampers: links(LinkKind::Damper),
    }
}

fn in_space(ObjectInSpace { parameters, body }: &ObjectInSpace) -> SpaceResult {
    let depth = range(body.feet.iter().map(|foot| foot.place.y)).map_or(0.0, |[low, high]| high - low);
    SpaceResult {
        base: match parameters.base {
            Base::Rectangle { .. } => "rectangle",
            Base::Circle { .. } => "circle",
            Base::List { .. } => "list",
        },
        depth,
        feet: body.count(),
        eccentricity_y: parameters.eccentricity[1],
        inertia: facts::inertia(body),
        omega_v: body.omega_v,
        xi_v: body.xi_v,
        kappa: parameters.kappa,
        xi_h: parameters.xi_h.unwrap_or(body.xi_v),
        stiffness: body.stiffness,
        damping: body.damping,
        delta_s: body.gravity / (body.omega_v * body.omega_v),
    }
}

pub(super) fn building(plan: &Plan) -> Option<BuildingResult> {
    let building = plan.sweep.building.as_ref()?;
    let threshold = plan.object.static_threshold();
    let pga = |motion: &GroundMotion| {
        let [pga, pfa] =
            [Measure::Pga, Measure::Pfa].map(|measure| motion.intensity(measure, 1.0, plan.object.scales()));
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
    let Plan { sweep, object, measure, .. } = plan;
    let of_object = object.scales();
    // In space the measures are those of both components, in the way of the measure of the curves.
    let over = sweep.space.as_ref().map(|_| measure.of_component().1.unwrap_or(OverDirections::RotD50));
    let of_ground = |measure: Measure, pair: ComponentMeasure| over.map_or(measure, |over| Measure::OfPair(pair, over));
    let motion = |number: usize| {
        let motion = &sweep.motions[number];
        let scales = (0..sweep.strengths.count()).map(|strength| sweep.strengths.scale(strength, motion, of_object));
        let floor = motion.floor.map(|floor| format!(", floor {floor}")).unwrap_or_default();
        MotionResult {
            name: motion.name() + &floor,
            motion: motion.motion.to_string(),
            azimuth: sweep.space.as_ref().map(|_| motion.azimuth),
            pga: motion.intensity(of_ground(Measure::Pga, ComponentMeasure::Pga), 1.0, of_object),
            pgv: motion.intensity(of_ground(Measure::Pgv, ComponentMeasure::Pgv), 1.0, of_object),
            pfa: motion.intensity(Measure::Pfa, 1.0, of_object),
            pfv: motion.intensity(Measure::Pfv, 1.0, of_object),
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
