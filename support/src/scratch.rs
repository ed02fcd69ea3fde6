//! A temporary folder that no process leaves behind for long: what a killed process could not
//! remove, the next one does.

use crate::regular_file;
use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;
use tempfile::TempDir;

/// Prefix of the names of scratch folders.
const PREFIX: &str = "kirigami-";
/// The file whose lock the owner of a folder holds as long as it lives.
const OWNER: &str = "owner.lock";

/// A folder among the temporary files of the system, removed when it is dropped.
#[derive(Debug)]
pub struct Scratch {
    folder: TempDir,
    _lock: File,
}

impl Scratch {
    /// A new folder. Those whose owners were killed are removed.
    pub fn new() -> io::Result<Self> {
        Self::new_in(&std::env::temp_dir())
    }

    fn new_in(root: &Path) -> io::Result<Self> {
        remove_abandoned(root);
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(root)?;
        // The file gets its name once it is locked: a folder whose file can be locked has lost its
        // owner. On a file system without locks it gets none, and the folder of a killed process
        // stays.
        let unlocked = folder.path().join("new.lock");
        let lock = File::create_new(&unlocked)?;
        if lock.try_lock().is_ok() {
            std::fs::rename(unlocked, folder.path().join(OWNER))?;
        }
        Ok(Self { folder, _lock: lock })
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes scratch folders without an owner. What cannot be read or removed belongs to another
/// user, and stays.
fn remove_abandoned(root: &Path) {
    let folders = std::fs::read_dir(root).into_iter().flatten().flatten();
    let scratch = folders.filter(|entry| {
        let folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        folder && entry.file_name().to_string_lossy().starts_with(PREFIX)
    });
    for folder in scratch.map(|entry| entry.path()).filter(|folder| is_abandoned(folder)) {
        let _ = std::fs::remove_dir_all(folder);
    }
}

fn is_abandoned(folder: &Path) -> bool {
    let lock = regular_file::open(OpenOptions::new().read(true), &folder.join(OWNER));
    lock.is_ok_and(|lock| lock.try_lock().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_killed_processes_are_removed_and_those_in_use_are_not() {
        let root = tempfile::tempdir().unwrap();
        let in_use = Scratch::new_in(root.path()).unwrap();
        let killed = root.path().join("kirigami-killed");
        std::fs::create_dir(&killed).unwrap();
        File::create(killed.join(OWNER)).unwrap();
        // Anyone can make one: it is not waited for.
        let pipe = root.path().join("kirigami-pipe");
        std::fs::create_dir(&pipe).unwrap();
        nix::unistd::mkfifo(&pipe.join(OWNER), nix::sys::stat::Mode::S_IRWXU).unwrap();
        let begun = root.path().join("kirigami-begun");
        std::fs::create_dir(&begun).unwrap();
        let other = Scratch::new_in(root.path()).unwrap();
        assert!(!killed.exists());
        assert!(in_use.path().exists() && begun.exists() && other.path().exists());
        let path = other.path().to_owned();
        drop(other);
        assert!(!path.exists());
    }
}
