//! The tables and pictures of `kirigami-studies polyester`.

use super::Row;
use super::objective_front::Front;
use crate::charts::{self, PathPanel};
use anyhow::Result;
use design::sheet::cut_sheet::HingePoint;
use kirigami::ui::{picture, run_folder};
use mesher::Tier;
use std::fmt::Write;
use std::path::Path;
use surrogate::Surrogate;
use verification::RecordedPath;

/// The paper's numbers for the same sheet: shape alone, and with both functionals.
const PAPER: [(&str, &str, &str); 11] = [
    ("ligaments, mm", "17.4 +- 2.4", "21.6 +- 0.7"),
    (
        "panel areas relative to the uniform sheet",
        "",
        "0.8 to 3.2",
    ),
    ("fraction of tension", "43 %", "53 %"),
    ("fraction of compression", "16.9 %", "10.6 %"),
    ("interfaces in tension", "7 of 12", "8 of 12"),
    ("maximum compression, N", "13.9", "6.9"),
    ("peak force, N", "23.9", "25.8"),
    ("mean force, N", "10.2", "7.2"),
    ("path samples inside the domain", "60.2 %", "95.9 %"),
    ("minimum eta_a", "-0.711", "-0.175"),
    (
        "mean over the hinges of the maximum damage, D_s",
        "0.175",
        "0.033",
    ),
];

pub(super) fn write(
    out: &Path,
    rows: &[Row],
    surrogate: &Surrogate,
    tier: Tier,
    front: &Front,
) -> Result<()> {
    let page = markdown(rows, surrogate, tier, front)?;
    picture::save(&front.chart, &out.join("front"), 1200)?;
    run_folder::write(out, "polyester.md", &page)?;
    run_folder::write(out, "polyester.csv", &csv(rows)?)?;
    let panels: Vec<PathPanel> = rows
        .iter()
        .map(|row| PathPanel {
            title: format!("{}, {}", name(row.point), row.objective),
            paths: row.paths.iter().map(eta).collect(),
            monitored: row.monitored,
            domain: domain_slice(surrogate, row),
            damage: damage_plane(surrogate, row),
        })
        .collect();
    picture::save(&charts::hinge_paths(&panels)?, &out.join("polyester"), 1700)?;
    for (k, row) in rows.iter().enumerate() {
        let svg = std::fs::read_to_string(row.folder.join("deployed.svg"))?;
        picture::save(&svg, &out.join(format!("deployed-{}", k + 1)), 1000)?;
    }
    println!("{page}\nwritten to {}", out.display());
    Ok(())
}

fn name(point: HingePoint) -> &'static str {
    match point {
        HingePoint::CutTip => "at the cut's tip",
        HingePoint::Corner => "at the corner",
    }
}

/// (eta_a, eta_s) of every state.
fn eta(path: &RecordedPath) -> Vec<[f64; 2]> {
    let states = path.states.iter();
    states.map(|state| state.eta(path.design.w_lig)).collect()
}

/// D / D_s over (eta_a, eta_s) for the design and the final opening of the monitored hinge.
fn damage_plane(surrogate: &Surrogate, row: &Row) -> Box<dyn Fn([f64; 2]) -> f64> {
    let (surrogate, path) = (surrogate.clone(), row.paths[row.monitored].clone());
    Box::new(move |[eta_a, eta_s]| {
        let (design, theta) = (path.design, path.end().theta);
        let state = hinge::HingeDeformation::from_eta(eta_a, eta_s, theta, design.w_lig);
        surrogate.damage(&[design], &[state])[0].d / surrogate.damage_scale()
    })
}

/// The boundary of the training domain for the design and the final opening of the monitored hinge.
fn domain_slice(surrogate: &Surrogate, row: &Row) -> Vec<[f64; 2]> {
    let path = &row.paths[row.monitored];
    surrogate
        .domain()
        .slice(path.design.w_lig, path.end().theta)
}

/// The quantities of the table, in the order of [`PAPER`].
fn quantities(row: &Row) -> [String; 11] {
    let count = row.w_lig.len() as f64;
    let mean = row.w_lig.iter().sum::<f64>() / count;
    let squares = row.w_lig.iter().map(|w| (w - mean).powi(2)).sum::<f64>();
    let min = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
    let max = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::NEG_INFINITY, f64::max);
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let tension = row.forces.iter().filter(|[normal, _]| *normal > 0.0);
    let etas = row.paths.iter().flat_map(eta).map(|[eta_a, _]| eta_a);
    [
        format!("{mean:.1} +- {:.1}", (squares / count).sqrt()),
        format!(
            "{:.2} to {:.2}",
            min(&mut row.areas.iter().copied()),
            max(&mut row.areas.iter().copied())
        ),
        percent(row.shares.tension),
        percent(row.shares.compression),
        format!("{} of {}", tension.count(), row.forces.len()),
        format!(
            "{:.1}",
            -min(&mut row.forces.iter().map(|[normal, _]| *normal)).min(0.0)
        ),
        format!(
            "{:.1}",
            max(&mut row.forces.iter().map(|[_, force]| *force))
        ),
        format!(
            "{:.1}",
            row.forces.iter().map(|[_, force]| force).sum::<f64>() / count
        ),
        percent(row.share_inside),
        format!("{:.3}", min(&mut etas.collect::<Vec<_>>().into_iter())),
        mean_damage(&row.damage),
    ]
}

