//! Contour lines of values on a grid.

/// Values on a grid of a plane.
pub struct PlaneValues {
    /// Coordinates along both axes.
    pub axes: [Vec<f64>; 2],
    /// One row for every coordinate of the second axis; NaN where there is no value.
    pub values: Vec<Vec<f64>>,
}

/// The segments of the contour at `level`, by triangles: every cell of the grid is two. Triangles with a value that is
/// not finite have none.
pub fn contours(plane: &PlaneValues, level: f64) -> Vec<[[f64; 2]; 2]> {
    let PlaneValues { axes, values } = plane;
    let [columns, rows] = [0, 1].map(|axis| axes[axis].len() - 1);
    let corner = |i: usize, j: usize| ([axes[0][i], axes[1][j]], values[j][i] - level);
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let diagonal = [corner(i, j), corner(i + 1, j + 1)];
        [corner(i + 1, j), corner(i, j + 1)].map(|third| [diagonal[0], diagonal[1], third])
    });
    triangles.filter_map(segment).collect()
}

/// The zero line of a linear function on a triangle given by its corners and its values there.
fn segment(triangle: [([f64; 2], f64); 3]) -> Option<[[f64; 2]; 2]> {
    if triangle.iter().any(|(_, value)| !value.is_finite()) {
        return None;
    }
    let crossings = (0..3).filter_map(|k| {
        let ((p, at_p), (q, at_q)) = (triangle[k], triangle[(k + 1) % 3]);
        ((at_p < 0.0) != (at_q < 0.0)).then(|| {
            let part = at_p / (at_p - at_q);
            [0, 1].map(|axis| p[axis] + part * (q[axis] - p[axis]))
        })
    });
    crossings.collect::<Vec<_>>().try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contour_of_a_linear_function_is_straight() {
        let axis: Vec<f64> = (0..5).map(f64::from).collect();
        let value = |y: &f64| axis.iter().map(|x| x + y).collect();
        let values: Vec<Vec<f64>> = axis.iter().map(value).collect();
        let axes = [axis.clone(), axis];
        let lines = contours(&PlaneValues { axes, values }, 2.5);
        let length: f64 = (lines.iter())
            .map(|[p, q]| f64::hypot(p[0] - q[0], p[1] - q[1]))
            .sum();
        assert!((length - 2.5 * 2f64.sqrt()).abs() < 1e-12, "{length}");
        assert!(
            lines
                .as_flattened()
                .iter()
                .all(|[x, y]| (x + y - 2.5).abs() < 1e-12)
        );
    }
}
