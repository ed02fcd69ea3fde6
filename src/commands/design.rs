//! `kirigami design`: cut pattern and ligament widths for scenes, and the cut files.

use crate::ui::{
    self, interrupt, processors,
    with_unit::{self, CornerTolerance},
};
use analysis::refinement::{inverse_design, refine, search};
use anyhow::{Result, ensure};
use app::{
    design::{ended, hold, with_level_bars, write_run},
    design_runs::{DesignRun, design_all, refuse_shared_folders},
    output_file,
};
use clap::Args;
use output::report::Report;
use scene::{
    Level, Scene, SceneConfig,
    design_run::{Designed, OnStep},
    run_inputs::{SCENE_FILE, scene_file},
};
use std::path::{Path, PathBuf};

/// Design a sheet: cut pattern and ligament widths for a target shape
///
/// Reads a scene and writes cut files (DXF and SVG, 1:1 in mm), pictures, a report and a page that
/// shows the run in a browser (run.html) to the scene's output folder. A stopped run continues when
/// it is started again. Several scenes or seeds are designed side by side on all processors, each
/// in a folder of its own, and compared in a table. Examples: kirigami design
/// configs/scenes/linear-7x7.toml; kirigami design configs/scenes/*7x7.toml --out runs/sheets
#[derive(Args)]
pub struct DesignCommand {
    /// Scene (TOML); see configs/scenes. Or the folder of a run, which holds its scene, material
    /// and weights
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Weights of the hinge energy, instead of the scene's
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Search at this level alone, instead of the scene's: how much of the hinges is modelled; see
    /// `kirigami levels`. Without it a search at `standard` or `fine` begins at `draft`. At `final`
    /// the hinges are solved by finite elements after the search, and it goes on with them: hours,
    /// which are stated first
    #[arg(long, value_name = "LEVEL", value_parser = with_unit::level_up_to(Level::Final))]
    level: Option<Level>,
    /// How accurately the corners of the panels are to be known: a length such as 0.5mm, or a part
    /// of the longer side of the sheet such as 0.2%. The search begins at `draft`. While the
    /// difference to the next finer level is larger, that level, `standard` and then `fine`,
    /// continues from the design. The next finer level evaluates the result
    #[arg(long, value_name = "ACCURACY", value_parser = with_unit::accuracy, conflicts_with_all = ["level", "steps"])]
    within: Option<CornerTolerance>,
    /// Run folder, instead of the scene's. Of several runs: the folder of the table, designs.md and
    /// designs.csv, and of the runs, each in a folder with the name of its scene [default of the
    /// table: runs/designs]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Design every scene with this many successive seeds, beginning with its own, each in the
    /// folder seed-N of its run folder. The scene needs a random start: optimiser.start_noise
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    seeds: u64,
    /// Number of search steps, instead of the scene's; of several levels, of each at most
    #[arg(long, value_name = "N")]
    steps: Option<usize>,
    /// Begin at the start design even if the run folder contains a run of this scene
    #[arg(long)]
    restart: bool,
    /// Write the cut files even if the report has errors
    #[arg(long)]
    force: bool,
    /// Print the report as JSON; of a single run
    #[arg(long)]
    json: bool,
}

