//! The data of the page.

use crate::deployment_states::kept;
use crate::mounting_kit::steps_svg;
use crate::report::{BUDGET_HEADING, Fact, HingeRow, Report, Warning, extent, miss, worst_first};
use crate::run_page::hinge_states::HingeStates;
use crate::run_page::packed::Packed;
use analysis::levels::Levels;
use analysis::unit::Unit;
use design::geometry::region::Contour;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::objective::loss::Objective;
use design::objective::scores::outline_error;
use design::objective::term::in_words;
use design::optimise::outer_loop::StepRecord;
use design::sheet::cut_sheet::Sheet;
use design::sheet::topology::PanelCorner;
use hinge::TrainingDomain;
use scene::design_run::Designed;
use scene::placement::seen;
use scene::{Actuation, Scene};
use serde::Serialize;
use support::table::Table;
use surrogate::Surrogate;

/// Maximum number of steps in the history of the objective, and of points on the target.
const MOST_POINTS: usize = 1500;
/// Maximum length of the text of the scene: a start with many panels is cut off.
const MOST_TEXT: usize = 20_000;

/// Everything that the page of a run shows.
#[derive(Serialize)]
pub struct PageData<'a> {
    title: &'a str,
    about_cut_files: Option<&'static str>,
    end_of_search: String,
    facts: &'a [Fact],
    budget: Option<BudgetTable>,
    warnings: &'a [Warning],
    /// The steps in which a mounted sheet is opened, as SVG.
    mounting: Option<String>,
    scene: String,
    history: History,
    /// What moves the sheet, and the units of displacement and load.
    stroke: Option<(&'a str, [Unit; 2])>,
    /// Displacement and load at the maximum of the load, if a displacement is prescribed.
    peak: Option<[f64; 2]>,
    /// The hinge nearest to failure.
    worst: usize,
    /// What the levels cost, if they were measured.
    levels: Option<&'a Levels>,
    #[serde(flatten)]
    sheet: SheetData<'a>,
}

/// A sheet with its states: what the page draws.
#[derive(Serialize)]
pub struct SheetData<'a> {
    /// Whether the hinges carry load; otherwise they are pins.
    carries_load: bool,
    /// How far the outline is from the target, in words.
    miss: String,
    panels: Panels,
    hinges: Hinges,
    states: HingeStates,
    actuation: Actuation,
    /// Closed outlines: of the flat sheet, of the target and of its holes (mm).
    outlines: Vec<Contour>,
    target: Packed,
    holes: Vec<Packed>,
    /// The training domain of the hinge law.
    domain: Option<&'a TrainingDomain>,
}

/// The error budget: what it is, its table, and what it leaves out.
#[derive(Serialize)]
struct BudgetTable {
    heading: &'static str,
    table: Table,
    left_out: String,
}

/// The objective along the search; its terms are weighted, so that their sum is the loss (mm^2).
#[derive(Serialize)]
pub struct History {
    step: Vec<usize>,
    loss: Vec<f64>,
    outline_error: Vec<f64>,
    terms: Vec<(String, Vec<f64>)>,
}

#[derive(Serialize)]
struct Panels {
    /// [column, row] of every panel.
    places: Vec<[usize; 2]>,
    /// Corners SW, SE, NE, NW of the cell of every panel (mm).
    corners: Packed,
    /// The panels that are not their cells, and their boundaries (mm).
    trimmed: Vec<(usize, Packed)>,
    /// The corners whose distances from the target are known, around a sheet of all cells.
    outline: Vec<PanelCorner>,
    /// The reference point of every panel's rotation (mm).
    references: Packed,
}

#[derive(Serialize)]
struct Hinges {
    /// Panel A and its corner, panel B and its corner, of every hinge.
    sites: Vec<[usize; 4]>,
    w_lig: Packed,
    alpha_deg: Packed,
    fillet_ratio: Packed,
    gamma: Packed,
    /// Maxima along the path; NaN if not known or not predicted.
    damage: Packed,
    damage_peak: Packed,
    /// Radius of the windows (mm).
    r_win: f64,
}

impl<'a> PageData<'a> {
    /// The data of a run, or of the start of a search.
    pub fn new(scene: &'a Scene, designed: &'a Designed, report: &'a Report) -> Self {
        let deployment = &designed.best.deployment;
        let reached = report.reached.as_ref();
        let worst = report.hinges.iter().min_by(|one, other| worst_first(one, other));
        Self {
            title: &report.title,
            about_cut_files: report.about_cut_files(),
            end_of_search: report.end_of_search(),
            facts: &report.facts,
            budget: report.budget.as_ref().map(|budget| BudgetTable {
                heading: BUDGET_HEADING,
                table: budget.table(),
                left_out: budget.left_out(),
            }),
            warnings: &report.warnings,
            mounting: (report.mounting.as_ref())
                .map(|mounting| steps_svg(&deployment.sheet, mounting)),
            scene: scene_text(scene),
            history: History::new(&designed.problem.objective, &designed.search.history),
            stroke: reached.map(|reached| (reached.stroke_of.as_str(), reached.units)),
            peak: reached
                .and_then(|reached| reached.peak)
                .map(|peak| [peak.displacement, peak.load]),
            worst: worst.map_or(0, |row| row.hinge),
            levels: report.checks.levels.as_ref(),
            sheet: SheetData::with_hinges(
                scene,
                &designed.problem,
                deployment,
                scene.networks(),
                &report.hinges,
            ),
        }
    }
}

