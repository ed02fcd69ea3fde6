//! Parity charts: predicted against computed values.

use super::*;
use train::ParityPoint;

/// One chart of [`parity`].
pub struct ParityChart<'a> {
    /// Title of the chart.
    pub title: String,
    /// The computed and predicted values.
    pub points: &'a [ParityPoint],
}

/// Charts side by side, one per quantity, with the line of perfect agreement; `axes` names the reference
/// and the evaluated values.
pub fn parity(charts: &[ParityChart], axes: [&str; 2]) -> Result<String> {
    let size = (360 * charts.len() as u32, 380);
    drawn(size, |root| {
        for (area, chart) in root.split_evenly((1, charts.len())).iter().zip(charts) {
            parity_chart(area, chart, axes)?;
        }
        Ok(())
    })
}

fn parity_chart(
    area: &Area,
    ParityChart { title, points }: &ParityChart,
    [computed, judged]: [&str; 2],
) -> ChartResult {
    // Quantities that the finite elements did not evaluate are NaN and get no mark.
    let known = || points.iter().filter(|p| !(p.target - p.predicted).is_nan());
    let range = padded(known().flat_map(|p| [p.target, p.predicted]));
    let mut chart = ChartBuilder::on(area)
        .caption(title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(range.clone(), range.clone())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_labels(5)
        .y_labels(5)
        .label_style((FONT, 12))
        .x_desc(computed)
        .y_desc(judged)
        .draw()?;
    let diagonal = [range.start, range.end].map(|v| (v, v));
    chart.draw_series(LineSeries::new(diagonal, GUIDE))?;
    let mark = |p: &ParityPoint| Circle::new((p.target, p.predicted), 2, POINT.mix(0.5).filled());
    chart.draw_series(known().map(mark))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parity_chart_holds_a_mark_for_every_row() {
        let points = [1.0, 2.0, 3.5, f64::NAN].map(|target| ParityPoint {
            target,
            predicted: 1.1 * target,
        });
        let chart = |title: &str| ParityChart {
            title: title.into(),
            points: &points,
        };
        let svg = parity(&[chart("W"), chart("D")], ["finite elements", "surrogate"]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("finite elements"));
    }
}
