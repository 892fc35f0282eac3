//! The parameters of a run and the directions in which they vary → block, initial values and excitation with their derivatives.

use rocking_block::block::restraints::{LinkKind, Tie, Ties, tie};
use rocking_block::block::{Block, BlockError, BlockParameters, Outline};
use rocking_block::excitation::{Excitation, Inputs, Pulse, PulseShape, Ramp};
use rocking_block::numerics::scalar::Elementary;
use rocking_block::simulation::Initial;
use rocking_block::unit::variables::{Causality, Kind, Metadata, VARIABLES};

use crate::{BATCH, Number};

/// The numbers of a run with respect to which derivatives exist.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters<T = f64> {
    /// The parameters of the block.
    pub block: BlockParameters<T>,
    /// Its ties.
    pub ties: Vec<Tie<T>>,
    /// Its initial values.
    pub initial: Initial<T>,
    /// The pulse.
    pub pulse: Pulse<T>,
    /// The scale of the records (1), if there are any.
    pub scale: Option<T>,
}

/// Returns the names and units of the real parameters of the FMU. The group is left out where the name alone is clear.
fn known() -> impl Iterator<Item = (&'static str, &'static str)> {
    let of_users = |known: &&Metadata| known.causality == Causality::Parameter && known.kind == Kind::Real;
    VARIABLES.iter().filter(of_users).map(|known| (known.short_name(), known.unit.unwrap_or("1")))
}

/// Returns the unit of a parameter; `1` for one without a unit.
pub fn unit(name: &str) -> &'static str {
    let of_tie = || tie::number_of_path(name).map(|number| number.quantity.unit());
    known().find(|(known, _)| *known == name).map(|(_, unit)| unit).or_else(of_tie).unwrap_or("1")
}

impl Parameters {
    /// Makes the block with its ties.
    ///
    /// # Errors
    /// The first invalid parameter.
    pub fn checked_block(&self) -> Result<Block, BlockError> {
        Block::new(&self.block)?.with_ties(&self.ties)
    }

    /// Returns the names of all parameters that the run reads.
    pub fn names(&self) -> Vec<String> {
        let of_tie = |(tie, found): (String, &Tie)| {
            found.kind.numbers().map(|number| format!("{tie}.{}", number.name)).collect::<Vec<_>>()
        };
        let of_ties = tie::names(&self.ties).into_iter().zip(&self.ties).flat_map(of_tie);
        let is_of_tie = |name: &&str| LinkKind::ALL.iter().any(|kind| name.starts_with(kind.word()));
        let all = known().map(|(name, _)| name).filter(|name| !is_of_tie(name)).map(String::from).chain(of_ties);
        let mut parameters = self.clone();
        all.filter(|name| parameters.number(name).is_some()).collect()
    }
}

impl<T: Elementary> Parameters<T> {
    /// Returns the parameter with this name, or `None` if the run does not read it.
    pub fn number(&mut self, name: &str) -> Option<&mut T> {
        let Parameters { block, ties, initial, pulse, scale } = self;
        if let Some((tie, key)) = name.split_once('.')
            && let Some(i) = tie::names(ties).iter().position(|known| known == tie)
        {
            let yields = ties[i].yields();
            let number = ties[i].number(key)?;
            // A strength of 0 means that it does not break, a yield force of 0 that it stays elastic.
            let is_read = match key {
                "strength" => number.value() > 0.0,
                "yield_force" | "hardening" => yields,
                _ => true,
            };
            return is_read.then_some(number);
        }
        let follows = match block.outline {
            Outline::Sizes { inertia: Some(_), .. } => name == "gamma",
            Outline::Sizes { inertia: None, .. } | Outline::Slenderness { .. } => false,
        };
        if let Some((_, _, number)) = block.numbers_mut().find(|(known, ..)| *known == name) {
            // A friction of 0 means no limit.
            let is_read = !follows && (name != "friction" || number.value() > 0.0);
            return is_read.then_some(number);
        }
        let (acts, gabor) = (pulse.shape != PulseShape::None, pulse.shape == PulseShape::Gabor);
        match name {
            "initial.theta" => Some(&mut initial.theta),
            "initial.theta_dot" => Some(&mut initial.theta_dot),
            "initial.v" => initial.vertical.as_mut().map(|(v, _)| v),
            "initial.v_dot" => initial.vertical.as_mut().map(|(_, v_dot)| v_dot),
            "pulse.amplitude" if acts => Some(&mut pulse.amplitude),
            "pulse.period" if acts => Some(&mut pulse.period),
            "pulse.start" if acts => Some(&mut pulse.start),
            "pulse.phase" if gabor => Some(&mut pulse.phase),
            "pulse.cycles" if gabor => Some(&mut pulse.cycles),
            "scale" => scale.as_mut().filter(|scale| scale.value() != 0.0),
            _ => None,
        }
    }

