//! The convergence study of the window: pure rotations, one modelling choice varied at a time.
//!
//! What a choice is worth is the root mean square, over the ray, of the difference that it makes
//! to W, F_a, M_theta and D, over that of the value it is compared with.

use crate::deck::StepControl;
use crate::job::{FileError, read_json, write_json};
use crate::path::DeformationPath;
use crate::window_solve::{SolveError, Tools, WindowModel};
use hinge::{HingeDeformation, HingeDesign, HingeSample, SheetMaterial};
use mesher::{Imperfection, MeshRecipe, Tier, mesh_window};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Rotation at the end of every ray of the study (deg).
pub const STUDY_THETA_DEG: f64 = 60.0;

/// One solve of the study.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyCase {
    /// What is varied: "mesh", "increments", ...
    pub study: &'static str,
    /// Its value in this case, as tables name it.
    pub value: String,
    /// The value of the same study that this one is compared with.
    pub against: &'static str,
    pub design: HingeDesign,
    pub recipe: MeshRecipe,
    pub step: StepControl,
}

/// What a solve of the study gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudySolution {
    pub elements: usize,
    /// Of the solver (s).
    pub cpu_seconds: f64,
    /// Share of the time from the mesh to the samples in which the solver did not run.
    pub overhead: f64,
    /// Largest resident memory of the solver (MiB).
    pub peak_memory_mib: f64,
    pub iterations: usize,
    pub samples: Vec<HingeSample>,
}

/// Every case for one hinge, the cheap ones first; `quick` leaves out what takes minutes. The
/// paper's own mesh is for comparison, at its right angle only.
pub fn study_cases(design: HingeDesign, quick: bool) -> Vec<StudyCase> {
    let (recipe, step) = (Tier::Default.recipe(), StepControl::default());
    let base = |study, value, against| StudyCase {
        study,
        value,
        against,
        design,
        recipe,
        step,
    };
    let mut cases = Vec::new();
    let finest = match quick {
        true => Tier::Fine,
        false => Tier::Reference,
    };
    let square = (design.alpha - FRAC_PI_2).abs() < 1e-9;
    for tier in Tier::ALL {
        let wanted = if quick {
            tier <= finest
        } else {
            tier != Tier::Paper || square
        };
        if wanted {
            cases.push(StudyCase {
                recipe: tier.recipe(),
                ..base("mesh", tier.to_string(), finest.name())
            });
        }
    }
    for greatest in [0.07, 0.035, 0.0175] {
        cases.push(StudyCase {
            step: StepControl { greatest, ..step },
            ..base("increments", greatest.to_string(), "0.0175")
        });
    }
    for amplitude in [0.1, 0.5, 1.0, 2.0] {
        let imperfection = Imperfection {
            amplitude,
            ..recipe.imperfection
        };
        cases.push(StudyCase {
            recipe: MeshRecipe {
                imperfection,
                ..recipe
            },
            ..base("imperfection amplitude", format!("{amplitude} t"), "1 t")
        });
    }
    for widths in [[0.5, 0.5], [1.0, 1.0], [2.0, 1.4]] {
        let imperfection = Imperfection {
            widths,
            ..recipe.imperfection
        };
        let [x, y] = widths;
        cases.push(StudyCase {
            recipe: MeshRecipe {
                imperfection,
                ..recipe
            },
            ..base("imperfection widths", format!("{x} x {y}"), "1 x 1")
        });
    }
    for r_win in [70.0, 100.0, 140.0] {
        cases.push(StudyCase {
            design: HingeDesign { r_win, ..design },
            ..base("window radius", format!("{r_win} mm"), "140 mm")
        });
    }
    for layers in [1, 2, 3] {
        cases.push(StudyCase {
            recipe: MeshRecipe { layers, ..recipe },
            ..base("layers", layers.to_string(), "3")
        });
    }
    cases
}

impl StudyCase {
    /// The solution kept in `folder`, if there is one.
    pub fn kept(&self, folder: &Path) -> Result<Option<StudySolution>, FileError> {
        read_json(&self.file(folder))
    }

    /// Keeps a solution in `folder`.
    pub fn keep(&self, folder: &Path, solution: &StudySolution) -> Result<(), FileError> {
        write_json(&self.file(folder), solution)
    }

    /// Its name is the same only for cases that solve the same.
    fn file(&self, folder: &Path) -> PathBuf {
        let decisive = (&self.design, &self.recipe, &self.step);
        let text = serde_json::to_vec(&decisive).expect("a case is numbers and text");
        let id = &blake3::hash(&text).to_hex()[..16];
        folder.join(id).with_extension("json")
    }

