//! `kirigami-studies approaches`: ways to keep a cut pattern valid during the search; section 3.1.

use crate::designed::designed;
use crate::drawing::{Column, side_by_side};
use crate::free_panels::{Enforcement, FreePanels};
use crate::outline_match::OutlineMatch;
use crate::tessellation::{Defects, Tessellation};
use anyhow::{Context, Result};
use clap::Args;
use design::geometry::chamfer::Precision;
use design::optimise::search::SearchMethod;
use design::scene::{Scene, SceneConfig};
use kirigami::ui::{picture, run_folder};
use output::run_results::remove_run;
use std::path::PathBuf;
use std::time::Instant;
use support::table::{Cell, Table};

/// Compare free panel corners, with and without penalties on validity, with the charts
///
/// Four approaches to one target from one start with the same number of steps, each at the better of two
/// learning rates; then the charts alone until L-BFGS converges. The three conditions of validity are evaluated
/// flat and at states of the deployment. Writes approaches.csv, approaches.md and a
/// picture. Example: kirigami-studies approaches configs/scenes/pin-7x7.toml
#[derive(Args)]
pub struct ApproachStudy {
    /// Scene (TOML) with hinge = "pin"
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Steps of each approach
    #[arg(long, value_name = "N", default_value_t = 150)]
    steps: usize,
    /// Folder for the table, the picture and the runs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-approaches")]
    out: PathBuf,
}

/// Learning rates: of corners relative to the sheet's side, and of chart coordinates.
const FREE_RATES: [f64; 2] = [0.005, 0.02];
const CHART_RATES: [f64; 2] = [0.05, 0.1];
/// Maximum number of steps until the charts have converged.
const CONVERGED_STEPS: usize = 3000;
/// Weights of the coverage for which the charts are converged.
const COVERAGES: [f64; 3] = [0.5, 0.1, 0.02];
/// Number of states of the deployment, between flat and deployed, at which gaps and overlaps are evaluated.
const STATES: usize = 20;

/// The result of one approach.
struct Outcome {
    name: String,
    paper: &'static str,
    coordinates: usize,
    rate: f64,
    steps: usize,
    /// L (mm^2), by which the learning rate is selected.
    loss: f64,
    fit: OutlineMatch,
    /// Of the flat sheet, and the maxima over the deployment.
    defects: Defects,
    opening_deg: f64,
    tessellation: Tessellation,
    target: Vec<[f64; 2]>,
    seconds: f64,
}

