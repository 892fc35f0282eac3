//! The summary of a command → text for a person, or JSON for a program.

use std::io::{ErrorKind, Write};
use std::path::Path;

use anyhow::Context;
use clap::Args;
use serde::{Serialize, Serializer};

use crate::study::place::{Place, STANDARD};

/// How the summary is printed.
#[derive(Args)]
#[command(next_help_heading = "Results")]
pub struct ReportOptions {
    /// Print the summary as one JSON object: SI units, numbers in full, names as in the tables. It goes, as the text
    /// does, to standard error if `-` sends a result to standard output
    #[arg(long)]
    pub json: bool,
}

/// What a command has written, and whether that leaves standard output to the summary.
pub struct Written<'a> {
    files: Vec<(&'static str, &'a Path)>,
    is_aside: bool,
}

impl<'a> Written<'a> {
    /// The outputs by the names of their options without the dashes.
    pub fn new(files: impl IntoIterator<Item = (&'static str, Option<&'a Path>)>) -> Written<'a> {
        let files: Vec<_> = files.into_iter().filter_map(|(name, path)| Some((name, path?))).collect();
        let is_aside = files.iter().any(|(_, path)| is_standard_output(path));
        Written { files, is_aside }
    }

    /// A line for each file.
    pub fn lines(&self) -> String {
        let files = self.files.iter().filter(|(_, path)| *path != Path::new(STANDARD));
        files.map(|(_, path)| format!("written       {}\n", path.display())).collect()
    }
}

/// Whether an output goes to standard output.
pub fn is_standard_output(path: &Path) -> bool {
    matches!(Place::of(path), Ok(Place::StandardOutput))
}

impl ReportOptions {
    /// Prints the summary of a command: `text`, or `result` as JSON with the command's name, what was written, and
    /// what the user should know.
    pub fn print(
        &self,
        command: &str,
        written: &Written,
        warnings: &[String],
        text: &str,
        result: &impl Serialize,
    ) -> anyhow::Result<()> {
        if !self.json {
            return print(text, written.is_aside);
        }
        let report = Report { command, version: env!("CARGO_PKG_VERSION"), result, written, warnings };
        print(&(serde_json::to_string(&report)? + "\n"), written.is_aside)
    }
}

#[derive(Serialize)]
struct Report<'a, T> {
    command: &'a str,
    version: &'a str,
    #[serde(flatten)]
    result: &'a T,
    written: &'a Written<'a>,
    warnings: &'a [String],
}

impl Serialize for Written<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.files.iter().map(|(name, path)| (name, path.to_string_lossy())))
    }
}

/// Prints on standard output, or aside on standard error. A reader that has seen enough closes the pipe.
pub fn print(text: &str, is_aside: bool) -> anyhow::Result<()> {
    let write = |mut to: Box<dyn Write>| to.write_all(text.as_bytes()).and_then(|()| to.flush());
    let (name, written) = if is_aside {
        ("standard error", write(Box::new(std::io::stderr())))
    } else {
        ("standard output", write(Box::new(std::io::stdout())))
    };
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written.with_context(|| format!("{name}: cannot be written")),
    }
}
