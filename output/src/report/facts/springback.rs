//! What becomes of the opening of a sheet: under a load that stays, and when the load is taken off.

use super::{Fact, fact};
use crate::report::deployed::{Deployed, Run};
use crate::report::numbers::rounded;
use analysis::springback::{ResidualShape, TOO_FAR, moment_after_overshoot, unload};
use analysis::unit::Unit;
use hinge::Creep;
use surrogate::SpringbackErrors;

/// Young's modulus above which a sheet is a metal (MPa).
const METAL: f64 = 40_000.0;

pub(super) fn springback_and_creep(of: &Deployed, run: &Run) -> Vec<Fact> {
    let (scene, problem) = (of.scene, &run.designed.problem);
    if problem.model.mechanics().is_none() {
        return Vec::new();
    }
    let creep = scene.material.creep.as_ref();
    let creep = fact(["creep"; 2], creep, Unit::None, creeping(creep));
    // Hinges of other laws are elastic: nothing stays.
    if scene.surrogate().is_none() {
        return vec![creep];
    }
    let metal = if scene.material.young > METAL {
        "; metals yield sooner in reverse, which is not modelled: with kinematic hardening hinges of steel spring back by up to twice \
         as far, of aluminium by four times (docs/results/springback)"
    } else {
        ""
    };
    let springback = |shape: Option<&ResidualShape>, text: String| {
        fact(["springback"; 2], shape, Unit::None, text + metal)
    };
    let Some(law) = &scene.springback else {
        let unknown = "not known: the sheet springs back when the load is taken off, and the scene names no law of released hinges \
                       (surrogate.springback)";
        return vec![springback(None, unknown.into()), creep];
    };
    match unload(scene, problem, law, of.deployment) {
        Err(error) => vec![springback(None, format!("not known: {error}")), creep],
        Ok(shape) => {
            let moments = moment_after_overshoot(scene, problem, law, of.deployment);
            let unloaded = springback(Some(&shape), residual_opening(&shape, law.errors.as_ref()));
            vec![unloaded, overshoot(moments), creep]
        }
    }
}

/// The moments of hinges that were opened too far and brought back, over the reported moments.
fn overshoot(moments: Option<f64>) -> Fact {
    let percent = 100.0 * TOO_FAR;
    let text = match moments {
        Some(fraction) => format!(
            "do not open it further than this: {percent:.0} % further and back again, its hinges hold with {:.0} % of their moments, by the law \
             of released hinges",
            100.0 * fraction
        ),
        None => format!(
            "not known: {percent:.0} % further, hinges leave the training domain of the law"
        ),
    };
    fact(["after_overshoot", "opened too far"], moments, Unit::None, text)
}

fn residual_opening(shape: &ResidualShape, errors: Option<&SpringbackErrors>) -> String {
    let [loaded, free] = shape.mean_rotations().map(f64::to_degrees);
    let ratio = shape.share().map_or(String::new(), |ratio| format!(", {:.0} %", 100.0 * ratio));
    let [rms, most] = shape.corners.map(|length| rounded(length, 3));
    let snaps = if shape.snaps { "; the sheet snaps to another state on the way" } else { "" };
    let law = match errors {
        Some(law) => format!(
            "the law of released hinges is off by {} deg (root mean square at {} hinges that it has not seen); the errors of the forces \
             are added",
            rounded(law.rest[2].to_degrees(), 2),
            law.hinges
        ),
        None => "the error of the law of released hinges is not known".into(),
    };
    format!(
        "of a mean opening of {} deg {} stay when the load is taken off{ratio}; corners move by {rms} mm (root mean square), \
         {most} mm at most{snaps}; {law}",
        rounded(loaded, 3),
        rounded(free, 3),
    )
}

/// What a load that stays does to the sheet.
fn creeping(known: Option<&Creep>) -> String {
    let Some(Creep { ratio, years }) = known else {
        return "not modelled, and not known: the material file has no figure ([creep]). Polymers under a load that stays keep deforming"
            .into();
    };
    format!(
        "not modelled: under a load that stays the stiffness of the material falls to about 1/{ratio} in {years} years, by order of \
         magnitude. A dead load opens the sheet further, and at a held stroke the force falls"
    )
}
