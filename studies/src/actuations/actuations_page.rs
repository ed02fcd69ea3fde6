//! The tables of `kirigami-studies actuations`.

use super::drive_readings::READINGS;
use super::{Case, boundary_error};
use anyhow::{Context, Result};
use design::analysis::void_families::VoidFamilies;
use design::sheet::validity::total_overlap;
use std::fmt::Write;
use std::path::Path;

/// Table 1 of the paper: drive (N), rotational fraction of the energy, non-rotational fraction in the
/// quarter of interfaces with the largest force, fraction of compression in the force (%).
const PAPER: [[f64; 4]; 5] = [
    [495.0, 98.6, 4.3, 12.0],
    [325.0, 99.2, 2.6, 11.0],
    [211.0, 99.5, 1.6, 16.0],
    [232.0, 99.2, 2.6, 10.0],
    [1723.0, 89.6, 22.4, 16.0],
];
/// Minimum number of panels of the paths whose arc over chord is evaluated.
const ROUTE: usize = 4;

/// The reported numbers of a case.
struct Numbers {
    /// Fractions in %.
    rotation: f64,
    non_rotational: f64,
    tension: f64,
    compression: f64,
    shear: f64,
    boundary_start: f64,
    boundary: f64,
    boundary_shape_alone: f64,
    /// Relative to the area of the sheet.
    overlap: f64,
    /// Mean and minimum opening (deg).
    opening: [f64; 2],
    rank_correlation: f64,
    clustering: f64,
    /// Panels of the longest tension path, and the mean arc over chord of the longer paths.
    longest_route: usize,
    arc_over_chord: Option<f64>,
    /// Mean area of the panels that carry the largest moment, relative to the median: moment of interfaces, of springs
    /// and of forces.
    moment_panels: [f64; 3],
    /// Work of the couples relative to that of all loads (%).
    couple: f64,
    /// Weights of (18) and (19) (mm^2).
    weights: [f64; 2],
}

impl Numbers {
    fn of(case: &Case) -> Self {
        let (loads, deployment) = (&case.scene.config.loads, &case.designed.best.deployment);
        let last = deployment.final_step();
        let (mut by_forces, mut by_couples) = (0.0, 0.0);
        for load in loads {
            let [column, row] = load.panel;
            let [x, y, phi] = last.configuration[row * deployment.sheet.grid.m + column];
            by_forces += load.force[0] * x + load.force[1] * y;
            by_couples += load.couple * phi;
        }
        let shares = case.transmission.shares();
        let openings = || {
            last.deformations
                .iter()
                .map(|state| state.theta.to_degrees())
        };
        // A ring has no chord.
        let bent: Vec<f64> = (case.routes.iter())
            .filter(|route| route.panels.len() >= ROUTE)
            .map(|route| route.arc_over_chord(&case.transmission))
            .filter(|ratio| ratio.is_finite())
            .collect();
        let start = case
            .designed
            .history
            .first()
            .map_or(f64::NAN, |step| step.scores.outline_error);
        Self {
            rotation: 100.0 * shares.rotation,
            non_rotational: 100.0 * shares.non_rotational,
            tension: 100.0 * shares.tension,
            compression: 100.0 * shares.compression,
            shear: 100.0 * shares.shear,
            boundary_start: 100.0 * start / case.scene.target.width(),
            boundary: 100.0 * boundary_error(&case.scene, &case.designed),
            boundary_shape_alone: 100.0 * case.shape_alone,
            overlap: total_overlap(&deployment.sheet, &last.configuration),
            opening: [
                openings().sum::<f64>() / last.deformations.len() as f64,
                openings().fold(f64::INFINITY, f64::min),
            ],
            rank_correlation: case.transmission.rank_correlation(),
            clustering: case.transmission.clustering(),
            longest_route: case.routes.first().map_or(0, |route| route.panels.len()),
            arc_over_chord: (!bent.is_empty())
                .then(|| bent.iter().sum::<f64>() / bent.len() as f64),
            moment_panels: [
                case.transmission.moment_panels(|moment| moment.interfaces),
                case.transmission.moment_panels(|moment| moment.springs),
                case.transmission.moment_panels(|moment| moment.forces),
            ],
            couple: 100.0 * by_couples / (by_forces + by_couples),
            weights: ["compression", "shear"].map(|name| case.objective.weight(name)),
        }
    }
}

