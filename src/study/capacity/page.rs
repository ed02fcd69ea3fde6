//! What the study of load capacity writes.

use super::{Capacity, PAPER};
use anyhow::{Context, Result};
use std::fmt::Write;
use std::path::Path;

pub(super) fn page(capacities: &[Capacity], scene: &Path, to: f64) -> Result<String> {
    let mut text = format!(
        "# Load capacity\n\n\
        The sheet of `{}`: its first load is held, its second is rho times what is given there, every \
        rho a deployment of its own. Loaded with both together, a sheet is deployed while every void is \
        open at full load. `kirigami study capacity`.\n\n\
        ![opening and boundary error against rho, and rho along the way of the load](capacity.png)\n\n\
        | pattern | carries rho | paper | just above | last jump on the way there, load factor | boundary rms at rho = 1, % |\n\
        |---|---|---|---|---|---|\n",
        scene.display()
    );
    for (capacity, paper) in capacities.iter().zip(PAPER) {
        let [carries, above, jump] = match &capacity.limit {
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
            "| {} | {carries} | {paper:.2} | {above} | {jump} | {boundary:.3} |",
            capacity.name
        )?;
    }
    write!(
        text,
        "\nThe pull first and held, then the second load led along its way, as the scene has it and against it, \
        until the sheet first gives way:\n\n\
        | pattern | carries rho | there | against it, carries rho | there |\n|---|---|---|---|---|\n"
    )?;
    for Capacity { name, after, .. } in capacities {
        let [along, against] = after.each_ref().map(|load| match load.ended {
            Some(ended) => format!("{:.3} | {ended}", load.carried()),
            None => format!("over {:.3} | it still resists", load.carried()),
        });
        writeln!(text, "| {name} | {along} | {against} |")?;
    }
    if let [_, kinematic, shape, full] = capacities {
        text += &gains(kinematic, shape, full)?;
    }
    Ok(text)
}

/// What the terms on the hinges gain over the two patterns that are designed without them.
fn gains(kinematic: &Capacity, shape: &Capacity, full: &Capacity) -> Result<String> {
    type Carried = fn(&Capacity) -> Option<f64>;
    let ways: [(_, Carried); 3] = [
        ("both loads together", |it| {
            it.limit.as_ref().map(|limit| limit.0)
        }),
        ("the pull first, then as in the scene", |it| {
            it.after[0].limit()
        }),
        ("the pull first, then against it", |it| it.after[1].limit()),
    ];
    let mut text = "\nCapacity with compression and shear in the objective, over that without:\n\n\
        | | over the shape term alone | over the geometric pattern |\n|---|---|---|\n\
        | the paper | 2.3 | 1.64 |\n"
        .to_owned();
    for (way, carried) in ways {
        // A sheet that carries all that was tried has no capacity to compare.
        let gain = |over: &Capacity| match (carried(full), carried(over)) {
            (Some(full), Some(over)) if over > 0.0 => format!("{:.2}", full / over),
            _ => "unknown".into(),
        };
        writeln!(text, "| {way} | {} | {} |", gain(shape), gain(kinematic))?;
    }
    let boundary = |it: &Capacity| it.boundary().unwrap_or(f64::NAN);
    writeln!(
        text,
        "\nMatching the target through equilibrium: {:.2} times the boundary error of the geometric pattern \
         (0.5).",
        boundary(shape) / boundary(kinematic)
    )?;
    Ok(text)
}

/// One line a point of the way of a second load.
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

/// One line a deployment of the sweep.
pub(super) fn csv(capacities: &[Capacity]) -> Result<String> {
    let mut text =
        "pattern,rho,mean_opening_deg,least_opening_deg,boundary_percent,last_jump,degeneration\n"
            .to_owned();
    for capacity in capacities {
        for point in &capacity.points {
            let [mean, least] = point.opening_deg;
            writeln!(
                text,
                "{},{},{mean:.3},{least:.3},{:.4},{},{}",
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
