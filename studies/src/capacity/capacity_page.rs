//! The tables of `kirigami-studies capacity`.

use super::readings::{READINGS, Reading};
use super::{Capacity, Carried, PAPER, Point};
use std::path::Path;
use support::table::{Cell, Table};

pub(super) fn page(capacities: &[Capacity], readings: &[Carried], scene: &Path, to: f64) -> String {
    let mut text = format!(
        "# Load capacity\n\n\
        The sheet of `{}`: its first load is constant, its second is rho times the scene's. With both loads applied \
        together, every rho is a separate deployment, and a sheet counts as deployed if every void is open at full \
        load. The capacity is the interval of rho about 1, the load of the designs, at which it is. A search ends when a \
        round of the scene's steps lowers its minimum loss by less than 1 %. `kirigami-studies capacity`.\n\n\
        ![opening and boundary error against rho, and rho against the stroke of the load](capacity.png)\n\n{}\
        \nThe pull first, held constant, then the second load under displacement control, in the direction of the \
        scene and in the opposite direction, until the first limit:\n\n{}",
        scene.display(),
        together(to).markdown(&std::iter::zip(capacities, PAPER).collect::<Vec<_>>()),
        one_after_the_other().markdown(capacities),
    );
    if let [_, kinematic, shape, full] = capacities {
        text += &gains(kinematic, shape, full);
    }
    let readings: Vec<_> = READINGS.iter().zip(readings).collect();
    text += "\nThe uniform sheet in other readings of the paper (1.66), both loads together:\n\n";
    text += &Table::new()
        .column("reading", |(reading, _): &(&Reading, &Carried)| {
            Cell::text(reading.name)
        })
        .column("minimum rho", |(_, carried)| Cell::fixed(carried.from, 2))
        .column("maximum rho", |(_, carried)| {
            let maximum = carried.maximum().map(|rho| Cell::fixed(rho, 2));
            Cell::known(maximum, &format!("over {to}"))
        })
        .markdown(&readings);
    text
}

