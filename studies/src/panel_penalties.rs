//! Penalties that make panels with free corners tile the sheet. They are dimensionless, for corners relative
//! to the sheet's side, and vanish if the panels do not overlap and if they cover the sheet.

use design::geometry::plane::{I, add, complex, cross};
use faer::c64;

/// The corners of every panel.
pub(crate) type Corners = [[[f64; 2]; 4]];

/// The sum over all pairs of panels of the squared depth of their overlap, and its gradient.
///
/// Convex panels are disjoint if one edge of one has all of the other on its outer side; the depth is
/// the distance that the best edge lacks.
pub(crate) fn overlap(panels: &Corners) -> (f64, Vec<[[f64; 2]; 4]>) {
    let (mut value, mut gradient) = (0.0, vec![[[0.0; 2]; 4]; panels.len()]);
    for i in 0..panels.len() {
        for j in 0..i {
            let separations = [(i, j), (j, i)].into_iter().flat_map(|(one, other)| {
                (0..4).map(move |edge| {
                    let heights = panels[other].map(|corner| outside(&panels[one], edge, corner));
                    let corner = index_of_min(&heights);
                    (heights[corner], one, edge, other, corner)
                })
            });
            let best = separations.max_by(|x, y| x.0.total_cmp(&y.0));
            let Some((separation, one, edge, other, corner)) = best else {
                continue;
            };
            if separation < 0.0 {
                value += separation * separation;
                let [by_corner, by_start, by_end] =
                    outside_gradient(&panels[one], edge, panels[other][corner]);
                let weight = 2.0 * separation;
                add(&mut gradient[other][corner], by_corner * weight);
                add(&mut gradient[one][edge], by_start * weight);
                add(&mut gradient[one][(edge + 1) % 4], by_end * weight);
            }
        }
    }
    (value, gradient)
}

/// The mean over `samples` of the square of the uncovered fraction at each, and its gradient.
///
/// The cover of a point by a panel is the product over its edges of sigma(depth/softness), so that panels
/// with a common edge cover it together exactly once. The whole sheet, with the same outline, has the same soft cover
/// near its border.
pub(crate) fn void(
    panels: &Corners,
    outline: &[[f64; 2]; 4],
    samples: &[[f64; 2]],
    softness: f64,
) -> (f64, Vec<[[f64; 2]; 4]>) {
    let within = |panel: &[[f64; 2]; 4], sample: [f64; 2]| -> [f64; 4] {
        std::array::from_fn(|edge| 1.0 / (1.0 + (outside(panel, edge, sample) / softness).exp()))
    };
    let weight_of_sample = 1.0 / samples.len() as f64;
    let (mut value, mut gradient) = (0.0, vec![[[0.0; 2]; 4]; panels.len()]);
    for &sample in samples {
        let covers: Vec<_> = (panels.iter().enumerate())
            .filter_map(|(k, panel)| {
                let edges = within(panel, sample);
                let cover: f64 = edges.iter().product();
                (cover > 1e-12).then_some((k, edges, cover))
            })
            .collect();
        let whole: f64 = within(outline, sample).iter().product();
        let lack = whole - covers.iter().map(|(_, _, cover)| cover).sum::<f64>();
        if lack <= 0.0 {
            continue;
        }
        value += weight_of_sample * lack * lack;
        for (k, edges, cover) in covers {
            for edge in 0..4 {
                let weight = 2.0 * weight_of_sample * lack * cover * (1.0 - edges[edge]) / softness;
                let [_, by_start, by_end] = outside_gradient(&panels[k], edge, sample);
                add(&mut gradient[k][edge], by_start * weight);
                add(&mut gradient[k][(edge + 1) % 4], by_end * weight);
            }
        }
    }
    (value, gradient)
}

/// Distance of a point outside an edge of a counter-clockwise panel; negative inside.
fn outside(panel: &[[f64; 2]; 4], edge: usize, point: [f64; 2]) -> f64 {
    let (start, end) = (complex(panel[edge]), complex(panel[(edge + 1) % 4]));
    cross(complex(point) - start, end - start) / (end - start).norm().max(f64::MIN_POSITIVE)
}

/// The gradient of [`outside`] in the point and in the start and the end of the edge.
fn outside_gradient(panel: &[[f64; 2]; 4], edge: usize, point: [f64; 2]) -> [c64; 3] {
    let (start, end) = (complex(panel[edge]), complex(panel[(edge + 1) % 4]));
    let (along, arm) = (end - start, complex(point) - start);
    let length = along.norm().max(f64::MIN_POSITIVE);
    let by_arm = -I * along / length;
    let by_along = I * arm / length - along * (cross(arm, along) / length.powi(3));
    [by_arm, -by_arm - by_along, by_along]
}

fn index_of_min(values: &[f64; 4]) -> usize {
    let smaller = |i: usize, j: usize| if values[j] < values[i] { j } else { i };
    (1..4).fold(0, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;
    use design::analysis::taylor::central_slope;

    const PANELS: [[[f64; 2]; 4]; 2] = [
        [[0.0, 0.0], [1.0, 0.1], [1.1, 1.0], [0.1, 0.9]],
        [[0.85, 0.25], [2.0, 0.1], [1.9, 1.2], [1.0, 1.1]],
    ];
    const SAMPLES: [[f64; 2]; 3] = [[0.1, 0.2], [1.5, 1.1], [2.0, 0.6]];

    fn panels(x: &[f64]) -> Vec<[[f64; 2]; 4]> {
        let panel = |x: &[f64]| std::array::from_fn(|j| [x[2 * j], x[2 * j + 1]]);
        x.chunks(8).map(panel).collect()
    }

    #[test]
    fn gradients_agree_with_differences() {
        let x = PANELS.as_flattened().as_flattened();
        let outline = [[0.0, 0.0], [2.5, 0.0], [2.5, 1.5], [0.0, 1.5]];
        let void = |panels: &Corners| void(panels, &outline, &SAMPLES, 0.05);
        let penalties: [&dyn Fn(&Corners) -> _; 2] = [&overlap, &void];
        for penalty in penalties {
            let (value, gradient) = penalty(&PANELS);
            assert!(value > 0.0);
            for (i, found) in gradient.as_flattened().as_flattened().iter().enumerate() {
                let unit: Vec<f64> = (0..x.len()).map(|j| f64::from(i == j)).collect();
                let slope = central_slope(|x| penalty(&panels(x)).0, x, &unit, 1e-6);
                assert!((found - slope).abs() < 1e-7, "{i}: {found} {slope}");
            }
        }
    }

    #[test]
    fn a_tiling_neither_overlaps_nor_leaves_a_void() {
        let square = |x: f64| [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
        // The last samples are half a softness from the border.
        let samples = [
            [0.5, 0.5],
            [1.0, 0.4],
            [1.02, 0.6],
            [1.995, 0.5],
            [0.5, 0.005],
        ];
        let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let void = |panels: &Corners| void(panels, &outline, &samples, 0.01).0;
        let tiled = [square(0.0), square(1.0)];
        assert_eq!(overlap(&tiled).0, 0.0);
        assert!(void(&tiled) < 1e-20);
        assert!((overlap(&[square(0.0), square(0.9)]).0 - 0.01).abs() < 1e-12);
        assert!(void(&[square(0.0), square(1.2)]) > 0.2);
    }
}
