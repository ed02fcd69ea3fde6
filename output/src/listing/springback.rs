//! Residual opening of a sheet when its loads are taken off, in numbers.

use crate::drawing;
use crate::listing::Listing;
use design::objective::design_problem::{Deployment, DesignProblem};
use design::pattern::design_vector::DesignVector;
use scene::Scene;
use scene::analysis::springback::{ResidualShape, UnloadError, unload_in_domain};
use serde_json::json;
use support::document::Document;
use support::table::Table;
use surrogate::{Springback, SpringbackErrors};

/// Deploys a design of a scene and its problem, unloads it, and lists it without loads; also its picture (SVG).
pub fn springback(
    scene: &Scene,
    problem: &DesignProblem,
    design: &DesignVector,
    law: &Springback,
) -> Result<(Listing, String), UnloadError> {
    let deployment = problem.deploy(design)?;
    let (released, stays) = unload_in_domain(scene, problem, law, &deployment)?;
    let unloaded = Deployment {
        released: Some(released),
        ..deployment
    };
    let document = document(&stays, law.errors.as_ref());
    let mut numbers = json!(stays);
    // Mean rotation of the hinges without load over that under load; null if they have not opened.
    numbers["share"] = json!(stays.share());
    // Errors of the law at hinges that it has not seen; null if they were not measured.
    numbers["law"] = json!(law.errors);
    let listing = Listing { numbers, document };
    Ok((listing, drawing::deployed(scene, &unloaded)))
}

fn document(stays: &ResidualShape, errors: Option<&SpringbackErrors>) -> Document {
    let ResidualShape {
        rest_rotations,
        displacement,
        displacement_unit,
        corners: [rms, most],
        snaps,
        outline_error,
        ..
    } = stays;
    let opened = stays.mean_rotations().map(f64::to_degrees);
    let mut table = Table::new(["", "loaded", "unloaded"]);
    let mut row = |what: String, pair: [f64; 2], digits: usize| {
        let [loaded, free] = pair.map(|value| format!("{value:.digits$}"));
        table.row([what, loaded, free]);
    };
    row("mean rotation of the hinges, deg".into(), opened, 2);
    if let Some(displacement) = displacement {
        let what = format!("displacement along the loads, {displacement_unit}");
        row(what, *displacement, 2);
    }
    let outline = "outline to target, root mean square, mm";
    row(outline.into(), *outline_error, 3);
    let mut page = Document::default();
    page.table(table);
    page.text(format!(
        "panel corners move by {rms:.2} mm (root mean square), at most {most:.2} mm, when the loads are taken off"
    ));
    if *snaps {
        page.text("the sheet snaps to another state while they are taken off");
    }
    if let Some(share) = stays.share() {
        let alone = rest_rotations.iter().map(|theta| theta.abs()).sum::<f64>();
        let alone = (alone / rest_rotations.len() as f64).to_degrees();
        page.text(format!(
            "{:.0} % of the opening stays; of hinges that were cut free, {:.0} %",
            100.0 * share,
            100.0 * alone / opened[0]
        ));
    }
    page.text(match errors {
        Some(errors) => format!(
            "the law of released hinges is off by {:.2} deg and by {:.0} % of the stiffness (root mean squares at {} hinges that it has not \
             seen), besides the errors of the forces",
            errors.rest[2].to_degrees(),
            100.0 * errors.stiffness,
            errors.hinges
        ),
        None => "the errors of the law of released hinges are not known".to_owned(),
    });
    page.text(
        "up to the opening that was reached hinges are elastic: the load that opened the sheet opens it again",
    );
    page.text(
        "Not in these numbers: creep under the load and recovery after it, kinematic hardening (a material that yields sooner the other \
         way), panels that leave the plane",
    );
    page
}
