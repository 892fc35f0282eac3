//! Values of parameters → body, initial state, pulse and settings of a block in space.
//!
//! Names every parameter of modelDescriptionInSpace.xml, once.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

use crate::excitation::{Pulse, PulseShape};
use crate::run::{OnOverturning, OnSeparation, Settings};
use crate::space::excitation::MAX_PULSES;
use crate::space::{
    Base, BaseSize, DirectedPulse, FootPlace, SpaceBody, SpaceInitial, SpaceParameters, SpaceSetup, SpaceSupports,
};
use crate::unit::choice::{on_overturning, on_separation, pulse_shape};
use crate::unit::in_space::feet;
use crate::unit::in_space::fmi3_values::SpaceFmi3Values;
use crate::unit::in_space::variables::{Choice, Parameter, Role, Text, VARIABLES, Variable, choices};

/// Values of all parameters that the importer sets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpaceValues {
    /// Numbers by value reference; start values for other variables. Integers, enumerations and Booleans (0 or 1) are stored as reals.
    numbers: Vec<f64>,
    /// Texts, in the order of [`Text::ALL`].
    texts: [String; Text::ALL.len()],
    /// Those that only FMI 3.0 has.
    pub(super) fmi3: SpaceFmi3Values,
}

impl Default for SpaceValues {
    fn default() -> SpaceValues {
        SpaceValues {
            numbers: VARIABLES.iter().map(|metadata| metadata.start.unwrap_or(0.0)).collect(),
            texts: Default::default(),
            fmi3: SpaceFmi3Values::default(),
        }
    }
}

impl Index<Text> for SpaceValues {
    type Output = String;

    fn index(&self, text: Text) -> &String {
        &self.texts[text as usize]
    }
}

impl IndexMut<Text> for SpaceValues {
    fn index_mut(&mut self, text: Text) -> &mut String {
        &mut self.texts[text as usize]
    }
}

impl Index<Variable> for SpaceValues {
    type Output = f64;

    fn index(&self, variable: Variable) -> &f64 {
        &self.numbers[variable as usize]
    }
}

impl IndexMut<Variable> for SpaceValues {
    fn index_mut(&mut self, variable: Variable) -> &mut f64 {
        &mut self.numbers[variable as usize]
    }
}

impl SpaceValues {
    /// Whether there is one value for each variable, within its limits.
    pub fn are_valid(&self) -> bool {
        self.fmi3.are_valid()
            && self.numbers.len() == VARIABLES.len()
            && VARIABLES.iter().zip(&self.numbers).all(|(metadata, &value)| {
                !metadata.is_settable() || (value.is_finite() && metadata.admits(value).is_ok())
            })
    }

    /// Returns the chosen item of an enumeration.
    fn choice<C: Choice>(&self, variable: Variable) -> C {
        C::of(self[variable])
            .unwrap_or_else(|| unreachable!("{} = {} is checked where it is set", variable.name(), self[variable]))
    }

    fn is_physical(&self) -> bool {
        match self.choice(Variable::Parameterization) {
            choices::Parameterization::Dimensionless => false,
            choices::Parameterization::Physical => true,
        }
    }

    fn base(&self) -> choices::Base {
        self.choice(Variable::Base)
    }

    /// Whether the base is a rectangle, whose feet have names.
    pub fn is_rectangle(&self) -> bool {
        self.base() == choices::Base::Rectangle
    }

    /// Returns the inertia I_xx, I_yy, I_zz, I_xy, I_xz, I_yz, if it is given.
    fn inertia(&self) -> Option<[f64; 6]> {
        let inertia = [
            Variable::PhysicalInertiaX,
            Variable::PhysicalInertiaY,
            Variable::PhysicalInertiaZ,
            Variable::PhysicalInertiaXy,
            Variable::PhysicalInertiaXz,
            Variable::PhysicalInertiaYz,
        ];
        let inertia = inertia.map(|variable| self[variable]);
        (self.is_physical() && inertia != [0.0; 6]).then_some(inertia)
    }

