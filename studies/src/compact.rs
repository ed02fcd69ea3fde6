//! `kirigami-studies compact`: a square of 11 x 11 panels that is closed again after 180 degrees, designed for published
//! outlines of such sheets.

use crate::cpu_seconds::cpu_seconds;
use crate::drawing::{Column, side_by_side};
use crate::tessellation::Tessellation;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use design::geometry::plane::{complex, point, turn};
use design::geometry::polygon::mean;
use design::geometry::symmetric_difference::intersection_over_union;
use design::objective::design_problem::Deployment;
use design::objective::target::TargetShape;
use design::optimise::outer_loop::{Ended, SearchState, optimise};
use design::scene::placement::deployed_outline;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::exit::Unfinished;
use kirigami::ui::progress::Progress;
use kirigami::ui::{interrupt, picture, run_folder};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::PathBuf;
use support::table::{Cell, Table};

/// Design one sheet for many target outlines, and measure the intersection over union
///
/// Every outline replaces the scene's target; its unit is the side of a square panel of the mean area. The search is
/// repeated from random starts, without a minimum panel width and with the scene's; the best of the starts counts.
/// Writes compact.csv, compact.md and a picture; designs in compact.csv are not made again. Example: kirigami-studies
/// compact configs/targets/compact.json
#[derive(Args)]
pub struct CompactStudy {
    /// Outlines (JSON): `targets`, the vertices by name
    #[arg(value_name = "TARGETS")]
    targets: PathBuf,
    /// Scene (TOML) of the sheet
    #[arg(
        long,
        value_name = "SCENE",
        default_value = "configs/scenes/compact-11x11.toml"
    )]
    scene: PathBuf,
    /// Number of starts; their seeds are consecutive, beginning with the scene's
    #[arg(long, value_name = "N", default_value_t = 2)]
    starts: u64,
    /// Rotate all outlines counter-clockwise (deg)
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    turned_deg: f64,
    /// Design only the first of every N outlines
    #[arg(long, value_name = "N", default_value_t = 1)]
    every: usize,
    /// Folder for the tables and the picture
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-compact")]
    out: PathBuf,
}

#[derive(Deserialize)]
struct Outlines {
    targets: BTreeMap<String, Vec<[f64; 2]>>,
}

/// What is designed for: a target and a minimum panel width.
struct Task<'a> {
    name: &'a str,
    outline: &'a [[f64; 2]],
    /// mm
    width: f64,
}

/// A finished task, as stored in compact.csv.
#[derive(Clone, Serialize, Deserialize)]
struct Fitted {
    target: String,
    min_panel_width: f64,
    /// Hash of the scene of the first start.
    scene: String,
    starts: u64,
    /// Seed of the best start.
    seed: u64,
    /// Intersection over union of the best start, and of the first.
    shared: f64,
    first: f64,
    /// mm
    thinnest: f64,
    /// Area where deployed panels overlap, over that of the sheet.
    overlap: f64,
    /// CPU time of all starts.
    cpu_seconds: f64,
}

/// All designs with one minimum panel width, the worst match first.
struct Set<'a>(Vec<(&'a Task<'a>, &'a Fitted)>);

const ROWS: &str = "compact.csv";

