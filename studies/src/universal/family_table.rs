//! The table of the solved rays of the family on one mesh tier, `default.parquet`: one row a converged increment.
//!
//! | column | unit | |
//! |---|---|---|
//! | ray | | index of the ray, and of its law, in the family |
//! | poisson, yield_strain, plateau, hardening | | the law: nu, y, q, h |
//! | w_lig_over_t | | ligament width |
//! | alpha, theta | rad | cut angle, rotation |
//! | eta_a, eta_s | | translations over w_lig |
//! | W, dW_deta_a, dW_deta_s, dW_dtheta | | energy and its derivatives over E t^3 |
//! | cpu_s | s | solver CPU time of the whole ray |

use crate::universal::family_rays::FamilyRay;
use crate::universal::law::Law;
use crate::universal::states::{Film, SolvedState};
use anyhow::{Context, Result, ensure};
use dataset::{Values, numbers_of_table, parquet_table};
use fe_driver::KeptSolution;
use hinge::SheetMaterial;
use std::path::Path;
use train::{EnergySlopes, LAW_STRAINS};

/// The states of a solved ray.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedRay {
    /// Index in the family.
    pub index: usize,
    /// Solver CPU time (s).
    pub cpu_seconds: f64,
    pub states: Vec<SolvedState>,
}

impl SolvedRay {
    pub fn new(
        ray: &FamilyRay,
        solution: &KeptSolution,
        sheet: &SheetMaterial,
        film: &Film,
    ) -> Self {
        let state = |sample| SolvedState::new(&ray.ray.design, sample, sheet, ray.law, film);
        Self {
            index: ray.index,
            cpu_seconds: solution.cpu_seconds.unwrap_or(0.0),
            states: solution.samples.iter().map(state).collect(),
        }
    }

    /// Whether it has the law, the hinge and the end of a ray in a sheet.
    pub fn is_of(&self, ray: &FamilyRay, sheet: &SheetMaterial) -> bool {
        let Some(last) = self.states.last() else {
            return false;
        };
        let (design, end) = (ray.ray.design, ray.ray.end);
        let [eta_a, eta_s] = end.eta(design.w_lig);
        let hinge = [design.w_lig / sheet.thickness, design.alpha];
        // The end is reached at lambda = 1, up to the rounding of the quotients.
        let ends = last.at.into_iter().zip([eta_a, eta_s, end.theta]);
        let reached = ends.map(|(found, end)| (found - end).abs());
        last.law == ray.law
            && [last.ligament, last.alpha] == hinge
            && reached.fold(0.0, f64::max) < 1e-9
    }
}

const COLUMNS: [&str; 15] = [
    "ray",
    "poisson",
    "yield_strain",
    "plateau",
    "hardening",
    "w_lig_over_t",
    "alpha",
    "eta_a",
    "eta_s",
    "theta",
    "W",
    "dW_deta_a",
    "dW_deta_s",
    "dW_dtheta",
    "cpu_s",
];

/// Writes the table atomically.
pub fn write(path: &Path, rays: &[SolvedRay]) -> Result<()> {
    let rows: Vec<[f64; 15]> = (rays.iter())
        .flat_map(|ray| ray.states.iter().map(|state| row(ray, state)))
        .collect();
    let columns: Vec<(&str, Values)> = COLUMNS
        .into_iter()
        .enumerate()
        .map(|(k, name)| {
            let values = rows.iter().map(|row| Some(row[k])).collect();
            (name, Values::Numbers(values))
        })
        .collect();
    let bytes = parquet_table(&columns)?;
    support::whole_file::write(path, &bytes)
        .with_context(|| format!("cannot write {}", path.display()))
}

/// Reads the table; the energies of the film are computed.
pub fn read(path: &Path, film: &Film) -> Result<Vec<SolvedRay>> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let rows = numbers_of_table(&bytes, COLUMNS)
        .with_context(|| format!("{} is no table of rays", path.display()))?;
    ensure!(
        rows.iter().flatten().all(|number| number.is_finite()),
        "{} has a number that is not finite",
        path.display()
    );
    let rays = rows.chunk_by(|left, right| left[0] == right[0]);
    Ok(rays
        .map(|rows| SolvedRay {
            index: rows[0][0] as usize,
            cpu_seconds: rows[0][14],
            states: rows.iter().map(|row| film.filled(state(row))).collect(),
        })
        .collect())
}

fn row(ray: &SolvedRay, state: &SolvedState) -> [f64; 15] {
    let Law {
        poisson,
        yield_strain,
        plateau,
        hardening,
    } = state.law;
    let [eta_a, eta_s, theta] = state.at;
    let EnergySlopes {
        energy,
        slopes: [by_a, by_s, by_theta],
    } = state.solved;
    [
        ray.index as f64,
        poisson,
        yield_strain,
        plateau,
        hardening,
        state.ligament,
        state.alpha,
        eta_a,
        eta_s,
        theta,
        energy,
        by_a,
        by_s,
        by_theta,
        ray.cpu_seconds,
    ]
}

fn state(row: &[f64; 15]) -> SolvedState {
    let [
        _,
        poisson,
        yield_strain,
        plateau,
        hardening,
        ligament,
        alpha,
        eta_a,
        eta_s,
        theta,
        energy,
        slopes @ ..,
        _,
    ] = *row;
    let law = Law {
        poisson,
        yield_strain,
        plateau,
        hardening,
    };
    SolvedState {
        law,
        works: law.works(),
        film_works: [0.0; LAW_STRAINS],
        ligament,
        alpha,
        at: [eta_a, eta_s, theta],
        solved: EnergySlopes { energy, slopes },
        film: EnergySlopes::default(),
    }
}
