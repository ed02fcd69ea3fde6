//! The learned law of hinges that were unloaded: the residual deformation, and how stiff the hinge
//! is about it, as functions of the hinge and of the state that it reached.
//!
//! ```text
//! r = x - K^-1 f + e,      K = U diag(exp d) U^T,      U = unit lower triangle in the order (a, theta, s)
//! ```
//!
//! x is the reached state and f its forces: a hinge of stiffness K springs back by K^-1 f, and e is
//! what that leaves where the stiffness changes on the way. All are in units of (w_lig, 1, w_lig).
//! K is positive definite for any coefficients. Each of e_a, e_theta, d and u_{theta a} is a
//! polynomial of second degree in (ln w_lig, alpha - 90 deg, eta_a, eta_s, theta) whose terms are
//! even in (alpha - 90 deg, eta_s), each of e_s, u_{s a} and u_{s theta} one whose terms are odd:
//! the law of the mirrored hinge is the mirrored law. A sheet of another thickness has similar
//! hinges: [`ReleasedHinge::scaled`].

use hinge::{HingeConstants, HingeDeformation, HingeDesign, ReleasedHinge};
use serde::{Deserialize, Serialize};
use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use support::{Fault, fault, regular_file, sealed_json, unread};

/// The even and the odd terms: products of two of the factors (1, ln w_lig, eta_a, theta, alpha -
/// 90 deg, eta_s), of which the last two change sign in the mirrored hinge.
const EVEN: [[usize; 2]; TERMS[0]] = [
    [0, 0],
    [0, 1],
    [0, 2],
    [0, 3],
    [1, 1],
    [1, 2],
    [1, 3],
    [2, 2],
    [2, 3],
    [3, 3],
    [4, 4],
    [4, 5],
    [5, 5],
];
const ODD: [[usize; 2]; TERMS[1]] =
    [[0, 4], [0, 5], [4, 1], [4, 2], [4, 3], [5, 1], [5, 2], [5, 3]];
/// Their numbers.
const TERMS: [usize; 2] = [13, 8];
/// The input that each factor after the first is in proportion to; see [`inputs`].
const INPUT_OF: [usize; 5] = [0, 2, 4, 1, 3];

/// The law, with its training and its errors.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Springback {
    /// Name of the sheet material.
    pub material: String,
    /// [`law_hash`](hinge::SheetMaterial::law_hash) of the material.
    pub material_hash: String,
    /// Thickness of the windows (mm).
    pub thickness: f64,
    /// Hole, kerf and radius of the windows.
    pub hinge: HingeConstants,
    /// Tier of their mesh.
    pub tier: String,
    /// Number of hinges that the law was fitted to.
    pub hinges: usize,
    /// Errors at hinges that the fit has not seen, with the forces of their windows; `None` without
    /// any.
    pub errors: Option<SpringbackErrors>,
    /// Mean and standard deviation of ln w_lig, eta_a and theta.
    means: [[f64; 2]; 3],
    /// Root mean squares of alpha - 90 deg and eta_s.
    spans: [f64; 2],
    /// Coefficients of (d_a, d_theta, d_s, u_{theta a}), a row a term.
    stiffness_even: [[f64; 4]; TERMS[0]],
    /// Coefficients of (u_{s a}, u_{s theta}).
    stiffness_odd: [[f64; 2]; TERMS[1]],
    /// Coefficients of (e_a, e_theta).
    rest_even: [[f64; 2]; TERMS[0]],
    /// Coefficients of e_s.
    rest_odd: [[f64; 1]; TERMS[1]],
}

/// Errors of the law at a set of hinges.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpringbackErrors {
    /// Number of hinges.
    pub hinges: usize,
    /// Root mean squares of the errors of r in (eta_a, eta_s, theta (rad)).
    pub rest: [f64; 3],
    /// The same of what springs back, the reached state minus r.
    pub sprung: [f64; 3],
    /// Root mean square of |K - K_fe| / |K_fe|, Frobenius norms in units of (w_lig, w_lig, 1).
    pub stiffness: f64,
}

