//! The searches and checks of a run, and the number of its findings.

use super::{Fact, fact, text};
use crate::report::deployed::{Deployed, Run};
use crate::report::numbers::rounded;
use analysis::design_checks::WholeSheet;
use analysis::levels::Levels;
use analysis::unit::Unit;
use scene::{CoarseSearch, Level, LevelDifference};
use support::severity::Severity;

pub(super) fn levels_and_findings(of: &Deployed, run: &Run) -> Vec<Fact> {
    let searches = &run.designed.coarse_searches;
    let mut facts: Vec<Fact> = searches.iter().map(coarse_search).collect();
    if searches.last().is_some_and(|last| !last.suffices()) {
        let level = of.scene.config.level;
        facts.push(text(COARSE_SEARCH, match run.designed.search.last().step {
            _ if level == Level::Final => {
                "not converged: all rounds of finite elements were made".into()
            }
            0 => "that is less than the mesh of the windows is known to: see its row of the error budget".into(),
            _ => format!(
                "searched on at `{level}`, and no level is finer: `kirigami verify --equilibrium` compares with finite elements"
            ),
        }));
    }
    facts.extend(run.estimate.map(|estimate| {
        let percent = |x: f64| format!("{:.1} %", 100.0 * x);
        let said = format!(
            "{} networks; standard deviation inside the domain: energy {}, forces {}, D_peak {}",
            estimate.networks,
            percent(estimate.energy),
            percent(estimate.forces),
            estimate.damage_peak.map_or("-".into(), percent)
        );
        fact(["ensemble"; 2], estimate, Unit::None, said)
    }));
    facts.extend(run.checks.levels.as_ref().map(levels));
    facts.extend(run.checks.whole_sheet.as_ref().map(whole_sheet));
    let counts = [Severity::Error, Severity::Warning, Severity::Note]
        .map(|severity| of.warnings.iter().filter(|found| found.severity == severity).count());
    let [errors, warnings, notes] = counts;
    let said = format!("errors {errors}, warnings {warnings}, notes {notes}");
    facts.push(fact(["findings"; 2], counts, Unit::None, said));
    facts
}

const COARSE_SEARCH: [&str; 2] = ["coarse_search", "coarse search"];

/// A search at a coarser level: its error, measured by the next finer one.
fn coarse_search(search: &CoarseSearch) -> Fact {
    let LevelDifference { corners, load, damage } = search.difference;
    let reference = match search.finer {
        Level::Final => "finite elements of every hinge".to_owned(),
        finer => format!("`{finer}`"),
    };
    let load = load.map(|load| format!(", the load by {} %", rounded(100.0 * load, 2)));
    let peak = damage.map(|peak| format!(", D_peak by {}", rounded(peak, 2)));
    text(
        COARSE_SEARCH,
        format!(
            "searched at the level `{}` in {} steps: its corners differ from {reference} by {} mm at most{}{}; tolerance: {} mm",
            search.level,
            search.steps,
            rounded(corners[1], 2),
            load.unwrap_or_default(),
            peak.unwrap_or_default(),
            rounded(search.tolerance, 3)
        ),
    )
}

/// The differences of the levels of a run to its finest one.
fn levels(levels: &Levels) -> Fact {
    let finest = levels.levels.last().map_or("", |level| level.level.name());
    let others = levels.levels.iter().filter_map(|level| {
        let corners = level.difference.as_ref()?.corners[1];
        Some(format!("`{}` {}", level.level, rounded(corners, 2)))
    });
    let others = others.collect::<Vec<_>>().join(", ");
    text(["levels"; 2], format!("largest difference of a corner to `{finest}`, mm: {others}"))
}

/// The whole sheet by finite elements.
fn whole_sheet(sheet: &WholeSheet) -> Fact {
    let [rms, largest] = sheet.corners.map(|length| rounded(length, 2));
    let load = sheet.load.map(|load| {
        let [law, elements] = load.map(|load| rounded(load, 4));
        format!("; load {elements} N, {law} N by the hinge law")
    });
    text(
        ["whole_sheet", "whole sheet"],
        format!(
            "by finite elements, {}: panels tilt by up to {} deg; corners {rms} mm (rms), {largest} mm at most, from the hinge law{}",
            sheet.support.in_words(),
            rounded(sheet.tilt_deg, 2),
            load.unwrap_or_default()
        ),
    )
}
