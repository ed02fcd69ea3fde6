//! Sheets with errors of cutting, of which the mean loss is the expected one.
//!
//! With independent errors p of the standard deviations sigma_p, and to second order in them,
//!
//! ```text
//! E[L] = L(0) + 1/2 sum_p sigma_p^2 d2L/dp2
//! ```
//!
//! Two sheets with all errors at once, one standard deviation to either side, x_p = +- s_p sigma_p with a sign s_p each, have
//!
//! ```text
//! (L(x) + L(-x)) / 2 = L(0) + 1/2 sum_p sigma_p^2 d2L/dp2 + 1/2 sum over p != q of s_p s_q sigma_p sigma_q d2L/dp dq
//! ```
//!
//! The last sum vanishes in the mean over pairs with independent signs, and between two errors whose signs are orthogonal. Two
//! pairs are therefore exact for the kerf and the thickness; for the ligaments, many and small, the signs are drawn once, so that
//! every design is judged by the same errors. (Trace estimator: Hutchinson, Communications in Statistics 18, 1989; two-level
//! arrays of noise factors: Taguchi, "Introduction to Quality Engineering", 1986.)

use crate::sheet::deviation::Deviation;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The name of the term: the mean loss of the cut sheets less that of the drawing.
pub(crate) const EXCESS: &str = "expected_excess";

/// Number of pairs of sheets if every ligament has errors of its own.
const PAIRS: usize = 4;
/// Seed of the signs of the ligaments.
const SEED: u64 = 0x6b65_7266;

/// The standard deviations of the errors of cutting (mm).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorDeviations {
    /// Of the width of every ligament by itself.
    pub ligament: f64,
    /// Of the kerf.
    pub kerf: f64,
    /// Of the thickness.
    pub thickness: f64,
}

/// Sheets with errors of cutting whose mean loss counts.
#[derive(Clone, Debug, PartialEq)]
pub struct CutSheets {
    /// Weight of the mean loss less the loss of the drawing.
    pub(crate) weight: f64,
    /// Thickness of the sheet of the drawing (mm).
    pub(crate) thickness: f64,
    pub(crate) deviations: Vec<Deviation>,
}

impl CutSheets {
    /// Pairs of sheets whose mean loss is the expected one to second order. The weight is that of the mean loss less that of the
    /// drawing, so that 1 is the expected loss; the sheet of the drawing has a number of hinges and a thickness (mm).
    pub fn new(weight: f64, hinges: usize, thickness: f64, errors: ErrorDeviations) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let common = [errors.kerf, errors.thickness];
        let common = common.iter().filter(|error| **error > 0.0).count();
        let (pairs, hinges) = match errors.ligament > 0.0 {
            true => (PAIRS, hinges),
            false => (common, 0),
        };
        let deviations = (0..pairs).flat_map(|pair| {
            let mut sign = || if random.random_bool(0.5) { 1.0 } else { -1.0 };
            let widths: Vec<f64> = (0..hinges).map(|_| sign() * errors.ligament).collect();
            let alternating = if pair % 2 == 0 { 1.0 } else { -1.0 };
            [1.0, -1.0].map(|side| Deviation {
                widths: widths.iter().map(|width| side * width).collect(),
                kerf: side * errors.kerf,
                thickness: side * alternating * errors.thickness,
                stress: 0.0,
            })
        });
        Self {
            weight,
            thickness,
            deviations: deviations.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The moments of the errors over the sheets are those of independent errors: exactly so for the kerf and the thickness.
    #[test]
    fn the_sheets_have_the_moments_of_their_errors() {
        let errors = ErrorDeviations {
            ligament: 0.3,
            kerf: 0.2,
            thickness: 0.1,
        };
        let alone = ErrorDeviations {
            ligament: 0.0,
            ..errors
        };
        for (errors, sheets) in [(errors, 8), (alone, 4)] {
            let found = CutSheets::new(1.0, 5, 1.0, errors).deviations;
            assert_eq!(found.len(), sheets);
            let mean =
                |of: &dyn Fn(&Deviation) -> f64| found.iter().map(of).sum::<f64>() / sheets as f64;
            for moment in [
                mean(&|of| of.kerf),
                mean(&|of| of.thickness),
                mean(&|of| of.kerf * of.thickness),
                mean(&|of| of.widths.iter().sum()),
            ] {
                assert!(moment.abs() < 1e-15, "{moment}");
            }
            assert!((mean(&|of| of.kerf.powi(2)) - 0.04).abs() < 1e-15);
            assert!((mean(&|of| of.thickness.powi(2)) - 0.01).abs() < 1e-15);
            for deviation in &found {
                assert!(deviation.widths.iter().all(|width| width.abs() == 0.3));
            }
        }
    }
}
