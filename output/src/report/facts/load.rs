//! Load and stroke, how the sheet is held, its weight, and what becomes of its opening: under a load
//! that stays, and when the load is taken off.

use super::{Fact, fact, number, text};
use crate::report::{
    deployed::{DeployedDesign, FinishedRun, is_heavy, of_the_load, posture},
    numbers::rounded,
};
use analysis::{
    springback::{ResidualShape, TOO_FAR, moment_after_overshoot, unload},
    unit::Unit,
};
use design::equilibrium::load_step::Status;
use hinge::{Creep, Regime};
use scene::{FRICTION, Posture};
use surrogate::SpringbackErrors;

pub(super) fn load_and_stroke(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let Some(reached) = &run.reached else { return Vec::new() };
    let [length, force] = reached.units;
    let last = of.deployment.final_step();
    let early = last.status == Status::Diverged;
    let end = if early { ", where the path ends early" } else { "" };
    let factor = format!(", load factor {}{end}", rounded(last.load_factor, 4));
    let mut facts = vec![number("load reached", reached.load, 4, force, &factor)];
    facts.extend(reached.peak.map(|peak| {
        let stroke = rounded(peak.displacement, 4);
        let at = format!(" at a stroke of {stroke} {length}");
        number("largest load", peak.load, 4, force, &at)
    }));
    if !reached.limit_points.is_empty() {
        facts.push(text("stable parts", reached.stable_parts()));
    }
    let stroke_of = format!(", {}", reached.stroke_of);
    facts.push(number("stroke reached", reached.displacement, 4, length, &stroke_of));
    facts.extend(reached.stiffness.map(|stiffness| {
        let unit = match force {
            Unit::Newton => Unit::NewtonPerMillimetre,
            _ => Unit::NewtonMillimetrePerRadian,
        };
        number("stiffness", stiffness, 4, unit, " at the end of the path")
    }));
    facts
}

pub(super) fn holding_and_weight(of: &DeployedDesign, _: &FinishedRun) -> Vec<Fact> {
    if !of.scene.hinge.carries_load() {
        return Vec::new();
    }
    let attachments = of.scene.actuation().attachments.into_iter().map(|attachment| {
        let panel = &of.deployment.sheet.panels[attachment.panel];
        let [x, y] = panel.position(attachment.point).map(|x| rounded(x, 5));
        let mut said = format!("{}, at ({x}, {y}) mm", attachment.name);
        for (what, size) in [("hole", attachment.hole), ("clip", attachment.clip)] {
            said += &size.map_or(String::new(), |size| format!(", {what} {} mm", rounded(size, 4)));
        }
        text("attachment", said)
    });
    let relative = |multiple: f64| {
        let ratio = of.weight_over_load().map(|ratio| of_the_load(multiple * ratio));
        ratio.map_or(String::new(), |ratio| format!(", {ratio}"))
    };
    let modelled = if is_heavy(of.scene) { "modelled" } else { "not modelled" };
    let remark = format!("{}; {modelled}", relative(1.0));
    let mut facts: Vec<Fact> = attachments.collect();
    facts.push(number("weight", of.weight(), 3, Unit::Newton, &remark));
    if posture(of.scene) == Some(Posture::Lying) {
        let remark = format!(
            "{}, while all panels slide at mu = {FRICTION}; not in the design",
            relative(FRICTION)
        );
        facts.push(number("friction", FRICTION * of.weight(), 3, Unit::Newton, &remark));
    }
    facts
}

/// What an earlier fold does to a film.
const FOLDED_BEFORE: &str = "not modelled, nor in the damage: a hinge of polyester film that had been folded to 90 deg opened with 233 N \
                             instead of 287 N and tore (one coupon each, docs/results/outside)";

/// Young's modulus above which a sheet is a metal (MPa).
const METAL: f64 = 40_000.0;

pub(super) fn springback_and_creep(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let (scene, problem) = (of.scene, &run.designed.problem);
    if problem.model.mechanics().is_none() {
        return Vec::new();
    }
    let creep = scene.material.creep.as_ref();
    let mut facts = vec![fact("creep", creep, creeping(creep))];
    // Hinges of other laws are elastic: nothing stays.
    if scene.surrogate().is_none() {
        return facts;
    }
    if scene.material.regime(scene.config.ligament.range[1]) == Regime::Film {
        facts.push(text("folded before", FOLDED_BEFORE.into()));
    }
    let metal = if scene.material.young > METAL {
        "; metals yield sooner in reverse, which is not modelled: with kinematic hardening hinges of steel spring back by up to twice \
         as far, of aluminium by four times (docs/results/springback)"
    } else {
        ""
    };
    let springback =
        |shape: Option<&ResidualShape>, text: String| fact("springback", shape, text + metal);
    let Some(law) = &scene.springback else {
        let unknown = "not known: the sheet springs back when the load is taken off, and the scene names no law of released hinges \
                       (surrogate.springback)";
        facts.push(springback(None, unknown.into()));
        return facts;
    };
    match unload(scene, problem, of.deployment) {
        Err(error) => facts.push(springback(None, format!("not known: {error}"))),
        Ok(shape) => {
            facts.push(springback(Some(&shape), residual_opening(&shape, law.errors.as_ref())));
            let moments = moment_after_overshoot(scene, problem, law, of.deployment);
            facts.push(overshoot(moments));
        }
    }
    facts
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
    fact("opened too far", moments, text)
}

fn residual_opening(shape: &ResidualShape, errors: Option<&SpringbackErrors>) -> String {
    let [loaded, free] = shape.mean_rotations().map(f64::to_degrees);
    let ratio = shape.fraction().map_or(String::new(), |ratio| format!(", {:.0} %", 100.0 * ratio));
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
