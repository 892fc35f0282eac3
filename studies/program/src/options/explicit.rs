//! Command line → the options set by the user; errors for those without effect.

use clap::ArgMatches;
use clap::parser::ValueSource;

/// The options set by the user, as opposed to defaults.
pub struct ExplicitOptions<'a>(&'a ArgMatches);

impl ExplicitOptions<'_> {
    /// Collects the options of the innermost subcommand, or of the program.
    pub fn of(matches: &ArgMatches) -> ExplicitOptions<'_> {
        let mut innermost = matches;
        while let Some((_, matches)) = innermost.subcommand() {
            innermost = matches;
        }
        ExplicitOptions(innermost)
    }

    /// Returns whether the user set an option, by its name without the leading dashes.
    pub fn has(&self, option: &str) -> bool {
        self.0.value_source(&option.replace('-', "_")) == Some(ValueSource::CommandLine)
    }

    /// Refuses the first of these options that the user set, unless they are read.
    ///
    /// `why` completes the message "--amplitude has no effect …", as in "without --pulse".
    pub fn refuse_unless(&self, read: bool, options: &[&str], why: &str) -> anyhow::Result<()> {
        match options.iter().find(|option| !read && self.has(option)) {
            Some(option) => anyhow::bail!("--{} has no effect {why}", option.replace('_', "-")),
            None => Ok(()),
        }
    }
}
