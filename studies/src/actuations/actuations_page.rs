//! The tables of `kirigami-studies actuations`.

use super::drive_readings::READINGS;
use super::{Case, boundary_error};
use anyhow::{Context, Result};
use design::analysis::void_families::VoidFamilies;
use design::sheet::validity::total_overlap;
use std::path::Path;
use support::table::{Cell, Table};

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
const PATH: usize = 4;

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
    longest_path: usize,
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
    fn new(case: &Case) -> Self {
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
        let bent: Vec<f64> = (case.lines.iter())
            .filter(|line| line.panels.len() >= PATH)
            .map(|line| line.arc_over_chord(&case.transmission))
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
            longest_path: case.lines.first().map_or(0, |line| line.panels.len()),
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

/// A case, its numbers and those of the paper.
type Row<'a> = (&'a Case, Numbers, [f64; 4]);

fn rows(cases: &[Case]) -> Vec<Row<'_>> {
    let cases = cases.iter().zip(PAPER);
    cases
        .map(|(case, paper)| (case, Numbers::new(case), paper))
        .collect()
}

/// Table 1 of the paper, whose numbers stand in brackets.
fn transmission_table<'a>() -> Table<'a, Row<'a>> {
    let beside = |value: f64, decimals: usize, paper: f64| {
        Cell::number(value, format!("{value:.decimals$} ({paper})"))
    };
    Table::new()
        .column("case", |row: &Row| Cell::text(row.0.label))
        .column("drive, N", move |row| beside(row.0.drives[0], 0, row.2[0]))
        .column("rotational energy, %", move |row| {
            beside(row.1.rotation, 1, row.2[1])
        })
        .column("non-rotational, %", move |row| {
            beside(row.1.non_rotational, 1, row.2[2])
        })
        .column("compression, %", move |row| {
            beside(row.1.compression, 0, row.2[3])
        })
        .column("tension, %", |row| Cell::fixed(row.1.tension, 0))
        .column("shear, %", |row| Cell::fixed(row.1.shear, 0))
        .column("boundary rms, %", move |row| beside(row.1.boundary, 2, 1.2))
        .column("from", |row| Cell::fixed(row.1.boundary_start, 2))
        .column("shape alone", |row| {
            Cell::fixed(row.1.boundary_shape_alone, 2)
        })
        .column("overlap", |row| Cell::scientific(row.1.overlap, 1))
        .column("mean opening, deg", |row| Cell::fixed(row.1.opening[0], 1))
        .column("minimum", |row| Cell::fixed(row.1.opening[1], 1))
}

/// The table with the columns of paths, correlations and moments.
fn with_paths<'a>(table: Table<'a, Row<'a>>) -> Table<'a, Row<'a>> {
    table
        .column("longest tension path, panels", |row| {
            Cell::text(row.1.longest_path)
        })
        .column("arc over chord", |row| {
            Cell::known(row.1.arc_over_chord.map(|ratio| Cell::fixed(ratio, 3)), "-")
        })
        .column("rank correlation", |row| {
            let correlation = row.1.rank_correlation;
            Cell::number(correlation, format!("{correlation:+.3}"))
        })
        .column("clustering", |row| Cell::fixed(row.1.clustering, 1))
        .column("panels of moment", |row| {
            Cell::fixed(row.1.moment_panels[0], 2)
        })
        .column("of springs", |row| Cell::fixed(row.1.moment_panels[1], 2))
        .column("of forces", |row| Cell::fixed(row.1.moment_panels[2], 2))
        .column("couple's work, %", |row| Cell::fixed(row.1.couple, 0))
        .column("w_comp, mm^2", |row| Cell::scientific(row.1.weights[0], 2))
        .column("w_shear, mm^2", |row| Cell::scientific(row.1.weights[1], 2))
}

