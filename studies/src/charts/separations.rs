//! Charts of path dependence: differences against the separation of path and ray.

use super::log_log::log_log;
use crate::power_law::PowerLaw;
use anyhow::Result;
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// The data of one chart of path dependence.
pub struct SeparationChart<'a> {
    /// Pairs of solves along path and ray: (separation, relative difference).
    pub pairs: &'a [(f64, f64)],
    /// The power law fitted to the pairs, if there is one.
    pub fit: Option<PowerLaw>,
    /// Separations of all recorded paths, for the histogram in the background.
    pub all: &'a [f64],
    pub quantity: &'a str,
}

/// Difference against separation on logarithmic axes, one chart per quantity.
pub fn separations(charts: &[SeparationChart]) -> Result<String> {
    let columns = charts.len().min(2);
    let rows = charts.len().div_ceil(2);
    let size = (480 * columns as u32, 420 * rows as u32);
    drawn(size, |root| {
        for (area, chart) in root.split_evenly((rows, columns)).iter().zip(charts) {
            separation_chart(area, chart)?;
        }
        Ok(())
    })
}

fn separation_chart(area: &Area, chart: &SeparationChart) -> ChartResult {
    /// Smaller differences are drawn at this value.
    const MIN_DIFFERENCE: f64 = 1e-6;
    /// Number of bars of the histogram.
    const BARS: usize = 24;
    let marks: Vec<_> = (chart.pairs.iter())
        .map(|(x, y)| (x.max(MIN_DIFFERENCE), y.max(MIN_DIFFERENCE)))
        .collect();
    let across = decades(
        marks
            .iter()
            .map(|p| p.0)
            .chain(chart.all.iter().map(|x| x.max(MIN_DIFFERENCE))),
    );
    let up = decades(marks.iter().map(|p| p.1));
    let mut context = log_log(
        area,
        chart.quantity,
        (
            across.clone(),
            "separation of path and ray, ligament widths",
        ),
        (up.clone(), "relative difference at the end"),
    )?;
    let (width, height) = ((across.end / across.start).ln(), (up.end / up.start).ln());
    let mut counts = [0usize; BARS];
    for x in chart.all {
        let fraction = (x.max(MIN_DIFFERENCE) / across.start).ln() / width;
        counts[((fraction * BARS as f64) as usize).min(BARS - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(1).max(1) as f64;
    context.draw_series(counts.iter().enumerate().map(|(i, count)| {
        let edge = |i: usize| across.start * (width * i as f64 / BARS as f64).exp();
        let top = up.start * (0.6 * height * *count as f64 / most).exp();
        Rectangle::new(
            [(edge(i), up.start), (edge(i + 1), top)],
            GUIDE.mix(0.25).filled(),
        )
    }))?;
    if let Some(law) = chart.fit {
        // From where the law enters the chart to where it leaves it: points outside would be moved to its edge.
        let [one, other] = [up.start, up.end].map(|y| law.reaches(y));
        let ends = [
            across.start.max(one.min(other)),
            across.end.min(one.max(other)),
        ];
        let line = ends.map(|x| (x, law.at(x)));
        context.draw_series(LineSeries::new(line, VALIDATION))?;
    }
    context.draw_series(marks.iter().map(|p| Circle::new(*p, 4, POINT.filled())))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separations_of_any_size_are_drawn() {
        let pairs = [(0.0, 0.0), (1e-3, 1e-4), (0.2, 0.05)];
        let chart = SeparationChart {
            pairs: &pairs,
            fit: PowerLaw::fit([(0.1, 0.01), (0.2, 0.04), (0.3, 0.09)]),
            all: &[1e-9, 0.01, 0.02, 0.3],
            quantity: "W",
        };
        let svg = separations(&[chart]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 3);
        let empty = SeparationChart {
            pairs: &[],
            fit: None,
            all: &[],
            quantity: "D",
        };
        assert!(separations(&[empty]).is_ok());
    }
}
