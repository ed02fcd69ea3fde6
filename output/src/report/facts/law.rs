//! What the hinge law rests on: its training domain and its weights.

use super::{Fact, fact, number, text};
use crate::report::deployed::{Deployed, Run};
use crate::report::numbers::rounded;
use analysis::unit::Unit;
use surrogate::TestErrors;

pub(super) fn domain_and_weights(of: &Deployed, _: &Run) -> Vec<Fact> {
    let (scene, mut facts) = (of.scene, Vec::new());
    let gamma = of.hinges.iter().filter_map(|row| row.gamma).min_by(f64::total_cmp);
    if let Some(gamma) = gamma {
        let said = format!("{}, for a sheet that lies on a surface", rounded(gamma, 4));
        facts.push(fact(["gamma_min", "minimum Gamma"], gamma, Unit::None, said));
    }
    let Some(weights) = scene.weights() else { return facts };
    if scene.surrogate().is_some() {
        let inside = 100.0 * of.deployment.share_inside();
        let names = ["inside_domain", "inside domain"];
        facts.push(number(names, inside, 4, Unit::Percent, " of the hinge states"));
    }
    let card = weights.card();
    let rays =
        card.training_rays.map_or("an unknown number of".to_owned(), |rays| rays.to_string());
    let trained =
        format!("{}, trained on {rays} rays of the mesh `{}`", of.weights_file(), card.tier);
    facts.push(text(["weights"; 2], trained));
    let predicted = if card.peak_scale.is_some() { 6 } else { 5 };
    let errors = |names, errors: &TestErrors, kind, remark: String| {
        let percents = &errors.percents()[..predicted];
        let said = format!("{} % (rms, {} {kind} states){remark}", listed(percents), errors.rows);
        fact(names, percents, Unit::Percent, said)
    };
    let names = ["test_errors", "test errors"];
    facts.push(errors(names, &card.test_errors, "unseen", String::new()));
    facts.extend(card.spot_check.as_ref().map(|check| {
        let inside = format!(", {} of them inside the domain", check.inside);
        errors(["spot_check", "spot check"], &check.errors, "random", inside)
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
    errors.collect::<Vec<_>>().join(", ")
}