/// Both loads together; `to`: the largest rho that is tried.
fn together<'a>(to: f64) -> Table<'a, (&'a Capacity, f64)> {
    let failure = |row: &(&'a Capacity, f64)| row.0.carried.to.as_ref().map(|(_, above)| above);
    Table::new()
        .column("pattern", |(capacity, _): &(&Capacity, f64)| {
            Cell::text(capacity.name)
        })
        .column("search steps", |(capacity, _)| Cell::text(capacity.steps))
        .column("minimum rho", |(capacity, _)| {
            Cell::fixed(capacity.carried.from, 3)
        })
        .column("maximum rho", move |(capacity, _)| {
            let maximum = capacity.carried.maximum().map(|rho| Cell::fixed(rho, 3));
            Cell::known(maximum, &format!("over {to}"))
        })
        .column("paper", |(_, paper)| Cell::fixed(*paper, 2))
        .column("failure just above", move |row| {
            let why = failure(row).and_then(|above| above.degeneration);
            Cell::known(why.map(Cell::text), "-")
        })
        .column("last jump before full load, load factor", move |row| {
            let Some(above) = failure(row) else {
                return Cell::text("-");
            };
            Cell::known(above.last_jump.map(|jump| Cell::fixed(jump, 2)), "none")
        })
        .column("boundary rms at rho = 1, %", |(capacity, _)| {
            Cell::known(capacity.boundary().map(|error| Cell::fixed(error, 3)), "-")
        })
}

/// The second load after the pull, in both directions.
fn one_after_the_other<'a>() -> Table<'a, Capacity> {
    let maximum = |way: usize| {
        move |capacity: &Capacity| {
            let load = &capacity.after[way];
            let carried = load.carried();
            Cell::text(match load.ended {
                Some(_) => format!("{carried:.3}"),
                None => format!("over {carried:.3}"),
            })
        }
    };
    let limit = |way: usize| {
        move |capacity: &Capacity| {
            let ended = capacity.after[way].ended.as_ref();
            Cell::known(ended.map(Cell::text), "none within the stroke")
        }
    };
    Table::new()
        .column("pattern", |capacity: &Capacity| Cell::text(capacity.name))
        .column("maximum rho", maximum(0))
        .column("limit", limit(0))
        .column("opposite direction, maximum rho", maximum(1))
        .column("limit", limit(1))
}

/// The ratio of the capacity with the objectives on the hinges to that of the two patterns without them.
fn gains(kinematic: &Capacity, shape: &Capacity, full: &Capacity) -> String {
    type Maximum = fn(&Capacity) -> Option<f64>;
    let loadings: [(&str, Maximum); 3] = [
        ("both loads together", |capacity| capacity.carried.maximum()),
        (
            "the pull first, then in the direction of the scene",
            |capacity| capacity.after[0].limit(),
        ),
        (
            "the pull first, then in the opposite direction",
            |capacity| capacity.after[1].limit(),
        ),
    ];
    let gain = |maximum: Maximum, over: &Capacity| match (maximum(full), maximum(over)) {
        (Some(full), Some(over)) if full > 0.0 && over > 0.0 => Cell::fixed(full / over, 2),
        (Some(_), Some(_)) => Cell::known(None, "-"),
        // If all tested loads are carried, the capacity is unknown.
        _ => Cell::known(None, "unknown"),
    };
    let paper = ["the paper", "2.3", "1.64"].map(Cell::text);
    let ours = loadings.map(|(name, maximum)| {
        [
            Cell::text(name),
            gain(maximum, shape),
            gain(maximum, kinematic),
        ]
    });
    let rows: Vec<[Cell; 3]> = std::iter::once(paper).chain(ours).collect();
    let table = Table::new()
        .column("", |row: &[Cell; 3]| row[0].clone())
        .column("to the shape term alone", |row| row[1].clone())
        .column("to the kinematic pattern", |row| row[2].clone());
    let boundary = |capacity: &Capacity| capacity.boundary().unwrap_or(f64::NAN);
    format!(
        "\nRatio of the capacity with compression and shear in the objective to that without:\n\n{}\
         \nDesigned through equilibrium, the sheet has {:.2} times the boundary error of the kinematic pattern \
         (paper: 0.5).\n",
        table.markdown(&rows),
        boundary(shape) / boundary(kinematic)
    )
}

/// One row per point of the path of a second load.
pub(super) fn paths(capacities: &[Capacity]) -> String {
    let mut rows = Vec::new();
    for Capacity { name, after, .. } in capacities {
        for (direction, load) in ["as in the scene", "against it"].into_iter().zip(after) {
            rows.extend(load.curve.iter().map(|point| (*name, direction, *point)));
        }
    }
    type Row<'a> = (&'a str, &'static str, (f64, f64));
    Table::new()
        .column("pattern", |row: &Row| Cell::text(row.0))
        .column("direction", |row| Cell::text(row.1))
        .column("stroke, mm", |row| Cell::fixed(row.2.0, 3))
        .column("rho", |row| Cell::fixed(row.2.1, 5))
        .csv(&rows)
}

/// One row per deployment of the sweep.
pub(super) fn csv(capacities: &[Capacity]) -> String {
    let rows: Vec<(&str, &Point)> = capacities
        .iter()
        .flat_map(|capacity| capacity.points.iter().map(|point| (capacity.name, point)))
        .collect();
    Table::new()
        .column("pattern", |row: &(&str, &Point)| Cell::text(row.0))
        .column("rho", |(_, point)| Cell::text(point.rho))
        .column("mean opening, deg", |(_, point)| {
            Cell::fixed(point.opening_deg[0], 3)
        })
        .column("minimum opening, deg", |(_, point)| {
            Cell::fixed(point.opening_deg[1], 3)
        })
        .column("boundary, %", |(_, point)| Cell::fixed(point.boundary, 4))
        .column("last jump", |(_, point)| {
            Cell::known(point.last_jump.map(|jump| Cell::fixed(jump, 3)), "")
        })
        .column("degeneration", |(_, point)| {
            Cell::known(point.degeneration.map(Cell::text), "")
        })
        .csv(&rows)
}
