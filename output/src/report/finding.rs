//! Findings about a run as a whole: what its model leaves out, what its weights are worth, how well it meets its target.

use crate::report::columns::rounded;
use crate::report::fact_sheet::{FactSheet, Reached, WeightFacts};
use crate::report::self_weight::of_the_load;
use crate::report::warning::{Concern, Warning};
use design::objective::scores::Scores;
use design::scene::Scene;
use design::scene::design_run::Designed;

/// Weight over load above which the sheet may not open as computed.
const HEAVY: f64 = 0.1;
/// Distance of the outline from the target over the longer side of the flat sheet from which the target is missed.
const MISSED: f64 = 0.01;
/// Relative error of a force (%) above which a law is inaccurate.
const INACCURATE: f64 = 10.0;

/// All findings about a run with these facts, whose best design has the scores `after`.
pub(super) fn of_run(
    scene: &Scene,
    designed: &Designed,
    facts: &FactSheet,
    after: &Scores,
) -> Vec<Warning> {
    let learned = scene.surrogate().is_some();
    [
        learned.then(|| not_modelled(facts)),
        learned.then(|| heavy(facts)).flatten(),
        facts.reached.as_ref().and_then(load_peak),
        facts.weights.as_ref().and_then(inaccurate),
        facts.weights.as_ref().and_then(outside),
        missed(facts, after),
        other_branch(designed),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn not_modelled(facts: &FactSheet) -> Warning {
    Concern::NotModelled.of_sheet(format!(
        "the panels are held flat in the model. Not modelled: panels that leave the plane, as those of a thin sheet do where \
         nothing holds them; the weight of the sheet, {}",
        facts.self_weight.beside_load()
    ))
}

fn heavy(facts: &FactSheet) -> Option<Warning> {
    let ratio = facts.self_weight.over_load.filter(|ratio| *ratio > HEAVY)?;
    Some(Concern::Weight.of_sheet(format!(
        "the weight of the sheet is {} and not modelled: a sheet that hangs or stands deploys otherwise, and one that lies \
         is also held by friction",
        of_the_load(ratio)
    )))
}

fn load_peak(reached: &Reached) -> Option<Warning> {
    let peak = reached.peak?;
    let carried = peak.dead_load_reaches?;
    let [length, force] = reached.units;
    let [maximum, at, last, end, carried] = [
        peak.load,
        peak.displacement,
        reached.load,
        reached.displacement,
        carried,
    ]
    .map(|value| rounded(value, 4));
    let consequence = match reached.load * reached.displacement > 0.0 {
        true => format!(
            "a dead load of {last} {force}, such as a hung weight, opens this sheet by {carried} {length} and not by {end} \
             {length}"
        ),
        false => format!(
            "no dead load opens this sheet by {end} {length}: the load has changed its direction there, to {last} {force}"
        ),
    };
    Some(Concern::LoadPeak.of_sheet(format!(
        "the load has a maximum of {maximum} {force} at a stroke of {at} {length}: {consequence}"
    )))
}

/// Weights whose forces are off by more than a tenth, at unseen rays or at their spot check.
fn inaccurate(weights: &WeightFacts) -> Option<Warning> {
    let spot_check = weights.spot_check.as_ref();
    let errors = [
        (Some(&weights.errors_percent), "unseen"),
        (spot_check.map(|check| &check.errors_percent), "random"),
    ];
    let names = ["F_a", "F_s", "M_theta"];
    let forces = errors.iter().flat_map(|(errors, states)| {
        let forces = errors.iter().flat_map(|errors| &errors[1..4]);
        std::iter::zip(names, forces).map(move |(name, error)| (*error, name, *states))
    });
    let (error, name, states) = forces
        .filter(|(error, ..)| *error > INACCURATE)
        .max_by(|one, other| one.0.total_cmp(&other.0))?;
    Some(Concern::WeakWeights.of_sheet(format!(
        "the weights {} are inaccurate: {name} is off by {} % at {states} states; solve more rays, or check this design by \
         `kirigami verify --equilibrium`",
        weights.file,
        rounded(error, 3)
    )))
}

/// Weights whose spot check mostly lies outside their training domain.
fn outside(weights: &WeightFacts) -> Option<Warning> {
    let check = weights.spot_check.as_ref()?;
    let inside = check.inside.filter(|inside| 2 * inside < check.states)?;
    Some(Concern::WeakWeights.of_sheet(format!(
        "only {inside} of {} states of the spot check lie inside the training domain of the weights {}: its errors say \
         little about them; solve more rays",
        check.states, weights.file
    )))
}

fn missed(facts: &FactSheet, after: &Scores) -> Option<Warning> {
    let [width, height] = facts.flat_size;
    let ratio = after.outline_error / width.max(height);
    (ratio > MISSED).then(|| {
        Concern::TargetMissed.of_sheet(format!(
            "the outline misses the target by {} mm (root mean square), {} % of the longer side of the flat sheet",
            rounded(after.outline_error, 3),
            rounded(100.0 * ratio, 2)
        ))
    })
}

fn other_branch(designed: &Designed) -> Option<Warning> {
    designed.contradicted.then(|| {
        Concern::OtherBranch.of_sheet(
            "during the search a corrected path was on another branch than the path followed from the flat sheet: the designs \
             found by it are not used, and the search went on from the best design whose path was followed"
                .into(),
        )
    })
}
