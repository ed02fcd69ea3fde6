//! Load and stroke, how the sheet is held, its weight, and what becomes of its opening: under a load
//! that stays, and when the load is taken off.

use super::{Fact, fact, number, text};
use crate::report::deployed::{DeployedDesign, FinishedRun, is_heavy, of_the_load, posture};
use crate::report::numbers::rounded;
use analysis::actuation_curve::{ActuationCurve, LimitPoint, LoadPeak, Mover};
use analysis::localisation::elasto_gravity_length;
use analysis::springback::{ResidualShape, TOO_FAR, moment_after_overshoot, unload};
use analysis::unit::Unit;
use design::equilibrium::load_step::Status;
use design::objective::design_problem::{Deployment, DesignProblem};
use hinge::Creep;
use scene::{FRICTION, Posture, Scene, panel_name};
use surrogate::SpringbackErrors;

/// Load and stroke at the end of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// What moves the sheet, and what its displacement means.
    pub stroke_of: String,
    /// Displacement, in the first of `units`.
    pub displacement: f64,
    /// Load, in the second of `units`.
    pub load: f64,
    /// Units of displacement and load.
    pub units: [Unit; 2],
    /// The maximum of the load along the path; `None` under dead loads, whose maximum is the load
    /// at the end.
    pub peak: Option<LoadPeak>,
    /// The maxima and minima of the load on the way; empty under dead loads, or if the sheet jumps.
    limit_points: Vec<LimitPoint>,
    /// Increment of the load for an increment of the displacement; `None` if supports move the
    /// sheet, or if the tangent is singular.
    stiffness: Option<f64>,
}

impl Reached {
    /// `None` without equilibrium, or if nothing moves the sheet.
    pub(in crate::report) fn new(
        scene: &Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
    ) -> Option<Self> {
        let mechanics = problem.model.mechanics()?;
        let curve = ActuationCurve::new(mechanics, deployment)?;
        let [displacement, load] = *curve.points.last()?;
        let stiffness = deployment.final_step().stiffness(&mechanics.solver);
        let resolved = (curve.is_prescribed(mechanics))
            .then(|| ActuationCurve::resolved(mechanics, &deployment.sheet))
            .flatten();
        Some(Self {
            stroke_of: stroke_of(scene, &curve),
            displacement,
            load,
            units: curve.units(),
            peak: resolved.as_ref().map(ActuationCurve::peak),
            // The curve beyond a jump is another branch.
            limit_points: resolved
                .filter(|_| deployment.path.iter().all(|step| step.jumps == 0))
                .map_or_else(Vec::new, |curve| curve.limit_points()),
            stiffness: stiffness.filter(|_| curve.mover == Mover::Loads),
        })
    }

    /// The load, if it is a force (N).
    pub(in crate::report) fn force(&self) -> Option<f64> {
        (self.units[1] == Unit::Newton).then_some(self.load)
    }

    /// The parts of the stroke in which the load rises, so a dead load holds the sheet there.
    fn stable_parts(&self) -> String {
        let [length, force] = self.units;
        let mut parts = Vec::new();
        let mut from = Some("0".to_owned());
        for point in &self.limit_points {
            let [at, load] = [point.displacement, point.load].map(|value| rounded(value, 4));
            match from.take() {
                Some(from) if point.is_maximum => {
                    parts.push(format!("{from} to {at} {length} (up to {load} {force})"));
                }
                _ => from = Some(at),
            }
        }
        if let Some(from) = from {
            parts.push(format!("{from} to {} {length}", rounded(self.displacement, 4)));
        }
        format!("a dead load holds the sheet at strokes of {}", parts.join(", "))
    }
}

/// What moves the sheet, and what its displacement means.
fn stroke_of(scene: &Scene, curve: &ActuationCurve) -> String {
    let [way, load] =
        if curve.translational { ["displacement", "force"] } else { ["rotation", "couple"] };
    let position = match (scene.actuation().loads.as_slice(), &*scene.config.loads) {
        ([only], [load]) => only.place.zip(Some(load.at)),
        _ => None,
    };
    let mut stroke = match position {
        _ if curve.mover == Mover::Supports => format!("{way} of the moved supports"),
        Some((panel, at)) => {
            format!("{way} of {at}{} along its {load}", panel_name(scene.grid(), panel))
        }
        None => format!("mean {way} along the loads, weighted by their {load}s"),
    };
    if is_heavy(scene) {
        stroke += ", from the flat sheet before its weight came on";
    }
    stroke
}

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
        let (unit, length) = (Unit::Millimetre, elasto_gravity_length(&of.scene.material));
        let ratio = rounded(length / of.scene.config.process.r_win, 2);
        let said = format!("l_eg {} mm, {ratio} times the radius of a window", rounded(length, 3));
        facts.push(Fact { unit, ..fact("bending by weight", length, said) });
    }
    facts
}

/// Young's modulus above which a sheet is a metal (MPa).
const METAL: f64 = 40_000.0;

pub(super) fn springback_and_creep(of: &DeployedDesign, run: &FinishedRun) -> Vec<Fact> {
    let (scene, problem) = (of.scene, &run.designed.problem);
    if problem.model.mechanics().is_none() {
        return Vec::new();
    }
    let creep = scene.material.creep.as_ref();
    let creep = fact("creep", creep, creeping(creep));
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
    let springback =
        |shape: Option<&ResidualShape>, text: String| fact("springback", shape, text + metal);
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
