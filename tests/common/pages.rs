//! The pages of the project.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use toml_edit::DocumentMut;

pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files with an extension in a folder and in the folders below it, relative to the root.
pub(crate) fn files_below(folder: &str, extension: &str) -> Vec<PathBuf> {
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

/// The folders of the crates of the workspace; the root is the last one.
pub(crate) fn members() -> Vec<String> {
    let manifest: DocumentMut = read(Path::new("Cargo.toml")).parse().unwrap();
    let members = manifest["workspace"]["members"].as_array().unwrap().iter();
    members.filter_map(|member| member.as_str()).chain(["."]).map(str::to_owned).collect()
}

/// The Rust sources of all crates, with their tests.
pub(crate) fn sources() -> Vec<PathBuf> {
    let parts = ["src", "tests", "benches"];
    let folders =
        members().into_iter().flat_map(|member| parts.map(|part| format!("{member}/{part}")));
    let folders = folders.map(|folder| folder.trim_start_matches("./").to_owned());
    let folders = folders.filter(|folder| root().join(folder).is_dir());
    // The tests of the root have a member among them.
    let files: BTreeSet<PathBuf> = folders.flat_map(|folder| files_below(&folder, "rs")).collect();
    files.into_iter().collect()
}

/// The pages of the project, relative to its root.
pub(crate) fn pages() -> Vec<PathBuf> {
    let mut pages = vec!["README.md".into(), "CHANGELOG.md".into(), "CONTRIBUTING.md".into()];
    pages.extend(["docs", "data"].iter().flat_map(|folder| files_below(folder, "md")));
    pages
}

pub(crate) fn read(page: &Path) -> String {
    std::fs::read_to_string(root().join(page)).unwrap()
}
