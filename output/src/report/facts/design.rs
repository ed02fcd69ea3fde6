//! What the sheet is made of, what its hinge law rests on, and the searches and checks of the run.

use super::{Fact, fact, number, text};
use crate::{
    cut_file::Machines,
    report::{
        deployed::{DeployedDesign, FinishedRun, extent},
        force_spreads::force_spreads,
        numbers::rounded,
    },
};
use analysis::{design_checks::WholeSheet, levels::Levels, unit::Unit};
use design::{pattern::grid::Grid, sheet::kinematics::deployed_boundaries};
use scene::{CoarseSearch, Level, LevelDifference};
use serde_json::json;
use support::{Joined, severity::Severity, statistics::root_mean_square};
use surrogate::TestErrors;

pub(super) fn material_and_size(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let (scene, sheet) = (of.scene, &of.deployment.sheet);
    let opened = deployed_boundaries(sheet, &of.deployment.final_step().configuration);
    let size = |label, size: [f64; 2], remark| {
        let [x, y] = size.map(|length| rounded(length, 5));
        let unit = Unit::Millimetre;
        Fact { unit, ..fact(label, size, format!("{x} x {y} {unit}{remark}")) }
    };
    let material = &scene.material;
    let thickness = rounded(material.thickness, 4);
    let (panels, Grid { m, n }) = (sheet.topology.panel_count(), sheet.topology.grid);
    let arranged = if sheet.topology.is_full() { ", " } else { ", some cells of " };
    let level = scene.config.level;
    let deployed = extent(opened.into_iter().flatten());
    let remark = ": common area over the area of both, gaps between opened panels closed";
    vec![
        number("target seen", 100.0 * run.seen, 3, Unit::Percent, remark),
        fact("material", &material.name, format!("{}, {thickness} mm thick", material.name)),
        number("mass", of.mass_kg(), 4, Unit::Kilogram, ", uncut"),
        fact("panels", panels, format!("{panels}{arranged}{m} x {n}")),
        size("flat size", of.flat_size(), ""),
        size("deployed size", deployed, ", panels in the plane"),
        fact("level", level, format!("{level}, {}", level.hinges())),
    ]
}

/// The services whose published limits the cuts keep.
pub(super) fn services(of: &DeployedDesign, _: &FinishedRun) -> Vec<Fact> {
    let Ok(cuts) = of.cuts else { return Vec::new() };
    let (features, thickness) = (cuts.features(), of.scene.material.thickness);
    let services = Machines::shipped().service.into_iter();
    let [accepting, refusing]: [Vec<String>; 2] = {
        let (accept, refuse): (Vec<_>, Vec<_>) =
            services.partition(|service| service.refusals(&features, thickness).is_empty());
        [accept, refuse].map(|services| services.into_iter().map(|service| service.name).collect())
    };
    let said = match (&accepting[..], &refusing[..]) {
        ([], _) => "none whose published limits it keeps; `kirigami init --for SERVICE` makes a sheet for one".to_owned(),
        (_, []) => format!("it keeps the limits that {} publish", accepting.join(", ")),
        _ => format!(
            "it keeps the limits that {} publish (some publish their kerf alone), and breaks a limit of {}",
            accepting.join(", "),
            refusing.join(", ")
        ),
    };
    vec![fact("services", accepting, said)]
}

/// BLAKE3 hashes: the keys of the scene without title and run folder, the law of the material, the
/// points of the target, and everything that the predictions of the weights depend on.
pub(super) fn hashes(of: &DeployedDesign, _: &FinishedRun) -> Vec<Fact> {
    let scene = of.scene;
    let short = |label, hash: String| {
        let short: String = hash.chars().take(16).collect();
        fact(label, hash, short)
    };
    let weights = scene.weights().map(|weights| weights.hash());
    (weights.map(|hash| short("hash of weights", hash)).into_iter())
        .chain([
            short("hash of scene", scene.hash()),
            short("hash of material", scene.material.law_hash()),
            short("hash of target", scene.target.hash()),
            text("kirigami", env!("CARGO_PKG_VERSION").to_owned()),
        ])
        .collect()
}

