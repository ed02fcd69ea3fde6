//! How the sheet is mounted, fastener by fastener, and what becomes of it if one thing is not as
//! designed.

use super::{Fact, fact};
use crate::report::{
    deployed::{DeployedDesign, FinishedRun},
    numbers::rounded,
};
use analysis::{
    mounting::Fastener,
    what_if::{ChangedSheet, WhatIf},
};

/// The steps of a mounted sheet.
pub(super) fn mounting(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let Some(mounting) = &run.mounting else { return Vec::new() };
    let [width, height] = mounting.board(&of.deployment.sheet);
    let board = format!("at least {width:.0} x {height:.0} mm, with {} fasteners", mounting.count);
    let steps = mounting.fasteners.iter().enumerate();
    let steps = steps.map(|(i, fastener)| fact("mounting", fastener, step(i + 1, fastener)));
    [fact("board", [width, height], board)].into_iter().chain(steps).collect()
}

/// What the hand does.
pub(crate) fn step(number: usize, of: &Fastener) -> String {
    let panel = of.panel;
    if number == 1 {
        return format!("1: fasten panel P{panel} at place 1, free to turn");
    }
    let outside = match of.outside {
        1 => "1 hinge leaves".to_owned(),
        count => format!("{count} hinges leave"),
    };
    let damage = match of.damage {
        _ if of.outside > 0 => {
            format!("; {outside} the training domain on the way: move the panels next to it along")
        }
        Some(damage) => format!("; largest damage on the way {}", rounded(damage, 2)),
        None => String::new(),
    };
    format!(
        "{number}: pull panel P{panel} by {} mm to place {number}, with {} N at most; its fastener holds {} N in the end{damage}",
        rounded(of.way_length(), 2),
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
