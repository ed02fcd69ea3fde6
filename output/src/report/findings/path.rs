//! Findings about the path, the target and the points at which panels are held and pulled.

use super::{Found, Rule, found, rule};
use crate::report::deployed::Deployed;
use crate::report::numbers::rounded;
use design::equilibrium::load_step::{LoadStep, Status};
use design::geometry::polygon::contains;
use design::sheet::cut_sheet::PanelPoint;
use support::severity::Severity::{Error, Note, Warning};

pub(super) const RULES: [Rule; 5] = [
    rule(
        "path",
        Warning,
        [
            "the path is not smooth and stable",
            "a jump, no equilibrium (an error if the path ends there), or an inaccurate step at the named load factor",
            "other loads or supports, or a prescribed stroke (`[drive]`) instead of dead loads",
        ],
        path,
    ),
    rule(
        "target-drawing",
        Warning,
        ["the drawing of the target", "it is open, or not read wholly", "another drawing"],
        target_drawing,
    ),
    rule(
        "target-crosses",
        Warning,
        ["the target crosses or touches itself", "its inside is not defined", "another drawing"],
        target_crosses,
    ),
    rule(
        "point-outside",
        Error,
        [
            "a panel has moved away from its point",
            "the design no longer contains the point at which it is held or pulled",
            "`at = \"bottom\"`, or another point",
        ],
        point_outside,
    ),
    rule(
        "not-modelled",
        Note,
        [
            "effects in the plane that are not modelled",
            "what the posture of the scene leaves out, such as friction",
            "as below",
        ],
        not_modelled,
    ),
];

fn path(of: &Deployed) -> Option<Found> {
    let weighed = of.deployment.weight_steps().len();
    // Under a prescribed stroke or motion a jump is no maximum of the load.
    let dead = of.scene.config.has_loads() && of.scene.config.drive.is_none();
    let mut before = "the beginning".to_owned();
    let mut departures = Vec::new();
    for (i, step) in of.deployment.path.iter().enumerate() {
        let by_weight = i < weighed;
        let place = match (by_weight, step.weight == 1.0) {
            (true, true) => "the whole weight".to_owned(),
            (true, false) => format!("{} of the weight", rounded(step.weight, 2)),
            (false, _) => format!("load factor {:.3}", step.load_factor),
        };
        let peaks = if by_weight || !dead { "" } else { "the load peaks and " };
        departures.extend(departure(step, peaks, &before, &place));
        before = place;
    }
    let message =
        format!("the equilibrium path is not smooth and stable: {}", departures.join(", "));
    let ends = of.deployment.final_step().status == Status::Diverged;
    (!departures.is_empty()).then(|| found(message).with(if ends { Error } else { Warning }))
}

/// How a step of the path at a place is not a stable equilibrium; `None` if it is one.
fn departure(step: &LoadStep, peaks: &str, before: &str, place: &str) -> Option<String> {
    Some(match step.status {
        Status::Converged | Status::LeftDomain => return None,
        Status::Almost => format!("residual {:.0e} at {place}", step.residual),
        Status::LimitPoint => format!("{peaks}the sheet jumps between {before} and {place}"),
        Status::Diverged => {
            let end = step.descent_end.map(|end| format!(": {end}"));
            format!("no equilibrium was found beyond {place}{}", end.unwrap_or_default())
        }
    })
}

fn target_drawing(of: &Deployed) -> Option<Found> {
    let notes = &of.scene.target.notes;
    (!notes.is_empty()).then(|| found(format!("the drawing of the target: {}", notes.join("; "))))
}

fn target_crosses(of: &Deployed) -> Option<Found> {
    let target = &of.scene.target;
    target.crossing.filter(|_| target.notes.is_empty()).map(|[x, y]| {
        found(format!(
            "the target outline crosses or touches itself near ({x:.1}, {y:.1}) mm: its inside is not defined; order \
             its vertices around the outline"
        ))
    })
}

/// A point at which a panel is held or pulled does not move with its cuts.
fn point_outside(of: &Deployed) -> Option<Found> {
    let panels = &of.deployment.sheet.panels;
    let attachments = of.scene.actuation().attachments.into_iter();
    let outside = attachments.filter(|attachment| {
        let panel = &panels[attachment.panel];
        matches!(attachment.point, PanelPoint::Fixed(_))
            && !contains(&panel.corners, panel.reference)
    });
    let outside: Vec<String> = outside.map(|attachment| attachment.name).collect();
    (!outside.is_empty()).then(|| {
        found(format!(
            "the design has moved a panel away from the point at which it is held or pulled ({}): move the point, or name \
             one that moves with the cuts, such as at = \"bottom\"",
            outside.join("; ")
        ))
    })
}

fn not_modelled(of: &Deployed) -> Option<Found> {
    of.scene.surrogate()?;
    let missing = of.run?.weight.left_out()?;
    Some(found(format!("not modelled: {missing}")))
}
