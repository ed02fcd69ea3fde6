//! The files of a run that a page offers.

use anyhow::Result;
use output::run_files::RUN_FILES;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A file of a run.
#[derive(Serialize)]
pub(crate) struct ListedFile {
    /// Its path in the run folder.
    pub name: String,
    contents: &'static str,
}

/// The files in a run folder: those for cutting first.
pub(crate) fn files_of_run(folder: &Path) -> Result<Vec<ListedFile>> {
    let cut = files_below(&folder.join("cut"))?.into_iter();
    let cut = cut.map(|path| (path, "written for cutting"));
    let of_run = RUN_FILES.iter().map(|file| (folder.join(file.name), file.contents));
    let all = cut.chain(of_run.filter(|(path, _)| path.is_file()));
    let listed = all.filter_map(|(path, contents)| {
        let name = path.strip_prefix(folder).ok()?;
        Some(ListedFile { name: name.to_string_lossy().into_owned(), contents })
    });
    Ok(listed.collect())
}

/// All files in a folder and the folders in it; none if it does not exist.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            files.extend(files_below(&path)?);
        } else if path.extension().is_some() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
