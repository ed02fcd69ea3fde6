//! The tables and the chart of `kirigami-studies sheet`.

use super::{Difference, Row};
use crate::charts::{self, CostPanel};
use anyhow::{Context, Result};
use kirigami::ui::picture;
use std::fmt::Write;
use std::path::Path;
use surrogate::Surrogate;

/// The studies and their definitions.
const STUDIES: [(&str, &str); 5] = [
    (
        "tolerance",
        "residual of an equilibrium, relative to the maximum force",
    ),
    (
        "load steps",
        "number N of load steps; the deployed shape does not depend on it, the path functionals do",
    ),
    (
        "method",
        "Newton on the sparse tangent, or L-BFGS as in the paper",
    ),
    ("hinge law", "model of the energy of a ligament"),
    ("hinge point", "point at which the learned law measures (8)"),
];

pub fn write(out: &Path, rows: &[Row], weights: &Surrogate) -> Result<()> {
    let save = |name: &str, text: String| {
        let path = out.join(name);
        support::whole_file::write(&path, text.as_bytes())
            .with_context(|| format!("cannot write {}", path.display()))
    };
    save("sheet.csv", csv(rows))?;
    save("sheet.md", markdown(rows, weights)?)?;
    save("tradeoff.md", tradeoff(rows)?)?;
    let pictures = picture::save(&charts::costs(&panels(rows))?, &out.join("sheet"), 1600)?;
    println!("{} choices; {}", rows.len(), pictures[1].display());
    Ok(())
}

/// Difference from the first row of the same scene and study.
fn difference(row: &Row, rows: &[Row]) -> Difference {
    let same = |other: &&Row| other.scene == row.scene && other.study == row.study;
    let reference = rows.iter().find(same).unwrap_or(row);
    row.found.difference(&reference.found)
}

fn csv(rows: &[Row]) -> String {
    let mut text = "scene,study,value,equilibrium_ms,with_gradient_ms,iterations,status,\
        shape_over_panel,opening_deg,gradient\n"
        .to_owned();
    for row in rows {
        let Difference {
            shape,
            opening_deg,
            gradient,
        } = difference(row, rows);
        let [equilibrium, with_gradient] = row.seconds.map(|seconds| 1e3 * seconds);
        let (scene, study, value) = (row.scene, row.study, &row.value);
        text += &format!(
            "\"{scene}\",{study},\"{value}\",{equilibrium:.3},{with_gradient:.3},{},{:?},\
             {shape:.3e},{opening_deg:.3e},{gradient:.3e}\n",
            row.iterations, row.status
        );
    }
    text
}

fn markdown(rows: &[Row], weights: &Surrogate) -> Result<String> {
    let card = weights.card();
    let mut text = format!(
        "# Cost and error of the sheet's choices\n\n\
         The scenes `a4-polyester` and `linear-7x7`, from a random start and without the damage term. The \
         learned hinges are of the material {}, window tier {}, database {:.12}, error of W {:.1} % \
         (root mean square, test rows). Differences are relative to the first row of each table: of the panel \
         corners (root mean square after the best rigid motion, relative to the size of a panel), of the \
         opening of a hinge (maximum) and of the gradient in the pattern (relative). Costs are \
         CPU time of one thread. The kernels compute in float64 only, so there is \
         no float32 row.\n",
        card.material,
        card.tier,
        card.dataset_hash,
        100.0 * card.test_errors.energy.relative_rmse
    );
    for (study, about) in STUDIES {
        let mut scene = "";
        for row in rows.iter().filter(|row| row.study == study) {
            if row.scene != scene {
                scene = row.scene;
                write!(
                    text,
                    "\n## {study}, {scene}\n\n{about}\n\n| choice | equilibrium, ms | with gradient, \
                     ms | iterations | status | shape | opening, deg | gradient |\n\
                     |---|---|---|---|---|---|---|---|\n"
                )?;
            }
            let [equilibrium, with_gradient] = row.seconds.map(|seconds| 1e3 * seconds);
            let Difference {
                shape,
                opening_deg,
                gradient,
            } = difference(row, rows);
            writeln!(
                text,
                "| {} | {equilibrium:.2} | {with_gradient:.2} | {} | {:?} | {shape:.1e} | \
                 {opening_deg:.1e} | {gradient:.1e} |",
                row.value, row.iterations, row.status
            )?;
        }
    }
    Ok(text)
}

/// One table for both scenes: cost, error, use.
fn tradeoff(rows: &[Row]) -> Result<String> {
    let mut text = "## The sheet's equilibrium\n\n\
        Details: [sheet](results/sheet/sheet.md). Errors are differences from the first row of each kind: of the \
        deployed corners, relative to the size of a panel, and of the gradient.\n\n\
        | choice | scene | cost with gradient, ms | shape | gradient | good for |\n\
        |---|---|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let Some(good_for) = good_for(row.study, &row.value) else {
            continue;
        };
        let found = difference(row, rows);
        writeln!(
            text,
            "| {} {} | {} | {:.2} | {:.1e} | {:.1e} | {good_for} |",
            row.study,
            row.value,
            row.scene,
            1e3 * row.seconds[1],
            found.shape,
            found.gradient
        )?;
    }
    Ok(text)
}

/// The recommended use of the choices in the short table.
fn good_for(study: &str, value: &str) -> Option<&'static str> {
    Some(match (study, value) {
        ("tolerance", "1e-10") => "the default",
        ("tolerance", "1e-4") => "a first look",
        ("load steps", "20") => "path functionals",
        ("load steps", "5") => "shape alone",
        ("method", "Newton, 1e-8") => "every use",
        ("method", "L-BFGS, 1e-8") => "comparison with the paper",
        ("hinge law", "surrogate") => "the final design: folding, yielding, damage",
        ("hinge law", "linear, secant at 20 deg") => "exploring with the weights' stiffness",
        ("hinge law", "pin, mean opening") => "exploring patterns by kinematics",
        ("hinge point", "corner") => "comparison with the paper",
        _ => return None,
    })
}

/// One panel per study: the error of the gradient against the cost.
fn panels(rows: &[Row]) -> Vec<CostPanel> {
    let of_study = |study: &'static str| {
        let points = rows.iter().filter(|row| row.study == study).map(|row| {
            let cost = 1e3 * row.seconds[1];
            (
                row.scene,
                row.value.clone(),
                cost,
                difference(row, rows).gradient,
            )
        });
        CostPanel {
            title: study,
            points: points.collect(),
        }
    };
    STUDIES.iter().map(|(study, _)| of_study(study)).collect()
}
