//! The folder of a sheet in the studio: its scene, its drawings and its runs.
//!
//! | file | contents |
//! |---|---|
//! | `scene.toml` | the scene that is shown, for `kirigami design` |
//! | `NAME-HASH.svg`, `.dxf` | drawings that were dropped onto the page, with the names of their files; pictures traced |
//! | `design-N/` | the run folders of the searches, from 1; the first one of an opened run is its copy |

use crate::request::{Drawing, NewSheet};
use anyhow::{Context, Result, ensure};
use app::{new_project::NewProject, output_file, own_drawing::OwnDrawing};
use base64::{Engine, engine::general_purpose::STANDARD};
use design::optimise::outer_loop::Ended;
use output::run_files::RUN_FILES;
use scene::{
    Scene, SceneConfig,
    design_run::{left_run, stored_design},
    run_inputs::{INPUTS, SCENE_FILE, STATE_FILE, scene_file},
};
use std::path::{Path, PathBuf};
use support::{Joined, at, regular_file, text_file, unread};

/// The first line of a scene that the studio writes. It changes no other scene.
const HEAD: &str =
    "# Written by `kirigami studio`, which replaces it when the sheet is changed there.\n";

/// The folder of a sheet.
pub struct Project {
    /// Its path.
    pub folder: PathBuf,
}

impl Project {
    /// Opens a scene or a run; a copy, in a new folder below `projects`, unless the studio wrote
    /// the scene.
    pub fn open(path: &Path, projects: &Path) -> Result<(Self, Scene)> {
        let file = match path.join(SCENE_FILE) {
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
        let named = if path.is_dir() { path } else { &path.with_extension("") };
        let name = named.file_name().unwrap_or_default().to_string_lossy();
        let project = Self::named(&name, projects)?;
        output_file::create_folder(&project.folder)?;
        if path.is_dir() {
            copy_run(path, &project.folder.join(project.next_run()))?;
        }
        let scene = project.write(shown.moved_to(&project.folder)?)?;
        Ok((project, scene))
    }

    /// The folder of a new sheet below `projects`, which does not exist yet.
    pub fn named(name: &str, projects: &Path) -> Result<Self> {
        let folder = free_folder(projects, name)?;
        Ok(Self { folder })
    }

    /// Removes the folder of a sheet that was refused.
    pub fn remove(&self) {
        // The error that is reported is the refusal.
        let _ = std::fs::remove_dir_all(&self.folder);
    }

    /// Writes a new sheet.
    pub fn begin(&self, sheet: &NewSheet) -> Result<Scene> {
        NewProject {
            folder: self.folder.clone(),
            material: sheet.material.clone(),
            thickness: sheet.thickness,
            size: sheet.size.filter(|_| sheet.stock.is_none()),
            stock: sheet.stock,
            margin: sheet.margin,
            service: sheet.service.clone(),
            any_width: sheet.drawing.is_some(),
            ..NewProject::default()
        }
        .create()?;
        let first = Scene::read(&self.scene_file())?;
        let mut config = first.config;
        config.title.clone_from(&sheet.name);
        if let Some(kerf) = sheet.kerf {
            let slit = &mut config.process.slit_width;
            *slit = if sheet.service.is_some() { slit.max(kerf) } else { kerf };
            // A service that wants wider slits allows for the kerf itself.
            config.cutting.kerf = Some(kerf).filter(|_| *slit <= kerf);
        }
        self.write(config)
    }

    /// The scene of the project.
    pub fn scene_file(&self) -> PathBuf {
        self.folder.join(SCENE_FILE)
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
        let text = scene.config.to_toml().context("cannot write the scene as TOML")?;
        output_file::write(&self.scene_file(), &(HEAD.to_owned() + &text))
    }

    /// Stores a drawing; also returns how a scene names it.
    pub fn keep_drawing(&self, drawing: &Drawing) -> Result<(OwnDrawing, PathBuf)> {
        let Drawing { name, file, piece, threshold, .. } = drawing;
        let contents = STANDARD.decode(file).map_err(at("the drawing is not sent in base64"))?;
        let own = OwnDrawing::new(name.into(), *piece, contents, *threshold)?;
        let mark = format!("-{}", &own.hash()[..6]);
        own.write(&self.folder, &mark)?;
        let name = own.name(&mark);
        Ok((own, name))
    }

    /// The name of the next run folder.
    pub fn next_run(&self) -> PathBuf {
        let mut free = run_names().skip_while(|name| self.folder.join(name).exists());
        free.next().expect("there are more numbers than folders")
    }

    /// The last run, with how it ended, if the sheet is its best design.
    pub fn run_of(&self, sheet: &Scene) -> Option<(Scene, Ended)> {
        let names = run_names().take_while(|name| self.folder.join(name).exists());
        let output = names.last()?;
        let run = Scene::read(&self.folder.join(&output).join(SCENE_FILE)).ok()?.config;
        let config = SceneConfig {
            start: run.start,
            optimiser: run.optimiser,
            pin: run.pin,
            output: output.clone(),
            ..sheet.config.clone()
        };
        let run = sheet.changed(config).ok()?;
        // A run that cannot be read, or has other keys, does not belong to the sheet.
        let (ended, search) = left_run(&run).ok()??;
        let of_sheet = SceneConfig { output, ..sheet.config.clone() };
        (run.starting_at(&search.best) == of_sheet).then_some((run, ended))
    }
}

/// The names of run folders.
fn run_names() -> impl Iterator<Item = PathBuf> {
    (1..).map(|i| PathBuf::from(format!("design-{i}")))
}

/// Copies a run: its state, its inputs and its results.
fn copy_run(from: &Path, to: &Path) -> Result<()> {
    let inputs = std::fs::read_dir(from.join(INPUTS))?;
    let inputs = inputs.map(|entry| Ok(Path::new(INPUTS).join(entry?.file_name())));
    let mut names = inputs.collect::<std::io::Result<Vec<_>>>()?;
    names.push(SCENE_FILE.into());
    names.extend(RUN_FILES.iter().map(|file| PathBuf::from(file.name)));
    for name in names.iter().filter(|name| from.join(name).is_file()) {
        let (from, to) = (from.join(name), to.join(name));
        let contents = regular_file::read(&from).map_err(unread(&from))?;
        output_file::create_folder_of(&to)?;
        output_file::write(&to, contents)?;
    }
    Ok(())
}

/// Whether the studio wrote a scene.
fn is_own(file: &Path) -> bool {
    text_file::read(file).is_ok_and(|text| text.starts_with(HEAD))
}

/// A folder for a sheet of this name that does not exist.
fn free_folder(projects: &Path, name: &str) -> Result<PathBuf> {
    let slug = slug(name);
    ensure!(!slug.is_empty(), "the name `{name}` has no letter and no digit: name the sheet");
    let numbered = (2..).map(|i| projects.join(format!("{slug}-{i}")));
    let mut free =
        std::iter::once(projects.join(&slug)).chain(numbered).filter(|folder| !folder.exists());
    Ok(free.next().expect("there are more numbers than folders"))
}

/// The letters and digits of a name, as a part of the name of a file.
fn slug(name: &str) -> String {
    let words = name.to_lowercase();
    let words = words.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let words = words.joined("-");
    words.chars().take(60).collect()
}
