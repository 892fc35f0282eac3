//! Outputs of a command: checked before it runs, written whole or not at all.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use tempfile::TempPath;

use crate::study::place::{Identity, Place, folder};

/// A file and the option that names it, as it is called in messages.
#[derive(Clone)]
pub struct Named {
    option: String,
    path: PathBuf,
}

impl Named {
    /// The file that an option names.
    pub fn new(option: &str, path: &Path) -> Named {
        Named { option: option.into(), path: path.into() }
    }
}

impl std::fmt::Display for Named {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.option, self.path.display())
    }
}

/// Refuses an output that is also an input or another output, by whatever name or link. Nothing is opened or changed.
pub fn check_distinct(inputs: &[Named], outputs: &[Named]) -> anyhow::Result<()> {
    let inputs: Vec<_> = inputs.iter().map(|named| (named, Identity::of_input(&named.path))).collect();
    let mut others: Vec<(&Named, Place, Option<Identity>)> = Vec::new();
    for output in outputs {
        let place = Place::of(&output.path)?;
        let identity = place.identity();
        if let Some((input, _)) = inputs.iter().find(|(_, other)| identity.is_some() && *other == identity) {
            anyhow::bail!("{output} would replace {input}; expected another file for the results");
        }
        let other = others.iter().find(|(_, other, known)| {
            identity.is_some() && *known == identity || place == Place::StandardOutput && *other == place
        });
        if let Some((other, ..)) = other {
            anyhow::bail!("{output} would replace {other}; expected a file for each");
        }
        others.push((output, place, identity));
    }
    Ok(())
}

/// An output under way. That it can be written is known before the work begins; what is there is left alone until the
/// new content is complete.
pub struct Pending {
    name: String,
    sink: Sink,
}

enum Sink {
    File(PathBuf),
    Stream(Box<dyn Write>),
}

impl Pending {
    /// Makes sure that the output can be written. A named pipe waits here for its reader.
    pub fn new(path: &Path) -> anyhow::Result<Pending> {
        let place = Place::of(path)?;
        let name = place.name(path);
        let refused = || format!("{name}: cannot be written");
        let sink = match place.open_stream().with_context(refused)? {
            Some(stream) => Sink::Stream(stream),
            None => {
                let Place::File(path) = place else { unreachable!("what is no file is a stream") };
                if path.exists() {
                    OpenOptions::new().write(true).open(&path).with_context(refused)?;
                }
                Staged::new(&path, Vec::new()).with_context(refused)?;
                Sink::File(path)
            }
        };
        Ok(Pending { name, sink })
    }

    /// Writes all outputs. No file is replaced before the content of all is written out, and none by a part of it.
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
            file.place(&path).with_context(refused(name))?;
        }
        for (name, mut stream, content) in streams {
            match stream.write_all(&content).and_then(|()| stream.flush()) {
                // A reader that has seen enough closes the pipe.
                Err(error) if error.kind() == ErrorKind::BrokenPipe => (),
                written => written.with_context(refused(name))?,
            }
        }
        Ok(())
    }
}

/// The content of a file, written out in its folder and not yet in its place.
enum Staged {
    /// A file without a name, of which nothing remains however the program ends.
    #[cfg(target_os = "linux")]
    Unnamed { file: File, content: Vec<u8> },
    /// A file with a name of its own, where the file system has no others; it is removed when this is dropped.
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
        // What tempfile opens by itself says its name in errors.
        let open = |name: &Path| OpenOptions::new().write(true).create_new(true).open(name);
        let mut file = tempfile::Builder::new().make_in(folder(path), open)?;
        fill(file.as_file_mut(), path, content)?;
        Ok(Staged::Named(file.into_temp_path()))
    }

    /// Puts the file in its place, instead of what is there.
    fn place(self, path: &Path) -> io::Result<()> {
        let named = match self {
            #[cfg(target_os = "linux")]
            Staged::Unnamed { file, content } => match name(&file, path) {
                Ok(named) => named,
                // Nothing can be named where /proc is missing.
                Err(_) => return Staged::named(path, &content)?.place(path),
            },
            Staged::Named(named) => named,
        };
        named.persist(path).map_err(|error| error.error)
    }
}

/// A file without a name, where the file system and the kernel have them.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    OpenOptions::new().write(true).custom_flags(libc::O_TMPFILE).open(folder)
}

/// Gives it a name of its own for the moment in which it replaces another file, which no unnamed one can.
#[cfg(target_os = "linux")]
fn name(file: &File, path: &Path) -> io::Result<TempPath> {
    use rustix::fs::{AtFlags, CWD, linkat};
    use std::os::fd::AsRawFd;
    let open = format!("/proc/self/fd/{}", file.as_raw_fd());
    let link = |name: &Path| Ok(linkat(CWD, &open, CWD, name, AtFlags::SYMLINK_FOLLOW)?);
    tempfile::Builder::new().make_in(folder(path), link).map(|named| named.into_temp_path())
}

/// Writes the content down to the disk, with the owner and the permissions of the file that is replaced.
fn fill(file: &mut File, path: &Path, content: &[u8]) -> io::Result<()> {
    if let Ok(old) = fs::metadata(path) {
        keep_owner(file, &old);
        // Some file systems know one mode only and refuse to be given it.
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
    // Who may not give files away owns the new one.
    let _ = fchown(file, Some(old.uid()), Some(old.gid()));
}

#[cfg(not(unix))]
fn keep_owner(_: &File, _: &Metadata) {}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a file system without unnamed files gets.
    #[test]
    fn a_file_with_a_name_of_its_own_replaces_another_one_whole_or_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        fs::write(&path, "old").unwrap();
        let staged = Staged::named(&path, b"new").unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        drop(staged);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        Staged::named(&path, b"new").unwrap().place(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!(fs::read(&path).unwrap(), b"new");
        // Nothing replaces a folder.
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        Staged::named(&inner, b"new").unwrap().place(&inner).unwrap_err();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
