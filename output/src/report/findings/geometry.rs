//! Findings about the target, the panels and their windows, and the cuts.

use super::{Rule, at, found, rule};
use crate::{
    cut_file::fits,
    display::Shape,
    report::{
        deployed::{DeployedDesign, miss},
        numbers::rounded,
    },
};
use design::{
    equilibrium::load_step::LoadStep,
    geometry::polygon::size,
    sheet::{
        hinge_window::HingeWindow,
        validity::{OVERLAP, overlap},
    },
};
use scene::placement::{NOT_SEEN, RECOGNISED, seen};
use support::severity::Severity::{Error, Note, Warning};

/// Mean opening of the hinges (rad) that is rounding.
const SHUT: f64 = -1e-6;
/// How much less of the target is seen after a search: rounding is smaller.
const LESS: f64 = 5e-4;
/// Distance of the outline from the target over the longer side of the flat sheet from which it is
/// a note, a warning and an error.
const MISSED: [f64; 3] = [0.01, 0.03, 0.2];

pub(super) const RULES: [Rule; 9] = [
    rule(
        "target-not-recognised",
        Warning,
        [
            "less than 90 % of the target is seen",
            "a viewer would not recognise it; an error below 75 %",
            "a larger stock or a thinner sheet, without parts narrower than two panels",
        ],
        |of| {
            // Sheets of an even pattern are made to be recognised; others are compared by their outline.
            of.scene.config.cells.as_ref()?;
            let seen = of.run.map_or_else(|| seen(of.scene, of.deployment), |run| run.seen);
            let grave = if seen < NOT_SEEN { Error } else { Warning };
            (seen < RECOGNISED).then(|| {
                let seen = rounded(100.0 * seen, 3);
                found(format!("{seen} % of the target is seen: a viewer would not recognise it"))
                    .with(grave)
            })
        },
    ),
    rule(
        "search-shows-less",
        Warning,
        [
            "the search shows less of the target",
            "the best design by its loss is a worse picture than the start",
            "an even pattern needs no search: `--steps 0`",
        ],
        |of| {
            let run = of.run.filter(|run| run.designed.search.last().step > 0)?;
            of.scene.config.cells.as_ref()?;
            let before = seen(of.scene, &run.designed.start.deployment);
            (before - run.seen > LESS).then(|| {
                let [before, after] = [before, run.seen].map(|part| rounded(100.0 * part, 3));
                found(format!(
                    "after the search {after} % of the target is seen, before it {before} %"
                ))
            })
        },
    ),
    rule(
        "target-missed",
        Note,
        [
            "the outline misses its target",
            "its distance is above 1 % of the longer side; a warning from 3 %, an error from 20 %",
            "another target, more panels, a larger stroke or load",
        ],
        |of| {
            let error = of.run?.after.outline_error;
            let [width, height] = of.flat_size();
            let ratio = error / width.max(height);
            let mut grave =
                std::iter::zip(MISSED, [Note, Warning, Error]).filter(|(least, _)| ratio > *least);
            let (_, severity) = grave.next_back()?;
            let seen = of.run?.seen;
            Some(found(miss(seen, error, of.flat_size())).with(severity))
        },
    ),
    rule(
        "panels-overlap",
        Error,
        [
            "panels overlap, or cuts are closed further than flat",
            "no sheet moves like that; a warning before the end of the path",
            "a larger target, or more loads that open the cuts",
        ],
        |of| {
            // Panels cannot lie over each other, for any hinge law. On the way the edges of closed cuts,
            // which are softer in the model than in the sheet, may let them by a little.
            let DeployedDesign { deployment, hinges, .. } = of;
            let covered = |step: &LoadStep| overlap(&deployment.sheet, &step.configuration);
            let at_the_end = covered(deployment.final_step());
            let openings = hinges.iter().map(|row| row.theta_deg.to_radians());
            let mean = openings.sum::<f64>() / hinges.len() as f64;
            let lie = |most: f64| {
                let most = rounded(100.0 * most, 2);
                format!("panels lie over each other, by up to {most} % of the area of a panel")
            };
            let mut causes = Vec::new();
            if mean < SHUT {
                let mean = rounded(mean.to_degrees(), 3);
                causes.push(format!(
                    "the cuts are closed further than in the flat sheet, by a mean opening of {mean} deg"
                ));
            }
            if at_the_end > OVERLAP {
                causes.push(lie(at_the_end));
            }
            if !causes.is_empty() {
                return Some(found(format!(
                    "{}: no sheet moves like that; use a larger target, or loads that open the cuts",
                    causes.join(", and ")
                )));
            }
            let most = deployment.path.iter().map(covered).fold(0.0, f64::max);
            (most > OVERLAP).then(|| {
                let message = format!(
                    "on the way, {}: the edges of a closed cut press against each other in the sheet, and its load is larger there; pull at \
                     more panels",
                    lie(most)
                );
                found(message).with(Warning)
            })
        },
    ),
    rule(
        "windows-overlap",
        Warning,
        [
            "windows overlap",
            "the sum of the hinge energies is not exact",
            "`objective.panel_shape` above zero, larger panels",
        ],
        |of| {
            let sheet = &of.deployment.sheet;
            let windows = HingeWindow::of_sheet(sheet);
            let overlapping = |h: &usize| {
                let mut others = windows.iter().enumerate().filter(|(other, _)| other != h);
                others.any(|(_, other)| windows[*h].overlaps(other))
            };
            let message = format!(
                "windows of {} mm radius overlap: their ligaments are not independent, and the sum of \
                 hinge energies is not exact",
                sheet.options.process.r_win
            );
            at((0..windows.len()).filter(overlapping).collect(), message)
        },
    ),
    rule(
        "windows-leave-panels",
        Note,
        [
            "panels too small for their windows",
            "the sum of the hinge energies is not exact",
            "as above",
        ],
        |of| {
            let sheet = &of.deployment.sheet;
            let windows = HingeWindow::of_sheet(sheet).into_iter().zip(&sheet.hinges);
            let leaving = windows.enumerate().filter(|(_, (window, hinge))| {
                let [a, b] = hinge.panels().map(|panel| &sheet.panels[panel]);
                !window.within(a, b)
            });
            let r_win = sheet.options.process.r_win;
            let message =
                format!("panels are too small for the {r_win} mm windows of their hinges");
            at(leaving.map(|(h, _)| h).collect(), message)
        },
    ),
    rule(
        "cannot-be-cut",
        Error,
        [
            "a slit or a hole vanishes",
            "there are no cut lines",
            "narrower ligaments, longer cuts; wider ligaments, larger holes (`fillet_ratio`, `hole_diameter`)",
        ],
        |of| of.cuts.as_ref().err().map(|error| found(error.to_string())),
    ),
    rule(
        "cuts-too-close",
        Error,
        [
            "another cut comes closer to the tip than w_lig",
            "the ligament is narrower than designed",
            "`objective.panel_shape`, narrower range",
        ],
        |of| {
            let cuts = of.cuts.as_ref().ok()?;
            let rounding = cuts.rounding();
            let close = of.hinges_where(|row| cuts.clearance(row.hinge) < row.w_lig - rounding);
            at(close, "another cut is closer to the tip than w_lig")
        },
    ),
    rule(
        "stock-too-small",
        Warning,
        [
            "the cuts do not fit on the stock",
            "they are larger than `cutting.stock` without its margin",
            "a smaller `sheet.size`, or `init --stock`",
        ],
        |of| {
            // The cuts of a sheet are within the stock that it is cut from.
            let cuts = of.cuts.as_ref().ok()?;
            let stock = cuts.cutting.stock?.size();
            let taken = size(Shape::extent(cuts.drawing().cuts()));
            let room = stock.map(|side| (side - 2.0 * cuts.cutting.margin).max(0.0));
            (!fits(taken, room.map(|side| side + cuts.rounding()))).then(|| {
                found(format!(
                    "the cuts take {:.1} x {:.1} mm with kerf and over-run, but the stock has {:.1} x {:.1} mm inside its margin: use a smaller \
                     sheet.size",
                    taken[0], taken[1], room[0], room[1]
                ))
            })
        },
    ),
];
