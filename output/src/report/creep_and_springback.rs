//! What becomes of the opening of a sheet: under a load that stays, and when the load is taken off.

use crate::report::numbers::rounded;
use design::objective::design_problem::{Deployment, DesignProblem};
use hinge::Creep;
use scene::Scene;
use analysis::springback::{
    ResidualShape, TOO_FAR, UnloadError, moment_after_overshoot, unload,
};
use serde::Serialize;
use surrogate::SpringbackErrors;

/// Creep and springback of a sheet whose hinges carry load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CreepAndSpringback {
    /// Creep of the material; `None` if its file has no figure.
    pub creep: Option<Creep>,
    /// The residual opening when the loads are taken off; `None` if it is not known.
    pub released: Option<Released>,
    #[serde(skip)]
    springback: Option<String>,
}

/// An unloaded sheet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Released {
    /// The residual opening.
    #[serde(flatten)]
    pub stays: ResidualShape,
    /// Errors of the law at hinges that it has not seen; `None` if they were not measured.
    pub law: Option<SpringbackErrors>,
    /// The moments of hinges that were opened too far and brought back, over the reported moments;
    /// `None` if that is not known.
    pub after_overshoot: Option<f64>,
}

/// Young's modulus above which a sheet is a metal (MPa).
const METAL: f64 = 40_000.0;

impl CreepAndSpringback {
    /// `None` if the hinges carry no load.
    pub(super) fn new(
        scene: &Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
    ) -> Option<Self> {
        problem.model.mechanics()?;
        let released = Released::new(scene, problem, deployment);
        // Hinges of other laws are elastic: nothing stays.
        let mut springback = scene.surrogate().map(|_| match &released {
            None => "not known: the sheet springs back when the load is taken off, and the scene names no law of released hinges \
                     (surrogate.springback)"
                .to_owned(),
            Some(Err(error)) => format!("not known: {error}"),
            Some(Ok(released)) => released.text(),
        });
        if let Some(text) = springback.as_mut().filter(|_| scene.material.young > METAL) {
            *text += "; metals yield sooner in reverse, which is not modelled: with kinematic hardening hinges of steel spring back by up to twice \
                      as far, of aluminium by four times (docs/results/springback)";
        }
        Some(Self {
            creep: scene.material.creep.clone(),
            released: released.and_then(Result::ok),
            springback,
        })
    }

    /// Names and values.
    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        let springback = self.springback.iter().cloned();
        let mut rows: Vec<_> = springback.map(|text| ("springback", text)).collect();
        rows.extend(
            (self.released.as_ref()).map(|released| ("opened too far", released.too_far())),
        );
        rows.push(("creep", creep(self.creep.as_ref())));
        rows
    }
}

impl Released {
    /// `None` if the scene names no law of released hinges.
    fn new(
        scene: &Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
    ) -> Option<Result<Self, UnloadError>> {
        let law = scene.springback.as_ref()?;
        let found = unload(scene, problem, law, deployment);
        Some(found.map(|stays| Self {
            stays,
            law: law.errors,
            after_overshoot: moment_after_overshoot(scene, problem, law, deployment),
        }))
    }

    fn too_far(&self) -> String {
        let percent = 100.0 * TOO_FAR;
        match self.after_overshoot {
            Some(share) => format!(
                "do not open it further than this: {percent:.0} % further and back again, its hinges hold with {:.0} % of their moments, by the law \
                 of released hinges",
                100.0 * share
            ),
            None => format!(
                "not known: {percent:.0} % further, hinges leave the training domain of the law"
            ),
        }
    }

    fn text(&self) -> String {
        let [loaded, free] = self.stays.mean_rotations().map(f64::to_degrees);
        let share = self.stays.share();
        let share = share.map_or(String::new(), |share| format!(", {:.0} %", 100.0 * share));
        let [rms, most] = self.stays.corners.map(|length| rounded(length, 3));
        let mut text = format!(
            "of a mean opening of {} deg {} stay when the load is taken off{share}; corners move by {rms} mm (root mean square), \
             {most} mm at most",
            rounded(loaded, 3),
            rounded(free, 3),
        );
        if self.stays.snaps {
            text += "; the sheet snaps to another state on the way";
        }
        text += &match &self.law {
            Some(law) => format!(
                "; the law of released hinges is off by {} deg (root mean square at {} hinges that it has not seen); the errors of the forces \
                 are added",
                rounded(law.rest[2].to_degrees(), 2),
                law.hinges
            ),
            None => "; the error of the law of released hinges is not known".into(),
        };
        text
    }
}

/// What a load that stays does to the sheet.
fn creep(known: Option<&Creep>) -> String {
    let Some(creep) = known else {
        return "not modelled, and not known: the material file has no figure ([creep]). Polymers under a load that stays keep deforming"
            .into();
    };
    let Creep { ratio, years } = creep;
    format!(
        "not modelled: under a load that stays the stiffness of the material falls to about 1/{ratio} in {years} years, by order of \
         magnitude. A dead load opens the sheet further, and at a held stroke the force falls"
    )
}