    /// Solves the case in `folder`.
    pub fn solve(
        &self,
        material: &SheetMaterial,
        tools: &Tools,
        folder: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<StudySolution, SolveError> {
        let thickness = material.thickness;
        let start = Instant::now();
        let mesh = mesh_window(&self.design, thickness, &self.recipe, folder, &tools.gmsh)?;
        let end = HingeDeformation {
            theta: STUDY_THETA_DEG.to_radians(),
            ..HingeDeformation::default()
        };
        let model = WindowModel {
            mesh: &mesh,
            path: &DeformationPath::straight(end),
            material,
            step: &self.step,
        };
        let solution = model.solve(&tools.ccx, folder, limit, stop)?;
        match solution.stopped {
            Some(reason) => Err(reason),
            None => Ok(StudySolution {
                elements: mesh.elements.len(),
                cpu_seconds: solution.cpu_seconds.unwrap_or(f64::NAN),
                overhead: 1.0 - solution.solver_seconds / start.elapsed().as_secs_f64(),
                peak_memory_mib: solution.peak_memory_mib.unwrap_or(f64::NAN),
                iterations: solution.iterations,
                samples: solution.samples,
            }),
        }
    }
}

/// W (N mm), F_a (N), M_theta (N mm), D and u_z (mm) of a hinge at one rotation.
pub type StudyState = [f64; 5];

impl StudySolution {
    /// The state at `theta_deg`, linear between the increments.
    pub fn at(&self, theta_deg: f64) -> StudyState {
        let lambda = theta_deg / STUDY_THETA_DEG;
        let state = |x: &HingeSample| [x.w, x.f_a, x.m_theta, x.d, x.uz_max];
        let after = self.samples.partition_point(|x| x.lambda < lambda);
        let after = after.min(self.samples.len() - 1);
        let (l1, y) = (self.samples[after].lambda, state(&self.samples[after]));
        let (l0, x) = match after.checked_sub(1) {
            Some(before) => (self.samples[before].lambda, state(&self.samples[before])),
            None => (0.0, [0.0; 5]),
        };
        let share = (lambda - l0) / (l1 - l0);
        std::array::from_fn(|i| x[i] + share * (y[i] - x[i]))
    }

    /// What the difference from `other` is worth in each component of the state: its root mean
    /// square over the ray past 3 deg, over that of `other`.
    pub fn difference(&self, other: &Self) -> StudyState {
        let (mut off, mut all) = ([0.0; 5], [0.0; 5]);
        for degrees in 3..=STUDY_THETA_DEG as u32 {
            let (x, y) = (self.at(degrees.into()), other.at(degrees.into()));
            for i in 0..5 {
                off[i] += (x[i] - y[i]).powi(2);
                all[i] += y[i].powi(2);
            }
        }
        std::array::from_fn(|i| (off[i] / all[i]).sqrt())
    }
}

/// What meshes of falling element size say of the limit of size zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Richardson {
    /// Power of the size that the error goes with.
    pub order: f64,
    /// Whether the order is that seen between the three meshes, or 2 because they show none
    /// between 1/2 and 6.
    pub observed: bool,
    /// The quantity at size zero.
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
        match ratio(middle) < seen {
            true => low = middle,
            false => high = middle,
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

    fn design() -> HingeDesign {
        HingeDesign {
            w_lig: 18.0,
            alpha: 1.5,
            fillet_ratio: 0.16,
            kerf: 0.2,
            r_win: 100.0,
        }
    }

    fn solution(scale: f64) -> StudySolution {
        let sample = |lambda: f64| HingeSample {
            lambda,
            w: scale * lambda * lambda,
            f_a: scale,
            m_theta: -scale * lambda,
            d: scale * lambda,
            uz_max: scale,
            ..HingeSample::default()
        };
        StudySolution {
            elements: 1,
            cpu_seconds: 1.0,
            overhead: 0.01,
            peak_memory_mib: 100.0,
            iterations: 1,
            samples: [0.25, 0.5, 1.0].map(sample).to_vec(),
        }
    }

    #[test]
    fn a_state_is_linear_between_increments_and_rests_at_the_start() {
        let solution = solution(8.0);
        assert_eq!(solution.at(30.0), [2.0, 8.0, -4.0, 4.0, 8.0]);
        assert_eq!(solution.at(45.0), [5.0, 8.0, -6.0, 6.0, 8.0]);
        assert_eq!(solution.at(0.0), [0.0; 5]);
    }

    #[test]
    fn a_state_that_is_three_percent_larger_differs_by_three_percent() {
        for difference in solution(1.03).difference(&solution(1.0)) {
            assert!((difference - 0.03).abs() < 1e-12);
        }
    }

    #[test]
    fn the_order_of_an_error_is_found_and_the_error_extrapolated_away() {
        let sizes = [1.0, 0.75, 0.5];
        for order in [1.0, 2.0, 3.3] {
            let found = richardson(sizes, sizes.map(|h: f64| 90.0 + 7.0 * h.powf(order)));
            assert!(found.observed && (found.order - order).abs() < 1e-6);
            assert!((found.limit - 90.0).abs() < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn values_without_an_order_are_extrapolated_as_of_second_order() {
        for values in [[1.0, 2.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.1, 9.0]] {
            let found = richardson([1.0, 0.75, 0.5], values);
            assert!(!found.observed && found.order == 2.0, "{found:?}");
            assert!(found.limit.is_finite());
        }
    }

    #[test]
    fn every_value_is_compared_with_one_that_is_solved() {
        for quick in [false, true] {
            let cases = study_cases(design(), quick);
            for case in &cases {
                let mut same = cases.iter().filter(|c| c.study == case.study);
                assert!(same.any(|c| c.value == case.against), "{case:?}");
            }
        }
    }
}
