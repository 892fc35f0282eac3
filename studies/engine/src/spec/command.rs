//! Parameters → the command line of the program with the same numbers.

use rocking_block::block::Foundation;
use rocking_block::block::restraints::Tie;

use crate::spec::space::FeetSpec;
use crate::spec::words::Words;
use crate::spec::{BlockSpec, SpaceSpec, option};

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

    /// Adds the parameters of a block that are no defaults. Its mass is added if it has an effect.
    pub fn block(&mut self, spec: &BlockSpec) -> &mut CommandLine {
        for (name, value) in spec.explicit() {
            self.option(&option(name), value);
        }
        self.unless("foundation", spec.foundation().word(), Foundation::Viscoelastic.word());
        for tie in spec.hold.links() {
            self.tie(tie.kind.word(), &tie);
        }
        self
    }

    /// Adds the given parameters of a block in space.
    pub fn block_in_space(&mut self, shared: &BlockSpec, space: &SpaceSpec) -> &mut CommandLine {
        let own = space.clone().numbers_mut().map(|(name, value)| (name, *value));
        let own = own.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let mass = shared.mass.filter(|_| space.inertia_tensor.is_some()).map(|mass| ("mass", mass));
        let is_other = |(name, _): &(&str, f64)| mass.is_none_or(|(known, _)| known != *name);
        // Friction without a limit is the default.
        let shared = shared.explicit().filter(is_other).filter(|(_, value)| value.is_finite());
        for (name, value) in shared.chain(mass).chain(own) {
            self.option(&option(name), value);
        }
        if let Some(base) = space.base {
            self.option("base", base.word());
        }
        match &space.feet {
            Some(FeetSpec::Count(count)) => _ = self.option("feet", count),
            Some(FeetSpec::File(path)) => _ = self.option("feet", path.display()),
            None => (),
        }
        if let Some(tensor) = &space.inertia_tensor {
            let numbers: Vec<String> = tensor.iter().map(f64::to_string).collect();
            self.option("inertia_tensor", numbers.join(","));
        }
        self
    }

    /// Adds a tie or a damper as the value of an option.
    pub fn tie(&mut self, name: &str, tie: &Tie) -> &mut CommandLine {
        let numbers: Vec<String> = tie.named().map(|(key, value)| format!("{key}={value}")).collect();
        self.option(name, numbers.join(","))
    }

    /// The text.
    pub fn text(&self) -> String {
        self.0.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::HoldSpec;

    #[test]
    fn values_that_begin_with_a_dash_are_values() {
        let mut line = CommandLine::new("simulate");
        line.option("record", "-dash.csv").option("record", "-a b.csv").option("theta", -0.1).option("alpha", 0.2);
        assert_eq!(line.text(), "rocking simulate --record=-dash.csv --record='-a b.csv' --theta=-0.1 --alpha 0.2");
    }

    /// The numbers of a block give the same block again.
    #[test]
    fn a_block_has_its_parameters_and_no_defaults() {
        let guy = Tie { block: [0.0, 2.0], ground: [3.0, 0.0], stiffness: 1e5, ..Tie::default() };
        let hold = HoldSpec { friction: Some(0.4), ties: vec![guy], ..HoldSpec::default() };
        let foundation = Some(Foundation::Rigid);
        let block = BlockSpec { p: Some(2.0), mass: Some(1e3), foundation, hold, ..BlockSpec::default() }.block();
        let spec = BlockSpec::of(&block.clone().unwrap());
        assert_eq!(spec.block(), block);
        let expected = "rocking search overturning --p 2 --mass 1000 --friction 0.4 --foundation rigid --tie \
                        block_x=0,block_z=2,ground_x=3,ground_z=0,stiffness=100000,pretension=0,slack=0,damping=0,strength=0,\
                        yield_force=0,hardening=0";
        assert_eq!(CommandLine::new("search overturning").block(&spec).text(), expected);
    }
}
