//! The convergence study of the window: rotations, one modelling choice varied at a time.
//!
//! The error of a choice is the root mean square, over the ray, of the difference that it makes
//! to W, F_a, M_theta and D, divided by the root mean square of the reference solution.

use fe_driver::{Ray, Solved, ToolVersions, WindowProblem, WindowSolve};
use hinge::{HingeDeformation, HingeDesign, HingeSample, Regime, SheetMaterial};
use mesher::Tier;
use std::f64::consts::FRAC_PI_2;

/// Rotation at the end of every ray of the study (deg).
pub const STUDY_THETA_DEG: f64 = 60.0;

/// One solve of the study.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyCase {
    /// The varied quantity: "mesh", "increments", ...
    pub study: &'static str,
    /// Its value in this case, as shown in tables.
    pub value: String,
    /// The reference value of the same study.
    pub against: String,
    /// The window solve of the case.
    pub solve: WindowSolve,
}

/// The modelling choices of a regime: the usual and the finest mesh, and the values that are tried. The usual bump is the
/// reference of the bumps, the last value that of the others.
struct Choices {
    usual: Tier,
    finest: Tier,
    /// eta_a at the end of the rays.
    eta_a: f64,
    increments: [f64; 3],
    amplitudes: &'static [f64],
    widths: &'static [[f64; 2]],
    radii: [f64; 3],
    layers: &'static [usize],
}

impl Choices {
    fn of(regime: Regime, quick: bool) -> Self {
        match regime {
            Regime::Film => Self {
                usual: Tier::Default,
                finest: if quick { Tier::Fine } else { Tier::Reference },
                eta_a: 0.0,
                increments: [0.07, 0.035, 0.0175],
                amplitudes: &[0.1, 0.5, 1.0, 2.0],
                widths: &[[0.5, 0.5], [1.0, 1.0], [2.0, 1.4]],
                radii: [70.0, 100.0, 140.0],
                layers: &[1, 2, 3],
            },
            // A ligament of a plate turns about its middle: 0.5 theta + 0.16 theta^2 at 60 deg.
            Regime::Plate => Self {
                usual: Tier::Plate,
                finest: if quick {
                    Tier::Plate
                } else {
                    Tier::PlateReference
                },
                eta_a: 0.70,
                increments: [0.1, 0.05, 0.0125],
                amplitudes: &[0.0, 0.02, 0.1, 1.0],
                widths: &[],
                radii: [8.4, 12.0, 24.0],
                layers: &[2, 3],
            },
        }
    }
}

/// All cases for one hinge. `quick` omits the meshes that take minutes. The paper's mesh is included for
/// comparison, only at the paper's right angle.
pub fn study_cases(
    design: HingeDesign,
    regime: Regime,
    material: &SheetMaterial,
    versions: &ToolVersions,
    quick: bool,
) -> Vec<StudyCase> {
    let choices = Choices::of(regime, quick);
    let theta = STUDY_THETA_DEG.to_radians();
    let end = HingeDeformation::from_eta(choices.eta_a, 0.0, theta, design.w_lig);
    let of_tier = |tier| {
        let problem = WindowProblem::new(Ray { design, end }, material, tier);
        WindowSolve::new(problem, versions)
    };
    let usual = of_tier(choices.usual);
    let mut cases = Vec::new();
    let mut add = |study, value: String, against: String, vary: &dyn Fn(&mut WindowSolve)| {
        let mut solve = usual.clone();
        vary(&mut solve);
        cases.push(StudyCase {
            study,
            value,
            against,
            solve,
        });
    };
    let finest = choices.finest;
    let square = (design.alpha - FRAC_PI_2).abs() < 1e-9;
    let tiers = Tier::ALL.into_iter();
    for tier in tiers.filter(|tier| tier.regime() == regime) {
        let wanted = if quick {
            tier <= finest
        } else {
            tier != Tier::Paper || square
        };
        if wanted {
            add("mesh", tier.to_string(), finest.to_string(), &|solve| {
                *solve = of_tier(tier);
            });
        }
    }
    let shortest = choices.increments[2].to_string();
    for maximum in choices.increments {
        add(
            "increments",
            maximum.to_string(),
            shortest.clone(),
            &|solve| {
                solve.problem.step.greatest = maximum;
            },
        );
    }
    let amplitude_of = |amplitude: f64| format!("{amplitude} t");
    let usual_bump = amplitude_of(usual.mesh.imperfection.amplitude);
    for &amplitude in choices.amplitudes {
        let value = amplitude_of(amplitude);
        add(
            "imperfection amplitude",
            value,
            usual_bump.clone(),
            &|solve| {
                solve.mesh.imperfection.amplitude = amplitude;
            },
        );
    }
    for &widths in choices.widths {
        let value = format!("{} x {}", widths[0], widths[1]);
        add("imperfection widths", value, "1 x 1".into(), &|solve| {
            solve.mesh.imperfection.widths = widths;
        });
    }
    let radius_of = |r_win: f64| format!("{r_win} mm");
    for r_win in choices.radii {
        let largest = radius_of(choices.radii[2]);
        add("window radius", radius_of(r_win), largest, &|solve| {
            solve.problem.hinge.design.r_win = r_win;
        });
    }
    for &layers in choices.layers {
        add("layers", layers.to_string(), "3".into(), &|solve| {
            solve.mesh.layers = layers;
        });
    }
    cases
}

