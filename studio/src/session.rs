//! The scene that is shown, and the answers to requests.

mod runs;

use crate::{
    catalogue::is_example,
    draft::{draft, draft_data},
    event::{Event, Kind},
    full_analysis::{FullAnalysis, Listener, Resting, refusal},
    opened::{Opened, OpenedRun, fitted_to, told},
    panels::with_panels,
    project::Project,
    request::{Change, Drawing, NewSheet, Request},
};
use analysis::fit::scene::toggled;
use analysis::levels::levels;
use anyhow::{Context, Result, bail, ensure};
use app::{failure::message, shell_word::shell_word};
use scene::{Scene, SceneConfig};
use serde::Serialize;
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};
use support::caught_panic;

/// The files that can be fetched, by the names that pages know.
pub(crate) type Fetched = Arc<Mutex<BTreeMap<String, PathBuf>>>;

/// What comes next.
pub(crate) enum Next {
    Request(Request),
    /// No request came for a moment.
    Rest,
    Closed,
}

pub(crate) struct Session {
    projects: PathBuf,
    analysis: Arc<FullAnalysis>,
    stop_search: Arc<AtomicBool>,
    listener: Listener,
    files: Fetched,
    sheet: Option<Opened>,
    at_rest: bool,
}

impl Session {
    pub(crate) fn new(
        projects: PathBuf,
        analysis: Arc<FullAnalysis>,
        stop_search: Arc<AtomicBool>,
        files: Fetched,
        listener: Listener,
    ) -> Self {
        Self { projects, analysis, stop_search, listener, files, sheet: None, at_rest: true }
    }

    pub(crate) fn is_at_rest(&self) -> bool {
        self.at_rest
    }

    /// Shows another sheet.
    pub(crate) fn open(&mut self, project: Project, scene: Scene) {
        self.analysis.stop();
        let run = project.run_of(&scene);
        let run = run.map(|(of, ended)| OpenedRun::new(of, scene.config.clone(), ended));
        let file = project.scene_file();
        let command = format!("kirigami design {}", shell_word(&file));
        self.tell(Kind::Sheet, &json!({ "file": file, "command": command }));
        self.sheet = Some(Opened {
            on_disk: scene.config.clone(),
            before: Vec::new(),
            after: Vec::new(),
            by: None,
            space: None,
            known: None,
            runs: run.into_iter().collect(),
            project,
            scene,
        });
        self.at_rest = false;
        self.tell_scene();
    }

    /// Does what comes next, and says why it cannot.
    pub(crate) fn go(&mut self, next: Next) {
        let done = caught_panic::catch(|| match next {
            Next::Request(request) => self.answer(request),
            Next::Rest => self.rest(),
            Next::Closed => self.commit(),
        });
        match done {
            Ok(Ok(())) => {}
            Ok(Err(error)) => self.give_up(&message(&error)),
            Err(panic) => self.give_up(&format!(
                "the studio failed: {panic}; the scene of the last rest is on disk"
            )),
        }
    }

    fn answer(&mut self, request: Request) -> Result<()> {
        match request {
            Request::New(sheet) => self.begin(&sheet)?,
            Request::Open { scene } => {
                ensure!(is_example(&scene), "{} is no example", scene.display());
                let (project, scene) = Project::open(&scene, &self.projects)?;
                self.open(project, scene);
            }
            Request::Change(Change { scene, by }) => {
                let changed = self.opened()?.scene.changed(*scene)?;
                self.draft(changed, Some(by))?;
            }
            Request::Panels { panels } => {
                self.tell(Kind::Working, &"panels");
                let changed = with_panels(&self.opened()?.scene, panels)?;
                self.draft(changed, None)?;
            }
            Request::Drawing(drawing) => self.drawing(&drawing)?,
            Request::Crop { panel_side } => {
                self.tell(Kind::Crop, &self.opened()?.cropped(panel_side)?);
            }
            Request::Cell { at } => {
                self.tell(Kind::Working, &"fit");
                let scene = &self.opened()?.scene;
                let (scene, says) = told(scene, toggled(scene, at)?)?;
                self.draft(scene, None)?;
                self.tell(Kind::Fit, &says);
            }
            Request::Level { level } => {
                let other = self.opened()?.scene.at_level(level)?;
                self.draft(other, None)?;
            }
            Request::Levels => self.levels()?,
            Request::Design => self.design()?,
            // The engine pauses a search at once.
            Request::Pause => {}
            Request::Undo => self.step_back(|sheet| (&mut sheet.before, &mut sheet.after))?,
            Request::Redo => self.step_back(|sheet| (&mut sheet.after, &mut sheet.before))?,
            Request::Write(files) => self.write(&files)?,
        }
        Ok(())
    }