    fn map<U: Elementary>(&self, of: impl Fn(T) -> U) -> Parameters<U> {
        Parameters {
            block: self.block.map(&of),
            ties: self.ties.iter().map(|tie| tie.map(&of)).collect(),
            initial: Initial {
                theta: of(self.initial.theta),
                theta_dot: of(self.initial.theta_dot),
                vertical: self.initial.vertical.map(|(v, v_dot)| (of(v), of(v_dot))),
            },
            pulse: self.pulse.map(&of),
            scale: self.scale.map(&of),
        }
    }
}

/// Block, initial values and excitation of a run, with derivatives in the directions of a batch.
#[derive(Clone, Copy, Debug)]
pub struct Varied {
    /// The block.
    pub block: Block<Number>,
    /// Its initial values.
    pub initial: Initial<Number>,
    /// The pulse.
    pub pulse: Pulse<Number>,
    /// The factor on the ground accelerations of the inputs (1), whose value is 1.
    pub ground: Number,
}

impl Varied {
    /// Returns the derivatives with respect to the parameters with these names, at most [`BATCH`]. `None` if one is not read.
    pub fn with_respect_to(parameters: &Parameters, block: &Block, names: &[&str]) -> Option<Varied> {
        let mut varied = parameters.map(Number::from);
        for (i, name) in names.iter().enumerate() {
            *varied.number(name)?.eps.get_mut(i)? = 1.0;
        }
        let Parameters { block: parameters, ties, initial, pulse, scale } = varied;
        let mut varied = Block::unchecked(&parameters);
        // The check of the block takes an e of almost 1 as 1.
        varied.restitution_factor.re = block.restitution_factor;
        varied.body.restraints.ties = Ties::of(&ties);
        let ground = Number::new(1.0, scale.map_or([0.0; BATCH], |scale| scale.eps.map(|eps| eps / scale.re)));
        Some(Varied { block: varied, initial, pulse, ground })
    }

    /// Returns the excitation under these inputs, with the pulse if it `acts`.
    pub fn excitation(&self, inputs: &Inputs, acts: bool) -> Excitation<Number> {
        let constant = |ramp: Ramp| Ramp { value: Number::from(ramp.value), rate: Number::from(ramp.rate) };
        let scaled = |ramp: Ramp| Ramp { value: self.ground * ramp.value, rate: self.ground * ramp.rate };
        let inputs = Inputs {
            time: Number::from(inputs.time),
            a_gx: scaled(inputs.a_gx),
            a_gz: scaled(inputs.a_gz),
            f_x: constant(inputs.f_x),
            f_z: constant(inputs.f_z),
            m_y: constant(inputs.m_y),
        };
        Excitation::new(&inputs, acts.then_some(&self.pulse), self.block.mass)
    }

    /// Returns the derivatives of a begin or end of `pulse` at `time` (s), if any. The second value says whether it acts right before.
    pub fn kink(&self, pulse: &Pulse, time: f64) -> Option<([f64; BATCH], bool)> {
        if pulse.shape == PulseShape::None {
            return None;
        }
        let end = self.pulse.start + self.pulse.duration();
        if time == pulse.start {
            Some((self.pulse.start.eps, false))
        } else {
            (time == pulse.end()).then_some((end.eps, true))
        }
    }
}
