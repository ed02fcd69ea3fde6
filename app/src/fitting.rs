//! A sheet that is fitted to its target before the search, and what is said of it.

use crate::progress::announce;
use analysis::fit::scene::{FittedScene, Missed, Nearness, fitted, on_larger_stock};
use analysis::out_of_plane::Stability;
use anyhow::Result;
use scene::Scene;

/// The number of missed parts that are named.
const NAMED: usize = 4;

/// Fits a sheet to its target; also returns what a person may expect of it.
pub fn fit_to_target(scene: &Scene) -> Result<(FittedScene, String)> {
    announce("fitting the sheet and the target to each other, in some seconds");
    let fit = fitted(scene)?;
    let expected = format!("{}\n  {}", expected(&fit), from_larger_stock(scene, &fit));
    Ok((fit, expected))
}

/// What a person may expect of the sheet.
pub fn expected(fit: &FittedScene) -> String {
    let [columns, rows] = fit.config.sheet.panels;
    let pulled = match (fit.pulled, fit.config.loads.len()) {
        (None, _) => "no equilibrium under pulls was found".to_owned(),
        (Some(near), 1) => format!("pulled at one panel, before the search: {}", within(near)),
        (Some(near), count) => {
            format!("pulled at {count} panels, before the search: {}", within(near))
        }
    };
    format!(
        "The sheet of {columns} x {rows} panels, opened by {:.0} deg, becomes the target\n  on pins: {}{}\n  {pulled}{}",
        fit.opening.to_degrees(),
        within(fit.on_pins),
        farthest(&fit.missed),
        fit.stability.map_or(String::new(), in_its_plane)
    )
}

/// Whether something must hold a plate flat.
fn in_its_plane(stability: Stability) -> String {
    match stability.leaves_at {
        Some(opening) => format!(
            "\n  its panels leave the plane where hinges open by {:.0} deg: hold it flat, such as between two boards",
            opening.to_degrees()
        ),
        None if !stability.is_safe() => {
            "\n  its panels nearly leave the plane: hold it flat, such as between two boards"
                .to_owned()
        }
        None => "\n  its panels stay in the plane by themselves".to_owned(),
    }
}

fn within(near: Nearness) -> String {
    let Nearness { error, relative, overlap } = near;
    format!(
        "within {error:.1} mm, {:.1} % of the sheet; {:.1} % of the area in common",
        100.0 * relative,
        100.0 * overlap
    )
}

/// What a larger stock would give.
fn from_larger_stock(scene: &Scene, fit: &FittedScene) -> String {
    match on_larger_stock(scene, fit, 2.0) {
        Ok((_, near)) if near.overlap <= fit.on_pins.overlap => {
            "on pins, from a stock twice as long and wide: no nearer, in a short search".to_owned()
        }
        Ok(([columns, rows], near)) => format!(
            "on pins, from a stock twice as long and wide ({columns} x {rows} panels): {}",
            within(near)
        ),
        Err(error) => format!("no sheet from a stock twice as long and wide: {error}"),
    }
}

/// Which parts of the target the sheet on pins does not reach, each named once.
fn farthest(missed: &[Missed]) -> String {
    let mut places: Vec<(String, f64)> = Vec::new();
    for Missed { distance, at } in missed {
        let name = part(*at);
        if places.iter().all(|(named, _)| *named != name) {
            places.push((name, *distance));
        }
    }
    if places.is_empty() {
        return String::new();
    }
    let places: Vec<String> = (places.iter().take(NAMED))
        .map(|(name, distance)| format!("{name} ({distance:.0} mm)"))
        .collect();
    format!("\n  on pins, parts of the target that it does not reach: {}", places.join(", "))
}

/// The name of a place, given as parts of the width and the height of the target.
fn part([x, y]: [f64; 2]) -> String {
    let third = |at: f64| ((3.0 * at) as usize).min(2);
    let across = ["left", "", "right"][third(x)];
    let up = ["bottom", "", "top"][third(y)];
    match (up, across) {
        ("", "") => "middle".to_owned(),
        _ => format!("{up} {across}").trim().to_owned(),
    }
}