pub fn page(cases: &[Case], families: &VoidFamilies, scenes: &Path) -> Result<String> {
    let rows = rows(cases);
    let scene = &cases.first().context("no case")?.scene;
    let ([columns, lines], [width, height]) = (
        scene.config.sheet.panels,
        scene.config.sheet.size.unwrap_or_default(),
    );
    let named = Table::new().column("case", |row: &Row| Cell::text(row.0.label));
    let weights = |k: usize| rows.iter().map(move |row| row.1.weights[k]);
    let spread =
        |k: usize| weights(k).fold(0.0, f64::max) / weights(k).fold(f64::INFINITY, f64::min);
    Ok(format!(
        "# One sheet, five actuations\n\n\
        {columns} x {lines} panels of {}, {width:.0} x {height:.0} mm, designed for one target with the scenes \
        `{}/actuation-1.toml` to `-5`, as in section 3.2 of the paper. The paper's numbers are in brackets. The load of \
        a case is the minimum with which the uniform sheet matches the target to 1.2 % of its width. \
        `kirigami-studies actuations`.\n\n\
        ![the five designs](actuations.png)\n\n{}\
        \nThe boundary error is that of the free outline corners, relative to the width of the target; \"from\" is \
         that of the uniform sheet under the same load, \"shape alone\" that of the design without compression and shear \
         in its objective. The overlap is the sum over all neighbouring panels, relative \
         to the area of the sheet (paper: below 3e-6).\n\n{}\
        \nThe paper: tension paths of up to 15 panels, 1.02 to 1.03 times as long as their chord; a rank correlation \
         of +0.99 between force and non-rotational fraction; next to a strongly loaded panel another one 1.9 to 2.8 \
         times more likely than by chance; the tenth of panels with the largest moment 1.61 times as large as the \
         median panel in case III and 1.00 times in case V; a couple with about 60 % of the drive; weights that span \
         a factor of 3.5. Here that factor is {:.1} for compression and {:.1} for shear.\n\n\
         Drive over the paper's in several readings; the first is that of the designs:\n\n{}\n{}\
         \nVoids of the {} disjoint unit cells of all designs (paper: 725 x 297, 491 x 360, 411 x 226 mm):\n\n{}",
        scene.material.name,
        scenes.display(),
        transmission_table().markdown(&rows),
        with_paths(named).markdown(&rows),
        spread(0),
        spread(1),
        drives(cases),
        distances(cases),
        families.family.len() / cases.len(),
        voids(families, cases),
    ))
}

/// The drives in all readings, relative to the paper's.
fn drives(cases: &[Case]) -> String {
    let mut table = Table::new().column("reading", |k: &usize| Cell::text(READINGS[*k].name));
    for (case, [paper, ..]) in cases.iter().zip(PAPER) {
        table = table.column(case.label, move |k| Cell::fixed(case.drives[*k] / paper, 2));
    }
    table.markdown(&Vec::from_iter(0..READINGS.len()))
}

/// The distances of the designs from each other and from their common start, in the aspect ratios.
fn distances(cases: &[Case]) -> String {
    let r = |case: &Case| case.designed.best.deployment.pattern.r.clone();
    let from_start = |case: &Case| apart(&r(case), &case.designed.start.deployment.pattern.r);
    let mut table = Table::new().column("", |case: &Case| Cell::text(case.label));
    for other in cases {
        table = table.column(other.label, move |case| {
            Cell::fixed(apart(&r(case), &r(other)), 4)
        });
    }
    let table = table.column("start", move |case| Cell::fixed(from_start(case), 4));
    let (mut farther, mut pairs) = (0, 0);
    for (i, one) in cases.iter().enumerate() {
        for other in &cases[..i] {
            let start = from_start(one).max(from_start(other));
            pairs += 1;
            farther += usize::from(apart(&r(one), &r(other)) > start);
        }
    }
    format!(
        "Distance of two designs (root mean square over the aspect ratios r; last column: distance from the uniform start):\n\n{}\
         \nIn {farther} of the {pairs} pairs the distance of the two designs is larger than the distance of each from \
         the start (paper: in all ten).\n",
        table.markdown(cases)
    )
}

/// The families of voids, and how many cells of each case belong to them.
fn voids(families: &VoidFamilies, cases: &[Case]) -> String {
    let count = |cells: &[usize], family: usize| {
        Cell::text(cells.iter().filter(|of_cell| **of_cell == family).count())
    };
    let mut table = Table::new()
        .column("family", |family: &usize| Cell::text(family + 1))
        .column("mean void, mm", |family| {
            let [long, short] = families.sides[*family];
            Cell::text(format!("{long:.0} x {short:.0}"))
        })
        .column("cells", |family| count(&families.family, *family));
    let of_cases = families
        .family
        .chunks(families.family.len() / cases.len().max(1));
    for (i, (case, cells)) in cases.iter().zip(of_cases).enumerate() {
        let heading = match i {
            0 => format!("in {}", case.label),
            _ => case.label.to_string(),
        };
        table = table.column(heading, move |family| count(cells, *family));
    }
    table.markdown(&Vec::from_iter(0..families.sides.len()))
}

fn apart(one: &[f64], other: &[f64]) -> f64 {
    let squares: f64 = std::iter::zip(one, other)
        .map(|(x, y)| (x - y).powi(2))
        .sum();
    (squares / one.len() as f64).sqrt()
}

/// One row per case.
pub fn csv(cases: &[Case]) -> String {
    with_paths(transmission_table()).csv(&rows(cases))
}
