//! Files that are no pipes, devices or links. Input files are not read from a pipe or a device:
//! that could wait forever or never end. Neither is a file that is larger than any input, which
//! could fill the memory. Files of this program in folders that others can write are no links
//! either.

use crate::verbose;
use std::fs::{File, FileType, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Maximum size of an input file (bytes): over ten times the database of 100 000 rays.
const MOST_BYTES: u64 = 4 << 30;

/// The bytes of a file; an error if it is not a regular file, or larger than 4 GiB.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = std::fs::metadata(path)?;
    if metadata.len() > MOST_BYTES {
        return Err(io::Error::new(
            ErrorKind::InvalidInput,
            "it is larger than 4 GiB, the maximum of an input file",
        ));
    }
    if is_endless(metadata.file_type()) {
        return Err(io::Error::new(
            ErrorKind::InvalidInput,
            "it is a pipe, a socket or a device, not a regular file: copy its contents to a file first",
        ));
    }
    let bytes = std::fs::read(path)?;
    verbose::note(|| format!("read {} ({} bytes)", path.display(), bytes.len()));
    Ok(bytes)
}

/// Opens a file in a folder that others can write. It is an error of the kind
/// [`ErrorKind::InvalidData`] if a link, a pipe or a device is in its place: nothing is awaited,
/// and nothing that a link names is read, created or changed.
pub fn open(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    let refused = || {
        let what = "a link, a pipe or a device is in its place: remove it";
        io::Error::new(ErrorKind::InvalidData, what)
    };
    let file = match without_following(options).open(path) {
        Err(error) if is_link_or_pipe(&error) => return Err(refused()),
        opened => opened?,
    };
    if file.metadata()?.is_file() { Ok(file) } else { Err(refused()) }
}

#[cfg(unix)]
fn without_following(options: &mut OpenOptions) -> &mut OpenOptions {
    use nix::libc;
    std::os::unix::fs::OpenOptionsExt::custom_flags(options, libc::O_NOFOLLOW | libc::O_NONBLOCK)
}

/// Whether the error is caused by a link, or by a pipe without a reader.
#[cfg(unix)]
fn is_link_or_pipe(error: &io::Error) -> bool {
    use nix::libc;
    matches!(error.raw_os_error(), Some(libc::ELOOP | libc::ENXIO))
}

/// The files of a page in a browser are in its memory, and no others can write there.
#[cfg(not(unix))]
fn without_following(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

#[cfg(not(unix))]
fn is_link_or_pipe(_: &io::Error) -> bool {
    false
}

/// A folder is not endless: reading it fails with a message of its own.
fn is_endless(kind: FileType) -> bool {
    !kind.is_file() && !kind.is_dir()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn a_pipe_and_a_device_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = Command::new("mkfifo").arg(&pipe).status();
        assert!(made.unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero")] {
            let message = read(path).unwrap_err().to_string();
            assert!(message.contains("not a regular file"), "{message}");
        }
        let missing = read(&folder.path().join("none")).unwrap_err();
        assert_eq!(missing.kind(), ErrorKind::NotFound);
        let file = folder.path().join("file");
        std::fs::write(&file, "text").unwrap();
        assert_eq!(read(&file).unwrap(), b"text");
    }

    #[test]
    fn a_file_that_would_fill_the_memory_is_refused() {
        // Sparse: it takes no space on the disk.
        let file = tempfile::NamedTempFile::new().unwrap();
        file.as_file().set_len(MOST_BYTES + 1).unwrap();
        let message = read(file.path()).unwrap_err().to_string();
        assert!(message.contains("4 GiB"), "{message}");
    }
}
