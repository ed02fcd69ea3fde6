//! Files that an external program writes: its log, its results, and results of earlier runs.

use crate::program::process_group::MAX_FILE_MIB;
use crate::regular_file;
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

/// Number of bytes at the end of a log that an error quotes.
const TAIL: i64 = 600;

/// Removes the output of an earlier run, so that it is not mistaken for the result of the next.
pub fn remove_stale(path: &Path) -> io::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The bytes of a file that a program wrote; empty if there is none. Anything else than a regular
/// file of at most 1 GiB is an error, also a link, which could name an endless device.
pub fn output_file(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    match open(path) {
        Ok(file) => {
            file.take(MAX_FILE_MIB << 20).read_to_end(&mut bytes)?;
            Ok(bytes)
        }
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(bytes),
        Err(error) => Err(error),
    }
}

/// A regular file of a size that a program may write.
fn open(path: &Path) -> io::Result<File> {
    let file = regular_file::open(OpenOptions::new().read(true), path)?;
    if file.metadata()?.len() > MAX_FILE_MIB << 20 {
        let what = "it is larger than any result";
        return Err(io::Error::new(ErrorKind::InvalidData, what));
    }
    Ok(file)
}

/// The last bytes of a log, or a note that the log cannot be read.
pub fn tail(log: &Path) -> String {
    let read = || -> io::Result<Vec<u8>> {
        let mut file = open(log)?;
        let length = file.metadata()?.len() as i64;
        file.seek(SeekFrom::End(-length.min(TAIL)))?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    match read() {
        Ok(bytes) => String::from_utf8_lossy(&bytes).trim().to_owned(),
        Err(error) => format!("(the log {} cannot be read: {error})", log.display()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn only_regular_files_are_read_as_output() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("file"), "text").unwrap();
        symlink(path("file"), path("link")).unwrap();
        symlink("/dev/zero", path("endless")).unwrap();
        nix::unistd::mkfifo(&path("pipe"), nix::sys::stat::Mode::S_IRWXU).unwrap();
        let sparse = File::create(path("large")).unwrap();
        sparse.set_len((MAX_FILE_MIB << 20) + 1).unwrap();
        assert_eq!(output_file(&path("file")).unwrap(), b"text");
        assert!(output_file(&path("none")).unwrap().is_empty());
        for name in ["link", "endless", "pipe", "large"] {
            let error = output_file(&path(name)).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::InvalidData, "{name}");
            let tail = tail(&path(name));
            assert!(tail.contains("cannot be read"), "{tail}");
        }
    }
}
