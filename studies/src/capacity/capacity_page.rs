//! The tables of `kirigami-studies capacity`.

use super::readings::READINGS;
use super::{Capacity, Carried, PAPER};
use anyhow::{Context, Result};
use std::fmt::Write;
use std::path::Path;

pub(super) fn page(
    capacities: &[Capacity],
    readings: &[Carried],
    scene: &Path,
    to: f64,
) -> Result<String> {
    let mut text = format!(
        "# Load capacity\n\n\
        The sheet of `{}`: its first load is constant, its second is rho times the scene's. With both loads applied \
        together, every rho is a separate deployment, and a sheet counts as deployed if every void is open at full \
        load. The capacity is the interval of rho about 1, the load of the designs, at which it is. A search ends when a \
        round of the scene's steps lowers its minimum loss by less than 1 %. `kirigami-studies capacity`.\n\n\
        ![opening and boundary error against rho, and rho against the stroke of the load](capacity.png)\n\n\
        | pattern | search steps | minimum rho | maximum rho | paper | failure just above | last jump before full load, load factor | boundary rms at rho = 1, % |\n\
        |---|---|---|---|---|---|---|---|\n",
        scene.display()
    );
    for (capacity, paper) in capacities.iter().zip(PAPER) {
        let [carries, above, jump] = match &capacity.carried.to {
            None => [format!("over {to}"), "-".into(), "-".into()],
            Some((carried, above)) => [
                format!("{carried:.3}"),
                above.degeneration.map_or("-".into(), |why| why.to_string()),
                above
                    .last_jump
                    .map_or("none".into(), |jump| format!("{jump:.2}")),
            ],
        };
        let boundary = capacity.boundary().context("the sweep has no rho = 1")?;
        writeln!(
            text,
            "| {} | {} | {:.3} | {carries} | {paper:.2} | {above} | {jump} | {boundary:.3} |",
            capacity.name, capacity.steps, capacity.carried.from
        )?;
    }
    write!(
        text,
        "\nThe pull first, held constant, then the second load under displacement control, in the direction of the \
        scene and in the opposite direction, until the first limit:\n\n\
        | pattern | maximum rho | limit | opposite direction, maximum rho | limit |\n|---|---|---|---|---|\n"
    )?;
    for Capacity { name, after, .. } in capacities {
        let [along, against] = after.each_ref().map(|load| match load.ended {
            Some(ended) => format!("{:.3} | {ended}", load.carried()),
            None => format!("over {:.3} | none within the stroke", load.carried()),
        });
        writeln!(text, "| {name} | {along} | {against} |")?;
    }
    if let [_, kinematic, shape, full] = capacities {
        text += &gains(kinematic, shape, full)?;
    }
    text += "\nThe uniform sheet in other readings of the paper (1.66), both loads together:\n\n\
        | reading | minimum rho | maximum rho |\n|---|---|---|\n";
    for (reading, carried) in READINGS.iter().zip(readings) {
        let maximum = carried.maximum();
        let maximum = maximum.map_or(format!("over {to}"), |rho| format!("{rho:.2}"));
        writeln!(
            text,
            "| {} | {:.2} | {maximum} |",
            reading.name, carried.from
        )?;
    }
    Ok(text)
}

/// The ratio of the capacity with the objectives on the hinges to that of the two patterns without them.
fn gains(kinematic: &Capacity, shape: &Capacity, full: &Capacity) -> Result<String> {
    type Maximum = fn(&Capacity) -> Option<f64>;
    let ways: [(_, Maximum); 3] = [
        ("both loads together", |it| it.carried.maximum()),
        ("the pull first, then in the direction of the scene", |it| {
            it.after[0].limit()
        }),
        ("the pull first, then in the opposite direction", |it| {
            it.after[1].limit()
        }),
    ];
    let mut text =
        "\nRatio of the capacity with compression and shear in the objective to that without:\n\n\
        | | to the shape term alone | to the kinematic pattern |\n|---|---|---|\n\
        | the paper | 2.3 | 1.64 |\n"
            .to_owned();
    for (way, carried) in ways {
        // If all tested loads are carried, the capacity is unknown.
        let gain = |over: &Capacity| match (carried(full), carried(over)) {
            (Some(full), Some(over)) if full > 0.0 && over > 0.0 => format!("{:.2}", full / over),
            (Some(_), Some(_)) => "-".into(),
            _ => "unknown".into(),
        };
        writeln!(text, "| {way} | {} | {} |", gain(shape), gain(kinematic))?;
    }
    let boundary = |it: &Capacity| it.boundary().unwrap_or(f64::NAN);
    writeln!(
        text,
        "\nDesigned through equilibrium, the sheet has {:.2} times the boundary error of the kinematic pattern \
         (paper: 0.5).",
        boundary(shape) / boundary(kinematic)
    )?;
    Ok(text)
}

/// One row per point of the path of a second load.
pub(super) fn ways(capacities: &[Capacity]) -> Result<String> {
    let mut text = "pattern,direction,way_mm,rho\n".to_owned();
    for Capacity { name, after, .. } in capacities {
        for (direction, load) in ["as in the scene", "against it"].iter().zip(after) {
            for (way, rho) in &load.curve {
                writeln!(text, "{name},{direction},{way:.3},{rho:.5}")?;
            }
        }
    }
    Ok(text)
}

/// One row per deployment of the sweep.
pub(super) fn csv(capacities: &[Capacity]) -> Result<String> {
    let mut text =
        "pattern,rho,mean_opening_deg,least_opening_deg,boundary_percent,last_jump,degeneration\n"
            .to_owned();
    for capacity in capacities {
        for point in &capacity.points {
            let [mean, minimum] = point.opening_deg;
            writeln!(
                text,
                "{},{},{mean:.3},{minimum:.3},{:.4},{},{}",
                capacity.name,
                point.rho,
                point.boundary,
                point
                    .last_jump
                    .map_or(String::new(), |jump| format!("{jump:.3}")),
                point
                    .degeneration
                    .map_or(String::new(), |why| why.to_string()),
            )?;
        }
    }
    Ok(text)
}