impl ApproachStudy {
    pub fn run(&self) -> Result<()> {
        let config: SceneConfig = support::toml_file::read(&self.scene)?;
        let _held = run_folder::hold(&self.out)?;
        // Radius of a circle with the area of the target.
        let radius =
            (Scene::new(config.clone(), &self.scene)?.target.area() / std::f64::consts::PI).sqrt();
        let mut outcomes = Vec::new();
        for (name, enforcement, paper) in [
            ("free corners", Enforcement::Nothing, "gap 7.8 %"),
            (
                "closed hinges",
                Enforcement::Projection,
                "no gap, no overlap, voids",
            ),
            (
                "closed hinges, no voids",
                Enforcement::Tiling,
                "half the void, a worse match",
            ),
        ] {
            for rate in FREE_RATES {
                outcomes.push(self.free(&config, name, paper, enforcement, rate)?);
            }
        }
        for rate in CHART_RATES {
            let mut config = config.clone();
            config.optimiser.steps = self.steps;
            config.optimiser.learning_rate = rate;
            outcomes.push(self.chart(config, "charts", "boundary 0.47 %, else 0")?);
        }
        let better = |pair: &[Outcome]| usize::from(pair[1].loss < pair[0].loss);
        let drawn: Vec<usize> = (outcomes.chunks(2).enumerate())
            .map(|(k, pair)| 2 * k + better(pair))
            .collect();
        for coverage in COVERAGES {
            let mut config = config.clone();
            config.objective.coverage = coverage;
            config.objective.precision = Precision::Curve;
            config.optimiser.steps = CONVERGED_STEPS;
            config.optimiser.method = SearchMethod::Lbfgs;
            let name = format!("charts until L-BFGS settles, coverage {coverage}");
            outcomes.push(self.chart(config, &name, "")?);
        }
        let lines: Vec<Line> = (outcomes.iter().enumerate())
            .map(|(k, outcome)| (outcome, drawn.contains(&k)))
            .collect();
        let page = page(&lines, self.steps, radius);
        run_folder::write(&self.out, "approaches.md", &page)?;
        let csv = with_match(validity(radius), radius).csv(&lines);
        run_folder::write(&self.out, "approaches.csv", &csv)?;
        let columns: Vec<_> = drawn.iter().map(|k| outcomes[*k].column(radius)).collect();
        picture::save(&side_by_side(&columns), &self.out.join("approaches"), 2400)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn free(
        &self,
        config: &SceneConfig,
        name: &str,
        paper: &'static str,
        enforcement: Enforcement,
        rate: f64,
    ) -> Result<Outcome> {
        let began = Instant::now();
        let scene = Scene::new(config.clone(), &self.scene)?;
        let (problem, start) = (scene.problem()?, scene.start());
        let opening = start
            .opening
            .context("the opening is no design variable: set hinge = \"pin\" without pin.held")?;
        let panels = FreePanels::new(&problem, &start, opening, enforcement)?;
        let found = panels.search(self.steps, rate);
        let tessellation = found.tessellation;
        let states = panels.while_opening(&tessellation.flat, found.opening, STATES);
        let (_, sheet) = problem.cut(&start)?;
        Ok(Outcome {
            name: name.to_owned(),
            paper,
            coordinates: panels.coordinates(),
            rate,
            steps: self.steps,
            loss: found.losses.iter().copied().fold(f64::INFINITY, f64::min),
            fit: OutlineMatch::new(
                &sheet,
                &tessellation.deployed,
                &problem.objective.shape.target,
            ),
            defects: tessellation.defects_in(states),
            opening_deg: found.opening.to_degrees(),
            tessellation,
            target: problem.objective.shape.target.clone(),
            seconds: began.elapsed().as_secs_f64(),
        })
    }

    fn chart(&self, mut config: SceneConfig, name: &str, paper: &'static str) -> Result<Outcome> {
        let began = Instant::now();
        let rate = config.optimiser.learning_rate;
        let folder = format!("{}-{rate}", name.replace([' ', ','], "-"));
        config.output = std::path::absolute(&self.out)?.join("runs").join(folder);
        let scene = Scene::new(config, &self.scene)?;
        remove_run(&scene)?;
        let designed = designed(&scene, &mut |_| {})?;
        let tessellation = Tessellation::from_deployment(&scene, &designed.best.deployment);
        let pattern = &designed.design.pattern;
        let opening = designed.design.opening.unwrap_or_default();
        let sheet = &designed.best.deployment.sheet;
        let problem = scene.problem()?;
        let panels = FreePanels::new(&problem, &designed.design, opening, Enforcement::Nothing)?;
        let states = panels.while_opening(&tessellation.flat, opening, STATES);
        Ok(Outcome {
            name: name.to_owned(),
            paper,
            coordinates: pattern.z.len() + pattern.ell.iter().map(Vec::len).sum::<usize>() + 1,
            rate,
            steps: designed.history.len() - 1,
            loss: designed.best.loss,
            fit: OutlineMatch::new(sheet, &tessellation.deployed, &scene.target.points),
            defects: tessellation.defects_in(states),
            opening_deg: opening.to_degrees(),
            tessellation,
            target: scene.target.points.clone(),
            seconds: began.elapsed().as_secs_f64(),
        })
    }
}

impl Outcome {
    fn column(&self, radius: f64) -> Column<'_> {
        let Defects {
            gap, overlap, void, ..
        } = self.defects;
        let lines = vec![
            format!(
                "boundary error {:.2} % of the radius",
                100.0 * self.fit.free.rms / radius
            ),
            format!(
                "gaps at hinges {} %, opening {} %",
                percent(gap[0]),
                percent(gap[1])
            ),
            format!(
                "overlap {} %, opening {} %",
                percent(overlap[0]),
                percent(overlap[1])
            ),
            format!("uncovered {} %", percent(void)),
        ];
        Column {
            title: &self.name,
            lines,
            tessellation: &self.tessellation,
            target: &self.target,
        }
    }
}

