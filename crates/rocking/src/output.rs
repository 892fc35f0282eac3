//! Content → files, devices and pipes: checked before the work begins, written whole or not at all.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use tempfile::TempPath;

use rocking_studies::output::output_target::{Identity, OutputTarget, folder};

/// A file, and the option that names it in messages.
#[derive(Clone)]
pub struct NamedFile {
    option: String,
    path: PathBuf,
}

impl NamedFile {
    /// Names a file by its option.
    pub fn new(option: &str, path: &Path) -> NamedFile {
        NamedFile { option: option.into(), path: path.into() }
    }

    /// Names the files of those options that the user set, without their leading dashes.
    pub fn of_options<'a>(files: impl IntoIterator<Item = (&'a str, Option<&'a Path>)>) -> Vec<NamedFile> {
        let named = |(option, path): (&str, Option<&Path>)| Some(NamedFile::new(&format!("--{option}"), path?));
        files.into_iter().filter_map(named).collect()
    }
}

impl std::fmt::Display for NamedFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.option, self.path.display())
    }
}

/// Refuses an output that is also an input or another output, under any name or link. Opens and changes nothing.
pub fn check_distinct(inputs: &[NamedFile], outputs: &[NamedFile]) -> anyhow::Result<()> {
    let inputs: Vec<_> = inputs.iter().map(|named| (named, Identity::of_input(&named.path))).collect();
    let mut others: Vec<(&NamedFile, OutputTarget, Option<Identity>)> = Vec::new();
    for output in outputs {
        let target = OutputTarget::of(&output.path)?;
        let identity = target.identity();
        if let Some((input, _)) = inputs.iter().find(|(_, other)| identity.is_some() && *other == identity) {
            anyhow::bail!("{output} would replace {input}; expected another file for the results");
        }
        let other = others.iter().find(|(_, other, known)| {
            identity.is_some() && *known == identity || target == OutputTarget::StandardOutput && *other == target
        });
        if let Some((other, ..)) = other {
            anyhow::bail!("{output} would replace {other}; expected a file for each");
        }
        others.push((output, target, identity));
    }
    Ok(())
}

/// An output whose content is still being computed.
///
/// It is known to be writable. An existing file stays untouched until the new content is complete.
pub struct Pending {
    name: String,
    sink: Sink,
}

enum Sink {
    File(PathBuf),
    Stream(Box<dyn Write>),
}

impl Pending {
    /// Checks that the output can be written. Opening a named pipe waits for its reader.
    pub fn new(path: &Path) -> anyhow::Result<Pending> {
        let target = OutputTarget::of(path)?;
        let name = target.name(path);
        let refused = || format!("{name}: cannot be written");
        let sink = match target.open_stream().with_context(refused)? {
            Some(stream) => Sink::Stream(stream),
            None => {
                let OutputTarget::File(path) = target else { unreachable!("every other target is a stream") };
                if path.exists() {
                    OpenOptions::new().write(true).open(&path).with_context(refused)?;
                }
                Staged::new(&path, Vec::new()).with_context(refused)?;
                Sink::File(path)
            }
        };
        Ok(Pending { name, sink })
    }

    /// Writes all outputs. No file is replaced before the contents of all files are on disk.
    pub fn write(outputs: Vec<(Pending, Vec<u8>)>) -> anyhow::Result<()> {
        let refused = |name: String| move || format!("{name}: cannot be written");
        let (mut staged, mut streams) = (Vec::new(), Vec::new());
        for (Pending { name, sink }, content) in outputs {
            match sink {
                Sink::File(path) => {
                    let file = Staged::new(&path, content).with_context(refused(name.clone()))?;
                    staged.push((name, path, file));
                }
                Sink::Stream(stream) => streams.push((name, stream, content)),
            }
        }
        for (name, path, file) in staged {
            file.replace(&path).with_context(refused(name))?;
        }
        for (name, mut stream, content) in streams {
            match stream.write_all(&content).and_then(|()| stream.flush()) {
                // A reader such as `head` may close its pipe early.
                Err(error) if error.kind() == ErrorKind::BrokenPipe => (),
                written => written.with_context(refused(name))?,
            }
        }
        Ok(())
    }
}

