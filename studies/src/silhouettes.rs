//! `kirigami-studies silhouettes`: one sheet designed for several drawn targets; Fig. 2.

use crate::designed::designed;
use crate::drawing::{Column, side_by_side};
use crate::tessellation::{Tessellation, WorstPanels};
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use design::geometry::intersection_over_union::intersection_over_union;
use design::objective::loss::OutlinePoints;
use design::objective::target::TargetShape;
use design::scene::placement::deployed_outline;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::progress::Progress;
use kirigami::ui::{picture, run_folder};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Design one sheet for several silhouettes, and measure the match and the shape of the panels
///
/// Every silhouette replaces the scene's target, with the same height and centre, once with the
/// scene's weight of the panel shape penalty and once without. Writes
/// silhouettes.csv, silhouettes.md and a picture. Example: kirigami-studies silhouettes
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

/// The design for one silhouette.
struct Fitted {
    name: String,
    /// Weight of the panel shape penalty.
    panel_shape: f64,
    /// Intersection over union of the outline through the free corners, and of that through all corners.
    shared: [f64; 2],
    /// Mean and root mean square distance of the free corners from the target, relative to its height.
    mean: f64,
    rms: f64,
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
        let weights = [config.objective.panel_shape, 0.0];
        let runs = self
            .silhouettes
            .iter()
            .flat_map(|file| weights.map(|weight| (file, weight)));
        let bar = Progress::new(
            weights.len() * self.silhouettes.len() * steps,
            "design steps",
        );
        let mut fitted = Vec::new();
        for (k, (silhouette, weight)) in runs.enumerate() {
            fitted.push(self.fit(&config, silhouette, weight, &|step, message| {
                bar.show(k * steps + step, None, message);
            })?);
        }
        bar.finish();
        let page = page(&fitted)?;
        run_folder::write(&self.out, "silhouettes.md", &page)?;
        run_folder::write(&self.out, "silhouettes.csv", &csv(&fitted)?)?;
        let columns: Vec<_> = fitted.iter().step_by(2).map(Fitted::column).collect();
        picture::save(&side_by_side(&columns), &self.out.join("silhouettes"), 2400)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn fit(
        &self,
        config: &SceneConfig,
        silhouette: &Path,
        panel_shape: f64,
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
        config.objective.panel_shape = panel_shape;
        let folder = format!("{name}-{panel_shape}");
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
        let (deployment, target) = (&designed.best.deployment, scene.target.points());
        let outline = |points| deployed_outline(&scene, deployment, points);
        let free = outline(OutlinePoints::Free);
        let distances: Vec<f64> = free.iter().map(|p| scene.target.distance(*p)).collect();
        let mean = |values: &dyn Fn(&f64) -> f64| {
            distances.iter().map(values).sum::<f64>() / distances.len() as f64
        };
        let tessellation = Tessellation::of(&scene, deployment);
        let opening = designed.design.opening;
        let opening = opening.context("the scene has no opening angle: set hinge = \"pin\"")?;
        Ok(Fitted {
            name,
            panel_shape,
            shared: [free.clone(), outline(OutlinePoints::All)]
                .map(|outline| intersection_over_union(&outline, target)),
            mean: mean(&|d| *d) / height,
            rms: mean(&|d| d * d).sqrt() / height,
            opening_deg: opening.to_degrees(),
            worst: tessellation.worst_panels(),
            seconds,
            target: target.to_vec(),
            tessellation,
        })
    }
}

impl Fitted {
    fn column(&self) -> Column<'_> {
        Column {
            title: &self.name,
            lines: vec![
                format!("boundary error {:.2} % of the height", 100.0 * self.mean),
                format!("intersection over union {:.3}", self.shared[0]),
                format!("opening {:.1}\u{b0}", self.opening_deg),
                format!("sharpest panel corner {:.0}\u{b0}", self.worst.sharpest_deg),
            ],
            tessellation: &self.tessellation,
            target: &self.target,
        }
    }
}

fn page(fitted: &[Fitted]) -> Result<String> {
    let mut text = "# Silhouettes\n\n\
        One sheet designed for drawn targets of one height, with the scene's weight of the panel shape penalty (in \
        the picture) and without. Distances of the free outline corners from the target are in % of its height. \
        Intersection over union is that of the deployed outline through these corners, the paper's point set, and \
        through all corners, for which the notches between them count as missing. The shortest edge and the minimum \
        area are relative to a square panel of the mean area. The seconds are those of this run; steps made by an \
        earlier run are not included. `kirigami-studies silhouettes`.\n\n\
        | silhouette | panel_shape | mean distance, % | rms, % | intersection over union | with notches | opening, deg | sharpest corner, deg | shortest edge | minimum area | overlap | s |\n\
        |---|---|---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for it in fitted {
        writeln!(
            text,
            "| {} | {} | {:.3} | {:.3} | {:.4} | {:.4} | {:.1} | {:.1} | {:.2} | {:.3} | {:.0e} | {:.0} |",
            it.name,
            it.panel_shape,
            100.0 * it.mean,
            100.0 * it.rms,
            it.shared[0],
            it.shared[1],
            it.opening_deg,
            it.worst.sharpest_deg,
            it.worst.shortest,
            it.worst.least,
            it.tessellation.defects().overlap.iter().sum::<f64>(),
            it.seconds,
        )?;
    }
    writeln!(
        text,
        "| the paper's seal | | 0.7 | | 0.967 | | 90 | | | | | |"
    )?;
    Ok(text)
}

fn csv(fitted: &[Fitted]) -> Result<String> {
    let mut text = "silhouette,panel_shape,mean_over_height,rms_over_height,intersection_over_union,with_notches,opening_deg,\
                    sharpest_corner_deg,shortest_edge,least_area,seconds\n"
        .to_owned();
    for it in fitted {
        writeln!(
            text,
            "{},{},{:.6},{:.6},{:.5},{:.5},{:.3},{:.2},{:.4},{:.4},{:.1}",
            it.name,
            it.panel_shape,
            it.mean,
            it.rms,
            it.shared[0],
            it.shared[1],
            it.opening_deg,
            it.worst.sharpest_deg,
            it.worst.shortest,
            it.worst.least,
            it.seconds,
        )?;
    }
    Ok(text)
}
