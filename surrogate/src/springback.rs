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

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};
use hinge::{
    HingeConstants, HingeDeformation, HingeDesign, ReleasedHinge, ReleasedSample, SheetMaterial,
};
use serde::{Deserialize, Serialize};
use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;
use std::io;
use std::path::{Path, PathBuf};
use support::file_error::FileError;
use support::sealed_json::{self, SealError};
use support::statistics::root_mean_square;
use support::vectors::dot;
use support::{regular_file, whole_file};

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
/// Ridge of the fit, relative to the number of hinges: terms that hardly vary get small
/// coefficients.
const RIDGE: f64 = 1e-4;
/// Smallest deviation that a quantity is divided by: one that does not vary has no effect.
const NARROWEST: f64 = 1e-3;
/// Fewest hinges of a fit: three for each even term.
pub const FEWEST: usize = 3 * TERMS[0];

/// The law, with its training and its errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Springback {
    /// Name of the sheet material.
    pub material: String,
    /// [`SheetMaterial::law_hash`] of the material.
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
    /// Of (u_{s a}, u_{s theta}).
    stiffness_odd: [[f64; 2]; TERMS[1]],
    /// Of (e_a, e_theta).
    rest_even: [[f64; 2]; TERMS[0]],
    /// Of e_s.
    rest_odd: [[f64; 1]; TERMS[1]],
}

/// Errors of the law at a set of hinges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
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