/// The mean over the hinges whose damage is known, and their number.
fn mean_damage(damage: &[Option<f64>]) -> String {
    let known: Vec<f64> = damage.iter().copied().flatten().collect();
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    match known.len() {
        0 => "not known".into(),
        all if all == damage.len() => format!("{mean:.3}"),
        some => format!("{mean:.3} ({some} of {})", damage.len()),
    }
}

fn markdown(rows: &[Row], surrogate: &Surrogate, tier: Tier, front: &Front) -> Result<String> {
    let mut text = format!(
        "# The polyester sheet with the learned hinge\n\nThe load is that at which the maximum hinge opening of the uniform \
         sheet is the given angle. Weights: hash {}. `kirigami-studies polyester`.\n\n| |",
        &surrogate.hash()[..16]
    );
    for row in rows {
        write!(text, " {}, {} |", name(row.point), row.objective)?;
    }
    text += " paper, shape alone | paper, with both |\n|---|";
    text += &"---|".repeat(rows.len() + 2);
    text += "\n| load, relative to the scene's |";
    for row in rows {
        write!(text, " {:.3} |", row.load)?;
    }
    text += " 27.85 N | |\n| outline error, start to design, mm |";
    for row in rows {
        let [before, after] = row.outline;
        write!(text, " {before:.1} to {after:.1} |")?;
    }
    text += " | |\n| maximum opening, deg |";
    for row in rows {
        let openings = row.paths.iter().map(|path| path.end().theta.to_degrees());
        write!(text, " {:.1} |", openings.fold(0.0, f64::max))?;
    }
    text += " | |\n";
    let columns: Vec<_> = rows.iter().map(quantities).collect();
    for (k, (quantity, alone, both)) in PAPER.iter().enumerate() {
        write!(text, "| {quantity} |")?;
        for column in &columns {
            write!(text, " {} |", column[k])?;
        }
        writeln!(text, " {alone} | {both} |")?;
    }
    writeln!(
        text,
        "\n## Finite-element solve of the monitored hinge\n\nThe hinge with the largest damage in the design for \
         shape alone, on its path in each sheet, windows of tier {tier}.\n\n| design | hinge | opening, deg | | W, N \
         mm | M, N mm | D | D_peak |\n|---|---|---|---|---|---|---|---|"
    )?;
    for row in rows {
        let opening = row.paths[row.monitored].end().theta.to_degrees();
        let design = format!("{}, {}", name(row.point), row.objective);
        let mut line = |by: &str, [w, m, d, peak]: [f64; 4]| {
            writeln!(
                text,
                "| {design} | {} | {opening:.1} | {by} | {w:.2} | {m:.1} | {d:.5} | {peak:.4} |",
                row.monitored
            )
        };
        line("surrogate", row.learned)?;
        match row.replayed {
            Some(values) => line("finite elements", values)?,
            None => writeln!(
                text,
                "| {design} | {} | {opening:.1} | not solved by finite elements | - | - | - | - |",
                row.monitored
            )?,
        }
    }
    text += &front.table;
    text += "\n![damage against outline error](front.png)\n\nMedians of the swept weights; along a line the weight of the \
             compression grows.\n";
    text += "\n## Deployed\n\n";
    for (k, row) in rows.iter().enumerate() {
        let design = format!("{}, {}", name(row.point), row.objective);
        writeln!(text, "![{design}](deployed-{}.png)\n{design}\n", k + 1)?;
    }
    text += "\n![paths of the hinges](polyester.png)\n\nThe paths of all hinges, the monitored one \
             as a thick line, over the predicted damage of the monitored hinge at its final opening. The \
             frame is the training domain.\n";
    Ok(text)
}

/// One row per hinge of a design.
fn csv(rows: &[Row]) -> Result<String> {
    let mut text =
        "point,objective,hinge,w_lig_mm,theta_deg,eta_a,eta_s,f_n,force,damage_over_ds\n"
            .to_owned();
    for row in rows {
        for (hinge, path) in row.paths.iter().enumerate() {
            let end = path.end();
            let [eta_a, eta_s] = end.eta(path.design.w_lig);
            let [normal, force] = row.forces[hinge];
            writeln!(
                text,
                "{},{},{hinge},{:.4},{:.4},{eta_a:.5},{eta_s:.5},{normal:.4},{force:.4},{}",
                name(row.point),
                row.objective,
                row.w_lig[hinge],
                end.theta.to_degrees(),
                row.damage[hinge].map_or(String::new(), |d| format!("{d:.6}"))
            )?;
        }
    }
    Ok(text)
}
