//! The studio as a page of files, which any web server serves: the page, the worker, and the
//! shipped files that designs need. The module of the worker is this program, compiled for
//! WebAssembly (`make page`).

use crate::page::{Connection, page};
use anyhow::{Context, Result};
use app::{new_project::WEIGHTS, output_file};
use serde_json::json;
use std::path::{Path, PathBuf};
use support::{regular_file, unread};

/// Folders of the materials and examples of the studio, and of the files that they name.
const CONFIGS: [&str; 4] =
    ["configs/materials", "configs/examples", "configs/targets", "configs/tensile"];

/// Writes the page into a new folder; the shipped files are in the working folder.
pub fn write(folder: &Path) -> Result<()> {
    let mut files = Vec::new();
    for of_configs in CONFIGS {
        files.extend(files_in(Path::new(of_configs))?);
    }
    for weights in WEIGHTS.iter().map(Path::new) {
        let all = files_in(weights.parent().unwrap_or(Path::new("")))?;
        files.extend(all.into_iter().filter(|file| is_for_designs(file)));
    }
    files.sort();
    for file in &files {
        let bytes = regular_file::read(file).map_err(unread(file))?;
        let copy = folder.join(file);
        output_file::create_folder_of(&copy)?;
        output_file::write(&copy, bytes)?;
    }
    let (later, first): (Vec<_>, Vec<_>) = files.iter().partition(|file| comes_later(file));
    let listed = json!({ "first": first, "later": later });
    output_file::write(&folder.join("files.json"), listed.to_string())?;
    output_file::write(&folder.join("index.html"), page(Connection::Worker))?;
    let worker = [include_str!("page/wasi.js"), include_str!("page/worker.js")].concat();
    output_file::write(&folder.join("worker.js"), worker)
}

fn files_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder);
    let entries = entries.with_context(|| {
        format!("cannot read {}: run in the folder of kirigami", folder.display())
    })?;
    let paths = entries.map(|entry| Ok(entry?.path()));
    let paths: Result<Vec<_>> = paths.collect();
    Ok(paths?.into_iter().filter(|path| path.is_file()).collect())
}

/// Weights with their cards, and laws of springback, but no database.
fn is_for_designs(file: &Path) -> bool {
    let is = |kind| file.extension().is_some_and(|extension| extension == kind);
    (is("safetensors") || is("json")) && !file.with_extension("parquet").is_file()
}

/// Whether a file comes when it is asked for: all data but the cards from which the page lists its
/// materials.
fn comes_later(file: &Path) -> bool {
    let mut cards = WEIGHTS.iter().map(|weights| Path::new(weights).with_extension("json"));
    file.starts_with("data") && !cards.any(|card| file == card)
}