    /// Refuses a length or stiffness of 0.
    fn positive(&self, variable: Variable) -> Result<f64, String> {
        let value = self[variable];
        if value > 0.0 { Ok(value) } else { Err(format!("{} = {value}; expected a number above 0", variable.name())) }
    }

    fn center_height(&self) -> Result<f64, String> {
        if self[Variable::PhysicalCenterHeight] > 0.0 {
            return Ok(self[Variable::PhysicalCenterHeight]);
        }
        Ok(0.5 * self.positive(Variable::PhysicalHeight)?)
    }

    fn size(&self) -> Result<BaseSize, String> {
        Ok(if self.is_physical() {
            BaseSize::Lengths { width: self.positive(Variable::PhysicalWidth)?, center_height: self.center_height()? }
        } else {
            BaseSize::Slenderness { alpha: self[Variable::DimensionlessAlpha], p: self[Variable::DimensionlessP] }
        })
    }

    /// Returns the feet of a list.
    fn feet(&self) -> Result<Vec<FootPlace>, String> {
        let path = &self[Text::FeetFile];
        if !path.is_empty() {
            return feet::read(path).map_err(|error| format!("{}: {path}: {error}", Variable::FeetFile.name()));
        }
        let [x, y, gap] = &self.fmi3.feet;
        if x.iter().chain(y).all(|&place| place == 0.0) {
            return Err(format!(
                "base = List without feet; expected {} or, in FMI 3.0, foot_x and foot_y",
                Variable::FeetFile.name()
            ));
        }
        Ok(x.iter().zip(y).zip(gap).map(|((&x, &y), &gap)| FootPlace { x, y, gap }).collect())
    }

    /// Makes the block.
    ///
    /// # Errors
    /// One line: the first invalid parameter.
    pub fn body(&self) -> Result<SpaceBody, String> {
        match self.choice(Variable::Foundation) {
            choices::Foundation::Viscoelastic => {}
            choices::Foundation::Rigid => {
                return Err(
                    "foundation = Rigid is not for a block in space; expected Viscoelastic, for a stiff base with \
                            dimensionless.eta of 100 to 300"
                        .into(),
                );
            }
        }
        let physical = self.is_physical();
        let base = match self.base() {
            choices::Base::Rectangle => {
                let depth_ratio = if physical {
                    self.positive(Variable::PhysicalDepth)? / self.positive(Variable::PhysicalWidth)?
                } else {
                    self[Variable::DimensionlessDepthRatio]
                };
                Base::Rectangle { size: self.size()?, depth_ratio }
            }
            choices::Base::Circle => Base::Circle { size: self.size()?, feet: self[Variable::Feet] as usize },
            choices::Base::List if !physical => {
                return Err(
                    "base = List with parameterization = Dimensionless; expected Physical, whose sizes a list needs"
                        .into(),
                );
            }
            choices::Base::List => Base::List { feet: self.feet()?, center_height: self.center_height()? },
        };
        let supports = if physical {
            let (stiffness, damping) = (self.positive(Variable::PhysicalK)?, self.positive(Variable::PhysicalC)?);
            SpaceSupports::OfFoot { stiffness, damping }
        } else {
            SpaceSupports::OfRocking { eta: self[Variable::DimensionlessEta], xi_v: self[Variable::DimensionlessXiV] }
        };
        let parameters = SpaceParameters {
            base,
            supports,
            kappa: self[Variable::Kappa],
            xi_h: (self[Variable::XiH] >= 0.0).then_some(self[Variable::XiH]),
            friction: self[Variable::Friction],
            mass: self[Variable::Mass],
            gamma: self[Variable::Gamma],
            gravity: self[Variable::G],
            eccentricity: [self[Variable::EccentricityX], self[Variable::EccentricityY]],
            inertia: self.inertia(),
        };
        SpaceBody::new(&parameters).map_err(|error| error.to_string())
    }

