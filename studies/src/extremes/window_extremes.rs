//! Windows at the limits of ligament, cut angle, hole, kerf, radius, rotation and fracture strain: meshed and solved on two tiers.

use super::{Checked, kept, one_line};
use crate::attempt::attempt;
use anyhow::Result;
use fe_driver::{
    CalculiX, DeformationPath, HingePath, Solution, SolveError, WindowProblem, WindowSolve,
};
use hinge::{HingeConstants, HingeDeformation, HingeDesign, HingeSample, SheetMaterial};
use kirigami::ui::progress::Progress;
use mesher::Tier;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// The tiers, and the one by which the first is judged.
const TIERS: [Tier; 2] = [Tier::Small, Tier::Default];
const LIMIT: Duration = Duration::from_secs(600);

/// A window with one extreme input.
struct Extreme {
    name: String,
    design: HingeDesign,
    theta_deg: f64,
    material: SheetMaterial,
    /// Whether it must be refused before anything is solved.
    refused: bool,
}

/// The paper's hinge with one input changed at a time.
fn all(material: &SheetMaterial) -> Vec<Extreme> {
    let own = HingeConstants::PAPER.hinge(18.0, f64::to_radians(60.0));
    let thickness = material.thickness;
    let mut list = Vec::new();
    let mut add = |name: String, refused: bool, edit: &dyn Fn(&mut Extreme)| {
        let mut extreme = Extreme {
            name,
            design: own,
            theta_deg: 60.0,
            material: material.clone(),
            refused,
        };
        edit(&mut extreme);
        list.push(extreme);
    };
    add("the paper's hinge, 18 mm, 60 deg".into(), false, &|_| ());
    for ratio in [3.0, 10.0, 50.0, 100.0] {
        let name = format!("ligament of {ratio} thicknesses");
        add(name, false, &|extreme| {
            extreme.design.w_lig = ratio * thickness;
            extreme.design.r_win = (5.0 * extreme.design.w_lig).max(20.0 * thickness);
        });
    }
    for (alpha_deg, refused) in [(0.0, true), (10.0, false), (25.0, false), (90.0, false)] {
        add(format!("cut angle {alpha_deg} deg"), refused, &|extreme| {
            extreme.design.alpha = f64::to_radians(alpha_deg);
        });
    }
    for (ratio, refused) in [(0.02, false), (0.4, false), (1.0, true)] {
        let name = format!("hole of {ratio} ligament widths");
        add(name, refused, &|extreme| {
            extreme.design.fillet_ratio = ratio;
        });
    }
    for (share, refused) in [(0.01, false), (0.99, false), (1.0, true)] {
        let name = format!("kerf of {share} hole diameters");
        add(name, refused, &|extreme| {
            extreme.design.kerf = share * 2.0 * extreme.design.fillet_radius();
        });
    }
    for (ratio, refused) in [(2.5, true), (2.6, false), (20.0, false)] {
        let name = format!("window of {ratio} ligament widths");
        add(name, refused, &|extreme| {
            extreme.design.r_win = ratio * extreme.design.w_lig;
        });
    }
    for theta_deg in [1e-6, 120.0] {
        let name = format!("rotation to {theta_deg:e} deg");
        add(name, false, &|extreme| extreme.theta_deg = theta_deg);
    }
    for (strain, refused) in [(1e-3, false), (0.0, true)] {
        let name = format!("fracture strain {strain:e}");
        add(name, refused, &|extreme| {
            extreme.material.fracture_strain = strain;
        });
    }
    list
}

