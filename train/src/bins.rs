//! Errors by bins: the accuracy of a surrogate over the training domain.

use crate::validation::Parity;
use dataset::Row;
use hinge::TrainingDomain;
use surrogate::{BinQuantity, ErrorBin};

/// Number of bins of each quantity, all of the same width.
const BINS: usize = 5;

/// Errors on `rows`, whose targets and predictions are `parity`, by compression, shear, rotation,
/// ligament width, cut angle, hole if it is a feature, and distance from the edge of the domain.
/// Bins without rows are omitted.
pub(crate) fn error_bins(parity: &Parity, rows: &[Row], domain: &TrainingDomain) -> Vec<ErrorBin> {
    let degrees = |range: [f64; 2]| range.map(f64::to_degrees);
    let [eta_a, eta_s, theta] = domain.bounds();
    let quantities = [
        (BinQuantity::EtaA, eta_a),
        (BinQuantity::EtaS, eta_s),
        (BinQuantity::ThetaDeg, degrees(theta)),
        (BinQuantity::WLig, domain.w_lig),
        (BinQuantity::AlphaDeg, degrees(domain.alpha)),
        (BinQuantity::Edge, [0.0, 1.0]),
    ];
    let hole = domain.holes.map(|range| (BinQuantity::FilletRatio, range));
    let mut bins = Vec::new();
    for (quantity, [minimum, maximum]) in quantities.into_iter().chain(hole) {
        let value = |Row { design, sample, .. }: &Row| match quantity {
            BinQuantity::EtaA => domain.coordinates(design, &sample.deformation())[0],
            BinQuantity::EtaS => domain.coordinates(design, &sample.deformation())[1],
            BinQuantity::ThetaDeg => sample.theta.to_degrees(),
            BinQuantity::WLig => design.w_lig,
            BinQuantity::AlphaDeg => design.alpha.to_degrees(),
            BinQuantity::FilletRatio => design.fillet_ratio,
            BinQuantity::Edge => domain.depth(design, &sample.deformation()).max(0.0),
        };
        let width = (maximum - minimum) / BINS as f64;
        for bin in 0..BINS {
            let lower = minimum + bin as f64 * width;
            let inside = |row: &Row| bin_of(value(row), minimum, width) == bin;
            let indices: Vec<usize> = (0..rows.len()).filter(|&i| inside(&rows[i])).collect();
            if !indices.is_empty() {
                bins.push(ErrorBin {
                    quantity,
                    range: [lower, lower + width],
                    errors: parity.of_rows(&indices).errors(),
                });
            }
        }
    }
    bins
}

/// The bin of a value; values beyond the range belong to the first or last bin.
fn bin_of(value: f64, minimum: f64, width: f64) -> usize {
    (((value - minimum) / width).max(0.0) as usize).min(BINS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dataset::ComparedState;
    use hinge::{HingeConstants, HingeSample};

    fn row(w_lig: f64, theta: f64) -> Row {
        let constants = HingeConstants::PAPER;
        Row {
            job: String::new(),
            design: constants.hinge(w_lig, 1.5),
            sample: HingeSample { theta, ..HingeSample::default() },
            ..Row::default()
        }
    }

    #[test]
    fn every_row_is_in_exactly_one_bin_of_each_quantity() {
        let rows = [row(5.0, 0.1), row(12.0, 0.5), row(25.0, 1.0)];
        let state_of = |error: f64| ComparedState { value: [1.0 + error; 6], reference: [1.0; 6] };
        let parity = Parity { states: [0.1, 0.2, 0.4].map(state_of).to_vec() };
        let state = [[-1.0, 1.0], [-1.0, 1.0], [0.0, 1.0]];
        let mut domain = TrainingDomain::from_box(state, [5.0, 25.0], [1.0, 2.0]);
        domain.holes = Some([0.1, 0.3]);
        let bins = error_bins(&parity, &rows, &domain);
        for quantity in
            ["eta_a", "eta_s", "theta_deg", "w_lig", "alpha_deg", "fillet_ratio", "edge"]
        {
            let of = bins.iter().filter(|bin| bin.quantity.to_string() == quantity);
            assert_eq!(of.map(|bin| bin.errors.rows).sum::<usize>(), 3, "{quantity}");
        }
        let widest = bins.iter().rfind(|bin| bin.quantity == BinQuantity::WLig).unwrap();
        assert_eq!(widest.range, [21.0, 25.0]);
        assert!((widest.errors.energy.relative_rmse - 0.4).abs() < 1e-12);
    }
}
