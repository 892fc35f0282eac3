//! Which options were given on the command line → refusals of those that nothing would read.

use clap::ArgMatches;
use clap::parser::ValueSource;

/// The options of a command that were given, as against those that have their default.
pub struct Given<'a>(&'a ArgMatches);

impl Given<'_> {
    /// The options of the command that was named, or of the program.
    pub fn of(matches: &ArgMatches) -> Given<'_> {
        let mut innermost = matches;
        while let Some((_, matches)) = innermost.subcommand() {
            innermost = matches;
        }
        Given(innermost)
    }

    /// Whether an option was given; its name is that on the command line, without dashes before it.
    pub fn has(&self, option: &str) -> bool {
        self.0.value_source(&option.replace('-', "_")) == Some(ValueSource::CommandLine)
    }

    /// Refuses the first of these options that was given, unless it is read; `why` tells what it would need, as in
    /// `without --pulse`.
    pub fn only_if(&self, read: bool, options: &[&str], why: &str) -> anyhow::Result<()> {
        match options.iter().find(|option| !read && self.has(option)) {
            Some(option) => anyhow::bail!("--{option} has no effect {why}"),
            None => Ok(()),
        }
    }
}