    /// Returns the block with its settings and its pulse, with this tolerance or the default.
    ///
    /// # Errors
    /// Those of [`SpaceValues::body`].
    pub fn setup(&self, tolerance: Option<f64>) -> Result<SpaceSetup, String> {
        let settings = Settings {
            tolerance: tolerance.unwrap_or(Settings::default().tolerance),
            on_separation: on_separation!(self.choice(Variable::OnSeparation)),
            on_overturning: on_overturning!(self.choice(Variable::OnOverturning)),
        };
        let mut pulses = [DirectedPulse::NONE; MAX_PULSES];
        pulses[0] = DirectedPulse::horizontal(self.pulse(), self[Variable::PulseAzimuth]);
        Ok(SpaceSetup { body: self.body()?, settings, pulses })
    }

    fn pulse(&self) -> Pulse {
        Pulse {
            shape: pulse_shape!(self.choice(Variable::PulseShape)),
            amplitude: self[Variable::PulseAmplitude],
            period: self[Variable::PulsePeriod],
            start: self[Variable::PulseStart],
            phase: self[Variable::PulsePhase],
            cycles: self[Variable::PulseCycles],
        }
    }

    /// Returns the initial state.
    pub fn initial(&self) -> SpaceInitial {
        SpaceInitial {
            tilt: [self[Variable::InitialTiltX], self[Variable::InitialTiltY]],
            twist: self[Variable::InitialTwist],
            omega: [self[Variable::InitialOmegaX], self[Variable::InitialOmegaY], self[Variable::InitialOmegaZ]],
            vertical: (self[Variable::InitialSettled] == 0.0)
                .then_some([self[Variable::InitialV], self[Variable::InitialVDot]]),
        }
    }

