//! Findings about panels that leave the plane.

use super::{Found, Rule, found, rule};
use crate::report::deployed::Deployed;
use crate::report::numbers::rounded;
use analysis::calibration::CALIBRATION;
use analysis::flatness::{Flatness, error_on_table};
use analysis::out_of_plane::{MOST, Stability};
use hinge::Regime;
use scene::Posture;
use support::severity::Severity::{Error, Note, Warning};

/// Findings of `kirigami verify --sheet`, which the report of a run repeats.
pub(super) const WHOLE_SHEET: Rule = rule(
    "whole-sheet",
    Note,
    [
        "by finite elements, ...",
        "what `kirigami verify --sheet` found of this design; it replaces the line above",
        "as there",
    ],
    |_| None,
);

pub(super) const RULES: [Rule; 2] = [
    rule(
        "leaves-plane",
        Warning,
        [
            "panels leave the plane",
            "nothing, or only its weight, keeps the sheet flat. Of a plate: by how much its panels tilt, the opening at which they leave the plane, and the share of its forces that suffices. Of a film: the expected error of the corners in mm; above 5 % of the sheet an error ([flatness](results/flatness/README.md))",
            "hold the sheet flat, take narrower ligaments or a thicker sheet, pull more panels, or solve it: `kirigami verify --sheet`",
        ],
        leaves_plane,
    ),
    WHOLE_SHEET,
];

/// Panels that leave the plane unless something holds them flat.
fn leaves_plane(of: &Deployed) -> Option<Found> {
    let posture = of.scene.config.posture?.kind;
    let solved = of.whole_sheet().is_some_and(|sheet| sheet.support == posture);
    if posture == Posture::HeldFlat || solved {
        return None;
    }
    let kept = match posture {
        Posture::Lying => "only its weight keeps the panels down on the surface",
        _ => "nothing keeps the panels in the plane",
    };
    let widest = of.hinges.iter().fold(0.0, |most, row| row.w_lig.max(most));
    let stability = |problem| Stability::new(of.scene, &problem, of.deployment);
    Some(match of.scene.material.regime(widest) {
        Regime::Plate => plate_leaves_plane(kept, of.scene.problem().ok().and_then(stability)),
        Regime::Film => film_leaves_plane(of, posture, kept, widest),
    })
}

/// How far a plate is from leaving its plane: see [`Stability`].
fn plate_leaves_plane(kept: &str, stability: Option<Stability>) -> Found {
    let advice = "hold it flat, such as between two boards, take narrower ligaments, or pull more panels; `kirigami verify --sheet` solves it";
    let Some(stability) = stability else {
        return found(format!(
            "{kept}, and whether they stay is not known: that needs a hinge law, and a clip or clamp that holds a panel"
        ));
    };
    let Stability { margin, tilt, leaves_at } = stability;
    let percent = (100.0 * margin).round();
    match leaves_at {
        Some(opening) => found(format!(
            "{kept}, and they leave it where hinges open by about {:.0} deg; in the worst state on the way {percent} % of the forces suffice. \
             The report is of the flat sheet: {advice}",
            opening.to_degrees()
        )),
        None if !stability.is_safe() => found(format!(
            "{kept}, and they nearly leave it: {percent} % of the forces on the way suffice, and panels tilt by a degree and more; {advice}"
        )),
        None => {
            let more = if margin < MOST { "" } else { "more than " };
            let message = format!(
                "{kept}, and by themselves they stay: it would take {more}{percent} % of the forces on the way to move them out of it. \
                 Bumps of ligaments tilt them by {:.2} deg (docs/results/flatness)",
                tilt.unwrap_or_default().to_degrees()
            );
            found(message).with(Note)
        }
    }
}

/// A film, whose ligaments buckle and tilt its panels.
fn film_leaves_plane(of: &Deployed, posture: Posture, kept: &str, widest: f64) -> Found {
    let (sheet, thickness) = (&of.deployment.sheet, of.scene.material.thickness);
    let r_win = sheet.options.process.r_win;
    let on_table =
        (posture == Posture::Lying).then(|| error_on_table(&of.scene.material, r_win)).flatten();
    let (off, falls) = match on_table {
        Some(error) => (
            format!(
                "the corners are expected {} mm (root mean square) from where the report has them, {} % of the sheet, where hinges open by 26 deg",
                rounded(error * sheet.outline.size(), 2),
                rounded(100.0 * error, 2)
            ),
            Flatness::of(error, 0.0) == Flatness::Falls,
        ),
        None => (
            "corners of whole sheets were 0.3 % of the sheet off with ligaments of 1.2 thicknesses, and 16 % with 3.6".to_owned(),
            widest > CALIBRATION.falls.value * thickness,
        ),
    };
    let message = format!(
        "{kept}, and they leave it as the ligaments buckle, which are up to {} times as wide as the sheet is thick: by finite elements {off}; \
         hold it flat, or solve it: `kirigami verify --sheet`",
        rounded(widest / thickness, 2)
    );
    found(message).with(if falls { Error } else { Warning })
}
