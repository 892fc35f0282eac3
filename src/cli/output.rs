//! Files that appear whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use tempfile::NamedTempFile;

/// A file under way: made beside its place before the work begins, so that a place that cannot be written is known
/// before anything is lost, and put there when all is done.
pub struct Pending {
    path: PathBuf,
    file: NamedTempFile,
}

impl Pending {
    /// Makes sure that the file can be written.
    pub fn new(path: &Path) -> anyhow::Result<Pending> {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if path.is_dir() {
            anyhow::bail!("{}: is a folder, not a file", path.display());
        }
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => anyhow::anyhow!("{}: its folder does not exist", path.display()),
            _ => anyhow::anyhow!("{}: cannot be written: {}", path.display(), cause(&error)),
        })?;
        Ok(Pending { path: path.to_path_buf(), file })
    }

    /// Writes the content, not yet to its place.
    pub fn write(&mut self, content: &[u8]) -> anyhow::Result<()> {
        let written = self.file.write_all(content).and_then(|()| self.file.flush());
        written.with_context(|| format!("{}: cannot be written", self.path.display()))
    }

    /// Puts all files in their places, or none.
    pub fn place(files: Vec<Pending>) -> anyhow::Result<()> {
        let mut placed: Vec<PathBuf> = Vec::new();
        for Pending { path, file } in files {
            if let Err(error) = file.persist(&path) {
                for path in placed {
                    // What is told is why the other file could not be written.
                    let _ = std::fs::remove_file(path);
                }
                anyhow::bail!("{}: cannot be written: {}", path.display(), error.error);
            }
            placed.push(path);
        }
        Ok(())
    }
}

/// The operating system's reason, without the name of the temporary file that the error wraps around it.
fn cause(error: &std::io::Error) -> String {
    let mut innermost: &dyn std::error::Error = error;
    while let Some(source) = innermost.source() {
        innermost = source;
    }
    innermost.to_string()
}