/// A fraction in per cent with two decimals; rounding errors are shown as zero.
fn percent(fraction: f64) -> String {
    if fraction < 1e-12 {
        "0".to_owned()
    } else {
        format!("{:.2}", 100.0 * fraction)
    }
}

/// A fraction in per cent; rounding errors are shown as zero.
fn fraction(value: f64) -> Cell {
    Cell::number(value, percent(value))
}

/// An approach, and whether it is the better of its rates.
type Line<'a> = (&'a Outcome, bool);

fn name((outcome, drawn): &Line) -> Cell {
    let mark = if *drawn { "**" } else { "" };
    Cell::text(format!("{mark}{}{mark}", outcome.name))
}

fn validity<'a>(radius: f64) -> Table<'a, Line<'a>> {
    Table::new()
        .column("approach", name)
        .column("coordinates", |(outcome, _)| {
            Cell::text(outcome.coordinates)
        })
        .column("rate", |(outcome, _)| Cell::text(outcome.rate))
        .column("steps", |(outcome, _)| Cell::text(outcome.steps))
        .column("boundary", move |(outcome, _)| {
            Cell::fixed(100.0 * outcome.fit.free.rms / radius, 3)
        })
        .column("flat gap", |(outcome, _)| fraction(outcome.defects.gap[0]))
        .column("opening gap", |(outcome, _)| {
            fraction(outcome.defects.gap[1])
        })
        .column("flat overlap", |(outcome, _)| {
            fraction(outcome.defects.overlap[0])
        })
        .column("opening overlap", |(outcome, _)| {
            fraction(outcome.defects.overlap[1])
        })
        .column("void", |(outcome, _)| fraction(outcome.defects.void))
        .column("beside", |(outcome, _)| fraction(outcome.defects.outside))
        .column("opening, deg", |(outcome, _)| {
            Cell::fixed(outcome.opening_deg, 1)
        })
        .column("s", |(outcome, _)| Cell::fixed(outcome.seconds, 1))
        .column("the paper", |(outcome, _)| Cell::text(outcome.paper))
}

/// The table with the columns of the match.
fn with_match<'a>(table: Table<'a, Line<'a>>, radius: f64) -> Table<'a, Line<'a>> {
    let of_radius = move |distance: fn(&OutlineMatch) -> f64| {
        move |(outcome, _): &Line| Cell::fixed(100.0 * distance(&outcome.fit) / radius, 3)
    };
    table
        .column("from free corners", of_radius(|fit| fit.free.rms))
        .column("from all corners", of_radius(|fit| fit.all.rms))
        .column("to free corners", of_radius(|fit| fit.free.uncovered))
        .column("to all corners", of_radius(|fit| fit.all.uncovered))
        .column("union, free", |(outcome, _)| {
            Cell::fixed(outcome.fit.free.shared, 4)
        })
        .column("union, all", |(outcome, _)| {
            Cell::fixed(outcome.fit.all.shared, 4)
        })
}

fn page(outcomes: &[Line], steps: usize, radius: f64) -> String {
    let named = Table::new()
        .column("approach", name)
        .column("rate", |(outcome, _): &Line| Cell::text(outcome.rate));
    format!(
        "# Validity by construction\n\n\
         One target, one start, {steps} steps of Adam, each approach at two learning rates; the rate with the smaller \
         loss is in bold and in the picture. The last rows are the charts until L-BFGS converges, with the distance \
         measured to the target's curve. Boundary: root mean square distance of the free outline corners from the \
         circle, in % of its radius. Gaps are in % of the sheet's side; overlaps, voids and the area beside the sheet \
         in % of its area. \"Opening\" is the maximum over {STATES} states of the deployment. `kirigami-studies \
         approaches`.\n\n{}\
         \nThe match in other measures: root mean square distance of corners from the circle and of the circle's points \
         from the nearest corner, in % of the radius, and intersection over union of the polygon through the corners \
         with the circle; for the free outline corners and for all.\n\n{}",
        validity(radius).markdown(outcomes),
        with_match(named, radius).markdown(outcomes)
    )
}
