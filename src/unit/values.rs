//! Values of parameters → block, initial state, pulse, settings and calculated parameters.
//!
//! Names every parameter of modelDescription.xml, once.

use crate::block::restraints::{Tie, Ties};
use crate::block::{
    Block, BlockError, BlockParameters, Common, Foundation, KelvinVoigt, Outline, Ratios, Restraints, Springs, Supports,
};
use crate::excitation::{Pulse, PulseShape};
use crate::numerics::scalar::Elementary;
use crate::run::{OnOverturning, OnSeparation, Settings};
use crate::simulation::Initial;
use crate::unit::choice::{on_overturning, on_separation, pulse_shape};
use crate::unit::fmi3_variables::Fmi3Values;
use crate::unit::links::LINKS;
use crate::unit::variables::{Choice, Parameter, Role, Text, VARIABLES, Variable, choices};

/// Values of all parameters that the importer sets.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Values {
    /// Numbers by value reference; start values for other variables. Integers, enumerations and Booleans (0 or 1) are stored as reals.
    numbers: Vec<f64>,
    /// Texts, in the order of [`Text::ALL`].
    texts: [String; Text::ALL.len()],
    /// Values of the variables that exist only in FMI 3.0.
    pub(super) fmi3: Fmi3Values,
}

impl Default for Values {
    fn default() -> Values {
        let numbers = VARIABLES.iter().map(|metadata| metadata.start.unwrap_or(0.0)).collect();
        Values { numbers, texts: Default::default(), fmi3: Fmi3Values::default() }
    }
}

impl std::ops::Index<Text> for Values {
    type Output = String;

    fn index(&self, text: Text) -> &String {
        &self.texts[text as usize]
    }
}

impl std::ops::IndexMut<Text> for Values {
    fn index_mut(&mut self, text: Text) -> &mut String {
        &mut self.texts[text as usize]
    }
}

impl std::ops::Index<Variable> for Values {
    type Output = f64;

    fn index(&self, variable: Variable) -> &f64 {
        &self.numbers[variable as usize]
    }
}

impl std::ops::IndexMut<Variable> for Values {
    fn index_mut(&mut self, variable: Variable) -> &mut f64 {
        &mut self.numbers[variable as usize]
    }
}

const ON_SUPPORTS: &str = "foundation = Viscoelastic";

impl Values {
    /// Whether there is one value for each variable, within its limits.
    pub fn are_valid(&self) -> bool {
        self.fmi3.are_valid()
            && self.numbers.len() == VARIABLES.len()
            && VARIABLES.iter().zip(&self.numbers).all(|(metadata, &value)| {
                !metadata.is_settable() || (value.is_finite() && metadata.admits(value).is_ok())
            })
    }

    /// Makes the block from the parameters.
    ///
    /// # Errors
    /// The first invalid parameter of the block, of its supports, or of a tie or damper.
    pub fn block(&self) -> Result<Block, BlockError> {
        let block = Block::new(&self.block_parameters(|variable| self[variable]))?;
        if self.foundation() == Foundation::Rigid {
            self.block_on_supports()?;
        }
        let ties = self.ties(|variable| self[variable]);
        for (tie, (name, _)) in ties.iter().zip(*LINKS) {
            tie.check(name)?;
        }
        block.with_ties(&ties)
    }

    /// Makes the block as it would stand on its supports, even on a rigid base. Calculated parameters show them there, too.
    ///
    /// # Errors
    /// The first invalid parameter.
    pub fn block_on_supports(&self) -> Result<Block, BlockError> {
        Block::new(&self.parameters_on(Foundation::Viscoelastic, |variable| self[variable]))
    }

    /// Makes [`Values::block_on_supports`] with the parameters from `of`, without checks.
    pub fn varied_block_on_supports<T: Elementary>(&self, of: impl Fn(Variable) -> T) -> Block<T> {
        Block::unchecked(&self.parameters_on(Foundation::Viscoelastic, of))
    }

