//! A summary → standard output, as text for a person or JSON for a program.

use std::io::{ErrorKind, Write};
use std::path::Path;

use anyhow::Context;
use clap::Args;
use serde::{Serialize, Serializer};

use rocking_studies::output::output_target::{OutputTarget, STANDARD};

/// Form of the summary.
#[derive(Args)]
#[command(next_help_heading = "Results")]
pub struct ReportOptions {
    /// Print the summary as one JSON object, in SI units, full precision and the names of the tables. If `-` sends a result
    /// to standard output, the summary goes to standard error, as the text does
    #[arg(long)]
    pub json: bool,
}

/// Outputs that a command has written.
pub struct WrittenFiles<'a> {
    files: Vec<(&'static str, &'a Path)>,
    /// Whether one of them occupies standard output, so that the summary goes to standard error.
    on_standard_output: bool,
}

impl<'a> WrittenFiles<'a> {
    /// Collects the outputs by the names of their options, without the dashes.
    pub fn new(files: impl IntoIterator<Item = (&'static str, Option<&'a Path>)>) -> WrittenFiles<'a> {
        let files: Vec<_> = files.into_iter().filter_map(|(name, path)| Some((name, path?))).collect();
        let on_standard_output = files.iter().any(|(_, path)| is_standard_output(path));
        WrittenFiles { files, on_standard_output }
    }

    /// Returns a line of the summary for each file.
    pub fn lines(&self) -> String {
        let files = self.files.iter().filter(|(_, path)| *path != Path::new(STANDARD));
        files.map(|(_, path)| format!("written       {}\n", path.display())).collect()
    }
}

/// Returns whether an output goes to standard output.
pub fn is_standard_output(path: &Path) -> bool {
    matches!(OutputTarget::of(path), Ok(OutputTarget::StandardOutput))
}

impl ReportOptions {
    /// Prints the summary of a command: `text`, or `result` as JSON. The JSON begins with the name of the command and ends with its outputs
    /// and warnings.
    pub fn print(
        &self,
        command: &str,
        written: &WrittenFiles,
        warnings: &[String],
        text: &str,
        result: &impl Serialize,
    ) -> anyhow::Result<()> {
        if !self.json {
            return print(text, written.on_standard_output);
        }
        let report = Report { command, version: env!("CARGO_PKG_VERSION"), result, written, warnings };
        print(&(serde_json::to_string(&report)? + "\n"), written.on_standard_output)
    }
}

#[derive(Serialize)]
struct Report<'a, T> {
    command: &'a str,
    version: &'a str,
    #[serde(flatten)]
    result: &'a T,
    written: &'a WrittenFiles<'a>,
    warnings: &'a [String],
}

impl Serialize for WrittenFiles<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.files.iter().map(|(name, path)| (name, path.to_string_lossy())))
    }
}

/// Prints to standard output, or to standard error. A reader such as `head` may close its pipe early.
pub fn print(text: &str, to_standard_error: bool) -> anyhow::Result<()> {
    let write = |mut to: Box<dyn Write>| to.write_all(text.as_bytes()).and_then(|()| to.flush());
    let (name, written) = if to_standard_error {
        ("standard error", write(Box::new(std::io::stderr())))
    } else {
        ("standard output", write(Box::new(std::io::stdout())))
    };
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.with_context(|| format!("{name}: cannot be written")),
    }
}