impl Springback {
    /// A hinge of the thickness of the windows after it was unloaded from a state with these forces
    /// (F_a, F_s, M_theta) (N, N, N mm).
    pub fn released(
        &self,
        design: &HingeDesign,
        reached: &HingeDeformation,
        forces: &[f64; 3],
    ) -> ReleasedHinge {
        let factors = self.factors(&inputs(design, reached));
        let (even, odd) = (products(&factors, &EVEN), products(&factors, &ODD));
        let [d_a, d_theta, d_s, u_theta] = product(&even, &self.stiffness_even);
        let [u_s, u_s_theta] = product(&odd, &self.stiffness_odd);
        let [e_a, e_theta] = product(&even, &self.rest_even);
        let [e_s] = product(&odd, &self.rest_odd);
        let unit = [[1.0, 0.0, 0.0], [u_theta, 1.0, 0.0], [u_s, u_s_theta, 1.0]];
        let pivots = [d_a, d_theta, d_s].map(f64::exp);
        // The units of (a, s, theta) (mm, mm, rad).
        let lengths = [design.w_lig, design.w_lig, 1.0];
        let sprung = back(&unit, &pivots, PLACES.map(|i| forces[i] * lengths[i]));
        let (left, reached) = ([e_a, e_s, e_theta], reached.to_array());
        let rest: [f64; 3] = from_fn(|i| reached[i] + lengths[i] * (left[i] - sprung[PLACES[i]]));
        ReleasedHinge {
            rest: rest.into(),
            stiffness: from_fn(|i| {
                from_fn(|j| {
                    let [p, q] = [PLACES[i], PLACES[j]];
                    let term = |k: usize| unit[p][k] * pivots[k] * unit[q][k];
                    (0..3).map(term).sum::<f64>() / (lengths[i] * lengths[j])
                })
            }),
        }
    }

    /// Reads a law from its file.
    pub fn load(path: &Path) -> Result<Self, Fault> {
        let bytes = regular_file::read(path).map_err(unread(path))?;
        sealed_json::from_slice(&bytes)
            .map_err(|error| fault!("{} is not a law of released hinges: {error}", path.display()))
    }

    /// The factors of the terms.
    fn factors(&self, x: &[f64; 5]) -> [f64; 6] {
        let [[w, of_w], [a, of_a], [t, of_t]] = self.means;
        let means = [w, a, t, 0.0, 0.0];
        let units = [of_w, of_a, of_t, self.spans[0], self.spans[1]];
        from_fn(|i| match i {
            0 => 1.0,
            _ => (x[INPUT_OF[i - 1]] - means[i - 1]) / units[i - 1],
        })
    }
}

/// (ln w_lig, alpha - 90 deg, eta_a, eta_s, theta)
fn inputs(design: &HingeDesign, reached: &HingeDeformation) -> [f64; 5] {
    let [eta_a, eta_s] = reached.eta(design.w_lig);
    [design.w_lig.ln(), design.alpha - FRAC_PI_2, eta_a, eta_s, reached.theta]
}

/// Where (a, s, theta) are in the order (a, theta, s), and the reverse.
const PLACES: [usize; 3] = [0, 2, 1];

/// The solution of U diag(pivots) U^T x = right.
fn back(unit: &[[f64; 3]; 3], pivots: &[f64; 3], right: [f64; 3]) -> [f64; 3] {
    let mut x = right;
    for i in 0..3 {
        x[i] -= (0..i).map(|k| unit[i][k] * x[k]).sum::<f64>();
    }
    for i in (0..3).rev() {
        x[i] = x[i] / pivots[i] - (i + 1..3).map(|k| unit[k][i] * x[k]).sum::<f64>();
    }
    x
}

fn products<const T: usize>(factors: &[f64; 6], terms: &[[usize; 2]; T]) -> [f64; T] {
    terms.map(|[i, j]| factors[i] * factors[j])
}

