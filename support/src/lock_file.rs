//! Lock files: they keep two commands from doing the same work. On a file system without locks they
//! do nothing, since no result depends on them.

use crate::regular_file;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

/// Locks a file, created if missing, until the returned file is dropped. If another process has
/// locked it, the error is of the kind [`io::ErrorKind::WouldBlock`].
pub fn try_hold(path: &Path) -> io::Result<File> {
    hold_by(path, |file| file.try_lock().map_err(io::Error::from))
}

/// Does the same as [`try_hold`], but waits while another process has locked the file.
pub fn hold(path: &Path) -> io::Result<File> {
    hold_by(path, File::lock)
}

fn hold_by(path: &Path, lock: impl Fn(&File) -> io::Result<()>) -> io::Result<File> {
    let file = regular_file::open(OpenOptions::new().create(true).append(true), path)?;
    match lock(&file) {
        Err(error) if !is_without_locks(&error) => Err(error),
        _ => Ok(file),
    }
}

/// Whether an error says that the file system has no locks.
fn is_without_locks(error: &io::Error) -> bool {
    #[cfg(unix)]
    if error.raw_os_error() == Some(nix::errno::Errno::ENOLCK as i32) {
        return true;
    }
    error.kind() == io::ErrorKind::Unsupported
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_held_file_cannot_be_held_again_until_it_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let held = hold(&path).unwrap();
        let refused = try_hold(&path).unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::WouldBlock);
        drop(held);
        try_hold(&path).unwrap();
    }

    /// Neither waits, nor creates or changes what a link names.
    #[test]
    fn only_a_regular_file_is_a_lock() {
        let folder = tempfile::tempdir().unwrap();
        let [pipe, link, named] = ["pipe", "link", "named"].map(|name| folder.path().join(name));
        nix::unistd::mkfifo(&pipe, nix::sys::stat::Mode::S_IRWXU).unwrap();
        std::os::unix::fs::symlink(&named, &link).unwrap();
        for path in [&pipe, &link] {
            for error in [try_hold(path).unwrap_err(), hold(path).unwrap_err()] {
                assert!(error.to_string().contains("remove it"), "{error}");
            }
        }
        assert!(!named.exists());
    }
}