/// W (N mm), F_a (N), M_theta (N mm), D and maximum u_z (mm) of a hinge at one rotation.
pub type StudyState = [f64; 5];

/// The state of a complete ray of the study at the rotation `theta_deg`.
pub fn study_state(solution: &Solved, theta_deg: f64) -> StudyState {
    let x = HingeSample::at(&solution.samples, theta_deg / STUDY_THETA_DEG).unwrap_or_default();
    [x.w, x.f_a, x.m_theta, x.d, x.uz_max]
}

/// Relative difference of two solutions in each component of the state: the root mean square of the difference
/// over the ray from 3 deg on, divided by the root mean square of `against`.
pub fn study_difference(solution: &Solved, against: &Solved) -> StudyState {
    let (mut off, mut all) = ([0.0; 5], [0.0; 5]);
    for degrees in 3..=STUDY_THETA_DEG as u32 {
        let [x, y] = [solution, against].map(|window| study_state(window, degrees.into()));
        for i in 0..5 {
            off[i] += (x[i] - y[i]).powi(2);
            all[i] += y[i].powi(2);
        }
    }
    std::array::from_fn(|i| (off[i] / all[i]).sqrt())
}

/// Extrapolation of a quantity from meshes of decreasing element size to size zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Richardson {
    /// Order of convergence: the power of the element size in the error.
    pub order: f64,
    /// Whether the order was observed between the three meshes. If no order between 1/2 and 6 fits them, 2 is
    /// assumed.
    pub observed: bool,
    /// The extrapolated quantity at size zero.
    pub limit: f64,
}

/// Extrapolates a quantity known at three sizes, the largest first, to size zero.
///
/// Roache, Verification and Validation in Computational Science and Engineering (1998): the order
/// p solves (f1 - f2) / (f2 - f3) = (h1^p - h2^p) / (h2^p - h3^p), whose right-hand side grows
/// with p.
pub fn richardson([h1, h2, h3]: [f64; 3], [f1, f2, f3]: [f64; 3]) -> Richardson {
    let ratio = |p: f64| (h1.powf(p) - h2.powf(p)) / (h2.powf(p) - h3.powf(p));
    let seen = (f1 - f2) / (f2 - f3);
    let [mut low, mut high] = [0.5, 6.0];
    let observed = ratio(low) <= seen && seen <= ratio(high);
    while observed && high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if ratio(middle) < seen {
            low = middle;
        } else {
            high = middle;
        }
    }
    let order = if observed { low } else { 2.0 };
    Richardson {
        order,
        observed,
        limit: f3 + (f3 - f2) / ((h2 / h3).powf(order) - 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fe_driver::SolveRecord;
    use std::path::PathBuf;

    fn design() -> HingeDesign {
        HingeDesign {
            w_lig: 18.0,
            alpha: 1.5,
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        }
    }

    fn film() -> SheetMaterial {
        let film = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../configs/materials/pet-0.5mm.toml"
        );
        SheetMaterial::load(std::path::Path::new(film)).unwrap()
    }

    fn versions() -> ToolVersions {
        let [gmsh, ccx] = ["4.8.4", "2.20"].map(str::to_owned);
        ToolVersions { gmsh, ccx }
    }

    fn solution(scale: f64) -> Solved {
        let sample = |lambda: f64| HingeSample {
            lambda,
            w: scale * lambda * lambda,
            f_a: scale,
            m_theta: -scale * lambda,
            d: scale * lambda,
            uz_max: scale,
            ..HingeSample::default()
        };
        Solved {
            id: String::new(),
            solve: study_cases(design(), Regime::Film, &film(), &versions(), true)
                .remove(0)
                .solve,
            record: SolveRecord::default(),
            samples: [0.25, 0.5, 1.0].map(sample).to_vec(),
            work: PathBuf::new(),
        }
    }

    #[test]
    fn a_solution_scaled_by_three_percent_differs_by_three_percent() {
        for difference in study_difference(&solution(1.03), &solution(1.0)) {
            assert!((difference - 0.03).abs() < 1e-12);
        }
    }

    #[test]
    fn the_order_of_convergence_and_the_limit_are_found() {
        let sizes = [1.0, 0.75, 0.5];
        for order in [1.0, 2.0, 3.3] {
            let found = richardson(sizes, sizes.map(|h: f64| 90.0 + 7.0 * h.powf(order)));
            assert!(found.observed && (found.order - order).abs() < 1e-6);
            assert!((found.limit - 90.0).abs() < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn values_without_an_observed_order_are_extrapolated_with_second_order() {
        for values in [[1.0, 2.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.1, 9.0]] {
            let found = richardson([1.0, 0.75, 0.5], values);
            assert!(!found.observed && found.order == 2.0, "{found:?}");
            assert!(found.limit.is_finite());
        }
    }

    #[test]
    fn the_reference_of_every_case_is_itself_a_case() {
        let regimes = [Regime::Film, Regime::Plate];
        for (quick, regime) in [false, true]
            .into_iter()
            .flat_map(|q| regimes.map(|r| (q, r)))
        {
            let cases = study_cases(design(), regime, &film(), &versions(), quick);
            for case in &cases {
                let mut same = cases.iter().filter(|c| c.study == case.study);
                assert!(same.any(|c| c.value == case.against), "{case:?}");
            }
        }
    }
}