pub(super) fn domain_and_weights(of: &DeployedDesign, _: &FinishedRun) -> Vec<Fact> {
    let (scene, mut facts) = (of.scene, Vec::new());
    let Some(weights) = scene.weights() else { return facts };
    if scene.surrogate().is_some() {
        let inside = 100.0 * of.deployment.share_inside();
        facts.push(number("inside domain", inside, 4, Unit::Percent, " of the hinge states"));
    }
    let card = weights.card();
    let rays =
        card.training_rays.map_or("an unknown number of".to_owned(), |rays| rays.to_string());
    let trained =
        format!("{}, trained on {rays} rays of the mesh `{}`", of.weights_file(), card.tier);
    facts.push(text("weights", trained));
    let predicted = if card.peak_scale.is_some() { 6 } else { 5 };
    let errors = |label, errors: &TestErrors, kind, remark: String| {
        let percents = &errors.percents()[..predicted];
        let said = format!("{} % (rms, {} {kind} states){remark}", listed(percents), errors.rows);
        Fact { unit: Unit::Percent, ..fact(label, percents, said) }
    };
    facts.push(errors("test errors", &card.test_errors, "unseen", String::new()));
    facts.extend(card.spot_check.as_ref().map(|check| {
        let inside = format!(", {} of them inside the domain", check.inside);
        errors("spot check", &check.errors, "random", inside)
    }));
    facts.extend(card.visited.as_ref().map(|check| {
        let sheets = ", on the paths of designed sheets".to_owned();
        errors("visited states", &check.errors, "visited", sheets)
    }));
    facts
}

/// Errors (%) of W, F_a, F_s, M_theta, D and D_peak as one line.
fn listed(percents: &[f64]) -> String {
    let names = ["W", "F_a", "F_s", "M_theta", "D", "D_peak"];
    let errors = std::iter::zip(names, percents).map(|(name, error)| match error.is_nan() {
        true => format!("{name} -"),
        false => format!("{name} {}", rounded(*error, 3)),
    });
    errors.joined(", ")
}

pub(super) fn levels_and_findings(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let searches = &run.designed.coarse_searches;
    let mut facts: Vec<Fact> = searches.iter().map(coarse_search).collect();
    let exceeds = |last: &&CoarseSearch| last.tolerance.is_some_and(|mm| !last.is_within(mm));
    if let Some(last) = searches.last().filter(exceeds) {
        let level = of.scene.config.level;
        facts.push(text(COARSE_SEARCH, match last.suffices() {
            _ if level == Level::Final => {
                "not converged: all rounds of finite elements were made".into()
            }
            true => "that is less than the mesh of the windows is known to: see its row of the error budget".into(),
            false => format!(
                "searched on at `{level}`, and no level is finer: `kirigami verify --equilibrium` compares with finite elements"
            ),
        }));
    }
    let networks = of.scene.networks();
    let spreads = force_spreads(networks, of.deployment).into_iter().flatten().flatten();
    let inside: Vec<f64> = spreads.filter(|spread| !spread.is_nan()).collect();
    if !inside.is_empty() {
        let (networks, forces) = (networks.len(), root_mean_square(inside));
        let said = format!(
            "{networks} networks, whose forces differ by {:.1} % inside the domain (standard deviation)",
            100.0 * forces
        );
        facts.push(fact("ensemble", json!({ "networks": networks, "forces": forces }), said));
    }
    facts.extend(run.checks.levels.as_ref().map(levels));
    facts.extend(run.checks.whole_sheet.as_ref().map(whole_sheet));
    let counts = [Severity::Error, Severity::Warning, Severity::Note]
        .map(|severity| of.severities.iter().filter(|found| **found == severity).count());
    let [errors, warnings, notes] = counts;
    let said = format!("errors {errors}, warnings {warnings}, notes {notes}");
    facts.push(fact("findings", counts, said));
    facts
}

const COARSE_SEARCH: &str = "coarse search";

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
            "searched at the level `{}` in {} steps: its corners differ from {reference} by {} mm at most{}{}{}",
            search.level,
            search.steps(),
            rounded(corners[1], 2),
            load.unwrap_or_default(),
            peak.unwrap_or_default(),
            match search.tolerance {
                Some(tolerance) => format!("; tolerance: {} mm", rounded(tolerance, 3)),
                None => format!("; the search went on at `{}`", search.finer),
            }
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
    let others = others.joined(", ");
    text("levels", format!("largest difference of a corner to `{finest}`, mm: {others}"))
}

/// The whole sheet by finite elements.
fn whole_sheet(sheet: &WholeSheet) -> Fact {
    let [rms, largest] = sheet.corners.map(|length| rounded(length, 2));
    let load = sheet.load.map(|load| {
        let [law, elements] = load.map(|load| rounded(load, 4));
        format!("; load {elements} N, {law} N by the hinge law")
    });
    text(
        "whole sheet",
        format!(
            "by finite elements, {}: panels tilt by up to {} deg; corners {rms} mm (rms), {largest} mm at most, from the hinge law{}",
            sheet.support.in_words(),
            rounded(sheet.tilt_deg, 2),
            load.unwrap_or_default()
        ),
    )
}
