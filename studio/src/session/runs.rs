//! The runs of a session: searches, cut files and the list of files.

use super::Session;
use crate::{
    draft::Steps,
    event::{Event, Kind, locked},
    full_analysis::{run_name, shown},
    opened::OpenedRun,
    request::Files,
    run_listing::files_of_run,
};
use analysis::refinement::inverse_design;
use anyhow::{Context, Result, ensure};
use app::{
    cut::{machine_file_of_run, tiles_of_run},
    design::write_run,
    failure::message,
    run_folder,
};
use design::optimise::outer_loop::Ended;
use scene::{Scene, SceneConfig};
use serde_json::json;
use std::sync::atomic::AtomicBool;

impl Session {
    pub(super) fn design(&mut self) -> Result<()> {
        self.commit()?;
        let sheet = self.opened()?;
        let scene = match sheet.run() {
            Some(run) if run.ended == Ended::Stopped => run.scene.clone(),
            _ => sheet.scene_of_run()?,
        };
        self.stop_analysis();
        self.tell(Kind::Working, &"design");
        let (run, stop) = (run_name(&scene), self.stop_search.clone());
        let end = self.search(scene, &stop)?;
        self.say(&format!("{run}: {end}"));
        Ok(())
    }

    /// Runs the search of a scene, and shows its best design; how it ended, in words.
    fn search(&mut self, scene: Scene, stop: &AtomicBool) -> Result<String> {
        let _held = run_folder::hold(&scene.output())?;
        let problem = scene.problem()?;
        let mut steps = Steps::default();
        let listener = &self.listener;
        let designed = inverse_design(&scene, stop, &mut |_, search| {
            if let Some(step) = steps.step(&scene, &problem, search) {
                listener(Event::new(Kind::Step, &step));
            }
        })?;
        self.tell(Kind::Working, &"files");
        let report = write_run(&scene, &designed, false)?;
        (self.listener)(shown(&scene, &designed, &report, true, None));
        let adopted = SceneConfig {
            output: self.opened()?.project.next_run(),
            ..scene.starting_at(&designed.search.best)
        };
        let shown = self.opened()?.scene.changed(adopted.clone())?;
        let sheet = self.show(shown)?;
        sheet.known = Some(designed.best.deployment.warm_start());
        // A run that went on is no longer what it was at its pause.
        let folder = scene.output();
        sheet.runs.retain(|run| run.scene.output() != folder);
        sheet.runs.push(OpenedRun::new(scene, adopted, designed.ended));
        self.commit()?;
        self.at_rest = true;
        self.list_files()?;
        self.tell(Kind::Working, &());
        Ok(report.end_of_search())
    }

    /// Writes cut files, from the run of the sheet that is shown: one without a step if there is
    /// none. Says what was written.
    pub(super) fn write(&mut self, files: &Files) -> Result<()> {
        self.commit()?;
        self.tell(Kind::Working, &"files");
        let mut said = Vec::new();
        if self.opened()?.run().is_none() {
            self.stop_analysis();
            let scene = self.opened()?.scene_of_run()?;
            said.push(format!("the run {}", run_name(&scene)));
            self.search(scene, &AtomicBool::new(true))?;
            self.tell(Kind::Working, &"files");
        }
        let sheet = self.opened_mut()?;
        let run = sheet.run_mut().context("the sheet has no run")?;
        let folder = run.scene.output();
        let mut refused = Vec::new();
        if let Some(paper) = &files.paper {
            match tiles_of_run(&folder, paper) {
                Ok(written) => said.push(written.to_string()),
                Err(error) => refused.push(format!("tiles: {}", message(&error))),
            }
        }
        if let Some(machine) = &files.machine {
            match machine_file_of_run(&folder, machine) {
                Ok((written, verdicts)) => {
                    said.push(written.to_string());
                    run.verdicts.insert(machine.clone(), verdicts);
                }
                Err(error) => refused.push(format!("{machine}: {}", message(&error))),
            }
        }
        self.list_files()?;
        self.tell(Kind::Working, &());
        let written = match said.is_empty() {
            true => "nothing was written".to_owned(),
            false => format!("written: {}", said.join("; ")),
        };
        ensure!(refused.is_empty(), "not written: {}; {written}", refused.join("; "));
        match said.is_empty() {
            true => self.say(&format!(
                "{written}: the files of {} are here; choose tiles or a machine for others",
                folder.display()
            )),
            false => self.say(&written),
        }
        Ok(())
    }

    /// Lists the files of the run that is shown for the pages; while no run is shown, the files of
    /// the last run stay.
    pub(super) fn list_files(&self) -> Result<()> {
        let Some(run) = self.opened()?.run() else {
            return Ok(());
        };
        let folder = run.scene.output();
        let listed = files_of_run(&folder)?;
        self.tell(Kind::Files, &json!({ "files": listed, "verdicts": run.verdicts }));
        let names = listed.into_iter().map(|file| file.name);
        let fetched = names.map(|name| (name.clone(), folder.join(name)));
        *locked(&self.files) = fetched.collect();
        Ok(())
    }
}
