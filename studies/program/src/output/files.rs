//! Content → files, devices and pipes. They are checked before the work begins, and written whole or not at all.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use tempfile::{NamedTempFile, TempPath};

use crate::output::report::WrittenFiles;
use rocking_studies::output::format::{DescribedTable, TableFormat};
use rocking_studies::output::output_target::{Identity, OutputTarget, STANDARD, folder};

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
    pub fn of_options<'a>(files: impl IntoIterator<Item = (&'static str, Option<&'a Path>)>) -> Vec<NamedFile> {
        let named = |(option, path): (&'static str, Option<&Path>)| Some(NamedFile::new(&format!("--{option}"), path?));
        files.into_iter().filter_map(named).collect()
    }
}

impl std::fmt::Display for NamedFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.option, self.path.display())
    }
}

/// Refuses an output that is also an input or another output. It is found under any name or link. Opens and changes nothing.
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

/// The outputs of a command, each under the name of its option. All are opened before the work begins, and written together after it.
pub struct Outputs<'a>(Vec<Output<'a>>);

struct Output<'a> {
    option: &'static str,
    path: &'a Path,
    file: Pending,
    content: Option<Vec<u8>>,
}

impl<'a> Outputs<'a> {
    /// Opens the outputs of those options that the user set, without their leading dashes.
    pub fn open(outputs: impl IntoIterator<Item = (&'static str, Option<&'a Path>)>) -> anyhow::Result<Outputs<'a>> {
        let open = |(option, path)| Ok(Output { option, path, file: Pending::new(path)?, content: None });
        let given = outputs.into_iter().filter_map(|(option, path)| Some((option, path?)));
        Ok(Outputs(given.map(open).collect::<anyhow::Result<_>>()?))
    }

    /// Opens outputs after checking that each differs from the inputs and from the others.
    pub fn checked(
        inputs: &[NamedFile],
        outputs: impl IntoIterator<Item = (&'static str, Option<&'a Path>)> + Clone,
    ) -> anyhow::Result<Outputs<'a>> {
        check_distinct(inputs, &NamedFile::of_options(outputs.clone()))?;
        Outputs::open(outputs)
    }

    /// Computes the content of the first output of this option that has none, if the user set the option.
    pub fn fill(&mut self, option: &str, content: impl FnOnce() -> anyhow::Result<Vec<u8>>) -> anyhow::Result<()> {
        if let Some(output) = self.0.iter_mut().find(|output| output.option == option && output.content.is_none()) {
            output.content = Some(content()?);
        }
        Ok(())
    }

    /// Makes the table of the first output of this option that has none, if the user set the option. Its format is that of its name.
    pub fn fill_table<T: Into<DescribedTable>>(
        &mut self,
        option: &str,
        table: impl FnOnce() -> anyhow::Result<T>,
    ) -> anyhow::Result<()> {
        let path =
            self.0.iter().find(|output| output.option == option && output.content.is_none()).map(|output| output.path);
        self.fill(option, || {
            let path = path.unwrap_or(Path::new(STANDARD));
            table()?
                .into()
                .encode(TableFormat::of(path))
                .with_context(|| format!("{}: cannot be written", path.display()))
        })
    }

    /// Writes all outputs, as [`Pending::write`] does.
    pub fn write(self) -> anyhow::Result<WrittenFiles<'a>> {
        let written = WrittenFiles::new(self.0.iter().map(|output| (output.option, Some(output.path))));
        let filled = |Output { option, file, content, .. }: Output| {
            (file, content.unwrap_or_else(|| unreachable!("--{option} has content")))
        };
        Pending::write(self.0.into_iter().map(filled).collect())?;
        Ok(written)
    }
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
    Stream(Box<dyn Write + Send>),
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
                Staged::new(&path).with_context(refused)?;
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
                    let file = Staged::with(&path, &content).with_context(refused(name.clone()))?;
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

/// A file whose content grows, and which replaces another one as a whole.
pub struct StreamedFile {
    name: String,
    path: PathBuf,
    staged: Staged,
}

