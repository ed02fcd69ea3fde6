//! Parity charts: predicted against computed values.

use super::axes::{Axis, axes, marks};
use super::*;
use dataset::ComparedState;

/// Charts side by side, one for each quantity of [`dataset::COMPARED`] that is known, with its
/// title and the line of perfect agreement; `axes` names the reference and the evaluated values.
pub fn parity(states: &[ComparedState], titles: [&str; 6], axes: [&str; 2]) -> Result<String> {
    let points = |i: usize| -> Vec<(f64, f64)> {
        let known = states.iter().filter(|state| state.is_known(i));
        known.map(|state| (state.reference[i], state.value[i])).collect()
    };
    let charts = titles.into_iter().enumerate();
    let charts = charts.map(|(i, title)| (title, points(i)));
    let charts: Vec<_> = charts.filter(|(_, points)| !points.is_empty()).collect();
    let size = (360 * charts.len() as u32, 380);
    drawn(size, |root| {
        let areas = root.split_evenly((1, charts.len()));
        for (area, (title, points)) in areas.iter().zip(&charts) {
            parity_chart(area, title, points, axes)?;
        }
        Ok(())
    })
}

fn parity_chart(
    area: &Area,
    title: &str,
    points: &[(f64, f64)],
    [computed, predicted]: [&str; 2],
) -> ChartResult {
    let range = padded(points.iter().flat_map(|&(target, value)| [target, value]));
    let [across, up] = [computed, predicted].map(|name| Axis::new(range.clone(), name));
    let mut chart = axes(area, title, across, up)?;
    let diagonal = [range.start, range.end].map(|v| (v, v));
    chart.draw_series(LineSeries::new(diagonal, GUIDE))?;
    marks(&mut chart, points.iter().copied(), 2, POINT.mix(0.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parity_chart_holds_a_mark_for_every_row() {
        let states = [1.0, 2.0, 3.5, f64::NAN].map(|target| {
            let with_unknown = |value: f64| [value, f64::NAN, f64::NAN, f64::NAN, value, f64::NAN];
            ComparedState { value: with_unknown(1.1 * target), reference: with_unknown(target) }
        });
        let axes = ["finite elements", "surrogate"];
        let svg = parity(&states, dataset::COMPARED, axes).unwrap();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("D") && !svg.contains("D_peak"));
        assert!(svg.contains("finite elements"));
    }
}
