//! Residual opening of a sheet when its loads are taken off, in numbers.

use crate::drawing;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::pattern::design_vector::DesignVector;
use scene::Scene;
use scene::analysis::springback::{ResidualShape, UnloadError, unload_in_domain};
use serde::Serialize;
use std::fmt;
use surrogate::{Springback, SpringbackErrors};

/// An unloaded sheet.
#[derive(Serialize)]
pub struct SpringbackListing {
    /// The residual opening.
    #[serde(flatten)]
    pub stays: ResidualShape,
    /// Mean rotation of the hinges without load over that under load; `None` if they have not opened.
    pub share: Option<f64>,
    /// Errors of the law at hinges that it has not seen; `None` if they were not measured.
    pub law: Option<SpringbackErrors>,
    #[serde(skip)]
    unloaded: Deployment,
}

impl SpringbackListing {
    /// Deploys a design of a scene and its problem, and unloads it.
    pub fn new(
        scene: &Scene,
        problem: &DesignProblem,
        design: &DesignVector,
        law: &Springback,
    ) -> Result<Self, UnloadError> {
        let deployment = problem.deploy(design)?;
        let (released, stays) = unload_in_domain(scene, problem, law, &deployment)?;
        Ok(Self {
            share: stays.share(),
            stays,
            law: law.errors,
            unloaded: Deployment {
                released: Some(released),
                ..deployment
            },
        })
    }

    /// The sheet without loads (SVG).
    pub fn picture(&self, scene: &Scene) -> String {
        drawing::deployed(scene, &self.unloaded)
    }
}

impl fmt::Display for SpringbackListing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let ResidualShape {
            rest_rotations,
            displacement,
            displacement_unit,
            corners,
            snaps,
            outline_error,
            ..
        } = &self.stays;
        let [loaded, free] = self.stays.mean_rotations().map(f64::to_degrees);
        let alone = rest_rotations.iter().map(|theta| theta.abs()).sum::<f64>();
        let alone = (alone / rest_rotations.len() as f64).to_degrees();
        writeln!(f, "{:<44}{:>12}{:>12}", "", "loaded", "unloaded")?;
        writeln!(
            f,
            "{:<44}{loaded:>12.2}{free:>12.2}",
            "mean rotation of the hinges, deg"
        )?;
        if let Some([under, without]) = displacement {
            writeln!(
                f,
                "{:<44}{under:>12.2}{without:>12.2}",
                format!("displacement along the loads, {displacement_unit}")
            )?;
        }
        let [before, after] = outline_error;
        writeln!(
            f,
            "{:<44}{before:>12.3}{after:>12.3}",
            "outline to target, root mean square, mm"
        )?;
        let [rms, most] = corners;
        writeln!(
            f,
            "\npanel corners move by {rms:.2} mm (root mean square), at most {most:.2} mm, when the loads are taken off"
        )?;
        if *snaps {
            writeln!(
                f,
                "the sheet snaps to another state while they are taken off"
            )?;
        }
        if let Some(share) = self.share {
            writeln!(
                f,
                "{:.0} % of the opening stays; of hinges that were cut free, {:.0} %",
                100.0 * share,
                100.0 * alone / loaded
            )?;
        }
        match &self.law {
            Some(law) => writeln!(
                f,
                "the law of released hinges is off by {:.2} deg and by {:.0} % of the stiffness (root mean squares at {} hinges that it has not \
                 seen), besides the errors of the forces",
                law.rest[2].to_degrees(),
                100.0 * law.stiffness,
                law.hinges
            )?,
            None => writeln!(f, "the errors of the law of released hinges are not known")?,
        }
        writeln!(
            f,
            "up to the opening that was reached hinges are elastic: the load that opened the sheet opens it again"
        )?;
        writeln!(
            f,
            "\nNot in these numbers: creep under the load and recovery after it, kinematic hardening (a material that yields sooner the other \
             way), panels that leave the plane"
        )
    }
}
