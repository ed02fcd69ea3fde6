//! The folder of a sheet in the studio: its scene, its drawings and its runs.
//!
//! | file | contents |
//! |---|---|
//! | `scene.toml` | the scene that is shown, for `kirigami design` |
//! | `target-HASH.svg` | drawings that were dropped onto the page |
//! | `design-N/` | the run folders of the searches, from 1 |

use crate::commands::init::InitCommand;
use crate::studio::request::NewSheet;
use crate::ui::output_file;
use anyhow::{Context, Result, ensure};
use design::scene::design_run::stored_design;
use design::scene::run_inputs::{STATE_FILE, scene_file};
use design::scene::{Scene, SceneConfig};
use std::path::{Path, PathBuf};
use support::regular_file;

/// The first line of a scene that the studio writes. It changes no other scene.
const HEAD: &str =
    "# Written by `kirigami studio`, which replaces it when the sheet is changed there.\n";
const SCENE: &str = "scene.toml";

/// The folder of a sheet.
pub(crate) struct Project {
    pub folder: PathBuf,
}

impl Project {
    /// Opens a scene or a run; a copy, in a new folder below `projects`, unless the studio wrote the scene.
    pub fn open(path: &Path, projects: &Path) -> Result<(Self, Scene)> {
        let file = match path.join(SCENE) {
            own if is_own(&own) => own,
            _ => scene_file(path)?,
        };
        let original = Scene::read(&file)?;
        if is_own(&file) {
            let folder = file.parent().unwrap_or(Path::new("")).to_owned();
            return Ok((Self { folder }, original));
        }
        let shown = if path.is_dir() {
            let best = stored_design(&path.join(STATE_FILE), &original)?;
            original.changed(original.starting_at(&best))?
        } else {
            original
        };
        let named = if path.is_dir() {
            path
        } else {
            &path.with_extension("")
        };
        let name = named.file_name().unwrap_or_default().to_string_lossy();
        let project = Self::create(projects, &name)?;
        let scene = project.write(shown.located()?)?;
        Ok((project, scene))
    }

    /// A new sheet, in a new folder below `projects`.
    pub fn begin(sheet: &NewSheet, projects: &Path) -> Result<(Self, Scene)> {
        let folder = free_folder(projects, &sheet.name)?;
        let (material, size) = (sheet.material.clone(), sheet.size);
        InitCommand::new_sheet(folder.clone(), material, sheet.thickness, size).create()?;
        let project = Self { folder };
        let mut config = Scene::read(&project.scene_file())?.config;
        config.title.clone_from(&sheet.name);
        let scene = project.write(config)?;
        Ok((project, scene))
    }

    fn create(projects: &Path, name: &str) -> Result<Self> {
        let folder = free_folder(projects, name)?;
        output_file::create_folder(&folder)?;
        Ok(Self { folder })
    }

    /// The scene of the project.
    pub fn scene_file(&self) -> PathBuf {
        self.folder.join(SCENE)
    }

    /// Checks and writes the first scene.
    fn write(&self, mut config: SceneConfig) -> Result<Scene> {
        config.output = self.next_run();
        let scene = Scene::new(config, &self.scene_file())?;
        self.save(&scene)?;
        Ok(scene)
    }

    /// Writes the scene.
    pub fn save(&self, scene: &Scene) -> Result<()> {
        let text = scene
            .config
            .to_toml()
            .context("cannot write the scene as TOML")?;
        output_file::write(&self.scene_file(), &(HEAD.to_owned() + &text))
    }

    /// Stores a drawing; returns the name of its file.
    pub fn keep_drawing(&self, svg: &str) -> Result<PathBuf> {
        let hash = blake3::hash(svg.as_bytes()).to_hex();
        let name = PathBuf::from(format!("target-{}.svg", &hash[..12]));
        output_file::write(&self.folder.join(&name), svg)?;
        Ok(name)
    }

    /// The name of the next run folder.
    pub fn next_run(&self) -> PathBuf {
        let names = (1..).map(|i| PathBuf::from(format!("design-{i}")));
        let mut free = names.filter(|name| !self.folder.join(name).exists());
        free.next().expect("there are more numbers than folders")
    }
}

/// Whether the studio wrote a scene.
fn is_own(file: &Path) -> bool {
    regular_file::read_to_string(file).is_ok_and(|text| text.starts_with(HEAD))
}

/// A folder for a sheet of this name that does not exist.
fn free_folder(projects: &Path, name: &str) -> Result<PathBuf> {
    let words = name.to_lowercase();
    let words = words
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty());
    let slug: String = words
        .collect::<Vec<_>>()
        .join("-")
        .chars()
        .take(60)
        .collect();
    ensure!(
        !slug.is_empty(),
        "the name `{name}` has no letter and no digit: name the sheet"
    );
    let numbered = (2..).map(|i| projects.join(format!("{slug}-{i}")));
    let mut free = std::iter::once(projects.join(&slug))
        .chain(numbered)
        .filter(|folder| !folder.exists());
    Ok(free.next().expect("there are more numbers than folders"))
}