impl CompactStudy {
    pub fn run(&self) -> Result<()> {
        ensure!(self.starts > 0, "--starts must be at least 1");
        ensure!(self.every > 0, "--every must be at least 1");
        let turned = self.turned_deg;
        ensure!(turned.is_finite(), "--turned-deg must be a finite number");
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        let width = config.objective.min_panel_width;
        let scene = self.scene.display();
        ensure!(width > 0.0, "{scene}: set objective.min_panel_width");
        let outlines = self.outlines()?;
        let _held = run_folder::hold(&self.out)?;
        let chosen = outlines.iter().step_by(self.every);
        let tasks: Vec<Task> = chosen
            .flat_map(|(name, outline)| {
                [0.0, width].map(|width| Task {
                    name,
                    outline,
                    width,
                })
            })
            .collect();
        let fitted = self.fit_all(&config, &tasks)?;
        let sets = [0.0, width].map(|width| Set::new(&tasks, &fitted, width));
        let page = self.page(&sets);
        run_folder::write(&self.out, "compact.md", &page)?;
        self.draw(&config, &sets)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn outlines(&self) -> Result<BTreeMap<String, Vec<[f64; 2]>>> {
        let file = || self.targets.display().to_string();
        let text = support::regular_file::read_to_string(&self.targets).with_context(file)?;
        let Outlines { targets } = serde_json::from_str(&text).with_context(file)?;
        ensure!(!targets.is_empty(), "{}: no targets", file());
        Ok(targets)
    }

    /// Every task in its order; those in compact.csv are taken from there.
    fn fit_all(&self, config: &SceneConfig, tasks: &[Task]) -> Result<Vec<Fitted>> {
        let path = self.out.join(ROWS);
        let mut stored: Vec<Fitted> = Vec::new();
        if path.exists() {
            let rows =
                csv::Reader::from_path(&path).and_then(|rows| rows.into_deserialize().collect());
            stored = rows.with_context(|| path.display().to_string())?;
        }
        let bar = Progress::new(tasks.len(), "designs");
        let mut fitted = Vec::new();
        for task in tasks {
            let id = self.scene(config, task, config.optimiser.seed)?.hash();
            let known = |row: &&Fitted| row.scene == id && row.starts == self.starts;
            let row = match stored.iter().find(known) {
                Some(row) => row.clone(),
                None => {
                    let row = self.fit(config, task);
                    let row = row.with_context(|| format!("target {}", task.name))?;
                    stored.push(row.clone());
                    run_folder::write(&self.out, ROWS, &csv_of(&stored)?)?;
                    row
                }
            };
            let message = format!("{}: {:.4}", task.name, row.shared);
            fitted.push(row);
            bar.show(fitted.len(), None, &message);
        }
        bar.finish();
        run_folder::write(&self.out, ROWS, &csv_of(&fitted)?)?;
        Ok(fitted)
    }

    fn scene(&self, config: &SceneConfig, task: &Task, seed: u64) -> Result<Scene> {
        let mut config = config.clone();
        let vertices = self.placed(&config, task.outline);
        config.target = TargetShape::Polygon { vertices };
        config.objective.min_panel_width = task.width;
        config.optimiser.seed = seed;
        Ok(Scene::new(config, &self.scene)?)
    }

    /// An outline in mm, about the middle of the flat sheet.
    fn placed(&self, config: &SceneConfig, outline: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let middle = complex(mean(&config.sheet.outline().corners));
        let turned = config.sheet.mean_panel_area().sqrt() * turn(self.turned_deg.to_radians());
        let place = |vertex: &[f64; 2]| point(middle + turned * complex(*vertex));
        outline.iter().map(place).collect()
    }

    fn fit(&self, config: &SceneConfig, task: &Task) -> Result<Fitted> {
        let began = cpu_seconds()?;
        let target = self.placed(config, task.outline);
        let first = self.scene(config, task, config.optimiser.seed)?;
        let mut designs = Vec::new();
        for seed in (config.optimiser.seed..).take(self.starts as usize) {
            let scene = self.scene(config, task, seed)?;
            let deployment = search(&scene)?;
            let outline = deployed_outline(&scene, &deployment, config.objective.outline);
            let shared = intersection_over_union(&outline, &target);
            designs.push((
                shared,
                seed,
                Tessellation::from_deployment(&scene, &deployment),
            ));
        }
        let of_first = designs[0].0;
        let best = designs.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (shared, seed, tessellation) = best.context("no start")?;
        Ok(Fitted {
            target: task.name.to_owned(),
            min_panel_width: task.width,
            scene: first.hash(),
            starts: self.starts,
            seed,
            shared,
            first: of_first,
            cpu_seconds: cpu_seconds()? - began,
            thinnest: tessellation.worst_panels().thinnest,
            overlap: tessellation.defects().overlap[1],
        })
    }

    /// The picture of the examples, which are designed again.
    fn draw(&self, config: &SceneConfig, sets: &[Set]) -> Result<()> {
        let mut drawn = Vec::new();
        for (task, fitted) in sets.iter().flat_map(Set::examples) {
            let scene = self.scene(config, task, fitted.seed)?;
            let tessellation = Tessellation::from_deployment(&scene, &search(&scene)?);
            let target = self.placed(config, task.outline);
            drawn.push((fitted.title(), fitted.lines(), tessellation, target));
        }
        let columns: Vec<Column> = (drawn.iter())
            .map(|(title, lines, tessellation, target)| Column {
                title,
                lines: lines.clone(),
                tessellation,
                target,
            })
            .collect();
        picture::save(&side_by_side(&columns), &self.out.join("compact"), 3200)?;
        Ok(())
    }

    fn page(&self, sets: &[Set]) -> String {
        let table = Table::new()
            .column("minimum panel width, mm", |set: &Set| {
                Cell::text(match set.0[0].1.min_panel_width {
                    0.0 => "none".to_owned(),
                    width => width.to_string(),
                })
            })
            .column("targets", |set| Cell::text(set.0.len()))
            .column("mean, %", |set| percent(set.mean(|it| it.shared)))
            .column("worst, %", |set| percent(set.examples()[2].1.shared))
            .column("median, %", |set| percent(set.examples()[1].1.shared))
            .column("best, %", |set| percent(set.examples()[0].1.shared))
            .column("mean of the first start, %", |set| {
                percent(set.mean(|it| it.first))
            })
            .column("thinnest panel, mm", |set| {
                let thinnest = set.0.iter().map(|(_, it)| it.thinnest);
                Cell::fixed(thinnest.fold(f64::INFINITY, f64::min), 2)
            })
            .column("maximum overlap", |set| {
                let overlaps = set.0.iter().map(|(_, it)| it.overlap);
                Cell::scientific(overlaps.fold(0.0, f64::max), 0)
            })
            .column("CPU s per target", |set| {
                Cell::fixed(set.mean(|it| it.cpu_seconds), 2)
            });
        format!(
            "# Closed again after 180 degrees\n\n\
            Intersection over union of a square sheet, opened by 180 degrees, with outlines that are turned by {} degrees: \
            the best of {} starts. The sheet is placed by the centroid of its area, and neither rotated nor scaled. The \
            thinnest panel and the overlap of deployed panels, relative to the area of the sheet, are the extremes over all \
            designs; the CPU time is that of all starts of a target. `kirigami-studies compact`.\n\n{}",
            self.turned_deg,
            self.starts,
            table.markdown(sets)
        )
    }
}

fn percent(fraction: f64) -> Cell {
    Cell::fixed(100.0 * fraction, 2)
}

fn csv_of(rows: &[Fitted]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// The deployment of the best design of a search without a run folder.
fn search(scene: &Scene) -> Result<Deployment> {
    let (problem, start, settings) = (scene.problem()?, scene.start(), &scene.config.optimiser);
    let evaluation = problem.evaluate(&start)?;
    ensure!(
        evaluation.loss.is_finite(),
        "seed {}: a panel of the start is not wider than objective.min_panel_width",
        settings.seed
    );
    let (method, rate) = (settings.method, settings.learning_rate);
    let mut search = SearchState::new(&problem, start, &evaluation, method, rate);
    let stop = interrupt::stop_flag()?;
    let Ok(ended) = optimise(&problem, &mut search, settings.steps, stop, &mut |_| {
        Ok::<_, Infallible>(())
    });
    if ended == Ended::Stopped {
        bail!(Unfinished::new(1, "study"));
    }
    Ok(problem.deploy(&search.best)?)
}

impl Fitted {
    fn title(&self) -> String {
        match self.min_panel_width {
            0.0 => self.target.clone(),
            width => format!("{}, at least {width} mm", self.target),
        }
    }

    fn lines(&self) -> Vec<String> {
        vec![
            format!("intersection over union {:.4}", self.shared),
            format!("thinnest panel {:.1} mm", self.thinnest),
        ]
    }
}

impl<'a> Set<'a> {
    fn new(tasks: &'a [Task], fitted: &'a [Fitted], width: f64) -> Self {
        let both = tasks.iter().zip(fitted);
        let mut set: Vec<_> = both.filter(|(task, _)| task.width == width).collect();
        set.sort_by(|a, b| a.1.shared.total_cmp(&b.1.shared));
        Self(set)
    }

    fn mean(&self, value: impl Fn(&Fitted) -> f64) -> f64 {
        self.0.iter().map(|(_, it)| value(it)).sum::<f64>() / self.0.len() as f64
    }

    /// The best, the median and the worst match.
    fn examples(&self) -> [(&'a Task<'a>, &'a Fitted); 3] {
        let last = self.0.len() - 1;
        [last, last / 2, 0].map(|k| self.0[k])
    }
}
