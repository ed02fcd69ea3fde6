//! Products of blocks, which are column-major slices, with matrices.
//!
//! faer has kernels for processors. In WebAssembly its tiles do not fit in the sixteen registers of vectors; tiles of 8 x 2 do, and are
//! computed at 1.8 times the rate.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// Rows of a tile.
const TILE: usize = 8;

/// Multiplies a block of `rows` rows by a matrix, into columns that begin `stride` apart.
pub(crate) fn product(
    block: &[f64],
    rows: usize,
    by: MatRef<'_, f64>,
    stride: usize,
    out: &mut [f64],
) {
    if cfg!(target_family = "wasm") && rows >= TILE {
        return product_in_tiles(block, rows, by, stride, out);
    }
    matmul(
        MatMut::from_column_major_slice_with_stride_mut(out, rows, by.ncols(), stride),
        Accum::Replace,
        MatRef::from_column_major_slice(block, rows, by.nrows()),
        by,
        1.0,
        Par::Seq,
    );
}

fn product_in_tiles(
    block: &[f64],
    rows: usize,
    by: MatRef<'_, f64>,
    stride: usize,
    out: &mut [f64],
) {
    let columns = by.ncols();
    for first in (0..columns - columns % 2).step_by(2) {
        columns_of_tiles::<2>(block, rows, by, first, &mut out[first * stride..], stride);
    }
    if columns % 2 == 1 {
        let first = columns - 1;
        columns_of_tiles::<1>(block, rows, by, first, &mut out[first * stride..], stride);
    }
}

/// Computes `COLUMNS` columns of the product, of which the first one has the index `first`.
fn columns_of_tiles<const COLUMNS: usize>(
    block: &[f64],
    rows: usize,
    by: MatRef<'_, f64>,
    first: usize,
    out: &mut [f64],
    stride: usize,
) {
    let weights: Vec<[f64; COLUMNS]> = (0..by.nrows())
        .map(|k| std::array::from_fn(|j| by[(k, first + j)]))
        .collect();
    for row in (0..rows).step_by(TILE) {
        // The last tile covers rows of the one before, too.
        let row = row.min(rows - TILE);
        let mut tile = [[0.0; TILE]; COLUMNS];
        for (column, weights) in block.chunks_exact(rows).zip(&weights) {
            // With a length that is known the tile stays in registers.
            let column: &[f64; TILE] = column[row..].first_chunk().expect("rows of a tile");
            for (sums, weight) in tile.iter_mut().zip(weights) {
                for (sum, value) in sums.iter_mut().zip(column) {
                    *sum += value * weight;
                }
            }
        }
        for (j, sums) in tile.iter().enumerate() {
            out[j * stride + row..][..TILE].copy_from_slice(sums);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

    #[test]
    fn tiles_give_the_product() {
        for (rows, inner, columns, stride) in [(8, 1, 1, 8), (17, 6, 5, 17), (28, 33, 8, 40)] {
            let block: Vec<f64> = (0..rows * inner).map(|i| (i as f64).sin()).collect();
            let by = Mat::from_fn(columns, inner, |i, j| {
                (1.3 * i as f64 - 0.7 * j as f64).cos()
            });
            let mut outs = [vec![0.0; stride * columns], vec![0.0; stride * columns]];
            let [expected, found] = &mut outs;
            product(&block, rows, by.transpose(), stride, expected);
            product_in_tiles(&block, rows, by.transpose(), stride, found);
            for (found, expected) in std::iter::zip(found, expected) {
                assert!((*found - *expected).abs() < 1e-13, "{found} {expected}");
            }
        }
    }
}