impl DesignCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let out = self.out.as_deref().map(std::path::absolute).transpose()?;
        match &self.scenes[..] {
            [file] if self.seeds == 1 => {
                let scene = self.scene(file, |config| {
                    config.output = out.unwrap_or_else(|| config.output.clone());
                })?;
                let report = with_level_bars(&scene, |progress| self.design(&scene, progress))?;
                let folder = scene.output().canonicalize()?;
                let text = format!("{}\nwritten to {}", report.document(), folder.display());
                ui::print(self.json, &report, text)?;
                ended(&scene, &report)
            }
            _ => {
                ensure!(!self.json, "--json prints the report of one run: name one scene");
                self.run_many(self.runs(out.as_deref())?)
            }
        }
    }

    /// All runs; with `out` in folders there.
    fn runs(&self, out: Option<&Path>) -> Result<Vec<DesignRun>> {
        let mut runs = Vec::new();
        for file in &self.scenes {
            for seed in 0..self.seeds {
                let scene = self.scene(file, |config| {
                    if let Some(out) = out {
                        // The scenes of `init` have the names of their folders.
                        let named = file.parent().filter(|_| file.ends_with(SCENE_FILE));
                        let named = named.map_or(file.file_stem(), Path::file_name);
                        let name = if file.is_dir() { file.file_name() } else { named };
                        config.output = out.join(name.unwrap_or_default());
                    }
                    config.optimiser.seed += seed;
                    if self.seeds > 1 {
                        let name = format!("seed-{}", config.optimiser.seed);
                        config.output = config.output.join(name);
                    }
                })?;
                ensure!(
                    self.seeds == 1 || scene.config.optimiser.start_noise > 0.0,
                    "{}: all seeds give the same run without a random start: set optimiser.start_noise",
                    file.display()
                );
                let (file, failure) = (file.clone(), None);
                runs.push(DesignRun { file, scene, failure });
            }
        }
        refuse_shared_folders(&runs)?;
        Ok(runs)
    }

    /// Designs the runs, as many at a time as there are processors, and compares them.
    fn run_many(&self, runs: Vec<DesignRun>) -> Result<()> {
        let stop = interrupt::stop_flag()?;
        let folder = self.out.clone().unwrap_or("runs/designs".into());
        output_file::create_folder(&folder)?;
        // The windows of a single sheet occupy all processors.
        let workers = match self.level {
            Some(Level::Final) => 1,
            _ => processors(),
        };
        design_all(runs, workers, &folder, stop, &|scene| self.design(scene, &mut |_, _| {}))
    }

    /// One run: its search and its results.
    fn design(&self, scene: &Scene, progress: OnStep) -> Result<Report> {
        let _held = hold(scene, self.restart)?;
        let stop = interrupt::stop_flag()?;
        let own = scene.config.level;
        let designed = match (self.within, self.level) {
            (None, Some(_)) if self.by_elements(own) => self.search_by_elements(scene, progress)?,
            (None, Some(_)) => search(scene, &[own], None, stop, progress)?,
            (None, None) => inverse_design(scene, stop, progress)?,
            (Some(accuracy), _) => {
                let tolerance = match accuracy {
                    CornerTolerance::Length(mm) => mm,
                    CornerTolerance::Part(part) => part * scene.config.sheet.outline().size(),
                };
                refine(scene, tolerance, stop, progress)?
            }
        };
        write_run(scene, &designed, self.force)
    }

    /// Whether the hinges of a scene at a level are still to be solved.
    fn by_elements(&self, of_scene: Level) -> bool {
        self.level == Some(Level::Final) && of_scene != Level::Final
    }

    #[cfg(feature = "pipeline")]
    fn search_by_elements(&self, scene: &Scene, progress: OnStep) -> Result<Designed> {
        let solves = crate::commands::pipeline::solve_args::SolveArgs::default().solves()?;
        app::final_search::search_by_elements(scene, solves, progress)
    }

    #[cfg(not(feature = "pipeline"))]
    fn search_by_elements(&self, _: &Scene, _: OnStep) -> Result<Designed> {
        anyhow::bail!(
            "the level `final` needs finite elements: install the whole program, as the README says"
        )
    }

    /// A scene with the changes of the command line and the changes of `change`.
    fn scene(&self, file: &Path, change: impl FnOnce(&mut SceneConfig)) -> Result<Scene> {
        let path = scene_file(file)?;
        let mut config: SceneConfig = support::toml_file::read(&path)?;
        if let Some(weights) = &self.weights {
            config.name_weights(weights)?;
        }
        change(&mut config);
        if let Some(steps) = self.steps {
            config.optimiser.steps = steps;
        }
        let mut scene = Scene::new(config, &path)?;
        if let Some(level) = self.level.filter(|_| !self.by_elements(scene.config.level)) {
            scene = scene.at_level(level)?;
        }
        Ok(scene)
    }
}
