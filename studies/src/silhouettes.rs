//! `kirigami-studies silhouettes`: one sheet designed for several drawn targets; Fig. 2.

use crate::designed::designed;
use crate::drawing::{Column, side_by_side};
use crate::outline_match::{Match, OutlineMatch};
use crate::tessellation::{Tessellation, WorstPanels};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use design::objective::shape::OutlinePoints;
use design::objective::target::TargetShape;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::progress::Progress;
use kirigami::ui::{picture, run_folder};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use support::table::{Cell, Table};

/// Design one sheet for several silhouettes, and measure the match and the shape of the panels
///
/// Every silhouette replaces the scene's target, with the same height and centre. It is designed through the free
/// outline corners without a minimum panel width and with the scene's, and through all outline corners with
/// the scene's. Writes silhouettes.csv, silhouettes.md and a picture. Example: kirigami-studies silhouettes
/// configs/scenes/shield-16x22.toml configs/targets/shield.svg configs/targets/leaf.svg
#[derive(Args)]
pub struct SilhouetteStudy {
    /// Scene (TOML) with a target.svg
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Silhouettes (SVG)
    #[arg(value_name = "SVG", required = true)]
    silhouettes: Vec<PathBuf>,
    /// Folder for the table, the picture and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-silhouettes")]
    out: PathBuf,
}

/// What one design of a silhouette is made for.
#[derive(Clone, Copy)]
struct Aim {
    outline: OutlinePoints,
    /// mm
    min_panel_width: f64,
}

/// The design for one silhouette.
struct Fitted {
    name: String,
    aim: Aim,
    fit: OutlineMatch,
    /// Height of the target (mm).
    height: f64,
    opening_deg: f64,
    worst: WorstPanels,
    seconds: f64,
    tessellation: Tessellation,
    target: Vec<[f64; 2]>,
}

impl SilhouetteStudy {
    pub fn run(&self) -> Result<()> {
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        // A run is stored under the name of its silhouette.
        let mut names = BTreeSet::new();
        for file in &self.silhouettes {
            ensure!(
                names.insert(file.file_stem()),
                "{}: another silhouette has the same name: rename one of them",
                file.display()
            );
        }
        let _held = run_folder::hold(&self.out)?;
        let steps = config.optimiser.steps;
        let width = config.objective.min_panel_width;
        let aims = [
            (OutlinePoints::Free, 0.0),
            (OutlinePoints::Free, width),
            (OutlinePoints::All, width),
        ]
        .map(|(outline, min_panel_width)| Aim {
            outline,
            min_panel_width,
        });
        let runs = self
            .silhouettes
            .iter()
            .flat_map(|file| aims.map(|aim| (file, aim)));
        let bar = Progress::new(aims.len() * self.silhouettes.len() * steps, "design steps");
        let mut fitted = Vec::new();
        for (k, (silhouette, aim)) in runs.enumerate() {
            fitted.push(self.fit(&config, silhouette, aim, &|step, message| {
                bar.show(k * steps + step, None, message);
            })?);
        }
        bar.finish();
        let page = page(&fitted);
        run_folder::write(&self.out, "silhouettes.md", &page)?;
        run_folder::write(&self.out, "silhouettes.csv", &columns().csv(&fitted))?;
        let limited = fitted.iter().filter(|it| it.aim.min_panel_width > 0.0);
        let titles: Vec<String> = limited.clone().map(Fitted::title).collect();
        let columns: Vec<_> = std::iter::zip(limited, &titles)
            .map(|(it, title)| it.column(title))
            .collect();
        picture::save(&side_by_side(&columns), &self.out.join("silhouettes"), 3200)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn fit(
        &self,
        config: &SceneConfig,
        silhouette: &Path,
        aim: Aim,
        show: &dyn Fn(usize, &str),
    ) -> Result<Fitted> {
        let name = silhouette.file_stem().unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        let mut config = config.clone();
        let TargetShape::Svg { file, height, .. } = &mut config.target else {
            bail!("{}: the scene needs a [target.svg]", self.scene.display());
        };
        *file = std::path::absolute(silhouette)?;
        let height = *height;
        config.objective.outline = aim.outline;
        config.objective.min_panel_width = aim.min_panel_width;
        let folder = format!("{name}-{}-{}", corners(aim.outline), aim.min_panel_width);
        config.output = std::path::absolute(&self.out)?.join("runs").join(folder);
        let scene = Scene::new(config, &self.scene)?;
        let began = std::time::Instant::now();
        let designed = designed(&scene, &mut |step| {
            show(
                step.step,
                &format!("{name}, outline {:.1} mm", step.scores.outline_error),
            );
        })?;
        let seconds = began.elapsed().as_secs_f64();
        let (deployment, target) = (&designed.best.deployment, &scene.target.points);
        let tessellation = Tessellation::from_deployment(&scene, deployment);
        let opening = designed.problem.opening(&designed.design);
        let opening = opening.context("the scene has no opening angle: set hinge = \"pin\"")?;
        Ok(Fitted {
            name,
            aim,
            fit: OutlineMatch::new(&deployment.sheet, &tessellation.deployed, target),
            height,
            opening_deg: opening.to_degrees(),
            worst: tessellation.worst_panels(),
            seconds,
            target: target.to_vec(),
            tessellation,
        })
    }
}

impl Fitted {
    fn title(&self) -> String {
        format!("{}, {} corners", self.name, corners(self.aim.outline))
    }

