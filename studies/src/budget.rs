//! `kirigami-studies budget`: how often the error of a deployed sheet stays within its budget.
//!
//! Small sheets are drawn, deployed by the learned hinge law, and deployed again with finite elements for all hinges. The movement of
//! the panel corners and the change of the load are the error; the budget states its standard deviation. The finite elements have the
//! imperfection, the material, the kerf and the thickness of the scene, so that only the causes that they see are compared.

mod drawn_sheet;

use crate::budget::drawn_sheet::drawn_sheet;
use anyhow::{Context, Result};
use clap::Args;
use design::analysis::error_budget::{Cause, Effect, ErrorBudget};
use design::scene::{Scene, SceneConfig};
use kirigami::commands::solve_args::{SolveArgs, task_error};
use kirigami::ui::run_folder;
use mesher::Tier;
use std::path::PathBuf;
use support::statistics::rms_and_maximum;
use support::table::{Cell, Table};
use verification::{Balanced, balanced_on, movements};

/// Measure how often the errors of deployed sheets stay within two standard deviations of their budget
///
/// Draws small sheets, and balances each once with finite elements for its hinges. What was solved is kept. Writes budget.md.
/// Example: kirigami-studies budget docs/results/budget/sheet.toml --sheets 12
#[derive(Args)]
pub struct BudgetStudy {
    /// Scene (TOML) whose panels, ligaments, supports and loads are drawn
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Number of sheets
    #[arg(long, value_name = "N", default_value_t = 12)]
    sheets: u64,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value = "reference")]
    tier: Tier,
    #[command(flatten)]
    solve: SolveArgs,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-budget")]
    out: PathBuf,
}

/// A sheet, judged.
struct Judged {
    number: u64,
    hinges: usize,
    /// Root mean square width of the ligaments over the thickness, and opening (deg).
    ligament: f64,
    opening_deg: f64,
    /// Distance of the panel corners from their places by finite elements (mm).
    corners: Vec<f64>,
    /// Relative error of the load; `None` under dead loads.
    load: Option<f64>,
    budget: ErrorBudget,
}

/// Errors within two standard deviations, of all.
#[derive(Default)]
struct Coverage {
    within: usize,
    of: usize,
}

impl BudgetStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let base: SceneConfig = support::toml_file::read(&self.scene)?;
        let service = self.solve.service(&self.out)?;
        let mut sheets = Vec::new();
        for number in 0..self.sheets {
            let scene = drawn_sheet(&base, &self.scene, number)?;
            let found = balanced_on(&[(self.tier, 1)], &scene, &scene.start(), &service);
            let (found, _) = found.map_err(task_error)?;
            sheets.push(Judged::new(number, &scene, &found)?);
        }
        let page = self.page(&sheets);
        run_folder::write(&self.out, "budget.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn page(&self, sheets: &[Judged]) -> String {
        let hinges: usize = sheets.iter().map(|sheet| sheet.hinges).sum();
        format!(
            "# Errors of small sheets beside their budget\n\n\
             {} sheets of film, drawn at random, {hinges} hinges by finite elements of the tier {}, one round. Error: by finite \
             elements; sigma: of the budget, of the causes that finite elements see. Corners: root mean square of all panel \
             corners. `kirigami-studies budget`.\n\n{}\n\
             Errors within two sigma, for sigma of these causes:\n\n{}",
            sheets.len(),
            self.tier,
            errors(sheets),
            coverages(sheets)
        )
    }
}

impl Judged {
    fn new(number: u64, scene: &Scene, found: &Balanced) -> Result<Self> {
        let [by_law, by_elements] = [found.by_law(), found.by_elements()];
        let budget = found.budget(scene)?;
        let [own, other] = [by_law, by_elements].map(|deployment| deployment.final_step());
        let widths = by_law.sheet.hinges.iter().map(|hinge| hinge.w_lig);
        let [width, _] = rms_and_maximum(widths);
        Ok(Self {
            number,
            hinges: by_law.sheet.hinges.len(),
            ligament: width / scene.material.thickness,
            opening_deg: own.opening().to_degrees(),
            corners: movements(by_law, by_elements),
            load: (scene.config.drive).map(|_| other.load_factor / own.load_factor - 1.0),
            budget: budget.context("the sheet has no error budget")?,
        })
    }

