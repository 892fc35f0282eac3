//! A run → the command line of `rocking` with the same numbers.

use rocking_block::block::Foundation;
use rocking_block::block::restraints::Tie;
use rocking_block::excitation::Pulse;
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_studies::spec::words::Words;

use rocking_studies::spec::option;

use crate::inputs::{Excitation, Inputs, Vertical};
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
        // After a blank, a name as -dash.csv would be an option.
        let sign = if value.trim_start_matches('\'').starts_with('-') { '=' } else { ' ' };
        self.0.push_str(&format!(" --{}{sign}{value}", name.replace('_', "-")));
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

/// A tie as an option of the program.
pub fn tie_text(tie: &Tie) -> String {
    tie.named().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(",")
}

/// The command line of a run that writes its history to `history.csv`.
pub fn simulate(inputs: &Inputs, vertical: &Vertical) -> String {
    let mut line = CommandLine::new("simulate");
    line.excitation(inputs, vertical, false);
    for (name, value) in inputs.spec.said() {
        line.option(&option(name), value);
    }
    line.unless("foundation", inputs.spec.foundation().word(), Foundation::Viscoelastic.word());
    for tie in inputs.spec.hold.links() {
        line.option(tie.kind.word(), tie_text(&tie));
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_begin_with_a_dash_are_values() {
        let mut line = CommandLine::new("simulate");
        line.option("record", "-dash.csv").option("record", "-a b.csv").option("theta", -0.1).option("alpha", 0.2);
        assert_eq!(line.text(), "rocking simulate --record=-dash.csv --record='-a b.csv' --theta=-0.1 --alpha 0.2");
    }
}
