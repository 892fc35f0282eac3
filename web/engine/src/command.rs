//! A run → the command line of `rocking` with the same numbers.

use rocking_block::block::restraints::Tie;
use rocking_block::block::{Common, Dimensionless, Foundation, Physical};
use rocking_block::excitation::Pulse;
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_block::words::Words;

use crate::inputs::{Excitation, Inputs, Parameters, Vertical};
use crate::records::EMBEDDED_PATH;

/// A command line in progress.
#[derive(Clone, Debug)]
pub struct CommandLine(String);

impl CommandLine {
    /// Begins with a command of the program.
    pub fn new(command: &str) -> CommandLine {
        CommandLine(format!("rocking {command}"))
    }

    /// Adds an option with a value in quotes where a shell needs them.
    pub fn option(&mut self, name: &str, value: impl ToString) -> &mut CommandLine {
        let value = value.to_string();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,+=:%@".contains(c);
        let value = match !value.is_empty() && value.chars().all(is_plain) {
            true => value,
            false => format!("'{}'", value.replace('\'', r"'\''")),
        };
        self.0.push_str(&format!(" --{} {value}", name.replace('_', "-")));
        self
    }

    /// Adds an option unless its value is the default of the program.
    pub fn unless<T: ToString + PartialEq>(&mut self, name: &str, value: T, default: T) -> &mut CommandLine {
        if value != default {
            self.option(name, value);
        }
        self
    }

    /// Adds the records and their scale factor, or the pulse.
    pub fn excitation(&mut self, inputs: &Inputs, vertical: &Vertical, names_embedded: bool) -> &mut CommandLine {
        match &inputs.excitation {
            Excitation::Embedded if names_embedded || vertical.is_some() => {
                self.option("record", EMBEDDED_PATH);
            }
            Excitation::Embedded => (),
            Excitation::File { name, settings } => {
                self.option("record", name);
                for (setting, value) in settings {
                    self.option(setting, value);
                }
            }
            Excitation::Pulse => {
                let Pulse { shape, amplitude, period, phase, cycles, .. } = inputs.run.pulse;
                self.option("pulse", shape.word()).option("amplitude", amplitude).unless("period", period, 1.0);
                self.unless("phase", phase, Pulse::NONE.phase).unless("cycles", cycles, Pulse::NONE.cycles);
            }
            Excitation::Release => {
                let Initial { theta, theta_dot, .. } = inputs.run.initial;
                self.unless("theta", theta, 0.0).unless("theta-dot", theta_dot, 0.0);
            }
        }
        if let Some((name, settings)) = vertical {
            self.option("vertical", name);
            for (setting, value) in settings {
                self.option(setting, value);
            }
        }
        self.unless("scale", inputs.scale, 1.0)
    }

    /// The text.
    pub fn text(&self) -> String {
        self.0.clone()
    }
}

/// The numbers of a tie, by the keys of the program.
pub fn tie_values(tie: &Tie) -> [(&'static str, f64); 9] {
    [
        ("block_x", tie.block[0]),
        ("block_z", tie.block[1]),
        ("ground_x", tie.ground[0]),
        ("ground_z", tie.ground[1]),
        ("stiffness", tie.stiffness),
        ("pretension", tie.pretension),
        ("slack", tie.slack),
        ("damping", tie.damping),
        ("strength", tie.strength),
    ]
}

/// A tie as an option of the program.
pub fn tie_text(tie: &Tie) -> String {
    tie_values(tie).map(|(key, value)| format!("{key}={value}")).join(",")
}

/// The command line of a run that writes its history to `history.csv`.
pub fn simulate(inputs: &Inputs, vertical: &Vertical) -> String {
    let block = &inputs.run.block;
    let common = Common::default();
    let mut line = CommandLine::new("simulate");
    line.excitation(inputs, vertical, false);
    match (block.foundation, inputs.parameters) {
        (_, Parameters::Dimensionless(Dimensionless { alpha, p, eta, xi_v })) => {
            line.unless("alpha", alpha, 0.25).unless("p", p, 1.0);
            if block.foundation == Foundation::Viscoelastic {
                line.unless("eta", eta, 40.0).unless("xi-v", xi_v, 0.1);
            }
        }
        (_, Parameters::Physical(Physical { width, height, stiffness, damping, inertia })) => {
            line.option("width", width);
            match height == inputs.body_height {
                true => line.option("height", height),
                false => line.option("center-height", 0.5 * height),
            };
            line.option("stiffness", stiffness).option("damping", damping).option("mass", block.mass);
            if let Some(inertia) = inertia {
                line.option("inertia", inertia);
            }
        }
    }
    if matches!(inputs.parameters, Parameters::Dimensionless(_)) {
        // A tie needs a mass, even that of the default.
        match block.ties().is_empty() {
            true => line.unless("mass", block.mass, common.mass),
            false => line.option("mass", block.mass),
        };
    }
    for tie in block.ties() {
        line.option("tie", tie_text(tie));
    }
    if !inputs.parameters.has_inertia() {
        line.unless("gamma", block.gamma, common.gamma);
    }
    line.unless("epsilon", block.epsilon, common.epsilon)
        .unless("g", block.gravity, common.gravity)
        .unless("foundation", block.foundation.word(), Foundation::Viscoelastic.word())
        .unless("restitution-factor", block.restitution_factor, common.restitution_factor)
        .unless("friction", block.friction, common.friction)
        .unless("eccentricity", block.eccentricity, common.eccentricity);
    let Settings { tolerance, on_separation, .. } = inputs.run.settings;
    line.unless("tolerance", tolerance, Settings::default().tolerance).unless(
        "on-separation",
        on_separation.word(),
        OnSeparation::Terminate.word(),
    );
    if let Some(duration) = inputs.run.duration {
        line.option("duration", duration);
    }
    if let Some(step) = inputs.step {
        line.option("step", step);
    }
    line.option("csv", "history.csv");
    line.text()
}