fn product<const T: usize, const N: usize>(terms: &[f64; T], rows: &[[f64; N]; T]) -> [f64; N] {
    from_fn(|n| std::iter::zip(terms, rows).map(|(x, row)| x * row[n]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;
    use support::statistics::root_mean_square;

    fn plate(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/polypropylene-3mm").join(name)
    }

    fn law() -> Springback {
        Springback::load(&plate("springback.json")).unwrap()
    }

    /// A hinge that finite elements unloaded.
    struct Unloaded {
        design: HingeDesign,
        reached: HingeDeformation,
        forces: [f64; 3],
        rest: [f64; 3],
        /// (K_aa, K_a s, K_a theta, K_ss, K_s theta, K_theta theta)
        stiffness: [f64; 6],
    }

    /// The hinges that neither the fit of the law nor the choice of its form has seen.
    fn unseen() -> Vec<Unloaded> {
        let rows = std::fs::read_to_string(plate("released-unseen.csv")).unwrap();
        let hinge = |row: &str| {
            let x: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
            Unloaded {
                design: law().hinge.hinge(x[0], x[1]),
                reached: [x[5], x[6], x[7]].into(),
                forces: [x[8], x[9], x[10]],
                rest: [x[12], x[13], x[14]],
                stiffness: from_fn(|i| x[15 + i]),
            }
        };
        rows.lines().skip(1).map(hinge).collect()
    }

    /// (K_aa, K_a s, K_a theta, K_ss, K_s theta, K_theta theta)
    fn upper(k: [[f64; 3]; 3]) -> [f64; 6] {
        [k[0][0], k[0][1], k[0][2], k[1][1], k[1][2], k[2][2]]
    }

    /// The figures of docs/results/springback.
    #[test]
    fn the_shipped_law_is_as_accurate_as_it_says_at_hinges_that_it_has_not_seen() {
        let (law, hinges) = (law(), unseen());
        assert_eq!(hinges.len(), 39);
        let found: Vec<_> =
            (hinges.iter()).map(|it| law.released(&it.design, &it.reached, &it.forces)).collect();
        let errors = |i: usize, unit: &dyn Fn(f64) -> f64| {
            let pairs = std::iter::zip(&hinges, &found);
            root_mean_square(
                pairs
                    .map(|(it, law)| (law.rest.to_array()[i] - it.rest[i]) / unit(it.design.w_lig)),
            )
        };
        let rest = [errors(0, &|w| w), errors(1, &|w| w), errors(2, &|_| 1.0).to_degrees()];
        for (error, stated) in std::iter::zip(rest, [0.0019, 0.0024, 0.13]) {
            assert!((error / stated - 1.0).abs() < 0.05, "{rest:?}");
        }
        let stiffness = std::iter::zip(&hinges, &found).map(|(it, law)| {
            let w = it.design.w_lig;
            // Off the diagonal every entry is there twice.
            let units =
                [w * w, 2.0_f64.sqrt() * w * w, 2.0_f64.sqrt() * w, w * w, 2.0_f64.sqrt() * w, 1.0];
            let norm = |k: [f64; 6]| (0..6).map(|i| (k[i] * units[i]).powi(2)).sum::<f64>().sqrt();
            let law = upper(law.stiffness);
            norm(from_fn(|i| law[i] - it.stiffness[i])) / norm(it.stiffness)
        });
        let stiffness = root_mean_square(stiffness);
        assert!((stiffness / 0.026 - 1.0).abs() < 0.05, "{stiffness}");
    }

    #[test]
    fn the_law_of_the_mirrored_hinge_is_the_mirrored_law() {
        let law = law();
        for Unloaded { design, reached, forces: [f_a, f_s, m_theta], .. } in unseen() {
            let image =
                law.released(&design.mirrored(), &reached.mirrored(), &[f_a, -f_s, m_theta]);
            let hinge = law.released(&design, &reached, &[f_a, f_s, m_theta]);
            let rest = std::iter::zip(image.rest.to_array(), hinge.rest.mirrored().to_array());
            let [a, a_s, a_t, s, s_t, t] = upper(hinge.stiffness);
            let stiffness = std::iter::zip(upper(image.stiffness), [a, -a_s, a_t, s, -s_t, t]);
            let close = |(x, y): (f64, f64)| (x - y).abs() < 1e-9 * (1.0 + y.abs());
            assert!(rest.chain(stiffness).all(close));
        }
    }

    #[test]
    fn a_damaged_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("springback.json");
        let text = std::fs::read_to_string(plate("springback.json")).unwrap();
        std::fs::write(&path, text.replace("\"hinges\": 45", "\"hinges\": 46")).unwrap();
        let damaged = Springback::load(&path).unwrap_err().to_string();
        assert!(damaged.contains("is not a law of released hinges"), "{damaged}");
    }
}