/// Why there is no law.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum SpringbackError {
    #[error("{0} hinges are too few for a law: at least {FEWEST}")]
    TooFew(usize),
    #[error(
        "row {0} has another hole, kerf or window than the first one, and a law knows one of each: use weights for holes of one radius"
    )]
    Constants(usize),
    #[error(
        "row {0} has a number that is not finite, or a stiffness that is not positive definite"
    )]
    Row(usize),
    #[error("cannot read {0}")]
    Read(#[source] FileError),
    #[error("{path} is not a law of released hinges: {source}", path = .path.display())]
    File { path: PathBuf, source: SealError },
    #[error("cannot write {0}")]
    Write(#[source] FileError),
}

impl Springback {
    /// Fits the law to hinges, and measures its errors at `unseen` ones.
    pub fn fit(
        rows: &[ReleasedSample],
        unseen: &[ReleasedSample],
        material: &SheetMaterial,
        tier: &str,
    ) -> Result<Self, SpringbackError> {
        if rows.len() < FEWEST {
            return Err(SpringbackError::TooFew(rows.len()));
        }
        let hinge = rows[0].design().constants();
        let other = |row: &ReleasedSample| row.design().constants() != hinge;
        if let Some(other) = rows.iter().position(other) {
            return Err(SpringbackError::Constants(other + 1));
        }
        let inputs: Vec<[f64; 5]> =
            rows.iter().map(|row| inputs(&row.design(), &row.reached())).collect();
        let column = |i: usize| inputs.iter().map(move |x| x[i]);
        let count = rows.len() as f64;
        let mean = |i: usize| {
            let mean = column(i).sum::<f64>() / count;
            let deviation = root_mean_square(column(i).map(|x| x - mean));
            [mean, deviation.max(NARROWEST)]
        };
        let mut law = Self {
            material: material.name.clone(),
            material_hash: material.law_hash(),
            thickness: material.thickness,
            hinge,
            tier: tier.to_owned(),
            hinges: rows.len(),
            errors: None,
            means: [mean(0), mean(2), mean(4)],
            spans: [1, 3].map(|i| root_mean_square(column(i)).max(NARROWEST)),
            stiffness_even: [[0.0; 4]; TERMS[0]],
            stiffness_odd: [[0.0; 2]; TERMS[1]],
            rest_even: [[0.0; 2]; TERMS[0]],
            rest_odd: [[0.0; 1]; TERMS[1]],
        };
        let factors: Vec<_> = (rows.iter().enumerate())
            .map(|(i, row)| {
                let factors = factors(row.w_lig, &row.released().stiffness);
                let known = row
                    .forces()
                    .iter()
                    .chain(&row.released().rest.to_array())
                    .all(|x| x.is_finite());
                factors.filter(|_| known).ok_or(SpringbackError::Row(i + 1))
            })
            .collect::<Result<_, _>>()?;
        let factors_of = inputs.iter().map(|x| law.factors(x));
        let (even, odd): (Vec<_>, Vec<_>) =
            factors_of.map(|x| (products(&x, &EVEN), products(&x, &ODD))).unzip();
        let (of_even, of_odd): (Vec<_>, Vec<_>) = factors.into_iter().unzip();
        law.stiffness_even = ridge(&even, &of_even);
        law.stiffness_odd = ridge(&odd, &of_odd);
        // So far e is zero: what is left is what it has to be.
        let left = rows.iter().map(|row| {
            let without = law.released(&row.design(), &row.reached(), &row.forces()).rest;
            let [a, s, theta] =
                from_fn(|i| row.released().rest.to_array()[i] - without.to_array()[i]);
            ([a / row.w_lig, theta], [s / row.w_lig])
        });
        let (of_even, of_odd): (Vec<_>, Vec<_>) = left.unzip();
        law.rest_even = ridge(&even, &of_even);
        law.rest_odd = ridge(&odd, &of_odd);
        law.errors = (!unseen.is_empty()).then(|| law.errors_at(unseen));
        Ok(law)
    }

    /// A hinge of the thickness of the windows after it was unloaded from a state with these forces
    /// (F_a, F_s, M_theta) (N, N, N mm).
    pub fn released(
        &self,
        design: &HingeDesign,
        reached: &HingeDeformation,
        forces: &[f64; 3],
    ) -> ReleasedHinge {
        self.local(design, reached, forces).released(reached)
    }

    /// The gradient, in what the hinge of [`released`](Self::released) follows from, of a function
    /// with the gradient `by` in it.
    pub fn released_pullback(
        &self,
        design: &HingeDesign,
        reached: &HingeDeformation,
        forces: &[f64; 3],
        by: &ByReleased,
    ) -> ReleasedGradient {
        let local = self.local(design, reached, forces);
        let stiffness = local.released(reached).stiffness;
        let Local { factors, lengths, unit, pivots, sprung, left } = local;
        // K enters r by K^-1 f: dr = -K^-1 dK K^-1 f.
        let by_sprung: [f64; 3] = from_fn(|p| -by.rest[PLACES[p]] * lengths[PLACES[p]]);
        let by_forces = back(&unit, &pivots, by_sprung);
        let by_k: [[f64; 3]; 3] = from_fn(|p| {
            from_fn(|q| {
                let [i, j] = [PLACES[p], PLACES[q]];
                by.stiffness[i][j] / (lengths[i] * lengths[j]) - by_forces[p] * sprung[q]
            })
        });
        let by_pivot = |k: usize| -> f64 {
            let sum = (0..9).map(|n| by_k[n / 3][n % 3] * unit[n / 3][k] * unit[n % 3][k]);
            pivots[k] * sum.sum::<f64>()
        };
        let by_unit = |p: usize, k: usize| -> f64 {
            let sum = (0..3).map(|q| (by_k[p][q] + by_k[q][p]) * unit[q][k]);
            pivots[k] * sum.sum::<f64>()
        };
        let of_even = [by_pivot(0), by_pivot(1), by_pivot(2), by_unit(1, 0)];
        let of_odd = [by_unit(2, 0), by_unit(2, 1)];
        let [of_a, of_s, of_theta] = from_fn(|i| by.rest[i] * lengths[i]);
        let mut by_factors = [0.0; 6];
        let mut add = |[i, j]: [usize; 2], by_term: f64| {
            by_factors[i] += by_term * factors[j];
            by_factors[j] += by_term * factors[i];
        };
        for (t, &term) in EVEN.iter().enumerate() {
            let by_rest = dot(&self.rest_even[t], &[of_a, of_theta]);
            add(term, dot(&self.stiffness_even[t], &of_even) + by_rest);
        }
        for (t, &term) in ODD.iter().enumerate() {
            let by_rest = dot(&self.rest_odd[t], &[of_s]);
            add(term, dot(&self.stiffness_odd[t], &of_odd) + by_rest);
        }
        let (mut by_inputs, units) = ([0.0; 5], self.units());
        (0..5).for_each(|k| by_inputs[INPUT_OF[k]] = by_factors[k + 1] / units[k]);
        let [by_width, by_angle, by_eta_a, by_eta_s, by_theta] = by_inputs;
        // The lengths of a and s are w_lig.
        let by_length = |i: usize| {
            let p = PLACES[i];
            let of_stiffness =
                (0..3).map(|j| (by.stiffness[i][j] + by.stiffness[j][i]) * stiffness[i][j]);
            by.rest[i] * (left[i] - sprung[p]) + by_forces[p] * forces[i]
                - of_stiffness.sum::<f64>() / lengths[i]
        };
        let (w, [eta_a, eta_s]) = (design.w_lig, reached.eta(design.w_lig));
        let of_inputs = (by_width - by_eta_a * eta_a - by_eta_s * eta_s) / w;
        ReleasedGradient {
            reached: [by.rest[0] + by_eta_a / w, by.rest[1] + by_eta_s / w, by.rest[2] + by_theta],
            forces: from_fn(|i| by_forces[PLACES[i]] * lengths[i]),
            w_lig: of_inputs + by_length(0) + by_length(1),
            alpha: by_angle,
        }
    }

    fn local(&self, design: &HingeDesign, reached: &HingeDeformation, forces: &[f64; 3]) -> Local {
        let factors = self.factors(&inputs(design, reached));
        let (even, odd) = (products(&factors, &EVEN), products(&factors, &ODD));
        let [d_a, d_theta, d_s, u_theta] = product(&even, &self.stiffness_even);
        let [u_s, u_s_theta] = product(&odd, &self.stiffness_odd);
        let [e_a, e_theta] = product(&even, &self.rest_even);
        let [e_s] = product(&odd, &self.rest_odd);
        let unit = [[1.0, 0.0, 0.0], [u_theta, 1.0, 0.0], [u_s, u_s_theta, 1.0]];
        let pivots = [d_a, d_theta, d_s].map(f64::exp);
        let lengths = [design.w_lig, design.w_lig, 1.0];
        Local {
            sprung: back(&unit, &pivots, PLACES.map(|i| forces[i] * lengths[i])),
            left: [e_a, e_s, e_theta],
            factors,
            lengths,
            unit,
            pivots,
        }
    }

    /// The errors of the law at hinges of finite elements.
    pub fn errors_at(&self, rows: &[ReleasedSample]) -> SpringbackErrors {
        let errors = rows.iter().map(|row| {
            let law = self.released(&row.design(), &row.reached(), &row.forces());
            let solved = row.released();
            let eta = |of: [f64; 3]| [of[0] / row.w_lig, of[1] / row.w_lig, of[2]];
            let [found, rest, reached] =
                [law.rest, solved.rest, row.reached()].map(|state| eta(state.to_array()));
            let lengths = [row.w_lig, row.w_lig, 1.0];
            let norm = |of: &dyn Fn(usize, usize) -> f64| {
                let squares =
                    (0..9).map(|k| (of(k / 3, k % 3) * lengths[k / 3] * lengths[k % 3]).powi(2));
                squares.sum::<f64>().sqrt()
            };
            let (k, k_fe) = (law.stiffness, solved.stiffness);
            let stiffness = norm(&|i, j| k[i][j] - k_fe[i][j]) / norm(&|i, j| k_fe[i][j]);
            let rest_error: [f64; 3] = from_fn(|i| found[i] - rest[i]);
            (rest_error, from_fn::<f64, 3, _>(|i| reached[i] - rest[i]), stiffness)
        });
        let errors: Vec<_> = errors.collect();
        SpringbackErrors {
            hinges: rows.len(),
            rest: from_fn(|i| root_mean_square(errors.iter().map(|(rest, ..)| rest[i]))),
            sprung: from_fn(|i| root_mean_square(errors.iter().map(|(_, sprung, _)| sprung[i]))),
            stiffness: root_mean_square(errors.iter().map(|(.., stiffness)| *stiffness)),
        }
    }

    /// BLAKE3 hash of the law.
    pub fn hash(&self) -> String {
        let law = serde_json::to_vec(self).expect("a law has finite numbers and plain keys");
        blake3::hash(&law).to_hex().to_string()
    }

    /// Reads a law from its file.
    pub fn load(path: &Path) -> Result<Self, SpringbackError> {
        let bytes =
            regular_file::read(path).map_err(FileError::at(path)).map_err(SpringbackError::Read)?;
        let law: Self = sealed_json::from_slice(&bytes)
            .map_err(|source| SpringbackError::File { path: path.to_owned(), source })?;
        Ok(law)
    }

    /// Writes the law to its file.
    pub fn save(&self, path: &Path) -> Result<(), SpringbackError> {
        let bytes = sealed_json::to_vec(self).map_err(io::Error::other);
        let written = bytes.and_then(|bytes| whole_file::write(path, &bytes));
        written.map_err(FileError::at(path)).map_err(SpringbackError::Write)
    }

    /// The factors of the terms.
    fn factors(&self, x: &[f64; 5]) -> [f64; 6] {
        let [[w, _], [a, _], [t, _]] = self.means;
        let (means, units) = ([w, a, t, 0.0, 0.0], self.units());
        from_fn(|i| match i {
            0 => 1.0,
            _ => (x[INPUT_OF[i - 1]] - means[i - 1]) / units[i - 1],
        })
    }

    /// What the inputs of the factors after the first are divided by.
    fn units(&self) -> [f64; 5] {
        let [[_, w], [_, a], [_, t]] = self.means;
        [w, a, t, self.spans[0], self.spans[1]]
    }
}

/// K, what a hinge springs back, and what that leaves, in units of (w_lig, 1, w_lig). K and what
/// springs back are in the order (a, theta, s).
struct Local {
    factors: [f64; 6],
    /// The units of (a, s, theta) (mm, mm, rad).
    lengths: [f64; 3],
    /// U
    unit: [[f64; 3]; 3],
    /// exp d
    pivots: [f64; 3],
    /// K^-1 f
    sprung: [f64; 3],
    /// e, in the order (a, s, theta).
    left: [f64; 3],
}

impl Local {
    fn released(&self, reached: &HingeDeformation) -> ReleasedHinge {
        let (reached, lengths) = (reached.to_array(), self.lengths);
        let rest: [f64; 3] =
            from_fn(|i| reached[i] + lengths[i] * (self.left[i] - self.sprung[PLACES[i]]));
        ReleasedHinge {
            rest: rest.into(),
            stiffness: from_fn(|i| {
                from_fn(|j| {
                    let [p, q] = [PLACES[i], PLACES[j]];
                    let term = |k: usize| self.unit[p][k] * self.pivots[k] * self.unit[q][k];
                    (0..3).map(term).sum::<f64>() / (lengths[i] * lengths[j])
                })
            }),
        }
    }
}

/// The gradient of a function of a released hinge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByReleased {
    /// In r = (a, s, theta).
    pub rest: [f64; 3],
    /// In the entries of K.
    pub stiffness: [[f64; 3]; 3],
}