pub fn page(cases: &[Case], families: &VoidFamilies, scenes: &Path) -> Result<String> {
    let numbers: Vec<Numbers> = cases.iter().map(Numbers::of).collect();
    let scene = &cases.first().context("no case")?.scene;
    let ([columns, rows], [width, height]) = (
        scene.config.sheet.panels,
        scene.config.sheet.size.unwrap_or_default(),
    );
    let mut text = format!(
        "# One sheet, five actuations\n\n\
        {columns} x {rows} panels of {}, {width:.0} x {height:.0} mm, designed for one target with the scenes \
        `{}/actuation-1.toml` to `-5`, as in section 3.2 of the paper. The paper's numbers are in brackets. The load of \
        a case is the minimum with which the uniform sheet matches the target to 1.2 % of its width. \
        `kirigami-studies actuations`.\n\n\
        ![the five designs](actuations.png)\n\n\
        | case | drive, N | rotational energy, % | non-rotational, % | compression, % | tension, % | shear, % | \
        boundary rms, % | from | shape alone | overlap | mean opening, deg | minimum \
        |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        scene.material.name,
        scenes.display()
    );
    for ((case, n), paper) in cases.iter().zip(&numbers).zip(PAPER) {
        let [drive, rotation, non_rotational, compression] = paper;
        writeln!(
            text,
            "| {} | {:.0} ({drive:.0}) | {:.1} ({rotation}) | {:.1} ({non_rotational}) | {:.0} ({compression:.0}) | \
             {:.0} | {:.0} | {:.2} (1.2) | {:.2} | {:.2} | {:.1e} | {:.1} | {:.1} |",
            case.label,
            case.drives[0],
            n.rotation,
            n.non_rotational,
            n.compression,
            n.tension,
            n.shear,
            n.boundary,
            n.boundary_start,
            n.boundary_shape_alone,
            n.overlap,
            n.opening[0],
            n.opening[1],
        )?;
    }
    text.push_str(
        "\nThe boundary error is that of the free outline corners, relative to the width of the target; \"from\" is \
         that of the uniform sheet under the same load, \"shape alone\" that of the design without compression and shear \
         in its objective. The overlap is the sum over all neighbouring panels, relative \
         to the area of the sheet (paper: below 3e-6).\n\n\
         | case | longest tension path, panels | arc over chord | rank correlation | clustering | panels of moment | \
         of springs | of forces | couple's work, % | w_comp, mm^2 | w_shear, mm^2 |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (case, n) in cases.iter().zip(&numbers) {
        writeln!(
            text,
            "| {} | {} | {} | {:+.3} | {:.1} | {:.2} | {:.2} | {:.2} | {:.0} | {:.2e} | {:.2e} |",
            case.label,
            n.longest_route,
            (n.arc_over_chord).map_or("-".into(), |ratio| format!("{ratio:.3}")),
            n.rank_correlation,
            n.clustering,
            n.moment_panels[0],
            n.moment_panels[1],
            n.moment_panels[2],
            n.couple,
            n.weights[0],
            n.weights[1],
        )?;
    }
    let weights = |k: usize| numbers.iter().map(move |n| n.weights[k]);
    let spread =
        |k: usize| weights(k).fold(0.0, f64::max) / weights(k).fold(f64::INFINITY, f64::min);
    write!(
        text,
        "\nThe paper: tension paths of up to 15 panels, 1.02 to 1.03 times as long as their chord; a rank correlation \
         of +0.99 between force and non-rotational fraction; next to a strongly loaded panel another one 1.9 to 2.8 \
         times more likely than by chance; the tenth of panels with the largest moment 1.61 times as large as the \
         median panel in case III and 1.00 times in case V; a couple with about 60 % of the drive; weights that span \
         a factor of 3.5. Here that factor is {:.1} for compression and {:.1} for shear.\n\n",
        spread(0),
        spread(1)
    )?;
    drives(&mut text, cases)?;
    distances(&mut text, cases)?;
    write!(
        text,
        "\nVoids of the {} disjoint unit cells of all designs (paper: 725 x 297, 491 x 360, 411 x 226 mm):\n\n",
        families.family.len() / cases.len()
    )?;
    text.push_str("| family | mean void, mm | cells | in I | II | III | IV | V |\n|---|---|---|---|---|---|---|---|\n");
    for (k, [long, short]) in families.sides.iter().enumerate() {
        let members: Vec<bool> = families.family.iter().map(|f| *f == k).collect();
        write!(
            text,
            "| {} | {long:.0} x {short:.0} | {} |",
            k + 1,
            members.iter().filter(|member| **member).count()
        )?;
        for of_case in members.chunks(families.family.len() / cases.len().max(1)) {
            write!(
                text,
                " {} |",
                of_case.iter().filter(|member| **member).count()
            )?;
        }
        text.push('\n');
    }
    Ok(text)
}

