//! Paths of files from a folder.

use std::io;
use std::path::{Path, PathBuf};

/// The path of a file from a folder; either need not exist. An absolute path where no other leads
/// there.
pub fn from_folder(folder: &Path, file: &Path) -> io::Result<PathBuf> {
    let (folder, file) = (std::path::absolute(folder)?, std::path::absolute(file)?);
    let (Some(parent), Some(name)) = (file.parent(), file.file_name()) else {
        return Ok(file);
    };
    let file = without_links(parent).join(name);
    Ok(pathdiff::diff_paths(&file, without_links(&folder)).unwrap_or(file))
}

/// An absolute path without symbolic links in the part of it that exists: `..` leads to the parent.
fn without_links(path: &Path) -> PathBuf {
    let mut existing = path.ancestors();
    let real = existing.find_map(|folder| {
        let rest = path.strip_prefix(folder).ok()?;
        Some(folder.canonicalize().ok()?.join(rest))
    });
    real.unwrap_or_else(|| path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_leads_from_a_folder_that_does_not_exist_yet_to_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(path("data/deep")).unwrap();
        let found = from_folder(&path("new/sheet"), &path("data/a.json")).unwrap();
        assert_eq!(found, Path::new("../../data/a.json"));
        // A folder behind a link is elsewhere.
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(path("data/deep"), path("link")).unwrap();
            let found = from_folder(&path("link/sheet"), &path("data/a.json")).unwrap();
            assert_eq!(found, Path::new("../../a.json"));
        }
    }
}
