//! The local curve [true stress, plastic strain] of rows at which the strain is uniform:
//! sigma = s (1 + e), eps_p = ln(1 + e) - sigma / E.

use crate::isotonic::{non_decreasing, pools};
use crate::landmarks::{Draw, yield_stress};
use crate::regression::mean;

/// Plastic strain above which no yield can be read from a curve: its noise is too large.
const MAX_ONSET: f64 = 5e-3;

/// A row [nominal strain, nominal stress] as [logarithmic strain, true stress].
pub(super) fn true_row(&[strain, stress]: &[f64; 2]) -> [f64; 2] {
    [strain.ln_1p(), stress * (1.0 + strain)]
}

/// [true stress, plastic strain] of a nominal row.
fn local(row: &[f64; 2], young: f64) -> [f64; 2] {
    let [strain, stress] = true_row(row);
    [stress, strain - stress / young]
}

/// The local curve from the end of the elastic part on: its stress at the plastic strain `onset`
/// becomes the stress at zero plastic strain. A film may reach its upper yield before: its curve is
/// then one row.
pub(super) fn first_part(
    curve: &[[f64; 2]],
    young: f64,
    onset: f64,
    draws: bool,
) -> Option<Vec<[f64; 2]>> {
    let rows: Vec<[f64; 2]> = curve.iter().map(|row| local(row, young)).collect();
    let after = rows.iter().rposition(|row| row[1] <= onset)? + 1;
    let yields = if after < rows.len() {
        yield_stress(&rows, after, onset, Some(0.0))
    } else {
        draws.then(|| rows[after - 1][0])?
    };
    let mut part = vec![[yields, 0.0]];
    part.extend(&rows[after..]);
    (onset < MAX_ONSET && yields > 0.0).then(|| monotone(&part))
}

/// The local curve from the natural draw ratio on.
pub(super) fn second_part(curve: &[[f64; 2]], draw: &Draw, young: f64) -> Vec<[f64; 2]> {
    let drawn = curve.partition_point(|row| 1.0 + row[0] <= draw.draw_ratio);
    let mut part = vec![local(&[draw.draw_ratio - 1.0, draw.plateau], young)];
    part.extend(curve[drawn..].iter().map(|row| local(row, young)));
    monotone(&part)
}

/// The curve [stress, plastic strain] with increasing strain and non-decreasing stress. The first
/// row is unchanged.
fn monotone(curve: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [first, start] = curve[0];
    let pools = pools(curve[1..].iter().map(|row| row[1].max(start)), true).into_iter();
    let mut rows = vec![curve[0]];
    rows.extend(pools.map(|pool| mean(&curve[1..][pool])).filter(|row| row[1] > start));
    let stresses: Vec<f64> = rows.iter().map(|row| row[0].max(first)).collect();
    let stresses = non_decreasing(&stresses).into_iter();
    stresses.zip(rows).map(|(stress, row)| [stress, row[1]]).collect()
}
