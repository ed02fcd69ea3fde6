//! The parts of the error that no network of the family can remove: the same windows with the hardening of a material and
//! with its law of the family, with two Poisson's ratios, and on two meshes.

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

/// A change of a window, and its effect on W of the rays.
struct Cause {
    sheet: String,
    change: &'static str,
    /// Root mean square of the change of W over that of W (%).
    rms: f64,
    /// The factor of W, minus one (%).
    factor: f64,
    rays: usize,
}

/// Solves the windows of the rays for the materials, each in a sheet of the thickness of `family`, and writes the
/// effect of each change as a table.
pub fn page(
    rays: &[FamilyRay],
    materials: &[SheetMaterial],
    family: &SheetMaterial,
    tier: Tier,
    solve: &SolveArgs,
    folder: &Path,
) -> Result<String> {
    let mut windows = Vec::new();
    for material in materials {
        let own = SheetMaterial {
            thickness: family.thickness,
            ..material.clone()
        };
        let described = Law::of_material(material).material(&own);
        let other_poisson = SheetMaterial {
            poisson: family.poisson,
            ..described.clone()
        };
        let of = |sheet: &SheetMaterial, tier| {
            let windows = rays.iter().map(|ray| ray.window(sheet, tier));
            windows.collect::<Vec<KeptSolve>>()
        };
        let before = of(&own, tier);
        windows.push((
            material,
            "its law of the family",
            before.clone(),
            of(&described, tier),
        ));
        windows.push((
            material,
            "Poisson's ratio of the family",
            of(&described, tier),
            of(&other_poisson, tier),
        ));
        windows.push((material, "next finer mesh", before, of(&own, finer(tier))));
    }
    let solves: Vec<&KeptSolve> = (windows.iter())
        .flat_map(|(.., before, after)| before.iter().chain(after))
        .collect();
    let mut outcomes = solve.solve(&solves, folder)?.into_iter();
    let mut causes = Vec::new();
    for (material, change, before, after) in windows {
        let mut take = |of: &[KeptSolve]| outcomes.by_ref().take(of.len()).collect::<Vec<_>>();
        let (before, after) = (take(&before), take(&after));
        causes.push(Cause::new(&material.name, change, &before, &after)?);
    }
    Ok(table(&causes, tier))
}

/// The next tier, or the last one.
fn finer(tier: Tier) -> Tier {
    let next = Tier::ALL.into_iter().find(|next| *next > tier);
    next.unwrap_or(tier)
}

impl Cause {
    fn new(
        sheet: &str,
        change: &'static str,
        before: &[Outcome],
        after: &[Outcome],
    ) -> Result<Self> {
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
        ensure!(rays > 0, "{sheet}, {change}: no ray was solved twice");
        Ok(Self {
            sheet: sheet.to_owned(),
            change,
            rms: 100.0 * (errors / squares).sqrt(),
            factor: 100.0 * (products / squares - 1.0),
            rays,
        })
    }
}

fn table(causes: &[Cause], tier: Tier) -> String {
    let mut text = format!(
        "# What a network of the family cannot know\n\nThe same windows, mesh `{tier}`, before and after a change: root \
         mean square of the change of W over that of W, and the factor of W, minus one. Each line is of the rays that \
         reached their ends both times. The next finer mesh is `{}`.\n\n| sheet | change | \
         rays | W | factor |\n|---|---|---|---|---|\n",
        finer(tier)
    );
    for cause in causes {
        let Cause {
            sheet,
            change,
            rms,
            factor,
            rays,
        } = cause;
        writeln!(
            text,
            "| {sheet} | {change} | {rays} | {rms:.2} % | {factor:+.2} % |"
        )
        .expect("writing to a string does not fail");
    }
    text
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