    /// Returns the missing setting that a parameter needs to be read, if any.
    fn lacks(&self, parameter: Parameter) -> Option<&'static str> {
        let (physical, base) = (self.is_physical(), self.base());
        let name = parameter.variable().name();
        if physical && name.starts_with("dimensionless.") {
            return Some("parameterization = Dimensionless");
        }
        if !physical && name.starts_with("physical.") {
            return Some("parameterization = Physical");
        }
        let is_list = base == choices::Base::List;
        match parameter {
            Parameter::DimensionlessDepthRatio | Parameter::PhysicalDepth => {
                (base != choices::Base::Rectangle).then_some("base = Rectangle")
            }
            Parameter::Feet => (base != choices::Base::Circle).then_some("base = Circle"),
            Parameter::PhysicalWidth => is_list.then_some("base = Rectangle or Circle"),
            Parameter::PhysicalHeight => {
                (self[Variable::PhysicalCenterHeight] != 0.0).then_some("physical.center_height = 0")
            }
            Parameter::Gamma => self.inertia().map(|_| "physical.inertia_x = 0"),
            Parameter::InitialV | Parameter::InitialVDot => {
                (self[Variable::InitialSettled] != 0.0).then_some("initial.settled = false")
            }
            Parameter::PulseAmplitude | Parameter::PulsePeriod | Parameter::PulseStart | Parameter::PulseAzimuth => {
                (self.pulse().shape == PulseShape::None).then_some("a pulse.shape")
            }
            Parameter::PulsePhase | Parameter::PulseCycles => {
                (self.pulse().shape != PulseShape::Gabor).then_some("pulse.shape = Gabor")
            }
            Parameter::RecordScale | Parameter::RecordStart | Parameter::RecordDt | Parameter::RecordAzimuth
                if self.fmi3.has_record() =>
            {
                None
            }
            Parameter::RecordScale | Parameter::RecordStart | Parameter::RecordDt => {
                (!self.has_file()).then_some("record.x, record.y or record.z")
            }
            Parameter::RecordAzimuth | Parameter::RecordXChannel => {
                self[Text::RecordX].is_empty().then_some("record.x")
            }
            Parameter::RecordYChannel => self[Text::RecordY].is_empty().then_some("record.y"),
            Parameter::RecordZChannel => self[Text::RecordZ].is_empty().then_some("record.z"),
            Parameter::Parameterization
            | Parameter::Base
            | Parameter::Foundation
            | Parameter::DimensionlessAlpha
            | Parameter::DimensionlessP
            | Parameter::DimensionlessEta
            | Parameter::DimensionlessXiV
            | Parameter::PhysicalCenterHeight
            | Parameter::PhysicalInertiaX
            | Parameter::PhysicalInertiaY
            | Parameter::PhysicalInertiaZ
            | Parameter::PhysicalInertiaXy
            | Parameter::PhysicalInertiaXz
            | Parameter::PhysicalInertiaYz
            | Parameter::PhysicalK
            | Parameter::PhysicalC
            | Parameter::Mass
            | Parameter::EccentricityX
            | Parameter::EccentricityY
            | Parameter::Kappa
            | Parameter::XiH
            | Parameter::Friction
            | Parameter::G
            | Parameter::OnSeparation
            | Parameter::OnOverturning
            | Parameter::InitialTiltX
            | Parameter::InitialTiltY
            | Parameter::InitialTwist
            | Parameter::InitialOmegaX
            | Parameter::InitialOmegaY
            | Parameter::InitialOmegaZ
            | Parameter::InitialSettled
            | Parameter::PulseShape => None,
        }
    }

    /// Returns the missing setting that a text needs to be read, if any.
    fn text_lacks(&self, text: Text) -> Option<&'static str> {
        match text {
            Text::FeetFile => (self.base() != choices::Base::List).then_some("base = List"),
            Text::RecordX | Text::RecordY | Text::RecordZ => None,
            Text::RecordXUnit => (!self.has_file()).then_some("record.x, record.y or record.z"),
            Text::RecordYUnit => self[Text::RecordY].is_empty().then_some("record.y"),
            Text::RecordZUnit => self[Text::RecordZ].is_empty().then_some("record.z"),
        }
    }

    fn is_at_start(&self, variable: Variable) -> bool {
        Some(self[variable]) == variable.metadata().start
    }

    /// Returns the parameters that were set but are not read. Each has the setting that it needs.
    pub fn unread(&self) -> Vec<(&'static str, &'static str)> {
        let numbers = VARIABLES.iter().filter_map(|metadata| {
            let Role::Parameter(parameter) = metadata.role else { return None };
            let needed = self.lacks(parameter)?;
            (!self.is_at_start(metadata.variable)).then_some((metadata.name, needed))
        });
        let texts = Text::ALL.into_iter().filter(|&text| !self[text].is_empty());
        numbers.chain(texts.filter_map(|text| Some((text.variable().name(), self.text_lacks(text)?)))).collect()
    }

    /// Returns the sizes that are read but have their start values, which fit no real block.
    pub fn unset_sizes(&self) -> Vec<(&'static str, f64)> {
        if !self.is_physical() {
            return Vec::new();
        }
        let read = VARIABLES.iter().filter_map(|metadata| match metadata.role {
            Role::Parameter(
                size @ (Parameter::PhysicalWidth
                | Parameter::PhysicalDepth
                | Parameter::PhysicalHeight
                | Parameter::PhysicalK
                | Parameter::PhysicalC),
            ) => self.lacks(size).is_none().then_some(metadata.variable),
            Role::Parameter(_) | Role::Input(_) | Role::Text(_) | Role::Derived(_) | Role::Output(_) => None,
        });
        read.filter(|&size| self.is_at_start(size)).map(|size| (size.name(), self[size])).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of the items are those of the shapes.
    #[test]
    fn pulses_are_the_shapes_with_their_numbers() {
        let items = Variable::PulseShape.metadata().items;
        let shapes = PulseShape::ALL.map(|shape| (shape as i32, format!("{shape:?}")));
        assert!(items.iter().map(|&(number, name)| (number, name.to_string())).eq(shapes));
    }
}
