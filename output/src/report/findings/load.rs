//! Findings about the path, its load, weight and friction, and panels that leave the plane.

use super::{Found, Rule, found, rule};
use crate::report::{
    deployed::{DeployedDesign, is_heavy, left_out, of_the_load, posture},
    numbers::rounded,
};
use analysis::{
    calibration::CALIBRATION,
    flatness::{Flatness, error_on_table},
    mounting::{Fastener, borne_by_hole},
    out_of_plane::{MOST, Stability},
    unit::Unit,
};
use design::{
    equilibrium::load_step::{LoadStep, Status},
    geometry::polygon::distance_to_polygon,
    sheet::cut_sheet::PanelPoint,
};
use hinge::Regime;
use scene::{FRICTION, ON_EDGE, Posture};
use support::Joined;
use support::severity::Severity::{Error, Note, Warning};

pub(super) const RULES: [Rule; 14] = [
    rule(
        "path",
        Warning,
        [
            "the path is not smooth and stable",
            "a jump, an inaccurate step, or no equilibrium, an error at the end",
            "other loads or supports, or a stroke (`[drive]`)",
        ],
        |of| {
            let weighed = of.deployment.weight_steps().len();
            // A jump under a prescribed stroke or motion is no maximum of the load.
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
            (!departures.is_empty())
                .then(|| found(message).with(if ends { Error } else { Warning }))
        },
    ),
    rule(
        "target-drawing",
        Warning,
        ["the drawing of the target", "it is open, or not read wholly", "another drawing"],
        |of| {
            let notes = &of.scene.target.notes;
            (!notes.is_empty())
                .then(|| found(format!("the drawing of the target: {}", notes.join("; "))))
        },
    ),
    rule(
        "target-crosses",
        Warning,
        ["the target crosses or touches itself", "its inside is not defined", "another drawing"],
        |of| {
            let target = &of.scene.target;
            target.crossing.filter(|_| target.notes.is_empty()).map(|[x, y]| {
                found(format!(
                    "the target outline crosses or touches itself near ({x:.1}, {y:.1}) mm: its inside is not defined; order \
                     its vertices around the outline"
                ))
            })
        },
    ),
    rule(
        "point-outside",
        Error,
        [
            "a panel has moved away from its point",
            "it no longer contains the point that is held or pulled",
            "`at = \"bottom\"`, or another point",
        ],
        |of| {
            // A point at which a panel is held or pulled does not move with its cuts.
            let panels = &of.deployment.sheet.panels;
            let attachments = of.scene.actuation().attachments.into_iter();
            let outside = attachments.filter(|attachment| {
                let panel = &panels[attachment.panel];
                matches!(attachment.point, PanelPoint::Fixed(_))
                    && distance_to_polygon(panel.reference, &panel.boundary) > ON_EDGE
            });
            let outside: Vec<String> = outside.map(|attachment| attachment.name).collect();
            (!outside.is_empty()).then(|| {
                found(format!(
                    "the design has moved a panel away from the point at which it is held or pulled ({}): move the point, or name \
                     one that moves with the cuts, such as at = \"bottom\"",
                    outside.join("; ")
                ))
            })
        },
    ),
    rule(
        "not-modelled",
        Note,
        [
            "effects in the plane that are not modelled",
            "what the posture leaves out, such as friction",
            "as below",
        ],
        |of| {
            of.scene.surrogate()?;
            of.run?;
            left_out(of.scene).map(|missing| found(format!("not modelled: {missing}")))
        },
    ),
    rule(
        "leaves-plane",
        Warning,
        [
            "panels leave the plane",
            "nothing, or only its weight, keeps the sheet flat ([flatness](results/flatness/README.md)); a film with corners off by more than 5 % of the sheet is an error, a plate that stays a note",
            "hold it flat, narrower ligaments, a thicker sheet, more pulls, or `kirigami verify --sheet`",
        ],
        |of| {
            // Panels that leave the plane unless something holds them flat.
            let posture = posture(of.scene)?;
            let solved = of.whole_sheet().is_some_and(|sheet| sheet.support == posture);
            if posture == Posture::HeldFlat || solved {
                return None;
            }
            let kept = match posture {
                Posture::Lying => "only its weight keeps the panels down on the surface",
                Posture::Mounted => "between the fasteners nothing keeps the panels in the plane",
                _ => "nothing keeps the panels in the plane",
            };
            let widest = of.hinges.iter().fold(0.0, |most, row| row.w_lig.max(most));
            let stability = |problem| Stability::new(of.scene, &problem, of.deployment);
            Some(match of.scene.material.regime(widest) {
                Regime::Plate => {
                    plate_leaves_plane(kept, of.scene.problem().ok().and_then(stability))
                }
                Regime::Film => film_leaves_plane(of, posture, kept, widest),
            })
        },
    ),
    WHOLE_SHEET,
    rule(
        "weight",
        Warning,
        [
            "the weight is not modelled",
            "it is more than 5 % of the load of a free sheet",
            "`posture.kind = \"hanging\"` with `down`",
        ],
        |of| {
            // A weight that acts in the plane of the sheet but not in the model.
            of.scene.surrogate()?;
            let acts = matches!(posture(of.scene)?, Posture::Hanging | Posture::Free);
            let ratio = of.weight_over_load().filter(|ratio| *ratio > HEAVY)?;
            (acts && !is_heavy(of.scene)).then(|| {
                found(format!(
                    "the weight of the sheet is {} and not modelled: if it hangs, set posture.kind = \"hanging\" with `down`",
                    of_the_load(ratio)
                ))
            })
        },
    ),
    rule(
        "friction",
        Warning,
        [
            "friction on the surface",
            "it is more than 5 % of the load of a lying sheet",
            "lift or shake the sheet while it opens",
        ],
        |of| {
            // Friction that the design does not know of.
            of.scene.surrogate()?;
            let ratio = FRICTION * of.weight_over_load()?;
            (ratio > HEAVY && posture(of.scene)? == Posture::Lying).then(|| {
                found(format!(
                    "friction on the surface, at mu = {FRICTION}, is {}, and the design does not contain it: lift or shake the sheet while \
                     it opens, or reduce the friction",
                    of_the_load(ratio)
                ))
            })
        },
    ),
    rule(
        "hung-weight",
        Warning,
        [
            "the weights that hang from the sheet",
            "they have more than fifty times its mass",
            "`mass_g` is in grams",
        ],
        |of| {
            // Weights that are too heavy to hang; a mass under a prescribed stroke is only a direction.
            let config = &of.scene.config;
            let grams: f64 = config.loads.iter().filter_map(|load| load.mass_g).sum();
            let ratio = 1e-3 * grams / of.mass_kg();
            (of.run.is_some() && config.drive.is_none() && ratio > HUNG).then(|| {
                found(format!(
                    "the weights that hang from the sheet have {} times its mass: mass_g is in grams; write 2 for two grams",
                    rounded(ratio, 2)
                ))
            })
        },
    ),
    rule(
        "load-peak",
        Warning,
        [
            "the load has a maximum",
            "a hung weight of the final size does not open the sheet",
            "a stroke (`[drive]`)",
        ],
        |of| {
            let reached = of.run?.reached.as_ref()?;
            let peak = reached.peak?;
            let [length, force] = reached.units;
            let [maximum, at, last, end, carried] = [
                peak.load,
                peak.displacement,
                reached.load,
                reached.displacement,
                peak.dead_load_reaches?,
            ]
            .map(|value| rounded(value, 4));
            let such = if force == Unit::Newton { ", such as a hung weight," } else { "" };
            let consequence = if reached.load * reached.displacement > 0.0 {
                format!(
                    "a dead load of {last} {force}{such} does not open this sheet: it moves it by {carried} {length} and not by {end} {length}"
                )
            } else {
                format!(
                    "no dead load opens this sheet by {end} {length}: the load has changed its direction there, to {last} {force}"
                )
            };
            Some(found(format!(
                "{consequence}; the load peaks at {maximum} {force} at a stroke of {at} {length}"
            )))
        },
    ),
    rule(
        "load-plateau",
        Warning,
        [
            "a dead load that is 10 % off",
            "it changes the mean opening by more than five degrees",
            "fasteners (`posture.kind = \"mounted\"`), or a stroke (`[drive]`)",
        ],
        |of| {
            let config = &of.scene.config;
            let changes = &of.run.filter(|_| config.has_loads() && config.drive.is_none())?.changes;
            let by_loads = changes.iter().filter(|row| row.change.starts_with("the loads"));
            let openings: Vec<[f64; 2]> =
                by_loads.filter_map(|row| Some(row.end?.openings)).collect();
            let far = openings.iter().any(|[before, after]| (after - before).abs() > PLATEAU);
            let after =
                openings.iter().map(|[_, after]| rounded(after.to_degrees(), 3)).joined(" and ");
            far.then(|| {
                found(format!(
                    "with loads 10 % lower and higher hinges open by {} in place of {} deg on the mean: a load does not determine the shape; fasten panels at \
                     their places, or prescribe the stroke",
                    after,
                    rounded(openings[0][0].to_degrees(), 3)
                ))
            })
        },
    ),
    rule(
        "mounting",
        Warning,
        [
            "a fastener cannot be put in after the others",
            "on the way of its hole a ligament tears, or no equilibrium is found, or the sheet ends in another state",
            "another order of the supports, more fasteners",
        ],
        |of| {
            let mounting = of.run?.mounting.as_ref()?;
            let tears = |damage: Option<f64>| damage.is_some_and(|damage| damage >= 1.0);
            let put_in = mounting.fasteners.len();
            let torn = mounting.fasteners.iter().position(|fastener| tears(fastener.damage));
            let message = match torn {
                Some(i) => format!(
                    "a ligament tears while panel P{} is pulled to its place",
                    mounting.fasteners[i].panel
                ),
                None if !mounting.is_complete() => {
                    format!(
                        "no equilibrium is found on the way of fastener {put_in} of {}",
                        mounting.count
                    )
                }
                None if mounting.apart > ELSEWHERE => format!(
                    "fastened one after the other the sheet ends in another state than the report has, corners up to {} mm away",
                    rounded(mounting.apart, 2)
                ),
                None => return None,
            };
            Some(found(message))
        },
    ),
    rule(
        "fastener-force",
        Warning,
        [
            "the force of a fastener",
            "it is more than half of what the edge of its hole bears (yield stress times thickness times diameter), or more than a hand holds on the way (150 N)",
            "more fasteners, larger holes; pull panels along",
        ],
        |of| {
            let fasteners = &of.run?.mounting.as_ref()?.fasteners;
            let over = |fastener: &&Fastener| {
                let bears = fastener.hole.map(|hole| borne_by_hole(&of.scene.material, hole));
                bears.is_some_and(|bears| fastener.holds > bears)
            };
            if let Some(Fastener { panel, holds, .. }) = fasteners.iter().find(over) {
                return Some(found(format!(
                    "the fastener of panel P{panel} holds {} N, more than half of what the edge of its hole bears",
                    rounded(*holds, 2)
                )));
            }
            let Fastener { panel, pull, .. } =
                fasteners.iter().find(|fastener| fastener.pull > HAND)?;
            Some(found(format!(
                "panel P{panel} is pulled to its place with up to {} N, more than one hand holds: pull the panels next to it along, or with two persons",
                rounded(*pull, 2)
            )))
        },
    ),
];

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

/// Weight or friction over load from which a sheet opens otherwise than without it.
const HEAVY: f64 = 0.05;
/// Ratio of the mass of hung weights to the mass of the sheet from which the weights are probably
/// given in another unit.
const HUNG: f64 = 50.0;

/// Findings of `kirigami verify --sheet`, which the report of a run repeats.
pub(super) const WHOLE_SHEET: Rule = rule(
    "whole-sheet",
    Note,
    [
        "by finite elements, ...",
        "what `kirigami verify --sheet` found; it replaces the line above",
        "as there",
    ],
    |_| None,
);

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
fn film_leaves_plane(of: &DeployedDesign, posture: Posture, kept: &str, widest: f64) -> Found {
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

/// Change of the mean opening under loads that are 10 % off from which a dead load is no recipe
/// (rad): five degrees.
const PLATEAU: f64 = 0.0873;

/// Distance of corners from which a mounted sheet has ended in another state (mm).
const ELSEWHERE: f64 = 0.5;

/// Force that a hand holds while a fastener is put in (N).
const HAND: f64 = 150.0;