    /// Makes the block with the parameters from `of`, such as numbers with derivatives, without checks.
    pub fn varied_block<T: Elementary>(&self, of: impl Fn(Variable) -> T) -> Block<T> {
        let mut block = Block::unchecked(&self.block_parameters(&of));
        block.body.restraints = Restraints { ties: Ties::of(&self.ties(of)) };
        block
    }

    /// Returns the ties up to the last one that is present, with parameters from `of`.
    pub fn ties<T: Elementary>(&self, of: impl Fn(Variable) -> T) -> Vec<Tie<T>> {
        let count = LINKS.iter().rposition(|(_, tie)| self.is_present(tie)).map_or(0, |last| last + 1);
        LINKS[..count].iter().map(|(_, tie)| tie.map(|variable| variable.map_or(T::from(0.0), &of))).collect()
    }

    /// Returns the parameters of the block from `of`.
    pub fn block_parameters<T: Elementary>(&self, of: impl Fn(Variable) -> T) -> BlockParameters<T> {
        self.parameters_on(self.foundation(), of)
    }

    fn parameters_on<T: Elementary>(&self, foundation: Foundation, of: impl Fn(Variable) -> T) -> BlockParameters<T> {
        let is_physical = self.is_physical();
        let outline = if is_physical {
            Outline::Sizes { width: 0.0, height: 0.0, inertia: self.has_inertia().then_some(0.0) }
        } else {
            Outline::Slenderness { alpha: 0.0, p: 0.0 }
        };
        let supports = match foundation {
            Foundation::Viscoelastic if is_physical => Supports::Viscoelastic(KelvinVoigt::Springs(Springs::default())),
            Foundation::Viscoelastic => Supports::Viscoelastic(KelvinVoigt::Ratios(Ratios::default())),
            Foundation::Rigid => Supports::HOUSNER,
        };
        let mut parameters = BlockParameters { outline, supports, common: Common::default() }.map(T::from);
        for (name, _, number) in parameters.numbers_mut() {
            *number = match name {
                "height" if self.has_center_height() => of(Variable::PhysicalCenterHeight) * 2.0,
                name => of(Variable::of_number(name)),
            };
        }
        parameters
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

    /// Whether the height of the centre of mass is read, if sizes are.
    fn has_center_height(&self) -> bool {
        self[Variable::PhysicalCenterHeight] != 0.0
    }

    /// Whether the moment of inertia is read, if sizes are.
    fn has_inertia(&self) -> bool {
        self[Variable::PhysicalInertia] != 0.0
    }

    fn foundation(&self) -> Foundation {
        match self.choice(Variable::Foundation) {
            choices::Foundation::Viscoelastic => Foundation::Viscoelastic,
            choices::Foundation::Rigid => Foundation::Rigid,
        }
    }

    /// Returns the parameters of a physical parameterization whose defaults fit no real block. A mass matters only beside a
    /// stiffness, a moment of inertia or ties. Empty for a dimensionless parameterization.
    pub fn sizes(&self) -> Vec<Variable> {
        use Variable::{Mass, PhysicalC, PhysicalCenterHeight, PhysicalHeight, PhysicalK, PhysicalWidth};
        if !self.is_physical() {
            return Vec::new();
        }
        let height = if self.has_center_height() { PhysicalCenterHeight } else { PhysicalHeight };
        let mut sizes = vec![PhysicalWidth, height];
        if self.foundation() == Foundation::Viscoelastic {
            sizes.extend([PhysicalK, PhysicalC]);
        }
        if self.foundation() == Foundation::Viscoelastic || self.has_inertia() || self.has_ties() {
            sizes.push(Mass);
        }
        sizes
    }

    /// The [`Values::sizes`] that have their start values, except the mass.
    pub fn unset_sizes(&self) -> impl Iterator<Item = Variable> {
        let is_unset = |variable: Variable| Some(self[variable]) == VARIABLES[variable as usize].start;
        let sizes = self.sizes().into_iter().filter(|&variable| variable != Variable::Mass);
        sizes.filter(move |&variable| is_unset(variable))
    }

    fn has_ties(&self) -> bool {
        LINKS.iter().any(|(_, tie)| self.is_present(tie))
    }

    fn is_present(&self, tie: &Tie<Option<Variable>>) -> bool {
        tie.map(|number| number.map_or(0.0, |variable| self[variable])).is_present()
    }

    /// Returns the missing setting that a parameter needs to be read, if any.
    fn lacks(&self, parameter: Parameter) -> Option<&'static str> {
        let (physical, rigid) = (self.is_physical(), self.foundation() == Foundation::Rigid);
        let name = parameter.variable().name();
        if physical && name.starts_with("dimensionless.") {
            return Some("parameterization = Dimensionless");
        }
        if !physical && name.starts_with("physical.") {
            return Some("parameterization = Physical");
        }
        match parameter {
            Parameter::PhysicalHeight => self.has_center_height().then_some("physical.center_height = 0"),
            Parameter::Gamma => (physical && self.has_inertia()).then_some("physical.inertia = 0"),
            Parameter::InitialV | Parameter::InitialVDot if rigid => Some(ON_SUPPORTS),
            Parameter::InitialV | Parameter::InitialVDot => {
                (self[Variable::InitialSettled] != 0.0).then_some("initial.settled = false")
            }
            Parameter::RestitutionFactor => (!rigid).then_some("foundation = Rigid"),
            Parameter::PulseAmplitude | Parameter::PulsePeriod | Parameter::PulseStart => {
                (self.pulse().shape == PulseShape::None).then_some("a pulse.shape")
            }
            Parameter::PulsePhase | Parameter::PulseCycles => {
                (self.pulse().shape != PulseShape::Gabor).then_some("pulse.shape = Gabor")
            }
            Parameter::RecordScale | Parameter::RecordStart | Parameter::RecordDt => {
                (!self.has_record()).then_some("record.horizontal or record.vertical")
            }
            Parameter::RecordHorizontalChannel => {
                self[Text::RecordHorizontal].is_empty().then_some("record.horizontal")
            }
            Parameter::RecordVerticalChannel => self[Text::RecordVertical].is_empty().then_some("record.vertical"),
            Parameter::DimensionlessAlpha
            | Parameter::DimensionlessP
            | Parameter::DimensionlessEta
            | Parameter::DimensionlessXiV
            | Parameter::PhysicalWidth
            | Parameter::PhysicalCenterHeight
            | Parameter::PhysicalInertia
            | Parameter::PhysicalK
            | Parameter::PhysicalC
            | Parameter::Parameterization
            | Parameter::Mass
            | Parameter::Eccentricity
            | Parameter::Epsilon
            | Parameter::G
            | Parameter::Friction
            | Parameter::Foundation
            | Parameter::OnSeparation
            | Parameter::OnOverturning
            | Parameter::InitialTheta
            | Parameter::InitialThetaDot
            | Parameter::InitialSettled
            | Parameter::PulseShape => None,
        }
    }

