//! Atomic file writes: a file is either complete or absent.

use crate::verbose;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Writes `bytes` to a temporary file with a unique name in the folder of `path`, which must exist, and renames it
/// to `path`. The path holds either the old bytes or the new ones, never a part of them, even after a loss of
/// power. File and folder are synced to the disk before this function returns.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let name = path.file_name().unwrap_or_default();
    let mut beside = tempfile::Builder::new()
        .prefix(name)
        .suffix(".partial")
        .permissions(permissions())
        .tempfile_in(folder)?;
    beside.write_all(bytes)?;
    beside.as_file().sync_all()?;
    beside.persist(path)?;
    File::open(folder)?.sync_all()?;
    verbose::note(|| format!("wrote {} ({} bytes)", path.display(), bytes.len()));
    Ok(())
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