    /// Begins a new sheet; the one that is shown stays if it is refused.
    fn begin(&mut self, sheet: &NewSheet) -> Result<()> {
        let project = Project::named(&sheet.name, &self.projects)?;
        let begun = self.new_sheet(&project, sheet);
        if begun.is_err() {
            project.remove();
        }
        let (space, scene, fit) = begun?;
        self.open(project, scene);
        self.opened_mut()?.space = Some(space);
        if let Some(fit) = fit {
            self.tell(Kind::Fit, &fit);
        }
        Ok(())
    }

    /// The space of a new sheet, the sheet, and what is said of its fit if it is for a drawing.
    fn new_sheet(
        &self,
        project: &Project,
        sheet: &NewSheet,
    ) -> Result<(SceneConfig, Scene, Option<Value>)> {
        let scene = project.begin(sheet)?;
        let space = scene.config.clone();
        let Some(drawing) = &sheet.drawing else {
            return Ok((space, scene, None));
        };
        let (scene, says) = self.fitted(project, &scene, None, drawing)?;
        Ok((space, scene, Some(says)))
    }

    /// Writes the scene, and lets the full analysis be computed.
    fn rest(&mut self) -> Result<()> {
        self.at_rest = true;
        if self.sheet.is_none() {
            return Ok(());
        }
        self.commit()?;
        self.list_files()?;
        self.tell(Kind::Working, &"everyday");
        let sheet = self.opened()?;
        let run = sheet.run();
        let scene = run.map_or(&sheet.scene, |run| &run.scene).clone();
        self.analysis.compute(Resting { scene, is_run: run.is_some() });
        Ok(())
    }

    /// Says why a request was not answered. The last result stays.
    fn give_up(&mut self, why: &str) {
        // The page shows one scene.
        let file = self.sheet.as_ref().map(|sheet| sheet.project.scene_file());
        let named = file.map(|file| format!("{}: ", file.display()));
        let why = named.and_then(|named| why.strip_prefix(&named)).unwrap_or(why);
        (self.listener)(refusal(why));
        self.tell(Kind::Working, &());
    }

    fn drawing(&mut self, drawing: &Drawing) -> Result<()> {
        let Opened { project, scene, space, .. } = self.opened()?;
        let uncut = scene.config.cells.is_none().then(|| scene.config.clone());
        let space = uncut.or_else(|| space.clone());
        let (scene, says) = self.fitted(project, scene, space.as_ref(), drawing)?;
        self.draft(scene, None)?;
        self.opened_mut()?.space = space;
        self.tell(Kind::Fit, &says);
        Ok(())
    }

    /// A sheet that is fitted to a drawing, and what is said of it.
    fn fitted(
        &self,
        project: &Project,
        scene: &Scene,
        space: Option<&SceneConfig>,
        drawing: &Drawing,
    ) -> Result<(Scene, Value)> {
        self.tell(Kind::Working, &"fit");
        let (own, name) = project.keep_drawing(drawing)?;
        let pieces = own.pieces()?;
        if drawing.piece.is_none() && pieces.len() > 1 {
            self.tell(Kind::Pieces, &pieces);
            bail!(
                "{} has {} pieces: click the one that is to be a sheet",
                drawing.name,
                pieces.len()
            );
        }
        fitted_to(scene, space, &own, name, drawing.panel_side)
    }