    fn column<'a>(&'a self, title: &'a str) -> Column<'a> {
        let Match { mean, shared, .. } = match self.aim.outline {
            OutlinePoints::Free => self.fit.free,
            OutlinePoints::All => self.fit.all,
        };
        Column {
            title,
            lines: vec![
                format!(
                    "boundary error {:.2} % of the height",
                    100.0 * mean / self.height
                ),
                format!("intersection over union {shared:.3}"),
                format!("opening {:.1}\u{b0}", self.opening_deg),
                format!("thinnest panel {:.1} mm", self.worst.thinnest),
            ],
            tessellation: &self.tessellation,
            target: &self.target,
        }
    }
}

fn corners(outline: OutlinePoints) -> &'static str {
    match outline {
        OutlinePoints::Free => "free",
        OutlinePoints::All => "all",
    }
}

fn columns<'a>() -> Table<'a, Fitted> {
    let percent_of_height = |value: fn(&Fitted) -> f64| {
        move |fitted: &Fitted| Cell::fixed(100.0 * value(fitted) / fitted.height, 3)
    };
    Table::new()
        .column(
            "silhouette, corners, minimum width in mm",
            |fitted: &Fitted| {
                let (name, corners) = (&fitted.name, corners(fitted.aim.outline));
                Cell::text(match fitted.aim.min_panel_width {
                    0.0 => format!("{name}, {corners}, none"),
                    width => format!("{name}, {corners}, {width}"),
                })
            },
        )
        .column(
            "mean distance free, %",
            percent_of_height(|it| it.fit.free.mean),
        )
        .column(
            "mean distance all, %",
            percent_of_height(|it| it.fit.all.mean),
        )
        .column("union free", |fitted| {
            Cell::fixed(fitted.fit.free.shared, 4)
        })
        .column("union all", |fitted| Cell::fixed(fitted.fit.all.shared, 4))
        .column("opening, deg", |fitted| Cell::fixed(fitted.opening_deg, 1))
        .column("sharpest corner, deg", |fitted| {
            Cell::fixed(fitted.worst.sharpest_deg, 1)
        })
        .column("thinnest panel, mm", |fitted| {
            Cell::fixed(fitted.worst.thinnest, 2)
        })
        .column("minimum area", |fitted| Cell::fixed(fitted.worst.least, 3))
        .column("overlap", |fitted| {
            let overlap = fitted.tessellation.defects().overlap;
            Cell::scientific(overlap.iter().sum(), 0)
        })
        .column("s", |fitted| Cell::fixed(fitted.seconds, 0))
}

fn page(fitted: &[Fitted]) -> String {
    format!(
        "# Silhouettes\n\n\
        One sheet designed for drawn targets of one height. The corners are those compared with the \
        target: those that belong to no hinge (free), the paper's point set, or all outline corners. Every match is \
        measured through both: the mean distance of the corners from the target, in % of its height, and the \
        intersection over union of the polygon through them with the target. The thinnest panel is the minimum distance \
        of a corner from an edge of its panel that does not end at it; the minimum area is relative to the mean. The \
        seconds are those of this run; steps made by an earlier run are not included. `kirigami-studies \
        silhouettes`.\n\n{}\
        | the paper's seal, not stated | 0.7 | | 0.967 | | 90 | | | | | |\n",
        columns().markdown(fitted)
    )
}
