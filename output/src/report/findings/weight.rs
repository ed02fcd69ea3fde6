//! Findings about weight, friction and the load.

use super::{Found, Rule, found, rule};
use crate::report::deployed::Deployed;
use crate::report::numbers::rounded;
use crate::report::self_weight::of_the_load;
use analysis::unit::Unit;
use scene::{FRICTION, Posture};
use support::severity::Severity::Warning;

/// Weight or friction over load from which a sheet opens otherwise than without it.
const HEAVY: f64 = 0.05;
/// Ratio of the mass of hung weights to the mass of the sheet from which the weights are probably
/// given in another unit.
const HUNG: f64 = 50.0;

pub(super) const RULES: [Rule; 4] = [
    rule(
        "weight",
        Warning,
        [
            "the weight is not modelled",
            "it is more than 5 % of the load of a free sheet",
            "`posture.kind = \"hanging\"` with `down`",
        ],
        weightless,
    ),
    rule(
        "friction",
        Warning,
        [
            "friction on the surface",
            "it is more than 5 % of the load of a lying sheet",
            "lift or shake the sheet while it opens",
        ],
        friction,
    ),
    rule(
        "hung-weight",
        Warning,
        [
            "the weights that hang from the sheet",
            "they have more than fifty times its mass",
            "`mass_g` is in grams",
        ],
        hung_weight,
    ),
    rule(
        "load-peak",
        Warning,
        [
            "the load has a maximum",
            "a dead load of the final size, such as a hung weight, does not open the sheet",
            "move the panels by the stroke (`[drive]`) instead of loading them",
        ],
        load_peak,
    ),
];

/// A weight that acts in the plane of the sheet but not in the model.
fn weightless(of: &Deployed) -> Option<Found> {
    of.scene.surrogate()?;
    let weight = &of.run?.weight;
    let left_out =
        !weight.is_modelled && matches!(weight.posture?, Posture::Hanging | Posture::Free);
    let ratio = weight.over_load.filter(|ratio| left_out && *ratio > HEAVY)?;
    Some(found(format!(
        "the weight of the sheet is {} and not modelled: if it hangs, set posture.kind = \"hanging\" with `down`",
        of_the_load(ratio)
    )))
}

/// Friction that the design does not know of.
fn friction(of: &Deployed) -> Option<Found> {
    of.scene.surrogate()?;
    let weight = &of.run?.weight;
    let ratio = FRICTION * weight.over_load.filter(|_| weight.lies())?;
    (ratio > HEAVY).then(|| {
        found(format!(
            "friction on the surface, at mu = {FRICTION}, is {}, and the design does not contain it: lift or shake the sheet while \
             it opens, or reduce the friction",
            of_the_load(ratio)
        ))
    })
}

fn hung_weight(of: &Deployed) -> Option<Found> {
    let ratio = of.run?.weight.hung;
    (ratio > HUNG).then(|| {
        found(format!(
            "the weights that hang from the sheet have {} times its mass: mass_g is in grams; write 2 for two grams",
            rounded(ratio, 2)
        ))
    })
}

fn load_peak(of: &Deployed) -> Option<Found> {
    let reached = of.run?.reached.as_ref()?;
    let peak = reached.peak?;
    let [length, force] = reached.units;
    let [maximum, at, last, end, carried] =
        [peak.load, peak.displacement, reached.load, reached.displacement, peak.dead_load_reaches?]
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
}
