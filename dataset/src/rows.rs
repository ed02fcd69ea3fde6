//! One row of the database: one converged increment with its provenance.

use hinge::{HingeDesign, HingeSample};

/// A sample of (eps, g) -> (W, grad W, D) with its provenance; section 2.4.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Id of the job (one geometry, one ray) of this row.
    pub job: String,
    /// The hinge design.
    pub design: HingeDesign,
    /// Deformation, energy, forces and damage of the increment.
    pub sample: HingeSample,
    /// Why the ray stopped before its end; empty for a complete ray.
    pub failure: String,
    /// Name of the sheet material.
    pub material: String,
    /// [`hinge::SheetMaterial::law_hash`] of the material; empty if unknown.
    pub material_hash: String,
    /// Hash of the settings that all jobs of a campaign share, except the material; empty if
    /// unknown.
    pub settings_hash: String,
    /// Requested tier of the window mesh.
    pub tier: String,
    /// Tier on which the row was solved: a finer one if the requested tier failed.
    pub solved_tier: String,
    /// Version of gmsh.
    pub gmsh: String,
    /// Version of ccx.
    pub ccx: String,
    /// CPU time of the whole ray (s), repeated in each of its rows.
    pub cpu_s: f64,
}

impl Row {
    /// (eta_a, eta_s) of (13).
    pub fn eta(&self) -> [f64; 2] {
        self.sample.deformation().eta(self.design.w_lig)
    }

    /// Whether the ray stopped before its end.
    pub fn is_partial(&self) -> bool {
        !self.failure.is_empty()
    }

    /// Whether it was solved on the tier of its campaign, and not on a finer one after a failure.
    pub fn is_as_asked(&self) -> bool {
        self.solved_tier == self.tier
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use hinge::HingeConstants;

    /// A row of the quadratic energy 10 (a^2 + s^2) + 50 theta^2 of the job `index`, at `lambda`.
    pub fn row(index: usize, lambda: f64) -> Row {
        let x = index as f64;
        let [a, s, theta] = [0.3 * (1.7 * x).sin(), 0.2 * (2.9 * x).cos(), 1.0].map(|v| v * lambda);
        Row {
            job: format!("job-{index:03}"),
            design: HingeConstants::PAPER
                .hinge(15.0 + 8.0 * (0.9 * x).sin(), 1.1 + 0.4 * (1.3 * x).sin()),
            sample: HingeSample {
                lambda,
                a,
                s,
                theta,
                w: 10.0 * (a * a + s * s) + 50.0 * theta * theta,
                w_work: 10.0 * (a * a + s * s) + 50.0 * theta * theta,
                w_elastic: 5.0 * lambda * lambda,
                f_a: 20.0 * a,
                f_s: 20.0 * s,
                m_theta: 100.0 * theta,
                plastic_integral: lambda,
                d: 0.01 * lambda,
                d_peak: Some(0.1 * lambda),
                uz_max: 20.0 * lambda.sqrt(),
                energy_residual: 1e-3,
            },
            failure: if index == 1 { "diverged" } else { "" }.into(),
            material: "film".into(),
            material_hash: "f11f".into(),
            settings_hash: "5e77".into(),
            tier: "default".into(),
            solved_tier: "default".into(),
            gmsh: "4.8.4".into(),
            ccx: "2.20".into(),
            cpu_s: 10.0,
        }
    }

    /// Ten increments of each of `jobs` jobs.
    pub fn rows(jobs: usize) -> Vec<Row> {
        let increments = |index| (1..=10).map(move |k| row(index, 0.1 * f64::from(k)));
        (0..jobs).flat_map(increments).collect()
    }

    /// The same rays on a finer mesh.
    pub fn finer(rows: Vec<Row>) -> Vec<Row> {
        let solved = |row: Row| Row {
            job: format!("fine-{}", row.job),
            settings_hash: "f19e".into(),
            tier: "reference".into(),
            solved_tier: "reference".into(),
            ..row
        };
        rows.into_iter().map(solved).collect()
    }
}
