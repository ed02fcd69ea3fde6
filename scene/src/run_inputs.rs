//! The inputs of a run, copied to its folder: the design can be replayed where scene, material and
//! weights are missing.
//!
//! | file | contents |
//! |---|---|
//! | `scene.toml` | the keys of the run; its paths name the files below |
//! | `inputs/material.toml` | the material, with its measured curve as `plastic` |
//! | `inputs/target.csv`, `.svg`, `.dxf` | the target, if the scene names a file |
//! | `inputs/weights.safetensors`, `.json` | weights and card, if the hinge law reads them |
//! | `inputs/ensemble-N.safetensors`, `inputs/draft.safetensors`, their `.json` | the further networks, from 1, and the network of drafts |
//! | `inputs/springback.json` | the law of released hinges, if the scene names one |
//! | `inputs/solved-hinges.json` | the hinges by finite elements, if the scene names them |
//!
//! The state of the run holds the BLAKE3 hash of each of them.

use crate::{
    checked_scene::Scene,
    drawing::drawn_outline::numbered,
    keys::{SceneConfig, resolved},
};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    convert::Infallible,
    fmt::Display,
    path::{Path, PathBuf},
};
use support::{Fault, ensure, regular_file, sealed_json, whole_file};

/// The state of a run, in its folder.
pub const STATE_FILE: &str = "state.json";
/// The scene of a run, in its folder.
pub const SCENE_FILE: &str = "scene.toml";
/// The folder of the copies, in the folder of a run.
pub const INPUTS: &str = "inputs";
const MATERIAL_FILE: &str = "inputs/material.toml";

/// The BLAKE3 hash of every input of a run, by its path relative to the run folder.
pub(super) type InputHashes = BTreeMap<String, String>;

/// The scene file that `path` names: itself, or if it is the folder of a run, the scene of the run,
/// after a check that none of the copied inputs has changed.
pub fn scene_file(path: &Path) -> Result<PathBuf, Fault> {
    /// The part of a run's state that names its inputs.
    #[derive(Deserialize)]
    struct Named {
        inputs: InputHashes,
    }
    let is_drawing = |end| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(end));
    ensure!(
        !["svg", "dxf"].into_iter().any(is_drawing),
        "{} is a drawing: `kirigami init FOLDER --target` makes a scene of it",
        path.display()
    );
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let state = path.join(STATE_FILE);
    ensure!(
        state.exists(),
        "{} is a folder without the state of a run: name a scene, or the folder of a run",
        path.display()
    );
    let named: Named = sealed_json::from_slice(&read(&state)?)
        .map_err(|error| format!("{} is not the state of a run: {error}", state.display()))?;
    for (name, expected) in named.inputs {
        let path = path.join(name);
        let found = blake3::hash(&read(&path)?).to_hex().to_string();
        ensure!(
            found == expected,
            "{} is not the file that the run was made with (BLAKE3 {found}, not {expected}): copy the whole run folder \
             again, or run `kirigami design` with the scene again",
            path.display()
        );
    }
    Ok(path.join(SCENE_FILE))
}

/// Whether a run has begun to write to a folder: its first file is there.
pub fn holds_a_run(folder: &Path) -> bool {
    folder.join(MATERIAL_FILE).is_file()
}

/// Copies the files that a scene reads to its run folder, and writes the scene that names the
/// copies.
pub(super) fn keep(scene: &Scene) -> Result<InputHashes, Fault> {
    let mut kept = Kept { scene, hashes: InputHashes::new() };
    let folder = scene.output().join(INPUTS);
    whole_file::create_folder(&folder).map_err(unused(&folder))?;
    let mut config = scene.config.without_unread_weights();
    config.output = ".".into();
    config.material = kept.write(MATERIAL_FILE, &toml(&scene.measured, &folder)?)?;
    for (name, file) in config.inputs_mut() {
        let name = format!("{INPUTS}/{name}");
        let (original, number) = numbered(&resolved(&scene.path, file));
        if let Some(stem) = name.strip_suffix(".safetensors") {
            kept.copy(&original.with_extension("json"), &format!("{stem}.json"))?;
        }
        *file = kept.copy(&original, &name)?;
        if let Some(number) = number {
            *file = format!("{name}#{number}").into();
        }
    }
    kept.write(SCENE_FILE, &toml(&config, &folder)?)?;
    Ok(kept.hashes)
}

/// The files that were written to a run folder.
struct Kept<'a> {
    scene: &'a Scene,
    hashes: InputHashes,
}

impl Kept<'_> {
    /// Writes a file unless it has these contents already; returns its path relative to the run
    /// folder.
    fn write(&mut self, name: &str, contents: &[u8]) -> Result<PathBuf, Fault> {
        let path = self.scene.output().join(name);
        if !path.exists() || read(&path)? != contents {
            whole_file::write(&path, contents).map_err(unused(&path))?;
        }
        let hash = blake3::hash(contents).to_hex().to_string();
        self.hashes.insert(name.to_owned(), hash);
        Ok(name.into())
    }

    fn copy(&mut self, from: &Path, name: &str) -> Result<PathBuf, Fault> {
        let contents = read(from)?;
        self.write(name, &contents)
    }
}

impl SceneConfig {
    /// The files that the scene names besides its material, to be changed, each with the name of
    /// its copy in the folder of a run.
    pub(crate) fn inputs_mut(&mut self) -> Vec<(String, &mut PathBuf)> {
        let target = self.target.file_mut().into_iter();
        let mut inputs: Vec<_> = target.map(|(name, file)| (name.to_owned(), file)).collect();
        if let Some(learned) = &mut self.surrogate {
            let mut add = |name: &str, file| inputs.push((name.to_owned(), file));
            add("weights.safetensors", &mut learned.weights);
            let mut add_all =
                |name: &str, files: Option<_>| files.into_iter().for_each(|file| add(name, file));
            add_all("draft.safetensors", learned.draft.as_mut());
            add_all("springback.json", learned.springback.as_mut());
            add_all("solved-hinges.json", learned.solved_hinges.as_mut());
            for (i, file) in learned.ensemble.iter_mut().enumerate() {
                add(&format!("ensemble-{}.safetensors", i + 1), file);
            }
        }
        inputs
    }

    /// The same scene without paths: two scenes that differ in paths alone describe one design
    /// problem if the files agree.
    pub(super) fn without_paths(&self) -> Self {
        let mut config = self.without_unread_weights();
        if let Some(learned) = &mut config.surrogate {
            learned.ensemble.clear();
            learned.draft = None;
            learned.springback = None;
            learned.solved_hinges = None;
        }
        let Ok(config) = config.with_paths(|_| Ok::<_, Infallible>(PathBuf::new()));
        config
    }

    /// The same scene with other paths.
    pub(crate) fn with_paths<E>(
        mut self,
        other: impl Fn(&Path) -> Result<PathBuf, E>,
    ) -> Result<Self, E> {
        for (_, path) in self.inputs_mut() {
            *path = other(path)?;
        }
        self.material = other(&self.material)?;
        self.output = other(&self.output)?;
        Ok(self)
    }
}

fn toml(value: &impl Serialize, folder: &Path) -> Result<Vec<u8>, Fault> {
    Ok(toml::to_string(value).map_err(unused(folder))?.into_bytes())
}

/// Maps an error with a file or a folder of a run, for use in `map_err`.
pub(crate) fn unused<E: Display>(path: &Path) -> impl FnOnce(E) -> Fault {
    move |error| format!("cannot use {}: {error}", path.display()).into()
}

fn read(path: &Path) -> Result<Vec<u8>, Fault> {
    regular_file::read(path).map_err(unused(path))
}