impl StreamedFile {
    /// Begins the file that will be at `path`.
    pub fn new(path: &Path) -> anyhow::Result<StreamedFile> {
        let name = path.display().to_string();
        let OutputTarget::File(path) = OutputTarget::of(path)? else {
            anyhow::bail!("{name}: cannot be written: it is a device or a pipe; expected the name of a file")
        };
        let staged = Staged::new(&path).with_context(|| format!("{name}: cannot be written"))?;
        Ok(StreamedFile { name, path, staged })
    }

    /// Returns a writer that appends to it.
    pub fn writer(&self) -> anyhow::Result<Box<dyn Write + Send>> {
        let file = self.staged.file().try_clone();
        Ok(Box::new(file.with_context(|| format!("{}: cannot be written", self.name))?))
    }

    /// Writes it to disk and gives it its name.
    pub fn complete(self) -> anyhow::Result<()> {
        let complete = self.staged.file().sync_all().and_then(|()| self.staged.replace(&self.path));
        complete.and_then(|()| synced(folder(&self.path))).with_context(|| format!("{}: cannot be written", self.name))
    }
}

/// Writes a folder to disk, with the names of its files.
#[cfg(unix)]
fn synced(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn synced(_: &Path) -> io::Result<()> {
    Ok(())
}

/// A file on disk that will replace another one in its folder. It has the owner and the permissions of that file.
enum Staged {
    /// A file without a name: the system removes it however the program ends.
    #[cfg(target_os = "linux")]
    Unnamed(File),
    /// A temporary file, on file systems without unnamed files; dropping this removes it.
    Named(NamedTempFile),
}

impl Staged {
    fn new(path: &Path) -> io::Result<Staged> {
        #[cfg(target_os = "linux")]
        if let Ok(file) = unnamed(folder(path)) {
            keep_rights(&file, path)?;
            return Ok(Staged::Unnamed(file));
        }
        Staged::named(path)
    }

    /// A file with this content, on disk.
    fn with(path: &Path, content: &[u8]) -> io::Result<Staged> {
        let staged = Staged::new(path)?;
        (&mut staged.file()).write_all(content)?;
        staged.file().sync_all()?;
        Ok(staged)
    }

    fn named(path: &Path) -> io::Result<Staged> {
        // A file opened by tempfile itself would put its temporary name into errors.
        let open = |name: &Path| OpenOptions::new().write(true).create_new(true).open(name);
        let file = tempfile::Builder::new().make_in(folder(path), open)?;
        keep_rights(file.as_file(), path)?;
        Ok(Staged::Named(file))
    }

    fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Staged::Unnamed(file) => file,
            Staged::Named(file) => file.as_file(),
        }
    }

    /// Replaces the file at `path` by this one.
    fn replace(self, path: &Path) -> io::Result<()> {
        let named = match self {
            #[cfg(target_os = "linux")]
            Staged::Unnamed(mut file) => match name(&file, path) {
                Ok(named) => named,
                // An unnamed file gets its name through /proc, which may be missing.
                Err(_) => {
                    let named = Staged::named(path)?;
                    file.rewind()?;
                    io::copy(&mut file, &mut named.file())?;
                    named.file().sync_all()?;
                    return named.replace(path);
                }
            },
            Staged::Named(named) => named.into_temp_path(),
        };
        named.persist(path).map_err(|error| error.error)
    }
}

/// Opens a file without a name; some file systems and kernels have none.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    OpenOptions::new().read(true).write(true).custom_flags(libc::O_TMPFILE).open(folder)
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

/// Gives a file the owner and the permissions of the file to be replaced.
fn keep_rights(file: &File, path: &Path) -> io::Result<()> {
    let Ok(old) = fs::metadata(path) else { return Ok(()) };
    keep_owner(file, &old);
    // Some file systems have a single mode and refuse any change.
    if file.metadata()?.permissions() != old.permissions() {
        file.set_permissions(old.permissions())?;
    }
    Ok(())
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
        let named = |path: &Path| {
            let staged = Staged::named(path).unwrap();
            staged.file().write_all(b"new").unwrap();
            staged
        };
        let staged = named(&path);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        drop(staged);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        named(&path).replace(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!(fs::read(&path).unwrap(), b"new");
        // A file cannot replace a folder.
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        named(&inner).replace(&inner).unwrap_err();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
