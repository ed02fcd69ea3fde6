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
use serde::Deserialize;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::path::PathBuf;
use support::table::{Cell, Table};

/// Design one sheet for many target outlines, and measure the intersection over union
///
/// Every outline replaces the scene's target; its unit is the side of a square panel of the mean area. The search is
/// repeated from random starts, without a minimum panel width and with the scene's; the best of the starts counts.
/// Writes compact.csv, compact.md and a picture. Example: kirigami-studies compact configs/targets/compact.json
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

/// The best design for an outline.
struct Fitted {
    name: String,
    /// mm
    min_panel_width: f64,
    /// Intersection over union of the best of the starts, and of the first.
    shared: f64,
    first: f64,
    /// CPU time of all starts.
    seconds: f64,
    /// mm
    thinnest: f64,
    /// Area where deployed panels overlap, over that of the sheet.
    overlap: f64,
    tessellation: Tessellation,
    target: Vec<[f64; 2]>,
}

/// All designs with one minimum panel width.
struct Set<'a> {
    /// In the order of their match, the worst first.
    fitted: Vec<&'a Fitted>,
}

impl CompactStudy {
    pub fn run(&self) -> Result<()> {
        ensure!(self.starts > 0, "--starts must be at least 1");
        ensure!(self.every > 0, "--every must be at least 1");
        ensure!(
            self.turned_deg.is_finite(),
            "--turned-deg must be a finite number"
        );
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        let targets = support::regular_file::read_to_string(&self.targets);
        let targets = targets.with_context(|| self.targets.display().to_string())?;
        let Outlines { targets } =
            serde_json::from_str(&targets).with_context(|| self.targets.display().to_string())?;
        ensure!(
            !targets.is_empty(),
            "{}: no targets",
            self.targets.display()
        );
        let _held = run_folder::hold(&self.out)?;
        let width = config.objective.min_panel_width;
        ensure!(
            width > 0.0,
            "{}: the study needs objective.min_panel_width",
            self.scene.display()
        );
        let widths = [0.0, width];
        let chosen: Vec<_> = targets.iter().step_by(self.every).collect();
        let bar = Progress::new(widths.len() * chosen.len(), "designs");
        let mut fitted = Vec::new();
        for (name, outline) in chosen {
            for width in widths {
                let design = self.fit(&config, name, outline, width);
                let design = design.with_context(|| format!("target {name}"))?;
                let message = format!("{name}: {:.4}", design.shared);
                fitted.push(design);
                bar.show(fitted.len(), None, &message);
            }
        }
        bar.finish();
        let sets = widths.map(|width| Set::new(&fitted, width));
        let page = self.page(&sets);
        run_folder::write(&self.out, "compact.md", &page)?;
        run_folder::write(&self.out, "compact.csv", &columns().csv(&fitted))?;
        let shown: Vec<&Fitted> = sets.iter().flat_map(Set::examples).collect();
        let titles: Vec<String> = shown.iter().map(|it| it.title()).collect();
        let pictured = shown.iter().zip(&titles);
        let pictured: Vec<_> = pictured.map(|(it, title)| it.column(title)).collect();
        picture::save(&side_by_side(&pictured), &self.out.join("compact"), 3200)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn fit(
        &self,
        config: &SceneConfig,
        name: &str,
        outline: &[[f64; 2]],
        width: f64,
    ) -> Result<Fitted> {
        let began = cpu_seconds()?;
        let mut config = config.clone();
        let unit = config.sheet.mean_panel_area().sqrt();
        let middle = complex(mean(&config.sheet.outline().corners));
        let turned = unit * turn(self.turned_deg.to_radians());
        let place = |vertex: &[f64; 2]| point(middle + turned * complex(*vertex));
        let target: Vec<[f64; 2]> = outline.iter().map(place).collect();
        config.target = TargetShape::Polygon {
            vertices: target.clone(),
        };
        config.objective.min_panel_width = width;
        let seeds = config.optimiser.seed..config.optimiser.seed + self.starts;
        let mut designs = Vec::new();
        for seed in seeds {
            config.optimiser.seed = seed;
            let scene = Scene::new(config.clone(), &self.scene)?;
            let deployment = search(&scene)?;
            let outline = deployed_outline(&scene, &deployment, config.objective.outline);
            let shared = intersection_over_union(&outline, &target);
            designs.push((shared, Tessellation::from_deployment(&scene, &deployment)));
        }
        let first = designs[0].0;
        let best = designs.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (shared, tessellation) = best.context("no start")?;
        Ok(Fitted {
            name: name.to_owned(),
            min_panel_width: width,
            shared,
            first,
            seconds: cpu_seconds()? - began,
            thinnest: tessellation.worst_panels().thinnest,
            overlap: tessellation.defects().overlap[1],
            tessellation,
            target,
        })
    }

    fn page(&self, sets: &[Set]) -> String {
        let percent =
            |set: &Set, value: fn(&Fitted) -> f64| Cell::fixed(100.0 * set.mean(value), 2);
        let at = |set: &Set, k: usize| Cell::fixed(100.0 * set.examples()[k].shared, 2);
        let table = Table::new()
            .column("minimum panel width, mm", |set: &Set| {
                Cell::text(match set.fitted[0].min_panel_width {
                    0.0 => "none".to_owned(),
                    width => width.to_string(),
                })
            })
            .column("targets", |set| Cell::text(set.fitted.len()))
            .column("mean, %", |set| percent(set, |it| it.shared))
            .column("worst, %", |set| at(set, 2))
            .column("median, %", |set| at(set, 1))
            .column("best, %", |set| at(set, 0))
            .column("mean of the first start, %", |set| {
                percent(set, |it| it.first)
            })
            .column("thinnest panel, mm", |set| {
                let thinnest = set.fitted.iter().map(|it| it.thinnest);
                Cell::fixed(thinnest.fold(f64::INFINITY, f64::min), 2)
            })
            .column("maximum overlap", |set| {
                let overlaps = set.fitted.iter().map(|it| it.overlap);
                Cell::scientific(overlaps.fold(0.0, f64::max), 0)
            })
            .column("CPU s per target", |set| {
                Cell::fixed(set.mean(|it| it.seconds), 2)
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
            0.0 => self.name.clone(),
            width => format!("{}, at least {width} mm", self.name),
        }
    }

    fn column<'a>(&'a self, title: &'a str) -> Column<'a> {
        Column {
            title,
            lines: vec![
                format!("intersection over union {:.4}", self.shared),
                format!("thinnest panel {:.1} mm", self.thinnest),
            ],
            tessellation: &self.tessellation,
            target: &self.target,
        }
    }
}

impl<'a> Set<'a> {
    fn new(all: &'a [Fitted], width: f64) -> Self {
        let of_width = all.iter().filter(|it| it.min_panel_width == width);
        let mut fitted: Vec<&Fitted> = of_width.collect();
        fitted.sort_by(|a, b| a.shared.total_cmp(&b.shared));
        Self { fitted }
    }

    fn mean(&self, value: impl Fn(&Fitted) -> f64) -> f64 {
        self.fitted.iter().map(|it| value(it)).sum::<f64>() / self.fitted.len() as f64
    }

    /// The best, the median and the worst match.
    fn examples(&self) -> [&'a Fitted; 3] {
        let last = self.fitted.len() - 1;
        [last, last / 2, 0].map(|k| self.fitted[k])
    }
}

fn columns<'a>() -> Table<'a, Fitted> {
    Table::new()
        .column("target", |it: &Fitted| Cell::text(&it.name))
        .column("minimum panel width, mm", |it| {
            Cell::text(it.min_panel_width)
        })
        .column("intersection over union", |it| Cell::fixed(it.shared, 5))
        .column("of the first start", |it| Cell::fixed(it.first, 5))
        .column("thinnest panel, mm", |it| Cell::fixed(it.thinnest, 2))
        .column("CPU s", |it| Cell::fixed(it.seconds, 2))
}