/// The gradient of a function of a released hinge in what it follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReleasedGradient {
    /// In the deformation (a, s, theta) that was reached.
    pub reached: [f64; 3],
    /// In the forces (F_a, F_s, M_theta) there.
    pub forces: [f64; 3],
    /// In the ligament width.
    pub w_lig: f64,
    /// In the angle of the cuts.
    pub alpha: f64,
}

/// (ln w_lig, alpha - 90 deg, eta_a, eta_s, theta)
fn inputs(design: &HingeDesign, reached: &HingeDeformation) -> [f64; 5] {
    let [eta_a, eta_s] = reached.eta(design.w_lig);
    [design.w_lig.ln(), design.alpha - FRAC_PI_2, eta_a, eta_s, reached.theta]
}

/// Where (a, s, theta) are in the order (a, theta, s), and the reverse.
const PLACES: [usize; 3] = [0, 2, 1];

/// (d_a, d_theta, d_s, u_{theta a}) and (u_{s a}, u_{s theta}) of a stiffness; `None` if it is not
/// positive definite.
fn factors(w: f64, k: &[[f64; 3]; 3]) -> Option<([f64; 4], [f64; 2])> {
    let (aa, ta, tt) = (k[0][0] * w * w, k[2][0] * w, k[2][2]);
    let (sa, st, ss) = (k[1][0] * w * w, k[1][2] * w, k[1][1] * w * w);
    let u_theta = ta / aa;
    let d_theta = tt - u_theta * ta;
    let u_s = sa / aa;
    let u_s_theta = (st - u_s * ta) / d_theta;
    let d_s = ss - u_s * sa - u_s_theta * u_s_theta * d_theta;
    let [d_a, d_theta, d_s] = [aa, d_theta, d_s].map(f64::ln);
    let found = ([d_a, d_theta, d_s, u_theta], [u_s, u_s_theta]);
    let finite = found.0.iter().chain(&found.1).all(|x| x.is_finite());
    finite.then_some(found)
}

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

