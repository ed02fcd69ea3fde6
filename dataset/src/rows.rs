//! One row of the database: one converged increment with its provenance.

use fe_driver::{FailureKind, ToolVersions};
use hinge::{HingeDesign, HingeSample};
use mesher::Tier;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use support::Fault;

/// A sample of (eps, g) -> (W, grad W, D) with its provenance; section 2.4.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Id of the job (one geometry, one ray) of this row.
    pub job: String,
    /// The hinge design.
    pub design: HingeDesign,
    /// Deformation, energy, forces and damage of the increment.
    pub sample: HingeSample,
    /// Why the ray stopped before its end; `None` for a complete ray.
    pub failure: Option<FailureKind>,
    /// Name of the sheet material.
    pub material: String,
    /// [`hinge::SheetMaterial::law_hash`] of the material; empty if unknown.
    pub material_hash: String,
    /// Hash of the settings that all jobs of a campaign share, except the material; empty if
    /// unknown.
    pub settings_hash: String,
    /// Requested mesh, or the mesh that the row was corrected to.
    pub tier: Fidelity,
    /// Mesh on which the row was solved: a finer one if the requested mesh failed.
    pub solved_tier: Tier,
    /// Versions of the programs that solved the row.
    pub tools: ToolVersions,
    /// CPU time of the whole ray (s), repeated in each of its rows.
    pub cpu_s: f64,
}

impl Row {
    /// (eta_a, eta_s) of (13).
    pub fn eta(&self) -> [f64; 2] {
        self.sample.deformation().eta(self.design.w_lig)
    }

    /// Whether it was solved on the tier of its campaign, and not on a finer one after a failure.
    pub fn at_requested_tier(&self) -> bool {
        self.tier == Fidelity::Solved(self.solved_tier)
    }
}

/// The rows followed by their mirror images.
///
/// ```text
/// W(a, s, theta; alpha) = W(a, -s, theta; pi - alpha),   and the same for D
/// ```
///
/// Mirror only after the split: an image contains no information beyond the information in its
/// original.
pub fn with_mirrored(rows: &[Row]) -> Vec<Row> {
    let images = rows.iter().map(|row| Row {
        design: row.design.mirrored(),
        sample: row.sample.mirrored(),
        ..row.clone()
    });
    rows.iter().cloned().chain(images).collect()
}

/// The meshes of the rows of a database. Files state its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Fidelity {
    /// Solved on this mesh.
    Solved(Tier),
    /// Solved on one mesh and corrected to a finer one.
    Corrected {
        /// The mesh on which the rows were solved.
        from: Tier,
        /// The finer mesh.
        to: Tier,
    },
}

/// Separator of the two mesh names of corrected rows.
const CORRECTED_TO: &str = " corrected to ";

impl Fidelity {
    /// The mesh whose results the rows represent.
    pub fn mesh(self) -> Tier {
        match self {
            Self::Solved(mesh) | Self::Corrected { to: mesh, .. } => mesh,
        }
    }
}

impl Default for Fidelity {
    fn default() -> Self {
        Self::Solved(Tier::default())
    }
}

impl fmt::Display for Fidelity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Solved(mesh) => mesh.fmt(f),
            Self::Corrected { from, to } => write!(f, "{from}{CORRECTED_TO}{to}"),
        }
    }
}

impl FromStr for Fidelity {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Self, Fault> {
        Ok(match text.split_once(CORRECTED_TO) {
            Some((from, to)) => Self::Corrected { from: from.parse()?, to: to.parse()? },
            None => Self::Solved(text.parse()?),
        })
    }
}

impl TryFrom<String> for Fidelity {
    type Error = Fault;

    fn try_from(text: String) -> Result<Self, Fault> {
        text.parse()
    }
}

impl From<Fidelity> for String {
    fn from(fidelity: Fidelity) -> Self {
        fidelity.to_string()
    }
}

/// Design and end of a ray, in millionths of their units.
pub(crate) type RayKey = [i64; 8];

/// The ray to a row, or straight on beyond it.
pub(crate) fn ray_key(row: &Row) -> RayKey {
    let (design, x) = (&row.design, &row.sample);
    let [a, s, theta] = [x.a, x.s, x.theta].map(|component| component / x.lambda);
    let ray =
        [design.w_lig, design.alpha, design.fillet_ratio, design.kerf, design.r_win, a, s, theta];
    ray.map(|number| (1e6 * number).round() as i64)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use hinge::HingeConstants;
    use std::f64::consts::PI;

    #[test]
    fn an_image_has_the_same_energy_and_the_opposite_shear_force() {
        let rows = rows(3);
        let both = with_mirrored(&rows);
        assert_eq!(both.len(), 2 * rows.len());
        assert_eq!(both[..rows.len()], rows);
        for (row, image) in rows.iter().zip(&both[rows.len()..]) {
            assert_eq!(image.design.alpha, PI - row.design.alpha);
            assert_eq!(image.design.w_lig, row.design.w_lig);
            assert_eq!(image.eta(), [row.eta()[0], -row.eta()[1]]);
            let (sample, original) = (image.sample, row.sample);
            assert_eq!(
                [sample.w, sample.d, sample.f_a, sample.m_theta],
                [original.w, original.d, original.f_a, original.m_theta]
            );
            assert_eq!(sample.f_s, -original.f_s);
        }
    }

    #[test]
    fn a_fidelity_is_written_and_read() {
        let corrected = Fidelity::Corrected { from: Tier::Default, to: Tier::Reference };
        assert_eq!(corrected.to_string(), "default corrected to reference");
        assert_eq!(corrected.to_string().parse(), Ok(corrected));
        assert_eq!(corrected.mesh(), Tier::Reference);
        assert_eq!("fine".parse(), Ok(Fidelity::Solved(Tier::Fine)));
        for unclear in ["default + tiny", "another solver", ""] {
            assert!(unclear.parse::<Fidelity>().is_err(), "{unclear}");
        }
    }

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
            failure: (index == 1).then_some(FailureKind::Diverged),
            material: "film".into(),
            material_hash: "f11f".into(),
            settings_hash: "5e77".into(),
            tier: Fidelity::default(),
            solved_tier: Tier::Default,
            tools: ToolVersions { gmsh: "4.8.4".into(), ccx: "2.20".into() },
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
            tier: Fidelity::Solved(Tier::Reference),
            solved_tier: Tier::Reference,
            ..row
        };
        rows.into_iter().map(solved).collect()
    }
}
