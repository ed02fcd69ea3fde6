//! Atomic file writes: a file is either complete or absent.

use crate::verbose;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;
use tempfile::NamedTempFile;

/// Writes `bytes` to `path`, whose folder must exist, as described at [`Unnamed`].
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = Unnamed::next_to(path)?;
    file.file().write_all(bytes)?;
    file.name(path)
}

/// A file on its way to its name. It is written to a temporary file with a unique name in the
/// folder of its path, and renamed at the end: the path holds either the old bytes or the new ones,
/// never a part of them, even after a loss of power. The temporary file is removed when this value
/// is dropped before; the temporary file of a killed process is removed by the next process that
/// writes to this path.
#[derive(Debug)]
pub struct Unnamed(NamedTempFile);

impl Unnamed {
    /// An empty temporary file in the folder of `path`, which must exist.
    pub fn next_to(path: &Path) -> io::Result<Self> {
        let name = path.file_name().unwrap_or_default();
        let mut file = tempfile::Builder::new();
        file.prefix(name).rand_bytes(RANDOM).suffix(SUFFIX);
        // The default permissions of a new file, before the umask is applied; a temporary file
        // would be private.
        #[cfg(unix)]
        file.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = file.tempfile_in(folder(path))?;
        // A file system without locks removes no file.
        let _ = file.as_file().try_lock();
        remove_abandoned(path, file.as_file());
        Ok(Self(file))
    }

    /// The file, to be written.
    pub fn file(&mut self) -> &mut File {
        self.0.as_file_mut()
    }

    /// Renames the file to `path`. File and folder are synced to the disk before this function
    /// returns.
    pub fn name(self, path: &Path) -> io::Result<()> {
        self.0.as_file().sync_all()?;
        let bytes = self.0.as_file().metadata()?.len();
        self.0.persist(path)?;
        File::open(folder(path))?.sync_all()?;
        verbose::note(|| format!("wrote {} ({bytes} bytes)", path.display()));
        Ok(())
    }
}

/// Gives a whole file another name in the same folder, which is synced to the disk before this
/// function returns.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    std::fs::rename(from, to)?;
    File::open(folder(to))?.sync_all()
}

/// The end of the name of a temporary file.
const SUFFIX: &str = ".partial";
/// Time after which the writer of a temporary file has locked it, if it is at work.
const LOCKED_AFTER: Duration = Duration::from_secs(5);

/// Removes the temporary files of `path` that killed processes left: no process has locked them,
/// and they are older than `newest`, which is on the same disk and was created just now. What
/// cannot be read stays.
fn remove_abandoned(path: &Path, newest: &File) {
    let (Some(name), Ok(now)) = (
        path.file_name().map(OsStr::as_encoded_bytes),
        newest.metadata().and_then(|new| new.modified()),
    ) else {
        return;
    };
    let is_temporary = |file: &OsStr| {
        let random = file.as_encoded_bytes().strip_prefix(name);
        random.is_some_and(|rest| {
            rest.len() == RANDOM + SUFFIX.len() && rest.ends_with(SUFFIX.as_bytes())
        })
    };
    let is_abandoned = |path: &Path| -> io::Result<bool> {
        let metadata = std::fs::symlink_metadata(path)?;
        let age = now.duration_since(metadata.modified()?).unwrap_or_default();
        Ok(metadata.is_file() && age > LOCKED_AFTER && File::open(path)?.try_lock().is_ok())
    };
    let entries = std::fs::read_dir(folder(path)).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| is_temporary(&entry.file_name())) {
        if is_abandoned(&entry.path()).unwrap_or(false) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Number of random characters in the name of a temporary file.
const RANDOM: usize = 6;

/// The folder of a path.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Creates a folder and its missing parents, and syncs their entries to the disk: a synced file is
/// not lost with its folder.
pub fn create_folder(path: &Path) -> io::Result<()> {
    if path == Path::new("") || path.is_dir() {
        return Ok(());
    }
    let parent = path.parent().unwrap_or(Path::new(""));
    create_folder(parent)?;
    match std::fs::create_dir(path) {
        // Another process may create it at the same time.
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => Err(error),
        _ if parent == Path::new("") => File::open(".")?.sync_all(),
        _ => File::open(parent)?.sync_all(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn what_a_killed_process_left_is_removed_by_the_next_that_writes_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        let old = |name: &str| {
            let file = File::create(folder.path().join(name)).unwrap();
            let created = file.metadata().unwrap().modified().unwrap();
            file.set_modified(created - 2 * LOCKED_AFTER).unwrap();
            file
        };
        // Left by a killed process; of another file; of a writer at work.
        old("a.jsonAbC123.partial");
        old("b.jsonAbC123.partial");
        old("a.json.partial");
        let at_work = old("a.jsonXyZ789.partial");
        at_work.lock().unwrap();
        // Its writer has not locked it yet.
        File::create(folder.path().join("a.jsonnew123.partial")).unwrap();
        write(&path, b"new").unwrap();
        let entries = std::fs::read_dir(&folder).unwrap();
        let mut left: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        let expected = [
            "a.json",
            "a.json.partial",
            "a.jsonXyZ789.partial",
            "a.jsonnew123.partial",
            "b.jsonAbC123.partial",
        ];
        assert_eq!(left, expected);
    }

    #[test]
    fn a_file_is_replaced_completely_and_no_temporary_file_remains() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write(&path, b"old and long").unwrap();
        write(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        let other = folder.path().join("other");
        File::create(&other).unwrap();
        let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&other));
        assert!(write(&folder.path().join("none/a.json"), b"").is_err());
    }
}
