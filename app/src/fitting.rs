//! A sheet of an even pattern for a drawing, and what is said of it.

use crate::progress::announce;
use analysis::fit::{
    fasteners::Fastening,
    scene::{FittedScene, WITHOUT_LIMB, fitted},
};
use anyhow::{Result, ensure};
use hinge::Regime;
use scene::{
    FILLS_HOLES, Scene,
    placement::{NOT_SEEN, RECOGNISED},
};

/// Makes the sheet that opens onto the target of a scene; also returns what a person may expect of
/// it. Its panels have a side (mm), or else the smallest one that they can have. A sheet that shows
/// too little of its target is refused unless `anyway`.
pub fn fit_to_target(
    scene: &Scene,
    side: Option<f64>,
    anyway: bool,
) -> Result<(FittedScene, String)> {
    announce("laying an even pattern over the target, in some seconds");
    // The sheet will have its holes.
    let notes = scene.target.notes.iter().filter(|note| **note != FILLS_HOLES);
    notes.for_each(|note| announce(&format!("the drawing: {note}")));
    let fit = fitted(scene, side)?;
    let expected = expected(&fit, scene.material.thickness);
    ensure!(
        anyway || fit.seen >= NOT_SEEN,
        "{expected}\na viewer would not recognise it: change the drawing, the stock or the thickness, or make the sheet with --anyway"
    );
    Ok((fit, expected))
}

/// What a person may expect of the sheet of a material of some thickness (mm).
pub fn expected(fit: &FittedScene, thickness: f64) -> String {
    let FittedScene { panels, side, smallest, opening, seen, lost, kept_by, held, reach, .. } = fit;
    let [opening, seen] = [opening.to_degrees(), 100.0 * seen];
    let mut lines = vec![format!(
        "{panels} panels of {side:.0} mm, opened by {opening:.0} deg, show {seen:.1} % of the target (common area over the area of both, gaps \
         between panels closed)"
    )];
    lines.push(held.as_ref().map_or("no equilibrium is found with fasteners".to_owned(), fastened));
    if *reach > WITHOUT_LIMB {
        lines.push(format!(
            "a part of the target is too narrow for two panels: one panel has it and reaches {:.0} mm from its middle; its hinges alone hold it",
            reach * side
        ));
    }
    let two = 2.0 * side;
    lines.extend(lost.iter().map(|part| {
        let (width, place) = (part.width * side, in_words(part.place));
        let why = if width < two { "it" } else { "what joins it to the rest" };
        format!("not shown: a part {width:.0} mm wide {place}; {why} is narrower than two panels of {side:.0} mm")
    }));
    if !lost.is_empty() && side > smallest {
        lines.push(format!("smaller panels show more, down to {smallest:.0} mm"));
    }
    lines.extend(kept_by.map(|factor| {
        let thinner = (100.0 * thickness / factor).floor() / 100.0;
        let same = Regime::usual(thinner) == Regime::usual(thickness);
        let or = if same { format!(", or a sheet of {thinner} mm") } else { String::new() };
        format!("a stock {factor} times as long and wide shows it{or}")
    }));
    if (NOT_SEEN..RECOGNISED).contains(&fit.seen) {
        lines.push("less than 90 % is seen: a viewer may not recognise it".to_owned());
    }
    if !lost.is_empty() && kept_by.is_none() {
        lines.push("not even a stock twice as long and wide shows all of it".to_owned());
    }
    lines.join("\n")
}

/// How many fasteners hold the sheet, and why so many.
fn fastened(held: &Fastening) -> String {
    let Fastening { count, force, of_borne, peak_damage, margin, .. } = held;
    let [off, borne] = [held.unevenness(), *of_borne].map(|part| 100.0 * part);
    let margin = margin.map_or(String::new(), |margin| {
        format!("; between them panels stay in the plane up to {margin:.1} times the forces")
    });
    let peak = peak_damage.map_or(String::new(), |peak| {
        format!(", {peak:.2} of the damage at which a ligament tears")
    });
    let enough = if held.suffices() { "" } else { " best, and more do not suffice" };
    format!(
        "{count} fasteners hold it{enough}: panels {off:.2} % of the longer side from the even opening (root mean square), \
         {force:.0} N a fastener, {borne:.0} % of what its hole bears{peak}{margin}"
    )
}

/// Where a part is in the drawing.
fn in_words([right, up]: [i32; 2]) -> String {
    let vertical = ["at the bottom", "", "at the top"][(up + 1) as usize];
    let horizontal = ["on the left", "in the middle", "on the right"][(right + 1) as usize];
    [vertical, horizontal].join(" ").trim().to_owned()
}
