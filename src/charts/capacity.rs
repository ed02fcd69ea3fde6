//! What sheets carry: opening and boundary error against the transverse load, and the load along its way.

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
    /// (way of the load in mm, rho) of the opened sheet, outwards and inwards.
    pub ways: [Vec<(f64, f64)>; 2],
}

const RHO: &str = "transverse load over the pull, rho";

/// Both loads at once, above: the least opening of a hinge beside the boundary error, dashed where a
/// pattern gives way. The pull first, below: rho along its way until a pattern gives way.
pub fn capacity(curves: &[CapacityCurve]) -> Result<String> {
    drawn((1100, 860), |root| {
        let areas = root.split_evenly((2, 2));
        let openings = |curve: &CapacityCurve| curve.openings.clone();
        let errors = |curve: &CapacityCurve| curve.errors.clone();
        let outwards = |curve: &CapacityCurve| curve.ways[0].clone();
        let inwards = |curve: &CapacityCurve| curve.ways[1].clone();
        panel(
            &areas[0],
            curves,
            &openings,
            [RHO, "least opening of a hinge, deg"],
        )?;
        panel(
            &areas[1],
            curves,
            &errors,
            [RHO, "boundary rms, % of the width"],
        )?;
        panel(
            &areas[2],
            curves,
            &outwards,
            ["way of the load outwards, mm", "rho, pulled first"],
        )?;
        panel(
            &areas[3],
            curves,
            &inwards,
            ["way of the load inwards, mm", "rho, pulled first"],
        )
    })
}

type Points<'a> = &'a dyn Fn(&CapacityCurve) -> Vec<(f64, f64)>;

fn panel(
    area: &Area,
    curves: &[CapacityCurve],
    points: Points,
    [abscissa, ordinate]: [&str; 2],
) -> DrawResult {
    let against_rho = abscissa == RHO;
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
        .x_desc(abscissa)
        .y_desc(ordinate)
        .draw()?;
    for (curve, &colour) in curves.iter().zip(SLICES.iter().cycle()) {
        let mut dots = points(curve);
        if !against_rho {
            dots.drain(..dots.len().saturating_sub(1));
        }
        chart.draw_series((dots.iter()).map(|&dot| Circle::new(dot, 3, colour.filled())))?;
        chart
            .draw_series(LineSeries::new(points(curve), colour.stroke_width(2)))?
            .label(curve.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        if let Some(limit) = curve.limit.filter(|_| against_rho) {
            let upright = [(limit, up.start), (limit, up.end)];
            let style = colour.mix(0.6).stroke_width(1);
            chart.draw_series(DashedLineSeries::new(upright, 4, 4, style))?;
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .label_font((FONT, 12))
        .border_style(GUIDE)
        .background_style(WHITE.mix(0.85))
        .draw()?;
    Ok(())
}
