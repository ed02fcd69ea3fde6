//! The data of the page.

use crate::{
    deployment_states::kept,
    mounting_kit::steps_svg,
    report::{BUDGET_HEADING, HingeRow, Report, extent, miss, worst_first},
    run_page::{hinge_states::hinge_states, packed::packed},
};
use design::{
    objective::{
        design_problem::{Deployment, DesignProblem},
        loss::Objective,
        scores::outline_error,
        term::in_words,
    },
    optimise::outer_loop::StepRecord,
    sheet::cut_sheet::Sheet,
};
use scene::{Scene, design_run::Designed, placement::seen};
use serde_json::{Value, json};
use surrogate::Surrogate;

/// Maximum number of steps in the history of the objective, and of points on the target.
const MOST_POINTS: usize = 1500;
/// Maximum length of the text of the scene: a start with many panels is cut off.
const MOST_TEXT: usize = 20_000;

/// Everything that the page of a run shows, or of the start of a search.
pub fn page_data(scene: &Scene, designed: &Designed, report: &Report) -> Value {
    let (problem, deployment) = (&designed.problem, &designed.best.deployment);
    let reached = report.reached.as_ref();
    let peak = reached.and_then(|reached| reached.peak);
    let worst = report.hinges.iter().min_by(|one, other| worst_first(one, other));
    let mut data = with_hinges(scene, problem, deployment, scene.networks(), &report.hinges);
    let of_run = json!({
        "title": report.title,
        "about_cut_files": report.about_cut_files(),
        "end_of_search": report.end_of_search(),
        "facts": report.facts,
        // The error budget: what it is, its table, and what it leaves out.
        "budget": report.budget.as_ref().map(|budget| json!({
            "heading": BUDGET_HEADING, "table": budget.table(), "left_out": budget.left_out(),
        })),
        "warnings": report.warnings,
        // The steps in which a mounted sheet is opened, as SVG.
        "mounting": report.mounting.as_ref().map(|it| steps_svg(&deployment.sheet, it)),
        "scene": scene_text(scene),
        "history": history(&problem.objective, &designed.history()),
        // What moves the sheet, and the units of displacement and load.
        "stroke": reached.map(|reached| (&reached.stroke_of, reached.units)),
        // Displacement and load at the maximum of the load, if a displacement is prescribed.
        "peak": peak.map(|peak| [peak.displacement, peak.load]),
        // The hinge nearest to failure.
        "worst": worst.map_or(0, |row| row.hinge),
        // What the levels cost, if they were measured.
        "levels": report.checks.levels,
    });
    if let (Value::Object(data), Value::Object(of_run)) = (&mut data, of_run) {
        data.extend(of_run);
    }
    data
}

/// A sheet with the states of a deployment, which is what the page draws, without the spread of the
/// scene's networks.
pub fn sheet_data(scene: &Scene, problem: &DesignProblem, deployment: &Deployment) -> Value {
    with_hinges(scene, problem, deployment, &[], &HingeRow::all(scene, deployment))
}

fn with_hinges(
    scene: &Scene,
    problem: &DesignProblem,
    deployment: &Deployment,
    networks: &[Surrogate],
    rows: &[HingeRow],
) -> Value {
    let (sheet, target) = (&deployment.sheet, &scene.target);
    let drawn = |points: &Vec<[f64; 2]>| {
        packed(kept(points.len(), MOST_POINTS).into_iter().flat_map(|i| points[i]))
    };
    let size = extent(sheet.outlines().into_iter().flatten());
    json!({
        // Whether the hinges carry load; otherwise they are pins.
        "carries_load": scene.hinge.carries_load(),
        // How far the outline is from the target, in words.
        "miss": miss(
            seen(scene, deployment), outline_error(&problem.objective, deployment), size,
        ),
        "panels": panels(sheet),
        "hinges": hinges(sheet, rows),
        "states": hinge_states(scene, problem, deployment, networks),
        "actuation": scene.actuation(),
        // Closed outlines: of the flat sheet, of the target and of its holes (mm).
        "outlines": sheet.outlines(),
        "target": drawn(&target.points),
        "holes": target.holes.iter().map(drawn).collect::<Vec<_>>(),
        // The training domain of the hinge law.
        "domain": scene.surrogate().map(Surrogate::domain),
    })
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

/// The objective along a search, in its first and last steps and those between them at equal
/// distances; its terms are weighted, so that their sum is the loss (mm^2).
pub fn history(objective: &Objective, records: &[StepRecord]) -> Value {
    let index = kept(records.len(), MOST_POINTS);
    let of = |value: &dyn Fn(&StepRecord) -> f64| -> Vec<f64> {
        index.iter().map(|&i| value(&records[i])).collect()
    };
    let terms = objective.weights().filter(|(.., weight)| *weight != 0.0);
    let terms = terms.map(|(name, _, weight)| {
        let value = |record: &StepRecord| weight * record.scores.terms[name];
        (in_words(name), of(&value))
    });
    json!({
        "step": index.iter().map(|&i| records[i].step).collect::<Vec<_>>(),
        "loss": of(&|record| record.scores.loss),
        "outline_error": of(&|record| record.scores.outline_error),
        "terms": terms.collect::<Vec<_>>(),
    })
}

fn panels(sheet: &Sheet) -> Value {
    let panels = || sheet.panels.iter();
    let trimmed = panels().enumerate().filter(|(_, panel)| panel.is_trimmed());
    let trimmed = trimmed.map(|(k, panel)| (k, packed(panel.boundary.concat())));
    let outline = if sheet.topology.is_full() { sheet.free_outline_corners() } else { Vec::new() };
    json!({
        // [column, row] of every panel.
        "places": sheet.topology.places,
        // Corners SW, SE, NE, NW of the cell of every panel (mm).
        "corners": packed(panels().flat_map(|panel| panel.corners).flatten()),
        // The panels that are not their cells, and their boundaries (mm).
        "trimmed": trimmed.collect::<Vec<_>>(),
        // The corners whose distances from the target are known, around a sheet of all cells.
        "outline": outline,
        // The reference point of every panel's rotation (mm).
        "references": packed(panels().flat_map(|panel| panel.reference)),
    })
}

fn hinges(sheet: &Sheet, rows: &[HingeRow]) -> Value {
    let of = |value: fn(&HingeRow) -> Option<f64>| {
        packed(rows.iter().map(|row| value(row).unwrap_or(f64::NAN)))
    };
    let sites = sheet.hinges.iter().map(|hinge| (hinge.site.a, hinge.site.b));
    json!({
        // Panel A and its corner, panel B and its corner, of every hinge.
        "sites": sites.map(|((a, at_a), (b, at_b))| [a, at_a, b, at_b]).collect::<Vec<_>>(),
        "w_lig": of(|row| Some(row.w_lig)),
        "alpha_deg": of(|row| Some(row.alpha_deg)),
        "fillet_ratio": packed(sheet.designs().iter().map(|g| g.fillet_ratio)),
        // Maxima along the path; NaN if not known or not predicted.
        "damage": of(|row| row.damage),
        "damage_peak": of(|row| row.damage_peak),
        // Radius of the windows (mm).
        "r_win": sheet.options.process.r_win,
    })
}