/// One row a window; the solves are made in `folder`.
pub(super) fn table(solver: &CalculiX, material: &SheetMaterial, folder: &Path) -> Result<Checked> {
    let [judged, judge] = TIERS;
    let mut text = format!(
        "# At the extremes: windows\n\n\
         Rays to 60 deg in {}, one input changed at a time, on the tiers `{judged}` and `{judge}`. Promised: the ray is solved to its end \
         with finite numbers and energy = work, or is refused with a reason before anything is solved. Error: of `{judged}` beside `{judge}`, \
         root mean square over the ray.\n\n\
         | extreme | elements | solved | W at the end, N mm | D_peak | energy residual | error in W | error in M_theta | |\n\
         |---|---|---|---|---|---|---|---|---|\n",
        material.name
    );
    let extremes = all(material);
    let bar = Progress::new(extremes.len(), "windows");
    let mut broken = 0;
    for (i, extreme) in extremes.iter().enumerate() {
        bar.show(i, None, &extreme.name);
        let found = extreme.solved(solver, folder)?;
        let (promise, outcome) = extreme.outcome(&found);
        broken += usize::from(!promise);
        writeln!(text, "| {} | {outcome} | {} |", extreme.name, kept(promise))?;
    }
    bar.finish();
    Ok(Checked { text, broken })
}

type Solved = Result<Solution, SolveError>;

impl Extreme {
    /// On both tiers. Fails only if it is stopped.
    fn solved(&self, solver: &CalculiX, folder: &Path) -> Result<[Solved; 2]> {
        let on = |tier: Tier| -> Result<Solved> {
            let theta = self.theta_deg.to_radians();
            let path = DeformationPath::straight(HingeDeformation::from([0.0, 0.0, theta]));
            let hinge = HingePath {
                design: self.design,
                path,
            };
            let problem = WindowProblem::new(hinge, &self.material, tier);
            let solve = WindowSolve::new(problem, &solver.versions());
            attempt(solver, &solve, &folder.join(tier.to_string()), LIMIT)
        };
        let [judged, judge] = TIERS.map(on);
        Ok([judged?, judge?])
    }

    /// Whether the promise is kept, and the cells of the row.
    fn outcome(&self, found: &[Solved; 2]) -> (bool, String) {
        match found {
            [Ok(judged), Ok(judge)] => {
                let ended = |solution: &Solution| {
                    let sound = solution.samples.iter().all(is_finite);
                    sound && solution.stopped.is_none() && !solution.samples.is_empty()
                };
                let promise = !self.refused && ended(judged) && ended(judge);
                (promise, cells(judged, judge))
            }
            [Err(reason), _] | [_, Err(reason)] => {
                let is_reason = matches!(reason, SolveError::Mesh(_) | SolveError::Material(_));
                let reason = one_line(&reason.to_string());
                (
                    self.refused && is_reason,
                    format!("- | {reason} | - | - | - | - | -"),
                )
            }
        }
    }
}

fn is_finite(sample: &HingeSample) -> bool {
    let forces = sample.forces().to_array();
    let mut numbers = forces.into_iter().chain([sample.w, sample.d]);
    numbers.all(f64::is_finite)
}

fn cells(judged: &Solution, judge: &Solution) -> String {
    let last = judge.samples.last().copied().unwrap_or_default();
    let reached = [judged, judge].map(|solution| {
        let lambda = solution.samples.last().map_or(0.0, |sample| sample.lambda);
        format!("{:.0} %", 100.0 * lambda)
    });
    let error = |of: fn(&HingeSample) -> f64| {
        let (mut errors, mut squares) = (0.0, 0.0);
        for sample in &judge.samples {
            if let Some(other) = HingeSample::at(&judged.samples, sample.lambda) {
                errors += (of(&other) - of(sample)).powi(2);
                squares += of(sample).powi(2);
            }
        }
        100.0 * f64::sqrt(errors / squares)
    };
    format!(
        "{}, {} | {} | {:.3e} | {} | {:.0e} | {:.1} % | {:.1} %",
        judged.elements,
        judge.elements,
        reached.join(", "),
        last.w,
        last.d_peak.map_or("-".into(), |peak| format!("{peak:.3}")),
        last.energy_residual,
        error(|sample| sample.w),
        error(|sample| sample.m_theta),
    )
}
