//! A sweep, the values in its middle → the object, in the plane or in space.

use crate::input::parameters::Parameter;
use crate::intensity::BlockScales;
use crate::spec::numbers_in_space::NumbersInSpace;
use crate::spec::words::friction;
use crate::sweep::Sweep;
use rocking_block::block::Block;
use rocking_block::space::{SpaceBody, SpaceParameters};
use rocking_block::unit::values::Values;
use rocking_block::unit::variables::Variable;

/// The object of an assessment.
#[derive(Clone, Debug)]
pub enum AssessedObject {
    /// A block in the plane.
    Plane(Box<Block>),
    /// A block in space.
    Space(Box<ObjectInSpace>),
}

/// An object in space.
#[derive(Clone, Debug)]
pub struct ObjectInSpace {
    /// The parameters.
    pub parameters: SpaceParameters,
    /// The block.
    pub body: SpaceBody,
}

/// The values of a study for one object: those of the FMU and, in space, those of the block.
#[derive(Clone, Debug)]
pub struct ObjectValues {
    /// The variables of the FMU; in space those of the pulse and of complete separation.
    pub variables: Values,
    /// The numbers of a block in space.
    pub in_space: Option<Box<NumbersInSpace>>,
}

impl ObjectValues {
    /// Those of a combination of the parameters.
    pub(super) fn of(sweep: &Sweep, combination: &[f64]) -> ObjectValues {
        ObjectValues { variables: sweep.values(combination), in_space: sweep.numbers_in_space(combination) }
    }

    /// Each parameter in the middle of its range or list.
    pub(super) fn middle(sweep: &Sweep) -> ObjectValues {
        ObjectValues::of(sweep, &sweep.middle())
    }

    /// The value of a parameter; `None` for a number of a block in space that the study does not name.
    pub(super) fn number(&self, parameter: &Parameter) -> Option<f64> {
        match parameter.variable() {
            Some(variable) => Some(self.variables[variable]),
            None => *self.in_space.clone()?.number_mut(parameter.in_space_number()?),
        }
    }

    /// The height of the body (m), twice that of its centre of mass, unless the study gives the latter alone.
    pub(super) fn height(&self, object: &AssessedObject) -> Option<f64> {
        match object {
            AssessedObject::Plane(block) => {
                (self.variables[Variable::PhysicalCenterHeight] <= 0.0).then_some(2.0 * block.h)
            }
            AssessedObject::Space(object) => {
                let has_center_height = self.in_space.as_ref()?.block.center_height.is_some();
                (!has_center_height).then_some(2.0 * object.body.center_height)
            }
        }
    }

    /// The object with the changes of a sweep.
    ///
    /// # Errors
    /// The first parameter that is not valid.
    pub(super) fn object(&self, sweep: &Sweep) -> Result<AssessedObject, String> {
        Ok(match &self.in_space {
            Some(numbers) => {
                let made = sweep.block_in_space(numbers).map_err(|error| error.spelled(str::to_owned))?;
                AssessedObject::Space(Box::new(ObjectInSpace { parameters: made.0, body: made.1 }))
            }
            None => AssessedObject::Plane(Box::new(sweep.block(&self.variables).map_err(|error| error.to_string())?)),
        })
    }
}

impl AssessedObject {
    /// The block in the plane, if it is one.
    pub fn in_plane(&self) -> Option<&Block> {
        match self {
            AssessedObject::Plane(block) => Some(block),
            AssessedObject::Space(_) => None,
        }
    }

    /// The block in space, if it is one.
    pub fn in_space(&self) -> Option<&ObjectInSpace> {
        match self {
            AssessedObject::Plane(_) => None,
            AssessedObject::Space(object) => Some(object),
        }
    }

    /// The scales of measures relative to the object.
    pub fn scales(&self) -> BlockScales {
        match self {
            AssessedObject::Plane(block) => (&**block).into(),
            AssessedObject::Space(object) => (&object.body).into(),
        }
    }

    /// The slenderness α (rad) of the middle of the base, in space that of the balance over the nearest edge.
    pub(super) fn alpha(&self) -> f64 {
        self.in_plane().map_or_else(|| self.scales().alpha, |block| block.alpha)
    }

    /// The weight M g (N).
    pub(super) fn weight(&self) -> f64 {
        match self {
            AssessedObject::Plane(block) => block.mass * block.gravity,
            AssessedObject::Space(object) => object.body.mass * object.body.gravity,
        }
    }

    /// The least distance from the centre of mass to an edge of the base, seen from above, over its height.
    pub(super) fn slope(&self) -> f64 {
        match self {
            AssessedObject::Plane(block) => (block.b - block.eccentricity.abs()) / block.h,
            AssessedObject::Space(object) => object.body.edge_distance / object.body.center_height,
        }
    }

    /// The quasi-static horizontal acceleration (m/s²) that lifts a corner or an edge. `None` for a block with ties.
    pub(super) fn static_threshold(&self) -> Option<f64> {
        let has_ties = self.in_plane().is_some_and(|block| !block.ties().is_empty());
        (!has_ties).then(|| self.scales().gravity * self.slope())
    }

    /// The coefficient of friction of users, infinite without a limit.
    pub(super) fn friction(&self) -> f64 {
        match self {
            AssessedObject::Plane(block) => friction::to_user(block.friction),
            // The default in space is one that no foot reaches.
            AssessedObject::Space(object) if object.body.friction >= SpaceParameters::default().friction => {
                f64::INFINITY
            }
            AssessedObject::Space(object) => object.body.friction,
        }
    }
}
