//! Chart of the energy against the rotation: curves of the surrogate, points of the finite elements.

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
    let all = || {
        slices
            .iter()
            .flat_map(|it| it.curve.iter().chain(&it.points))
    };
    let mut chart = ChartBuilder::on(area)
        .caption("Energy against rotation", (FONT, 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(padded(all().map(|p| p.0)), padded(all().map(|p| p.1)))?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("theta (deg)")
        .y_desc("W (N mm); points: finite elements")
        .draw()?;
    for (slice, &colour) in slices.iter().zip(SLICES.iter().cycle()) {
        chart
            .draw_series(LineSeries::new(
                slice.curve.iter().copied(),
                colour.stroke_width(2),
            ))?
            .label(&slice.title)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        let marks = slice
            .points
            .iter()
            .map(|&p| Circle::new(p, 3, colour.filled()));
        chart.draw_series(marks)?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .label_font((FONT, 13))
        .border_style(GUIDE)
        .background_style(WHITE)
        .draw()?;
    Ok(())
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
