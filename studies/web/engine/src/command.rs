//! A run → the command line of `rocking` with the same numbers.

use rocking_block::excitation::Pulse;
use rocking_block::simulation::{Initial, OnSeparation, Settings};
use rocking_studies::spec::command::CommandLine;
use rocking_studies::spec::words::Words;

use crate::inputs::{Excitation, Inputs, Vertical};
use crate::records::{self, EMBEDDED_PATH};

/// Adds the records and their scale factor, the pulse, or the initial state of a release.
pub fn add_excitation(line: &mut CommandLine, inputs: &Inputs, vertical: &Vertical, names_embedded: bool) {
    let Inputs { excitation, run, scale, .. } = inputs;
    if *excitation == Excitation::Release {
        let Initial { theta, theta_dot, .. } = run.initial;
        line.unless("theta", theta, 0.0).unless("theta-dot", theta_dot, 0.0);
    }
    add_motion(line, (excitation, vertical), &run.pulse, *scale, names_embedded);
}

/// Adds the records and their scale factor, or the pulse.
pub fn add_motion(
    line: &mut CommandLine,
    (excitation, vertical): (&Excitation, &Vertical),
    pulse: &Pulse,
    scale: f64,
    names_embedded: bool,
) {
    match excitation {
        Excitation::Embedded if names_embedded || vertical.is_some() => {
            line.option("record", EMBEDDED_PATH);
        }
        Excitation::Embedded => (),
        Excitation::File { name, settings } => {
            add_file(line, "record", name, settings);
        }
        Excitation::Pulse => {
            let Pulse { shape, amplitude, period, phase, cycles, .. } = *pulse;
            let default = Pulse::NONE;
            line.option("pulse", shape.word()).option("amplitude", amplitude).unless("period", period, default.period);
            line.unless("phase", phase, default.phase).unless("cycles", cycles, default.cycles);
        }
        Excitation::Release => (),
    }
    if let Some((name, settings)) = vertical {
        add_file(line, "vertical", name, settings);
    }
    line.unless("scale", scale, 1.0);
}

fn add_file(line: &mut CommandLine, option: &str, name: &str, settings: &records::Settings) {
    line.option(option, name);
    for (setting, value) in settings {
        line.option(setting, value);
    }
}

/// The command line of a run that writes its history to `history.csv`.
pub fn simulate(inputs: &Inputs, vertical: &Vertical) -> String {
    let mut line = CommandLine::new("simulate");
    add_excitation(&mut line, inputs, vertical, false);
    line.block(&inputs.spec);
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
