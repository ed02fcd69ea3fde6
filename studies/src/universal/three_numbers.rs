//! The error of a description of the hardening by three numbers: the same windows with the hardening of a material and
//! with its law of the family.

use crate::universal::family_rays::FamilyRay;
use crate::universal::law::Law;
use anyhow::{Result, ensure};
use fe_driver::KeptSolve;
use hinge::{HingeSample, SheetMaterial};
use kirigami::replays::kept_solves::{Outcome, SolveArgs};
use mesher::Tier;
use std::fmt::Write;
use std::path::Path;

/// States of a ray that are compared.
const STATES: usize = 20;

/// Solves the windows of the rays for the materials, each in a sheet of the thickness of `family`, and writes the
/// effect of the description as a table.
pub fn page(
    rays: &[FamilyRay],
    materials: &[SheetMaterial],
    family: &SheetMaterial,
    tier: Tier,
    solve: &SolveArgs,
    folder: &Path,
) -> Result<String> {
    let of = |sheet: &SheetMaterial| {
        let windows = rays.iter().map(|ray| ray.window(sheet, tier));
        windows.collect::<Vec<KeptSolve>>()
    };
    let mut text = format!(
        "# Three numbers instead of a curve\n\nThe same windows, mesh `{tier}`, with the hardening curve of a material and \
         with its law of the family: root mean square of the change of W over that of W, and the factor of W, minus one. \
         Each line is of the rays that reached their ends both times.\n\n| sheet | rays | W | factor |\n|---|---|---|---|\n"
    );
    for material in materials {
        let own = SheetMaterial {
            thickness: family.thickness,
            ..material.clone()
        };
        let windows = [of(&own), of(&Law::of_material(material).material(&own))].concat();
        let windows: Vec<&KeptSolve> = windows.iter().collect();
        let outcomes = solve.solve(&windows, folder)?;
        let (before, after) = outcomes.split_at(rays.len());
        let Change { rays, rms, factor } = Change::new(before, after);
        ensure!(rays > 0, "{}: no ray was solved twice", material.name);
        let name = &material.name;
        writeln!(text, "| {name} | {rays} | {rms:.2} % | {factor:+.2} % |")?;
    }
    Ok(text)
}

/// The change of W on the rays that reached their ends both times.
struct Change {
    rays: usize,
    /// Root mean square of the change of W over that of W (%).
    rms: f64,
    /// The factor of W, minus one (%).
    factor: f64,
}

impl Change {
    fn new(before: &[Outcome], after: &[Outcome]) -> Self {
        let (mut errors, mut squares, mut products, mut rays) = (0.0, 0.0, 0.0, 0);
        for (before, after) in before.iter().zip(after) {
            let (Ok(before), Ok(after)) = (before, after) else {
                continue;
            };
            rays += 1;
            for k in 1..=STATES {
                let lambda = k as f64 / STATES as f64;
                let w = |samples: &[HingeSample]| HingeSample::at(samples, lambda).map(|x| x.w);
                if let (Some(before), Some(after)) = (w(&before.samples), w(&after.samples)) {
                    errors += (after - before).powi(2);
                    squares += before * before;
                    products += before * after;
                }
            }
        }
        Self {
            rays,
            rms: 100.0 * (errors / squares).sqrt(),
            factor: 100.0 * (products / squares - 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fe_driver::{DeformationPath, Tools};
    use hinge::{HingeConstants, HingeDeformation};
    use kirigami::replays::routes::window;
    use std::f64::consts::FRAC_PI_2;
    use std::sync::atomic::AtomicBool;
    use std::time::Duration;

    /// W of a rotated window of a sheet on the coarsest mesh.
    fn energy(sheet: &SheetMaterial) -> f64 {
        let design = HingeConstants::PAPER.hinge(12.0, FRAC_PI_2);
        let end = HingeDeformation::from_eta(0.0, 0.0, 0.6, 12.0);
        let solve = window(design, DeformationPath::straight(end), sheet, Tier::Tiny);
        let (folder, tools) = (tempfile::tempdir().unwrap(), Tools::find().unwrap());
        let (limit, stop) = (Duration::from_secs(600), AtomicBool::new(false));
        let solution = solve.solution(folder.path(), folder.path(), &tools, limit, &stop);
        solution.unwrap().samples.last().unwrap().w
    }

    #[test]
    fn the_energy_doubles_with_e_if_the_law_over_e_is_kept() {
        let sheet = SheetMaterial {
            name: "film".into(),
            thickness: 0.5,
            young: 3000.0,
            poisson: 0.36,
            density_kg_m3: 1000.0,
            fracture_strain: 1.0,
            plastic: vec![],
        };
        let law = Law::of_family(0);
        let stiffer = SheetMaterial {
            young: 6000.0,
            ..sheet.clone()
        };
        let [once, twice] = [&sheet, &stiffer].map(|sheet| energy(&law.material(sheet)));
        assert!((twice / once - 2.0).abs() < 1e-3, "{once} {twice}");
    }
}
