//! Chart of errors against the standard deviation of an ensemble, which estimates them.

use anyhow::Result;
use kirigami::ui::charts::*;
use plotters::prelude::*;
use std::ops::Range;

/// Groups of states: root mean square deviation and error of each.
pub struct Calibration<'a> {
    pub title: &'a str,
    pub points: &'a [[f64; 2]],
}

/// Error against deviation in percent on logarithmic axes, one panel each; on the diagonal line they
/// are equal.
pub fn calibration(panels: &[Calibration]) -> Result<String> {
    drawn((480 * panels.len() as u32, 420), |root| {
        let all = panels.iter().flat_map(|panel| panel.points).flatten();
        let range = decades(all.map(|value| 100.0 * value).filter(|value| *value > 0.0));
        for (area, panel) in root.split_evenly((1, panels.len())).iter().zip(panels) {
            calibration_chart(area, panel, range.clone())?;
        }
        Ok(())
    })
}

fn calibration_chart(area: &Area, panel: &Calibration, range: Range<f64>) -> ChartResult {
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, (FONT, 15))
        .margin(10)
        .margin_right(26)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(range.clone().log_scale(), range.clone().log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("deviation of the networks' forces, %")
        .y_desc("error of their mean, %")
        .draw()?;
    let ends = [range.start, range.end].map(|end| (end, end));
    chart.draw_series(LineSeries::new(ends, GUIDE))?;
    let points = panel.points.iter().map(|point| point.map(|x| 100.0 * x));
    let points = points.map(|[x, y]| (x, y));
    let points: Vec<(f64, f64)> = points.filter(|(x, y)| *x > 0.0 && *y > 0.0).collect();
    chart.draw_series(LineSeries::new(points.iter().copied(), POINT))?;
    chart.draw_series(points.iter().map(|&p| Circle::new(p, 4, POINT.filled())))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_group_is_a_mark() {
        let panel = |points| Calibration { title: "", points };
        let svg = calibration(&[panel(&[[0.01, 0.02], [0.1, 0.3]]), panel(&[])]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 2);
    }
}
