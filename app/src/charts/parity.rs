//! Parity charts: predicted against computed values.

use super::{
    axes::{Axis, Look, chart, series},
    *,
};
use dataset::ComparedState;

/// Number of charts side by side.
const COLUMNS: usize = 3;

/// Charts, one for each quantity of [`dataset::COMPARED`] that is known, with its title and the line
/// of perfect agreement; `axes` names the reference and the evaluated values.
pub fn parity(states: &[ComparedState], titles: [&str; 6], axes: [&str; 2]) -> Result<String> {
    let points = |i: usize| -> Vec<(f64, f64)> {
        let known = states.iter().filter(|state| state.is_known(i));
        known.map(|state| (state.reference[i], state.value[i])).collect()
    };
    let charts = titles.into_iter().enumerate();
    let charts = charts.map(|(i, title)| (title, points(i)));
    let charts: Vec<_> = charts.filter(|(_, points)| !points.is_empty()).collect();
    let [columns, rows] = [charts.len().min(COLUMNS), charts.len().div_ceil(COLUMNS)];
    drawn((360 * columns as u32, 380 * rows as u32), |root| {
        let areas = root.split_evenly((rows, columns));
        for (area, (title, points)) in areas.iter().zip(charts) {
            let range = padded(points.iter().flat_map(|&(target, value)| [target, value]));
            let diagonal = [range.start, range.end].map(|v| (v, v));
            let [across, up] = axes.map(|name| Axis::new(range.clone(), name));
            let all = vec![
                series("", diagonal, Look::Line, GUIDE),
                series("", points, Look::Circles(2), POINT.mix(0.5).filled()),
            ];
            chart(area, title, (across, up), all, SeriesLabelPosition::UpperRight)?;
        }
        Ok(())
    })
}
