//! Charts of the errors of a surrogate against its number of training rays.

use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, line, marks};
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// Test errors of one network size against the number of training rays.
#[derive(Default)]
pub struct Curve {
    pub title: String,
    /// (rays, error of W in percent)
    pub energy: Vec<(f64, f64)>,
    /// (rays, error of the forces in percent)
    pub forces: Vec<(f64, f64)>,
}

/// Errors against rays on logarithmic axes: one chart for the energy, one for the forces, and the names beside them.
pub fn against_rays(curves: &[Curve]) -> Result<String> {
    drawn((1240, 420), |root| {
        let (root, names) = root.split_horizontally(1000);
        legend(&names, curves)?;
        type Points = fn(&Curve) -> &[(f64, f64)];
        let quantities: [(&str, Points); 2] = [
            ("energy W", |curve| &curve.energy),
            ("forces", |curve| &curve.forces),
        ];
        for (area, (title, points)) in root.split_evenly((1, 2)).iter().zip(quantities) {
            let lines: Vec<_> = curves.iter().map(points).collect();
            rays_chart(area, title, &lines)?;
        }
        Ok(())
    })
}

/// The colour of each curve, in their order.
fn colours() -> impl Iterator<Item = RGBColor> {
    SLICES.into_iter().cycle()
}

/// The names of the curves with their colours, one below the other.
fn legend(area: &Area, curves: &[Curve]) -> ChartResult {
    for ((curve, colour), row) in curves.iter().zip(colours()).zip(1..) {
        let y = 40 * row;
        area.draw(&PathElement::new([(8, y), (30, y)], colour.stroke_width(2)))?;
        area.draw(&Circle::new((19, y), 3, colour.filled()))?;
        area.draw(&Text::new(curve.title.clone(), (38, y - 7), (FONT, 13)))?;
    }
    Ok(())
}

fn rays_chart(area: &Area, title: &str, lines: &[&[(f64, f64)]]) -> ChartResult {
    let all = || lines.iter().copied().flatten();
    let margin = |values: Vec<f64>| {
        let min = values.iter().copied().fold(f64::INFINITY, f64::min);
        let max = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        (0.8 * min.min(max)..1.25 * max).log_scale()
    };
    let (rays, errors) = (all().map(|point| point.0), all().map(|point| point.1));
    let across = Axis {
        // Whole decades: an axis without a power of ten has no labels.
        range: decades(rays).log_scale(),
        name: "training rays",
        tick: round_number,
    };
    let up = Axis::new(margin(errors.collect()), "error on unseen geometries, %");
    let mut chart = axes(area, title, across, up)?;
    for (points, colour) in lines.iter().zip(colours()) {
        line(
            &mut chart,
            "",
            points.iter().copied(),
            colour.stroke_width(2),
        )?;
        marks(&mut chart, points.iter().copied(), 3, colour)?;
    }
    Ok(())
}

/// Labels of 1, 2 and 5 times a power of ten; other ticks, which are too close, have no label.
fn round_number(value: &f64) -> String {
    let digits = format!("{value:.0}");
    match digits.trim_end_matches('0') {
        "1" | "2" | "5" => digits,
        _ => String::new(),
    }
}
