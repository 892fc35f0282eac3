//! The name of an output → where it goes: a regular file, a device or pipe, or standard output.

use std::fs::{self, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The name of standard input, as an input, and of standard output, as an output.
pub const STANDARD: &str = "-";

/// Why nothing can be written where the name of an output points. Every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// The name of a folder.
    #[error("{0}: cannot be written: it is a folder; expected the name of a file")]
    Folder(String),
    /// The folder in which the file would be is missing.
    #[error("{0}: cannot be written: its folder does not exist")]
    NoFolder(String),
    /// A disk or a partition, the content of which would be lost.
    #[error("{0}: cannot be written: it is a disk; expected the name of a file")]
    Disk(String),
    /// The operating system refuses.
    #[error("{file}: cannot be written: {error}")]
    Refused {
        /// Name of the output.
        file: String,
        /// The reason that the operating system gives.
        error: io::Error,
    },
}

/// Where an output goes.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Standard output: `-`, another name of it such as `/dev/stdout`, or the file that it was redirected to.
    StandardOutput,
    /// A device, a pipe or an open file of another program, written into as it is.
    Stream(PathBuf),
    /// A regular file, which may not exist yet. Symbolic links have been followed: this is what they point to.
    File(PathBuf),
}

impl Place {
    /// Finds out where an output of this name goes. Nothing is opened or changed.
    ///
    /// # Errors
    /// There is a folder or a disk of that name, its own folder does not exist, or it cannot be looked up.
    pub fn of(path: &Path) -> Result<Place, PlaceError> {
        let name = || path.display().to_string();
        let refused = |error| PlaceError::Refused { file: name(), error };
        if path == Path::new(STANDARD) {
            return Ok(Place::StandardOutput);
        }
        if path.as_os_str().to_string_lossy().ends_with(std::path::is_separator) {
            return Err(PlaceError::Folder(name()));
        }
        let found = match fs::metadata(path) {
            Ok(metadata) => Some(metadata),
            // A new file, or a link to one.
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(refused(error)),
        };
        let target = target(path).map_err(refused)?;
        let Some(metadata) = found else {
            return if folder(&target).is_dir() { Ok(Place::File(target)) } else { Err(PlaceError::NoFolder(name())) };
        };
        let is_open = is_open_file(&target);
        // A file is standard output where that was redirected to it; /dev/null is not, though it may be both.
        let is_standard_output = (is_open || metadata.is_file())
            && os::inode(&metadata)
                .is_some_and(|inode| os::standard_output().and_then(|output| os::inode(&output)) == Some(inode));
        if metadata.is_dir() {
            Err(PlaceError::Folder(name()))
        } else if os::is_disk(&metadata) {
            Err(PlaceError::Disk(name()))
        } else if is_standard_output {
            Ok(Place::StandardOutput)
        } else if is_open || !metadata.is_file() {
            Ok(Place::Stream(target))
        } else {
            Ok(Place::File(target))
        }
    }

    /// What to call this place in messages, when the user called it `path`.
    pub fn name(&self, path: &Path) -> String {
        match self {
            Place::StandardOutput => "standard output".into(),
            Place::Stream(_) | Place::File(_) => path.display().to_string(),
        }
    }

    /// Opens what is written into as it is; nothing for a regular file. A named pipe waits for its reader.
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn open_stream(&self) -> io::Result<Option<Box<dyn Write>>> {
        Ok(match self {
            Place::StandardOutput => Some(Box::new(io::stdout())),
            // What another program has written into an open file before stays there.
            Place::Stream(path) => Some(Box::new(OpenOptions::new().append(true).open(path)?)),
            Place::File(_) => None,
        })
    }

    /// What tells this place from others.
    pub fn identity(&self) -> Option<Identity> {
        match self {
            Place::StandardOutput => os::standard_output().and_then(|metadata| Identity::of(&metadata)),
            Place::Stream(path) => fs::metadata(path).ok().and_then(|metadata| Identity::of(&metadata)),
            Place::File(path) => Identity::of_input(path).or_else(|| {
                let folder = folder(path).canonicalize().ok()?;
                Some(Identity::Name(folder.join(path.file_name()?)))
            }),
        }
    }
}

/// The folder in which a file is.
pub fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What a chain of symbolic links ends in, whether it exists or not, or the open file of a program on the way.
fn target(path: &Path) -> io::Result<PathBuf> {
    // As many as Linux follows; that they end has been seen.
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

/// What tells one regular file or pipe from another, whatever its names. Devices have none: they may be named twice.
#[derive(Clone, Debug, PartialEq)]
pub enum Identity {
    /// Device and inode.
    Inode(u64, u64),
    /// Absolute path without links, of a file that does not exist yet or where there are no inodes.
    Name(PathBuf),
}

impl Identity {
    /// That of an input; nothing if it does not exist.
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
