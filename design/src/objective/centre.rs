//! The centroid of the area inside the deployed outline P, which is placed at the origin, and
//! likewise the centroid of the target,
//!
//! ```text
//! c = 1/(6 A) sum (p_i + p_i+1) (p_i x p_i+1),     A = 1/2 sum p_i x p_i+1
//! ```

use crate::geometry::{
    plane::{I, complex, cross, dot, point},
    polygon::mean,
};
use faer::c64;
use support::Point;

/// The centroid of the area inside an outline.
pub fn of(outline: &[Point]) -> Point {
    let middle = mean(outline);
    let (area, moment) = moments(outline, middle);
    point(complex(middle) + moment / (3.0 * area))
}

/// The gradient in the points of an outline from that in its points relative to its centre.
pub(crate) fn pullback(outline: &[Point], moved: &[Point]) -> Vec<Point> {
    let force: c64 = moved.iter().map(|slope| complex(*slope)).sum();
    let relative = std::iter::zip(moved, by_centroid(outline, force));
    relative.map(|(moved, by_centre)| point(complex(*moved) - by_centre)).collect()
}

/// 2 A and the sum of (p_i + p_i+1) (p_i x p_i+1), relative to a point.
fn moments(outline: &[Point], origin: Point) -> (f64, c64) {
    let (mut twice, mut moment) = (0.0, c64::ZERO);
    for [p, q] in relative_edges(outline, origin) {
        twice += cross(p, q);
        moment += (p + q) * cross(p, q);
    }
    (twice, moment)
}

/// The gradient of the product of the centroid with a vector.
fn by_centroid(outline: &[Point], vector: c64) -> Vec<c64> {
    let middle = mean(outline);
    let (twice, moment) = moments(outline, middle);
    let centroid = dot(vector, moment) / (3.0 * twice);
    let mut gradient = vec![c64::ZERO; outline.len()];
    for (i, [p, q]) in relative_edges(outline, middle).enumerate() {
        let along = vector * (cross(p, q) / (3.0 * twice));
        let by_cross = dot(vector, p + q) / (3.0 * twice) - centroid / twice;
        gradient[i] += along - I * q * by_cross;
        gradient[(i + 1) % outline.len()] += along + I * p * by_cross;
    }
    gradient
}

fn relative_edges(outline: &[Point], origin: Point) -> impl Iterator<Item = [c64; 2]> {
    let at = move |i: usize| complex(outline[i % outline.len()]) - complex(origin);
    (0..outline.len()).map(move |i| [at(i), at(i + 1)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::derivatives::assert_gradient;

    const L: [[f64; 2]; 6] =
        [[5.0, 7.0], [8.0, 7.0], [8.0, 8.0], [6.0, 8.0], [6.0, 10.0], [5.0, 10.0]];

    #[test]
    fn the_centroid_of_an_angle_is_that_of_its_two_legs() {
        let [x, y] = of(&L);
        // Legs of 3 x 1 at (1.5, 0.5) and of 1 x 2 at (0.5, 2) from the corner (5, 7).
        assert!((x - 5.0 - (3.0 * 1.5 + 2.0 * 0.5) / 5.0).abs() < 1e-14);
        assert!((y - 7.0 - (3.0 * 0.5 + 2.0 * 2.0) / 5.0).abs() < 1e-14);
    }

    #[test]
    fn the_gradient_agrees_with_differences() {
        // sum k (x_k + 2 y_k^2) of the points relative to the centre
        let value = |flat: &[f64]| -> f64 {
            let points = flat.as_chunks().0;
            let [x, y] = of(points);
            let relative = points.iter().map(|p| [p[0] - x, p[1] - y]);
            let terms = relative.zip(1..);
            terms.map(|([x, y], k)| f64::from(k) * (x + 2.0 * y * y)).sum()
        };
        let [_, y] = of(&L);
        let slopes =
            L.iter().zip(1..).map(|(p, k)| [1.0, 4.0 * (p[1] - y)].map(|s| f64::from(k) * s));
        let gradient = pullback(&L, &slopes.collect::<Vec<_>>());
        let found = gradient.as_flattened();
        assert_gradient(value, L.as_flattened(), found, 1e-5, |_| 1e-8);
    }
}
