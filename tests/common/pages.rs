//! The pages of the project.

use std::path::{Path, PathBuf};

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files with an extension in a folder and in the folders below it, relative to the root.
pub fn files_below(folder: &str, extension: &str) -> Vec<PathBuf> {
    let (mut pages, mut folders) = (Vec::new(), vec![PathBuf::from(folder)]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).unwrap() {
            let path = folder.join(entry.unwrap().file_name());
            match path.extension() {
                _ if root().join(&path).is_dir() => folders.push(path),
                Some(kind) if kind == extension => pages.push(path),
                _ => {}
            }
        }
    }
    pages
}

/// The pages of the project, relative to its root.
pub fn pages() -> Vec<PathBuf> {
    let mut pages = vec!["README.md".into(), "CHANGELOG.md".into()];
    pages.extend(["docs", "data"].iter().flat_map(|folder| files_below(folder, "md")));
    pages
}

pub fn read(page: &Path) -> String {
    std::fs::read_to_string(root().join(page)).unwrap()
}