/// Writes the drives in all readings, relative to the paper's.
fn drives(text: &mut String, cases: &[Case]) -> Result<()> {
    writeln!(
        text,
        "Drive over the paper's in several readings; the first is that of the designs:\n\n\
         | reading | I | II | III | IV | V |\n|---|---|---|---|---|---|"
    )?;
    for (k, reading) in READINGS.iter().enumerate() {
        write!(text, "| {} |", reading.name)?;
        for (case, [paper, ..]) in cases.iter().zip(PAPER) {
            write!(text, " {:.2} |", case.drives[k] / paper)?;
        }
        text.push('\n');
    }
    text.push('\n');
    Ok(())
}

/// Writes the distances of the designs from each other and from their common start, in the aspect ratios.
fn distances(text: &mut String, cases: &[Case]) -> Result<()> {
    let start = &cases
        .first()
        .context("no case")?
        .designed
        .start
        .deployment
        .pattern
        .r;
    let r = |case: &Case| case.designed.best.deployment.pattern.r.clone();
    let from_start: Vec<f64> = cases.iter().map(|case| apart(&r(case), start)).collect();
    writeln!(
        text,
        "Distance of two designs (root mean square over the aspect ratios r; last column: distance from the uniform start):\n\n\
         | | I | II | III | IV | V | start |\n|---|---|---|---|---|---|---|"
    )?;
    let (mut farther, mut pairs) = (0, 0);
    for (i, one) in cases.iter().enumerate() {
        write!(text, "| {} |", one.label)?;
        for (j, other) in cases.iter().enumerate() {
            let distance = apart(&r(one), &r(other));
            if j < i {
                pairs += 1;
                farther += usize::from(distance > from_start[i].max(from_start[j]));
            }
            write!(text, " {distance:.4} |")?;
        }
        writeln!(text, " {:.4} |", from_start[i])?;
    }
    writeln!(
        text,
        "\nIn {farther} of the {pairs} pairs the distance of the two designs is larger than the distance of each from \
         the start (paper: in all ten)."
    )?;
    Ok(())
}

fn apart(one: &[f64], other: &[f64]) -> f64 {
    let squares: f64 = std::iter::zip(one, other)
        .map(|(x, y)| (x - y).powi(2))
        .sum();
    (squares / one.len() as f64).sqrt()
}

/// One row per case.
pub fn csv(cases: &[Case]) -> Result<String> {
    let mut text = "case,drive_n,rotation_percent,non_rotational_percent,tension_percent,compression_percent,shear_percent,\
        boundary_percent,start_percent,shape_alone_percent,overlap,mean_opening_deg,least_opening_deg,longest_route,arc_over_chord,\
        rank_correlation,clustering,panels_of_moment,of_springs,of_forces,couple_percent,w_comp_mm2,w_shear_mm2\n"
        .to_owned();
    for case in cases {
        let n = Numbers::of(case);
        writeln!(
            text,
            "{},{:.2},{:.4},{:.4},{:.4},{:.4},{:.4},{:.5},{:.5},{:.5},{:.4e},{:.4},{:.4},{},{},{:.5},{:.4},{:.4},{:.4},{:.4},{:.3},{:.6e},{:.6e}",
            case.label,
            case.drives[0],
            n.rotation,
            n.non_rotational,
            n.tension,
            n.compression,
            n.shear,
            n.boundary,
            n.boundary_start,
            n.boundary_shape_alone,
            n.overlap,
            n.opening[0],
            n.opening[1],
            n.longest_route,
            (n.arc_over_chord).map_or(String::new(), |ratio| format!("{ratio:.5}")),
            n.rank_correlation,
            n.clustering,
            n.moment_panels[0],
            n.moment_panels[1],
            n.moment_panels[2],
            n.couple,
            n.weights[0],
            n.weights[1],
        )?;
    }
    Ok(text)
}