    fn seen(&self) -> Effect {
        self.budget.sum(Cause::is_seen_by_elements)
    }
}

/// One line a sheet.
fn errors(sheets: &[Judged]) -> String {
    let rms = |sheet: &Judged| rms_and_maximum(sheet.corners.iter().copied())[0];
    let percent = |load: Option<f64>| Cell::known(load.map(|load| Cell::percent(load, 2)), "-");
    let of = |cause: Cause| {
        move |sheet: &Judged| {
            let [corners, _] = sheet.budget.sum(|other| other == cause).corners;
            Cell::fixed(corners, 3)
        }
    };
    let table = Table::new()
        .column("sheet", |sheet: &Judged| Cell::text(sheet.number))
        .column("hinges", |sheet| Cell::text(sheet.hinges))
        .column("w_lig / t", |sheet| Cell::fixed(sheet.ligament, 1))
        .column("opening, deg", |sheet| Cell::fixed(sheet.opening_deg, 1))
        .column("corners, mm: error", |sheet| Cell::fixed(rms(sheet), 3))
        .column("sigma", |sheet| Cell::fixed(sheet.seen().corners[0], 3))
        .column("error / sigma", |sheet| {
            Cell::fixed(rms(sheet) / sheet.seen().corners[0], 2)
        })
        .column("sigma of network", of(Cause::Network))
        .column("window mesh", of(Cause::WindowMesh))
        .column("loading path", of(Cause::LoadingPath))
        .column("load: error", |sheet| percent(sheet.load))
        .column("load: sigma", |sheet| percent(sheet.seen().load));
    table.markdown(sheets)
}

/// How often errors are within two standard deviations, for the sums of several causes.
fn coverages(sheets: &[Judged]) -> String {
    type Pairs = fn(&Judged, &Effect) -> Vec<[f64; 2]>;
    let seen: Vec<Cause> = Cause::ALL
        .into_iter()
        .filter(|cause| cause.is_seen_by_elements())
        .collect();
    let single = seen.iter().map(|cause| vec![*cause]);
    let rows: Vec<Vec<Cause>> = std::iter::once(seen.clone()).chain(single).collect();
    let names = |causes: &Vec<Cause>| {
        let names: Vec<&str> = causes.iter().map(|cause| cause.name()).collect();
        names.join(", ")
    };
    let coverage = |causes: &[Cause], pairs: Pairs| {
        Coverage::of(sheets.iter().flat_map(|sheet| {
            let effect = sheet.budget.sum(|cause| causes.contains(&cause));
            pairs(sheet, &effect)
        }))
    };
    let quantities: [(&str, &str, Pairs); 3] = [
        ("corners of a sheet, rms", "sheets", |sheet, effect| {
            let [rms, _] = rms_and_maximum(sheet.corners.iter().copied());
            vec![[rms, effect.corners[0]]]
        }),
        ("single corners", "corners", |sheet, effect| {
            let corners = std::iter::zip(&sheet.corners, &effect.by_corner);
            corners.map(|(error, sigma)| [*error, *sigma]).collect()
        }),
        ("load", "loads", |sheet, effect| {
            let pair = sheet.load.zip(effect.load);
            Vec::from_iter(pair.map(|(error, sigma)| [error, sigma]))
        }),
    ];
    let mut table = Table::new().column("causes", move |causes: &Vec<Cause>| {
        Cell::text(names(causes))
    });
    for (quantity, all, pairs) in quantities {
        table = table
            .column(quantity, move |causes| {
                let Coverage { within, of } = coverage(causes, pairs);
                Cell::percent(within as f64 / of as f64, 0)
            })
            .column(all, move |causes| Cell::text(coverage(causes, pairs).of));
    }
    table.markdown(&rows)
}

impl Coverage {
    /// Of pairs (error, standard deviation); the corners of a clamped panel, which have none, do not count.
    fn of(pairs: impl Iterator<Item = [f64; 2]>) -> Self {
        let mut coverage = Self::default();
        for [error, sigma] in pairs.filter(|[_, sigma]| *sigma > 0.0) {
            coverage.of += 1;
            coverage.within += usize::from(error.abs() <= 2.0 * sigma);
        }
        coverage
    }
}