    /// Measures the levels of the sheet that is shown.
    fn levels(&mut self) -> Result<()> {
        self.stop_analysis();
        self.tell(Kind::Working, &"levels");
        let scene = &self.opened()?.scene;
        let stop = &*self.stop_search;
        stop.store(false, Ordering::Relaxed);
        let found = levels(scene, &scene.start(), stop, &mut |_| ())?;
        self.tell(Kind::Levels, &found.levels);
        Ok(())
    }

    /// Shows another scene at full load, and its keys unless a page has changed them. A scene
    /// without an equilibrium is refused: the last one stays, here and on disk.
    fn draft(&mut self, scene: Scene, by: Option<(String, u64)>) -> Result<()> {
        self.say("");
        let begin = Instant::now();
        let path = self.analysis.last_path();
        let sheet = self.opened_mut()?;
        sheet.known = path.or(sheet.known.take());
        let problem = scene.problem()?;
        let deployment = draft(&problem, &scene.start(), sheet.known_near(&scene))?;
        let sheet = self.show(scene)?;
        sheet.known = Some(deployment.warm_start());
        sheet.by = by;
        if self.opened()?.by.is_none() {
            self.tell_scene();
        }
        let draft = draft_data(&self.opened()?.scene, &problem, &deployment, begin);
        self.tell(Kind::Draft, &draft);
        Ok(())
    }

    /// Writes the scene that is shown, and keeps that before it for an undo.
    fn commit(&mut self) -> Result<()> {
        let Some(sheet) = &mut self.sheet else {
            return Ok(());
        };
        if sheet.scene.config != sheet.on_disk {
            let before = std::mem::replace(&mut sheet.on_disk, sheet.scene.config.clone());
            sheet.before.push(before);
            sheet.after.clear();
        }
        sheet.project.save(&sheet.scene)?;
        self.tell_scene();
        Ok(())
    }

    /// Shows the last scene of one list and puts that on disk into the other.
    fn step_back(
        &mut self,
        lists: impl Fn(&mut Opened) -> (&mut Vec<SceneConfig>, &mut Vec<SceneConfig>),
    ) -> Result<()> {
        self.commit()?;
        let sheet = self.opened_mut()?;
        let Some(config) = lists(sheet).0.last().cloned() else {
            return Ok(());
        };
        let scene = sheet.scene.changed(config.clone())?;
        self.draft(scene, None)?;
        let sheet = self.opened_mut()?;
        lists(sheet).0.pop();
        let left = std::mem::replace(&mut sheet.on_disk, config);
        lists(sheet).1.push(left);
        sheet.project.save(&sheet.scene)?;
        self.tell_scene();
        Ok(())
    }

    fn opened(&self) -> Result<&Opened> {
        self.sheet.as_ref().context(NO_SHEET)
    }

    fn opened_mut(&mut self) -> Result<&mut Opened> {
        self.sheet.as_mut().context(NO_SHEET)
    }

    /// Shows a scene.
    fn show(&mut self, scene: Scene) -> Result<&mut Opened> {
        self.stop_analysis();
        let sheet = self.opened_mut()?;
        sheet.scene = scene;
        sheet.by = None;
        Ok(sheet)
    }

    /// Ends the full analysis, which a rest computes again.
    fn stop_analysis(&mut self) {
        self.at_rest = false;
        let path = self.analysis.stop();
        if let (Some(sheet), Some(path)) = (&mut self.sheet, path) {
            sheet.known = Some(path);
        }
    }

    fn tell(&self, kind: Kind, data: &impl Serialize) {
        (self.listener)(Event::new(kind, data));
    }

    fn say(&self, message: &str) {
        let says = json!({ "refused": false, "message": message });
        self.tell(Kind::Says, &says);
    }

    fn tell_scene(&self) {
        if let Some(sheet) = &self.sheet {
            self.tell(
                Kind::Scene,
                &json!({
                    "scene": sheet.scene.config,
                    "by": sheet.by,
                    "run": sheet.run().is_some(),
                    "undo": sheet.before.len(),
                    "redo": sheet.after.len(),
                }),
            );
        }
    }
}

const NO_SHEET: &str = "there is no sheet yet: begin one";