impl<'a> SheetData<'a> {
    /// A sheet with the states of a deployment, without the spread of the scene's networks.
    pub fn new(scene: &'a Scene, problem: &DesignProblem, deployment: &Deployment) -> Self {
        let rows = HingeRow::all(scene, deployment);
        Self::with_hinges(scene, problem, deployment, &[], &rows)
    }

    fn with_hinges(
        scene: &'a Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
        networks: &[Surrogate],
        rows: &[HingeRow],
    ) -> Self {
        let sheet = &deployment.sheet;
        let drawn = |points: &Vec<[f64; 2]>| -> Packed {
            (kept(points.len(), MOST_POINTS).into_iter()).flat_map(|i| points[i]).collect()
        };
        Self {
            carries_load: scene.hinge.carries_load(),
            miss: miss(
                seen(scene, deployment),
                outline_error(&problem.objective, deployment),
                extent(sheet.outlines().into_iter().flatten()),
            ),
            panels: Panels::new(sheet),
            hinges: Hinges::new(sheet, rows),
            states: HingeStates::new(scene, problem, deployment, networks),
            actuation: scene.actuation(),
            outlines: sheet.outlines(),
            target: drawn(&scene.target.points),
            holes: scene.target.holes.iter().map(drawn).collect(),
            domain: scene.surrogate().map(|surrogate| surrogate.domain()),
        }
    }
}

/// The keys of the scene as TOML.
fn scene_text(scene: &Scene) -> String {
    let mut text = scene.config.to_toml().unwrap_or_else(|error| error.to_string());
    if text.len() > MOST_TEXT {
        text.truncate(text.floor_char_boundary(MOST_TEXT));
        text += "\n# ... the scene file contains the rest\n";
    }
    text
}

impl History {
    /// The history of a search, its first and last steps and those between them at equal distances.
    pub fn new(objective: &Objective, records: &[StepRecord]) -> Self {
        let index = kept(records.len(), MOST_POINTS);
        let of = |value: &dyn Fn(&StepRecord) -> f64| -> Vec<f64> {
            index.iter().map(|&i| value(&records[i])).collect()
        };
        let terms = objective.weights().filter(|(.., weight)| *weight != 0.0);
        let terms = terms.map(|(name, _, weight)| {
            let value = |record: &StepRecord| weight * record.scores.terms[name];
            (in_words(name), of(&value))
        });
        Self {
            step: index.iter().map(|&i| records[i].step).collect(),
            loss: of(&|record| record.scores.loss),
            outline_error: of(&|record| record.scores.outline_error),
            terms: terms.collect(),
        }
    }
}

impl Panels {
    fn new(sheet: &Sheet) -> Self {
        let panels = || sheet.panels.iter();
        Self {
            places: sheet.topology.places.clone(),
            corners: panels().flat_map(|panel| panel.corners).flatten().collect(),
            trimmed: (panels().enumerate())
                .filter(|(_, panel)| panel.is_trimmed())
                .map(|(k, panel)| (k, panel.boundary.iter().flatten().copied().collect()))
                .collect(),
            outline: if sheet.topology.is_full() {
                sheet.free_outline_corners()
            } else {
                Vec::new()
            },
            references: panels().flat_map(|panel| panel.reference).collect(),
        }
    }
}

impl Hinges {
    fn new(sheet: &Sheet, rows: &[HingeRow]) -> Self {
        let known = |damage: Option<f64>| damage.unwrap_or(f64::NAN);
        Self {
            sites: (sheet.hinges.iter())
                .map(|hinge| [hinge.site.a, hinge.site.b].map(|(k, corner)| [k, corner]))
                .map(|[[a, at_a], [b, at_b]]| [a, at_a, b, at_b])
                .collect(),
            w_lig: rows.iter().map(|row| row.w_lig).collect(),
            alpha_deg: rows.iter().map(|row| row.alpha_deg).collect(),
            fillet_ratio: sheet.designs().iter().map(|g| g.fillet_ratio).collect(),
            gamma: rows.iter().map(|row| row.gamma.unwrap_or(f64::NAN)).collect(),
            damage: rows.iter().map(|row| known(row.damage)).collect(),
            damage_peak: rows.iter().map(|row| known(row.damage_peak)).collect(),
            r_win: sheet.options.process.r_win,
        }
    }
}
