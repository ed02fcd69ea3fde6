//! Atomic file writes: a file is either complete or absent.

use crate::verbose;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use tempfile::NamedTempFile;

/// Writes `bytes` to `path`, whose folder must exist, as described at [`Unnamed`].
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = Unnamed::beside(path)?;
    file.file().write_all(bytes)?;
    file.name(path)
}

/// A file on its way to its name. It is written to a temporary file with a unique name in the folder of its path, and
/// renamed at the end: the path holds either the old bytes or the new ones, never a part of them, even after a loss of
/// power. The temporary file is removed when this value is dropped before.
#[derive(Debug)]
pub struct Unnamed(NamedTempFile);

impl Unnamed {
    /// An empty temporary file in the folder of `path`, which must exist.
    pub fn beside(path: &Path) -> io::Result<Self> {
        let name = path.file_name().unwrap_or_default();
        tempfile::Builder::new()
            .prefix(name)
            .suffix(".partial")
            .permissions(permissions())
            .tempfile_in(folder(path))
            .map(Self)
    }

    /// The file, to be written.
    pub fn file(&mut self) -> &mut File {
        self.0.as_file_mut()
    }

    /// Renames the file to `path`. File and folder are synced to the disk before this function returns.
    pub fn name(self, path: &Path) -> io::Result<()> {
        self.0.as_file().sync_all()?;
        let bytes = self.0.as_file().metadata()?.len();
        self.0.persist(path)?;
        File::open(folder(path))?.sync_all()?;
        verbose::note(|| format!("wrote {} ({bytes} bytes)", path.display()));
        Ok(())
    }
}

/// Gives a whole file another name in the same folder, which is synced to the disk before this function returns.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    std::fs::rename(from, to)?;
    File::open(folder(to))?.sync_all()
}

/// The folder of a path.
fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Creates a folder and its missing parents, and syncs their entries to the disk: a synced file is not lost with its
/// folder.
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

/// The default permissions of a new file, before the umask is applied; a temporary file would be private.
fn permissions() -> std::fs::Permissions {
    std::os::unix::fs::PermissionsExt::from_mode(0o666)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

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
