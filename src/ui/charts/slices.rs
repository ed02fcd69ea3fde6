//! Chart of the energy against the rotation: curves of the surrogate, points of the finite elements.

use super::axes::{Axis, axes, line, marks, names};
use super::*;

/// W against the rotation at one hinge design: the surrogate's curve and the finite-element points.
pub struct Slice {
    /// Title of the curve.
    pub title: String,
    /// (theta in degrees, W in N mm)
    pub curve: Vec<(f64, f64)>,
    /// Finite-element points (theta in degrees, W in N mm).
    pub points: Vec<(f64, f64)>,
}

/// Curves of the surrogate with the finite-element points.
pub fn slices(slices: &[Slice]) -> Result<String> {
    drawn((720, 480), |root| slice_chart(root, slices))
}

fn slice_chart(area: &Area, slices: &[Slice]) -> ChartResult {
    let all = || (slices.iter()).flat_map(|slice| slice.curve.iter().chain(&slice.points));
    let theta = Axis::new(padded(all().map(|point| point.0)), "theta (deg)");
    let energies = padded(all().map(|point| point.1));
    let energy = Axis::new(energies, "W (N mm); points: finite elements");
    let mut chart = axes(area, "Energy against rotation", theta, energy)?;
    for (slice, &colour) in slices.iter().zip(SLICES.iter().cycle()) {
        let curve = slice.curve.iter().copied();
        line(&mut chart, &slice.title, curve, colour.stroke_width(2))?;
        marks(&mut chart, slice.points.iter().copied(), 3, colour)?;
    }
    names(&mut chart, SeriesLabelPosition::UpperLeft)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_show_every_computed_point() {
        let slice = |title: &str| Slice {
            title: title.into(),
            curve: vec![(0.0, 0.0), (30.0, 4.0)],
            points: vec![(10.0, 0.5), (20.0, 1.9), (30.0, 4.1)],
        };
        let svg = slices(&[slice("narrow"), slice("wide")]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("narrow") && svg.contains("wide"));
    }
}
