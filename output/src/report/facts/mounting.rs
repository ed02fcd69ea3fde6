//! How the sheet is mounted, fastener by fastener, and what becomes of it if one thing is not as
//! designed.

use super::{Fact, fact};
use crate::report::{
    deployed::{DeployedDesign, FinishedRun},
    numbers::rounded,
};
use analysis::{
    mounting::{ByHand, Fastener},
    what_if::{ChangedSheet, WhatIf},
};

/// The steps of a mounted sheet.
pub(super) fn mounting(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let Some(mounting) = &run.mounting else { return Vec::new() };
    let [width, height] = mounting.board(&of.deployment.sheet);
    let board = format!("at least {width:.0} x {height:.0} mm, with {} fasteners", mounting.count);
    let steps = mounting.fasteners.iter().enumerate();
    let steps = steps.map(|(i, fastener)| fact("mounting", fastener, step(i + 1, fastener)));
    let by_hand = mounting.by_hand.map(|it| fact("mounting", it, open_by_hand(&it)));
    [fact("board", [width, height], board)].into_iter().chain(by_hand).chain(steps).collect()
}

/// What both hands do first.
pub(crate) fn open_by_hand(of: &ByHand) -> String {
    let [opened, stays] = [of.opened, of.stays].map(f64::to_degrees);
    format!(
        "First open the sheet evenly, all round, until its hinges have turned by {opened:.0} deg, and release it: about {stays:.0} deg stay. A hinge takes \
         up to {} N mm",
        rounded(of.moment, 2)
    )
}

/// What the hand does for a fastener.
pub(crate) fn step(number: usize, of: &Fastener) -> String {
    let panel = of.panel;
    if number == 1 {
        return format!("1: fasten panel P{panel} at place 1, free to turn");
    }
    let damage = match (of.outside, of.damage) {
        (1.., _) => format!(
            "; the weights do not know the way of {} of the ligaments: move the panels next to it along",
            of.outside
        ),
        (0, Some(1.0..)) => "; a ligament tears on the way".to_owned(),
        (0, Some(damage)) => {
            format!("; a ligament reaches {:.2} of its tear", (100.0 * damage).floor() / 100.0)
        }
        (0, None) => String::new(),
    };
    format!(
        "{number}: pull panel P{panel} by {} mm to place {number}, with {} N at most; its fastener holds {} N in the end{damage}",
        rounded(of.way, 2),
        rounded(of.pull, 2),
        rounded(of.holds, 2)
    )
}

/// The sheet with one thing changed.
pub(super) fn what_if(_: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    run.changes.iter().map(|row| fact("what if", row, changed(row))).collect()
}

fn changed(WhatIf { change, end }: &WhatIf) -> String {
    let Some(ChangedSheet { seen, corners, openings }) = end else {
        return format!("{change}: no equilibrium is found");
    };
    let [rms, most] = corners.map(|length| rounded((1e3 * length).round() / 1e3, 2));
    let [before, after] = openings.map(|angle| rounded(angle.to_degrees(), 3));
    format!(
        "{change}: {} % of the target is seen, corners move by {rms} mm (root mean square), {most} mm at most; mean opening {after} in place of \
         {before} deg",
        rounded(100.0 * seen, 3)
    )
}
