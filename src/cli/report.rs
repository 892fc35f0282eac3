//! The summary of a command → standard output, or standard error where a result has the other.

use std::io::{ErrorKind, Write};
use std::path::Path;

use anyhow::Context;

use crate::study::place::{Place, STANDARD};

/// What a command has written, and whether that leaves standard output to the summary.
pub struct Written<'a> {
    files: Vec<&'a Path>,
    /// Whether the summary goes to standard error.
    pub is_aside: bool,
}

impl<'a> Written<'a> {
    /// The outputs.
    pub fn new(files: impl IntoIterator<Item = Option<&'a Path>>) -> Written<'a> {
        let files: Vec<_> = files.into_iter().flatten().collect();
        let is_aside = files.iter().any(|path| is_standard_output(path));
        Written { files, is_aside }
    }

    /// A line for each file.
    pub fn lines(&self) -> String {
        let files = self.files.iter().filter(|path| **path != Path::new(STANDARD));
        files.map(|path| format!("written       {}\n", path.display())).collect()
    }
}

/// Whether an output goes to standard output.
pub fn is_standard_output(path: &Path) -> bool {
    matches!(Place::of(path), Ok(Place::StandardOutput))
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
