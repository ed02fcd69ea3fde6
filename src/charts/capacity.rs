//! What sheets carry: opening and boundary error against the transverse load.

use super::*;

/// A pattern under rho times its pull.
pub struct CapacityCurve<'a> {
    pub name: &'a str,
    /// The greatest rho that is carried.
    pub limit: Option<f64>,
    /// (rho, least opening in degrees)
    pub openings: Vec<(f64, f64)>,
    /// (rho, boundary error in % of the target's width)
    pub errors: Vec<(f64, f64)>,
}

/// The least opening of a hinge beside the boundary error; dashed where a pattern gives way.
pub fn capacity(curves: &[CapacityCurve]) -> Result<String> {
    drawn((1100, 430), |root| {
        let areas = root.split_evenly((1, 2));
        let openings = |curve: &CapacityCurve| curve.openings.clone();
        let errors = |curve: &CapacityCurve| curve.errors.clone();
        panel(
            &areas[0],
            curves,
            &openings,
            "least opening of a hinge, deg",
            true,
        )?;
        panel(
            &areas[1],
            curves,
            &errors,
            "boundary rms, % of the width",
            false,
        )
    })
}

type Points<'a> = &'a dyn Fn(&CapacityCurve) -> Vec<(f64, f64)>;

fn panel(
    area: &Area,
    curves: &[CapacityCurve],
    points: Points,
    name: &str,
    legend: bool,
) -> DrawResult {
    let all: Vec<_> = curves.iter().flat_map(points).collect();
    let up = padded(all.iter().map(|point| point.1));
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(padded(all.iter().map(|point| point.0)), up.clone())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 13))
        .x_desc("transverse load over the pull, rho")
        .y_desc(name)
        .draw()?;
    for (curve, &colour) in curves.iter().zip(SLICES.iter().cycle()) {
        let dots = points(curve).into_iter();
        chart.draw_series(dots.map(|point| Circle::new(point, 2, colour.filled())))?;
        chart
            .draw_series(LineSeries::new(points(curve), colour.stroke_width(2)))?
            .label(curve.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        if let Some(limit) = curve.limit {
            let upright = [(limit, up.start), (limit, up.end)];
            let style = colour.mix(0.6).stroke_width(1);
            chart.draw_series(DashedLineSeries::new(upright, 4, 4, style))?;
        }
    }
    if legend {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::MiddleRight)
            .label_font((FONT, 12))
            .border_style(GUIDE)
            .background_style(WHITE.mix(0.85))
            .draw()?;
    }
    Ok(())
}
