//! The name of an output → a regular file, a device or pipe, or standard output.

use std::fs::{self, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The name of standard input as an input, and of standard output as an output.
pub const STANDARD: &str = "-";

/// The reason why an output cannot be written, in one line.
#[derive(Debug, thiserror::Error)]
#[error("{file}: cannot be written: {reason}")]
pub struct OutputTargetError {
    file: String,
    reason: String,
}

/// The target of an output.
#[derive(Clone, Debug, PartialEq)]
pub enum OutputTarget {
    /// Standard output by any of its names. These are `-`, another one such as `/dev/stdout`, and the file to which it is redirected.
    StandardOutput,
    /// A device, a pipe or an open file of another program, appended to.
    Stream(PathBuf),
    /// A regular file, which may not exist yet; symbolic links are resolved.
    File(PathBuf),
}

impl OutputTarget {
    /// Determines the target of an output. Nothing is opened or changed.
    ///
    /// # Errors
    /// The name is that of a folder or a disk, its folder does not exist, or the lookup fails.
    pub fn of(path: &Path) -> Result<OutputTarget, OutputTargetError> {
        let refused = |reason: &str| OutputTargetError { file: path.display().to_string(), reason: reason.into() };
        let by_system = |error: io::Error| refused(&error.to_string());
        let folder_found = || refused("it is a folder; expected the name of a file");
        if path == Path::new(STANDARD) {
            return Ok(OutputTarget::StandardOutput);
        }
        if path.as_os_str().to_string_lossy().ends_with(std::path::is_separator) {
            return Err(folder_found());
        }
        let found = match fs::metadata(path) {
            Ok(metadata) => Some(metadata),
            // A new file, or a link to one.
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(by_system(error)),
        };
        let target = target(path).map_err(by_system)?;
        let Some(metadata) = found else {
            return if folder(&target).is_dir() {
                Ok(OutputTarget::File(target))
            } else {
                Err(refused("found no folder for it; expected an existing one"))
            };
        };
        let is_open = is_open_file(&target);
        // A regular file with the inode of standard output is its redirection; devices such as /dev/null are excluded.
        let is_standard_output = (is_open || metadata.is_file())
            && os::inode(&metadata)
                .is_some_and(|inode| os::standard_output().and_then(|output| os::inode(&output)) == Some(inode));
        if metadata.is_dir() {
            Err(folder_found())
        } else if os::is_disk(&metadata) {
            Err(refused("it is a disk; expected the name of a file"))
        } else if is_standard_output {
            Ok(OutputTarget::StandardOutput)
        } else if is_open || !metadata.is_file() {
            Ok(OutputTarget::Stream(target))
        } else {
            Ok(OutputTarget::File(target))
        }
    }

    /// The name of the target in messages, given as `path` by the user.
    pub fn name(&self, path: &Path) -> String {
        match self {
            OutputTarget::StandardOutput => "standard output".into(),
            OutputTarget::Stream(_) | OutputTarget::File(_) => path.display().to_string(),
        }
    }

    /// Opens a stream or standard output; nothing for a regular file. A named pipe waits for its reader.
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn open_stream(&self) -> io::Result<Option<Box<dyn Write + Send>>> {
        Ok(match self {
            OutputTarget::StandardOutput => Some(Box::new(io::stdout())),
            // Appending keeps the earlier output of other programs.
            OutputTarget::Stream(path) => Some(Box::new(OpenOptions::new().append(true).open(path)?)),
            OutputTarget::File(_) => None,
        })
    }

    /// The identity of the target.
    pub fn identity(&self) -> Option<Identity> {
        match self {
            OutputTarget::StandardOutput => os::standard_output().and_then(|metadata| Identity::of(&metadata)),
            OutputTarget::Stream(path) => fs::metadata(path).ok().and_then(|metadata| Identity::of(&metadata)),
            OutputTarget::File(path) => Identity::of_input(path).or_else(|| {
                let folder = folder(path).canonicalize().ok()?;
                Some(Identity::Name(folder.join(path.file_name()?)))
            }),
        }
    }
}

/// The folder of a file.
pub fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The end of a chain of symbolic links, existing or not. An open file of a program ends the chain.
fn target(path: &Path) -> io::Result<PathBuf> {
    // The limit of Linux; the caller has checked that the chain ends.
    const LINKS: usize = 40;
    let mut target = path.to_path_buf();
    for _ in 0..LINKS {
        let is_link = fs::symlink_metadata(&target).is_ok_and(|metadata| metadata.is_symlink());
        if !is_link || is_open_file(&target) {
            break;
        }
        target = folder(&target).join(fs::read_link(&target)?);
    }
    Ok(target)
}

/// Whether a path names an open file of a program, as `/dev/fd/3` and `/proc/self/fd/3` do.
fn is_open_file(path: &Path) -> bool {
    let folder = folder(path).canonicalize().unwrap_or_default();
    folder == Path::new("/dev/fd") || folder.starts_with("/proc") && folder.ends_with("fd")
}

/// The identity of a regular file or pipe, whatever its names. Devices have none: they may be named twice.
#[derive(Clone, Debug, PartialEq)]
pub enum Identity {
    /// Device and inode.
    Inode(u64, u64),
    /// Absolute path without links, for a new file or a system without inodes.
    Name(PathBuf),
}

impl Identity {
    /// The identity of an input; nothing if it does not exist.
    pub fn of_input(path: &Path) -> Option<Identity> {
        if path == Path::new(STANDARD) {
            return Identity::of(&os::standard_input()?);
        }
        let metadata = fs::metadata(path).ok()?;
        let named = || metadata.is_file().then(|| path.canonicalize().ok().map(Identity::Name)).flatten();
        Identity::of(&metadata).or_else(named)
    }

    fn of(metadata: &Metadata) -> Option<Identity> {
        let lasts = metadata.is_file() || os::is_pipe(metadata);
        os::inode(metadata).filter(|_| lasts).map(|(device, inode)| Identity::Inode(device, inode))
    }
}

#[cfg(unix)]
mod os {
    use std::fs::{File, Metadata};
    use std::io;
    use std::os::fd::{AsFd, BorrowedFd};
    use std::os::unix::fs::{FileTypeExt, MetadataExt};

    pub fn is_disk(metadata: &Metadata) -> bool {
        metadata.file_type().is_block_device()
    }

    pub fn is_pipe(metadata: &Metadata) -> bool {
        metadata.file_type().is_fifo()
    }

    /// Device and inode.
    pub fn inode(metadata: &Metadata) -> Option<(u64, u64)> {
        Some((metadata.dev(), metadata.ino()))
    }

    pub fn standard_input() -> Option<Metadata> {
        metadata(io::stdin().as_fd())
    }

    pub fn standard_output() -> Option<Metadata> {
        metadata(io::stdout().as_fd())
    }

    fn metadata(open: BorrowedFd) -> Option<Metadata> {
        File::from(open.try_clone_to_owned().ok()?).metadata().ok()
    }
}

#[cfg(not(unix))]
mod os {
    use std::fs::Metadata;

    pub fn is_disk(_: &Metadata) -> bool {
        false
    }

    pub fn is_pipe(_: &Metadata) -> bool {
        false
    }

    pub fn inode(_: &Metadata) -> Option<(u64, u64)> {
        None
    }

    pub fn standard_input() -> Option<Metadata> {
        None
    }

    pub fn standard_output() -> Option<Metadata> {
        None
    }
}
