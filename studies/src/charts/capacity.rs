//! Charts of the load capacity: opening and boundary error against the transverse load; load against stroke.

use anyhow::Result;
use kirigami::ui::charts::axes::{Axis, axes, line, marks, names};
use kirigami::ui::charts::*;
use plotters::prelude::*;

/// A pattern under a transverse load of rho times its pull.
pub struct CapacityCurve<'a> {
    pub name: &'a str,
    /// The ends of the interval of rho that is carried.
    pub limits: Vec<f64>,
    /// (rho, minimum opening in degrees)
    pub openings: Vec<(f64, f64)>,
    /// (rho, boundary error in % of the target's width)
    pub errors: Vec<(f64, f64)>,
    /// (stroke of the load in mm, rho) of the opened sheet, in the direction of the scene and the opposite one.
    pub ways: [Vec<(f64, f64)>; 2],
}

const RHO: &str = "transverse load / pull, rho";

/// Top: both loads together, the minimum opening of a hinge and the boundary error, with dashed lines where a
/// pattern fails. Bottom: after the pull, rho against the stroke until the first limit.
pub fn capacity(curves: &[CapacityCurve]) -> Result<String> {
    drawn((1100, 860), |root| {
        let areas = root.split_evenly((2, 2));
        let drawn = |swept| move |points| Drawn { points, swept };
        let (swept, led) = (drawn(true), drawn(false));
        let openings = swept(|curve| &curve.openings);
        panel(
            &areas[0],
            curves,
            openings,
            [RHO, "minimum opening of a hinge, deg"],
        )?;
        let errors = swept(|curve| &curve.errors);
        panel(
            &areas[1],
            curves,
            errors,
            [RHO, "boundary rms, % of the width"],
        )?;
        let along = led(|curve| &curve.ways[0]);
        panel(
            &areas[2],
            curves,
            along,
            ["stroke of the load, mm", "rho, after the pull"],
        )?;
        let against = led(|curve| &curve.ways[1]);
        panel(
            &areas[3],
            curves,
            against,
            ["stroke of the reversed load, mm", "rho, after the pull"],
        )
    })
}

/// The data of one panel.
#[derive(Clone, Copy)]
struct Drawn {
    points: for<'a> fn(&'a CapacityCurve<'_>) -> &'a Vec<(f64, f64)>,
    /// Whether every point is a separate deployment and the limit of rho is drawn; otherwise only the end is marked.
    swept: bool,
}

fn panel(
    area: &Area,
    curves: &[CapacityCurve],
    Drawn { points, swept }: Drawn,
    [abscissa, ordinate]: [&str; 2],
) -> ChartResult {
    let all: Vec<_> = curves.iter().flat_map(points).copied().collect();
    let up = padded(all.iter().map(|point| point.1));
    let across = padded(all.iter().map(|point| point.0));
    let (across, ordinate) = (Axis::new(across, abscissa), Axis::new(up.clone(), ordinate));
    let mut chart = axes(area, "", across, ordinate)?;
    for (curve, &colour) in curves.iter().zip(SLICES.iter().cycle()) {
        let points = points(curve);
        if swept {
            marks(&mut chart, points.iter().copied(), 2, colour)?;
        } else {
            marks(&mut chart, points.last().copied(), 3, colour)?;
        }
        line(
            &mut chart,
            curve.name,
            points.iter().copied(),
            colour.stroke_width(2),
        )?;
        for limit in curve.limits.iter().copied().filter(|_| swept) {
            let upright = [(limit, up.start), (limit, up.end)];
            let style = colour.mix(0.6).stroke_width(1);
            chart.draw_series(DashedLineSeries::new(upright, 4, 4, style))?;
        }
    }
    names(&mut chart, SeriesLabelPosition::LowerRight)
}