/// The coefficients that fit outputs to terms best, by least squares with [`RIDGE`].
fn ridge<const T: usize, const N: usize>(
    terms: &[[f64; T]],
    outputs: &[[f64; N]],
) -> [[f64; N]; T] {
    let count = terms.len() as f64;
    let normal = Mat::from_fn(T, T, |p, q| {
        let sum: f64 = terms.iter().map(|row| row[p] * row[q]).sum();
        sum + if p == q { RIDGE * count } else { 0.0 }
    });
    let right = Mat::from_fn(T, N, |p, n| {
        let pairs = std::iter::zip(terms, outputs);
        pairs.map(|(row, output)| row[p] * output[n]).sum::<f64>()
    });
    let factor = Llt::new(normal.as_ref(), Side::Lower).expect("the ridge is positive");
    let found = factor.solve(right);
    from_fn(|p| from_fn(|n| found[(p, n)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::{HingeConstants, HingeForces};

    fn material() -> SheetMaterial {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let film = root.join("../configs/materials/pet-0.5mm.toml");
        SheetMaterial::load(&film).unwrap()
    }

    /// The law of some hinges.
    fn law() -> (Vec<ReleasedSample>, Springback) {
        let rows = rows(60);
        let law = Springback::fit(&rows, &[], &material(), "plate").unwrap();
        (rows, law)
    }

    /// Hinges whose law is in the space of the fit, with small but full stiffness.
    fn rows(count: usize) -> Vec<ReleasedSample> {
        let wave = |i: usize, k: usize| ((1 + i) as f64 * (k as f64 + 0.37).sqrt() * 1.7).sin();
        (0..count)
            .map(|i| {
                let (w_lig, alpha) = (1.7 + 0.8 * wave(i, 0), FRAC_PI_2 + 0.6 * wave(i, 1));
                let design = HingeConstants::PAPER.hinge(w_lig, alpha);
                let w = design.w_lig;
                let theta = 0.5 + 0.4 * wave(i, 2);
                let reached = HingeDeformation::from_eta(0.4 * theta, 0.1 * wave(i, 3), theta, w);
                let [eta_a, eta_s] = reached.eta(w);
                let rest = HingeDeformation::from_eta(0.8 * eta_a, 0.7 * eta_s, theta - 0.15, w);
                // In units of (w, 1, w) and the order (a, theta, s).
                let d = [900.0 * w, 40.0, 300.0 * w * w];
                let u = [-0.3, 0.1 * eta_s, 0.2 * eta_s];
                let ta = u[0] * d[0];
                let (sa, st) = (u[1] * d[0], u[1] * ta + u[2] * d[1]);
                let tt = d[1] + u[0] * ta;
                let ss = d[2] + u[1] * sa + u[2] * u[2] * d[1];
                let stiffness = [
                    [d[0] / (w * w), sa / (w * w), ta / w],
                    [sa / (w * w), ss / (w * w), st / w],
                    [ta / w, st / w, tt],
                ];
                let hinge = ReleasedHinge { rest, stiffness };
                // Not quite those that a constant stiffness would have.
                let [f_a, f_s, m_theta] = hinge.forces(&reached).map(|force| 0.9 * force);
                let forces = HingeForces { f_a, f_s, m_theta };
                ReleasedSample::new(&design, &reached, &forces, Some(0.5), &hinge)
            })
            .collect()
    }

    #[test]
    fn a_law_of_its_own_kind_is_found() {
        let rows = rows(160);
        let law = Springback::fit(&rows[..120], &rows[120..], &material(), "plate").unwrap();
        let errors = law.errors.unwrap();
        assert_eq!(errors.hinges, 40);
        let mut parts = std::iter::zip(errors.rest, errors.sprung);
        assert!(parts.all(|(rest, sprung)| rest < 0.01 * sprung));
        assert!(errors.stiffness < 0.01, "{}", errors.stiffness);
    }

    #[test]
    fn the_law_of_the_mirrored_hinge_is_the_mirrored_law() {
        let (rows, law) = law();
        for row in &rows[..10] {
            let (design, reached, forces) = (row.design(), row.reached(), row.forces());
            let [f_a, f_s, m_theta] = forces;
            let (image, state) = (design.mirrored(), reached.mirrored());
            let mirrored = law.released(&image, &state, &[f_a, -f_s, m_theta]);
            let expected = law.released(&design, &reached, &forces).mirrored();
            let close = |x: f64, y: f64| (x - y).abs() < 1e-9 * (1.0 + y.abs());
            let pairs = std::iter::zip(mirrored.rest.to_array(), expected.rest.to_array());
            let stiffness = std::iter::zip(mirrored.stiffness, expected.stiffness);
            let stiffness = stiffness.flat_map(|(x, y)| std::iter::zip(x, y));
            assert!(pairs.chain(stiffness).all(|(x, y)| close(x, y)));
        }
    }

    /// The gradient of a linear function of r and K in all eight numbers that they follow from, by
    /// central differences.
    #[test]
    fn the_pullback_is_the_gradient() {
        let (rows, law) = law();
        let by = ByReleased {
            rest: [0.7, -1.1, 0.4],
            stiffness: [[2e-3, -1e-3, 3e-3], [4e-3, 1e-3, -2e-3], [1e-2, 5e-3, 2e-2]],
        };
        for row in &rows[..10] {
            let (design, reached, forces) = (row.design(), row.reached(), row.forces());
            let [a, s, theta] = reached.to_array();
            let [f_a, f_s, m_theta] = forces;
            let at = [a, s, theta, f_a, f_s, m_theta, design.w_lig, design.alpha];
            let value = |x: [f64; 8]| -> f64 {
                let mut design = design;
                [design.w_lig, design.alpha] = [x[6], x[7]];
                let reached = [x[0], x[1], x[2]].into();
                let hinge = law.released(&design, &reached, &[x[3], x[4], x[5]]);
                let stiffness = hinge.stiffness.as_flattened();
                let of_stiffness = std::iter::zip(stiffness, by.stiffness.as_flattened());
                dot(&hinge.rest.to_array(), &by.rest)
                    + of_stiffness.map(|(k, by)| k * by).sum::<f64>()
            };
            let found = law.released_pullback(&design, &reached, &forces, &by);
            let by_design = [found.w_lig, found.alpha];
            let found = [&found.reached[..], &found.forces, &by_design].concat();
            for i in 0..8 {
                let step = 1e-5 * at[i].abs().max(0.1);
                let moved = |side: f64| {
                    let mut x = at;
                    x[i] += side * step;
                    value(x)
                };
                let slope = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                let least = 1e-3 * value(at).abs() / at[i].abs().max(0.1);
                let allowed = 1e-6 * slope.abs().max(least);
                let error = (found[i] - slope).abs();
                assert!(error < allowed, "{i}: {error} of {slope}");
            }
        }
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let mut rows = rows(60);
        let fit = |rows: &[ReleasedSample]| Springback::fit(rows, &[], &material(), "plate");
        assert!(matches!(fit(&rows[..20]), Err(SpringbackError::TooFew(20))));
        rows[3].k_tt = -1.0;
        assert!(matches!(fit(&rows), Err(SpringbackError::Row(4))));
        rows[2].fillet_ratio = 0.2;
        assert!(matches!(fit(&rows), Err(SpringbackError::Constants(3))));
    }

    #[test]
    fn a_file_keeps_the_law_and_a_damaged_one_is_refused() {
        let (_, law) = law();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("springback.json");
        law.save(&path).unwrap();
        assert_eq!(Springback::load(&path).unwrap(), law);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("\"hinges\": 60", "\"hinges\": 61")).unwrap();
        let damaged = Springback::load(&path);
        assert!(matches!(damaged, Err(SpringbackError::File { .. })));
    }
}