    /// Returns the missing setting that a parameter of a tie or damper needs to be read, if any.
    fn link_lacks(&self, parameter: Variable) -> Option<&'static str> {
        let parameter = Some(parameter);
        let is_of = |mut link: Tie<_>| link.numbers().iter().any(|number| **number == parameter);
        let (_, link) = LINKS.iter().find(|(_, link)| is_of(*link))?;
        let needed = if parameter == link.hardening {
            link.yield_force
        } else if parameter == link.yield_force || !self.is_present(link) {
            link.stiffness
        } else {
            None
        };
        let missing = needed.filter(|&setting| needed != parameter && self[setting] == 0.0)?;
        Some(missing.name())
    }

    /// Returns the parameters that were set but are not read. Each has the setting that it needs.
    pub fn unread(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let lacking = VARIABLES.iter().filter_map(|metadata| {
            let needed = match metadata.role {
                Role::Parameter(parameter) => self.lacks(parameter)?,
                Role::Link(link) => self.link_lacks(link.variable())?,
                Role::Input(_) | Role::Text(_) | Role::Derived(_) | Role::Output(_) => return None,
            };
            Some((metadata.variable, needed))
        });
        let numbers = self.changed(lacking.collect());
        numbers.chain(Text::ALL.into_iter().filter(|&text| !self[text].is_empty()).filter_map(|text| {
            let needed = self.text_lacks(text)?;
            Some((text.variable().name(), needed))
        }))
    }

    /// Returns the missing setting that a text needs to be read, if any.
    fn text_lacks(&self, text: Text) -> Option<&'static str> {
        match text {
            Text::RecordHorizontal | Text::RecordVertical => None,
            // It is also the unit of a vertical record without its own unit.
            Text::RecordHorizontalUnit => {
                let of_vertical = !self[Text::RecordVertical].is_empty() && self[Text::RecordVerticalUnit].is_empty();
                (self[Text::RecordHorizontal].is_empty() && !of_vertical).then_some("record.horizontal")
            }
            Text::RecordVerticalUnit => self[Text::RecordVertical].is_empty().then_some("record.vertical"),
        }
    }

    /// Returns [`Values::unread`] and, on a rigid base, the parameters of the supports. Only calculated parameters read those.
    pub fn unread_by_motion(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let supports = match (self.foundation(), self.is_physical()) {
            (Foundation::Viscoelastic, _) => vec![],
            (Foundation::Rigid, true) => vec![Variable::PhysicalK, Variable::PhysicalC],
            (Foundation::Rigid, false) => vec![Variable::DimensionlessEta, Variable::DimensionlessXiV],
        };
        self.unread().chain(self.changed(supports.into_iter().map(|variable| (variable, ON_SUPPORTS)).collect()))
    }

    /// Keeps the variables that differ from their start values, with their names.
    fn changed(&self, variables: Vec<(Variable, &'static str)>) -> impl Iterator<Item = (&'static str, &'static str)> {
        let changed = |variable: Variable| Some(self[variable]) != VARIABLES[variable as usize].start;
        variables.into_iter().filter(move |(v, _)| changed(*v)).map(|(v, needed)| (v.name(), needed))
    }

    /// Returns the initial state.
    pub fn initial(&self) -> Initial {
        self.initial_of(|variable| self[variable])
    }

    /// Returns the initial state with the parameters from `of`.
    pub(super) fn initial_of<T>(&self, of: impl Fn(Variable) -> T) -> Initial<T> {
        let vertical = (of(Variable::InitialV), of(Variable::InitialVDot));
        Initial {
            theta: of(Variable::InitialTheta),
            theta_dot: of(Variable::InitialThetaDot),
            vertical: (self[Variable::InitialSettled] == 0.0).then_some(vertical),
        }
    }

    /// Returns the pulse.
    pub fn pulse(&self) -> Pulse {
        self.pulse_of(|variable| self[variable])
    }

    /// Returns the pulse with the parameters from `of`.
    pub(super) fn pulse_of<T>(&self, of: impl Fn(Variable) -> T) -> Pulse<T> {
        Pulse {
            shape: pulse_shape!(self.choice(Variable::PulseShape)),
            amplitude: of(Variable::PulseAmplitude),
            period: of(Variable::PulsePeriod),
            start: of(Variable::PulseStart),
            phase: of(Variable::PulsePhase),
            cycles: of(Variable::PulseCycles),
        }
    }

    /// Returns the settings of the run, with this tolerance or the default.
    pub fn settings(&self, tolerance: Option<f64>) -> Settings {
        Settings {
            tolerance: tolerance.unwrap_or(Settings::default().tolerance),
            on_separation: on_separation!(self.choice(Variable::OnSeparation)),
            on_overturning: on_overturning!(self.choice(Variable::OnOverturning)),
        }
    }
}

impl Variable {
    /// Returns its name in modelDescription.xml.
    pub fn name(self) -> &'static str {
        VARIABLES[self as usize].name
    }
}