/// The content of a file, on disk in the same folder, before it replaces that file.
enum Staged {
    /// A file without a name: the system removes it however the program ends.
    #[cfg(target_os = "linux")]
    Unnamed { file: File, content: Vec<u8> },
    /// A temporary file, on file systems without unnamed files; dropping this removes it.
    Named(TempPath),
}

impl Staged {
    fn new(path: &Path, content: Vec<u8>) -> io::Result<Staged> {
        #[cfg(target_os = "linux")]
        if let Ok(mut file) = unnamed(folder(path)) {
            fill(&mut file, path, &content)?;
            return Ok(Staged::Unnamed { file, content });
        }
        Staged::named(path, &content)
    }

    fn named(path: &Path, content: &[u8]) -> io::Result<Staged> {
        // A file opened by tempfile itself would put its temporary name into errors.
        let open = |name: &Path| OpenOptions::new().write(true).create_new(true).open(name);
        let mut file = tempfile::Builder::new().make_in(folder(path), open)?;
        fill(file.as_file_mut(), path, content)?;
        Ok(Staged::Named(file.into_temp_path()))
    }

    /// Replaces the file at `path` by this one.
    fn replace(self, path: &Path) -> io::Result<()> {
        let named = match self {
            #[cfg(target_os = "linux")]
            Staged::Unnamed { file, content } => match name(&file, path) {
                Ok(named) => named,
                // An unnamed file gets its name through /proc, which may be missing.
                Err(_) => return Staged::named(path, &content)?.replace(path),
            },
            Staged::Named(named) => named,
        };
        named.persist(path).map_err(|error| error.error)
    }
}

/// Opens a file without a name; some file systems and kernels have none.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    OpenOptions::new().write(true).custom_flags(libc::O_TMPFILE).open(folder)
}

/// Gives a file a temporary name, since only a named file can replace another.
#[cfg(target_os = "linux")]
fn name(file: &File, path: &Path) -> io::Result<TempPath> {
    use rustix::fs::{AtFlags, CWD, linkat};
    use std::os::fd::AsRawFd;
    let open = format!("/proc/self/fd/{}", file.as_raw_fd());
    let link = |name: &Path| Ok(linkat(CWD, &open, CWD, name, AtFlags::SYMLINK_FOLLOW)?);
    tempfile::Builder::new().make_in(folder(path), link).map(|named| named.into_temp_path())
}

/// Writes the content to disk, with the owner and the permissions of the file to be replaced.
fn fill(file: &mut File, path: &Path, content: &[u8]) -> io::Result<()> {
    if let Ok(old) = fs::metadata(path) {
        keep_owner(file, &old);
        // Some file systems have a single mode and refuse any change.
        if file.metadata()?.permissions() != old.permissions() {
            file.set_permissions(old.permissions())?;
        }
    }
    file.write_all(content)?;
    file.sync_all()
}

#[cfg(unix)]
fn keep_owner(file: &File, old: &Metadata) {
    use std::os::unix::fs::{MetadataExt, fchown};
    // Without the right to give files away the user owns the new file.
    let _ = fchown(file, Some(old.uid()), Some(old.gid()));
}

#[cfg(not(unix))]
fn keep_owner(_: &File, _: &Metadata) {}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fallback for file systems without unnamed files.
    #[test]
    fn a_temporary_file_replaces_another_one_or_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        fs::write(&path, "old").unwrap();
        let staged = Staged::named(&path, b"new").unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        drop(staged);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        Staged::named(&path, b"new").unwrap().replace(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!(fs::read(&path).unwrap(), b"new");
        // A file cannot replace a folder.
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        Staged::named(&inner, b"new").unwrap().replace(&inner).unwrap_err();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
