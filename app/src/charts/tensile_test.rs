//! Chart of a fitted material: the records of its specimens at small strains and in full, and the
//! hardening curve.

use super::axes::{Axis, Chart, axes, line, names};
use super::*;
use plotters::coord::types::RangedCoordf64;
use tensile::{HardeningRow, MaterialFit, Origin, Specimen};

/// Maximum number of points of a drawn curve; a record may have a hundred thousand.
const POINTS: usize = 1500;
/// Size of one panel (px).
const PANEL: (u32, u32) = (500, 440);
/// Half the size of the cross of a dropped row (px).
const CROSS: i32 = 3;

/// A panel with a strain and a stress (MPa) as axes.
type StressChart<'a> = Chart<'a, RangedCoordf64, RangedCoordf64>;

/// Three panels: the linear part with modulus and offset yield, the whole records with the draw,
/// and the hardening table on the curve that it approximates.
pub fn tensile_test(fit: &MaterialFit, name: &str) -> Result<String> {
    drawn((3 * PANEL.0, PANEL.1), |root| {
        let areas = root.split_evenly((1, 3));
        small_strains(&areas[0], fit)?;
        records(&areas[1], fit, name)?;
        hardening(&areas[2], fit)
    })
}

/// Modulus and offset yield, up to three times the strain at yield.
fn small_strains(area: &Area, fit: &MaterialFit) -> ChartResult {
    let (young, yields) = (fit.young.mean, fit.offset_yield.mean);
    let end = 300.0 * (yields / young + 0.002);
    let toes = fit.specimens.iter().map(|specimen| -100.0 * specimen.toe);
    let start = toes.fold(0.0, f64::min).max(-0.5 * end);
    let seen = (fit.specimens.iter().flat_map(|specimen| &specimen.nominal))
        .filter(|row| 100.0 * row[0] < end);
    let top = 1.25 * seen.map(|row| row[1]).fold(yields, f64::max);
    let strain = Axis::new(start - 0.03 * end..end, "strain, %");
    let stress = Axis::new(0.0..top, "stress, MPa");
    let mut chart = axes(area, "Modulus and offset yield", strain, stress)?;
    draw_records(&mut chart, &fit.specimens, [start, end])?;
    for offset in [0.0, 0.2] {
        let at = |stress: f64| (offset + 100.0 * stress / young, stress);
        let line = DashedLineSeries::new([at(0.0), at(0.97 * top)], 6, 4, GUIDE.stroke_width(1));
        chart.draw_series(line)?;
    }
    let at_yield = (100.0 * yields / young + 0.2, yields);
    mark(&mut chart, at_yield)?;
    let right = 0.03 * (end - start);
    write_at(&mut chart, (at_yield.0 + right, 0.5 * yields), &format!("E = {young:.0} MPa"))?;
    write_at(&mut chart, (at_yield.0 + right, 0.4 * yields), &format!("Rp0.2 = {yields:.1} MPa"))?;
    names(&mut chart, SeriesLabelPosition::LowerRight)
}

/// The whole records, with upper yield, plateau and natural draw ratio.
fn records(area: &Area, fit: &MaterialFit, name: &str) -> ChartResult {
    let rows = || fit.specimens.iter().flat_map(|specimen| &specimen.nominal);
    let end = 100.0 * rows().map(|row| row[0]).fold(0.0, f64::max);
    let top = 1.25 * rows().map(|row| row[1]).fold(0.0, f64::max);
    let strain = Axis::new(-0.02 * end..1.03 * end, "strain, %");
    let stress = Axis::new(0.0..top, "stress, MPa");
    let mut chart = axes(area, name, strain, stress)?;
    draw_records(&mut chart, &fit.specimens, [-end, end])?;
    if let (Some(upper), Some(plateau), Some(ratio)) =
        (fit.upper_yield, fit.plateau, fit.draw_ratio)
    {
        let (stress, natural) = (plateau.mean, 100.0 * (ratio.mean - 1.0));
        for line in [[(0.0, stress), (natural, stress)], [(natural, 0.0), (natural, 1.06 * stress)]]
        {
            chart.draw_series(DashedLineSeries::new(line, 6, 4, GUIDE.stroke_width(1)))?;
        }
        for draw in fit.specimens.iter().filter_map(|specimen| specimen.draw) {
            let at_yield = (100.0 * draw.upper_yield_strain, draw.upper_yield);
            mark(&mut chart, at_yield)?;
        }
        let upper_text = format!("upper yield {:.1} MPa", upper.mean);
        write_at(&mut chart, (0.04 * end, 1.06 * upper.mean), &upper_text)?;
        write_at(
            &mut chart,
            (0.15 * end, 1.13 * stress),
            &format!("draw plateau {stress:.1} MPa"),
        )?;
        let ratio = format!("natural draw ratio {:.2}", ratio.mean);
        // The text takes a third of the width.
        let beside =
            if natural + 0.36 * end < end { natural + 0.02 * end } else { natural - 0.36 * end };
        write_at(&mut chart, (beside, 0.5 * stress), &ratio)?;
    }
    names(&mut chart, SeriesLabelPosition::UpperRight)
}

/// The hardening curve by its origin, the rows of the table, and the fracture strain.
fn hardening(area: &Area, fit: &MaterialFit) -> ChartResult {
    let end = 1.05 * fit.fracture_strain.max(fit.curve[fit.curve.len() - 1].strain);
    let top = 1.25 * fit.curve.iter().map(|row| row.stress).fold(0.0, f64::max);
    let strain = Axis::new(-0.02 * end..1.02 * end, "true plastic strain");
    let stress = Axis::new(0.0..top, "true stress, MPa");
    let mut chart = axes(area, "Hardening table", strain, stress)?;
    for (origin, name, colour) in [
        (Origin::Measured, "measured", POINT),
        (Origin::Drawn, "neck: equal work", VALIDATION),
        (Origin::Extrapolated, "Considere's tangent", COLOURS[2]),
    ] {
        for (index, part) in parts(&fit.curve, origin).into_iter().enumerate() {
            let points = part.iter().map(|row| (row.strain, row.stress));
            let style = colour.stroke_width(2);
            if index == 0 {
                line(&mut chart, name, points, style)?;
            } else {
                chart.draw_series(LineSeries::new(points, style))?;
            }
        }
    }
    let rows = fit.table.iter().map(|row| Circle::new((row.strain, row.stress), 3, BLACK));
    chart
        .draw_series(rows)?
        .label(format!("table, {} rows", fit.table.len()))
        .legend(|(x, y)| Circle::new((x + 9, y), 3, BLACK));
    let fracture = [(fit.fracture_strain, 0.0), (fit.fracture_strain, 0.8 * top)];
    let colour = COLOURS[4];
    chart
        .draw_series(DashedLineSeries::new(fracture, 6, 4, colour.stroke_width(1)))?
        .label(format!("fracture strain {:.3}", fit.fracture_strain))
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(1)));
    names(&mut chart, SeriesLabelPosition::UpperLeft)
}

/// The connected parts of a curve with one origin. A part begins at the last row of the part before
/// it.
fn parts(curve: &[HardeningRow], origin: Origin) -> Vec<&[HardeningRow]> {
    let mut start = 0;
    let mut parts = Vec::new();
    for part in curve.chunk_by(|a, b| a.origin == b.origin) {
        if part[0].origin == origin {
            parts.push(&curve[start.max(1) - 1..start + part.len()]);
        }
        start += part.len();
    }
    parts
}

/// The used rows of each specimen as a line and the dropped ones as crosses, between two strains
/// (%).
fn draw_records(
    chart: &mut StressChart,
    specimens: &[Specimen],
    [from, to]: [f64; 2],
) -> ChartResult {
    let within = move |strain: f64| (from..=to).contains(&(100.0 * strain));
    for (index, specimen) in specimens.iter().enumerate() {
        let seen: Vec<_> = specimen.nominal.iter().filter(|row| within(row[0])).collect();
        let step = seen.len().div_ceil(POINTS).max(1);
        let points = seen.iter().step_by(step).chain(seen.last());
        let points = points.map(|row| (100.0 * row[0], row[1]));
        let style = POINT.mix(0.8).stroke_width(1);
        if index == 0 {
            let name = if specimens.len() == 1 { "record" } else { "records" };
            line(chart, name, points, style)?;
        } else {
            chart.draw_series(LineSeries::new(points, style))?;
        }
    }
    let dropped = specimens.iter().flat_map(|specimen| &specimen.dropped);
    let dropped: Vec<_> = dropped.filter(|row| within(row.strain) && row.stress >= 0.0).collect();
    if dropped.is_empty() {
        return Ok(());
    }
    let step = dropped.len().div_ceil(POINTS / 5).max(1);
    let crosses = dropped.iter().step_by(step).map(|row| {
        let at = (100.0 * row.strain, row.stress);
        Cross::new(at, CROSS, VALIDATION.stroke_width(1))
    });
    chart
        .draw_series(crosses)?
        .label("rows not used")
        .legend(|(x, y)| Cross::new((x + 9, y), CROSS, VALIDATION.stroke_width(1)));
    Ok(())
}

fn mark(chart: &mut StressChart, at: (f64, f64)) -> ChartResult {
    chart.draw_series([Circle::new(at, 4, BLACK.stroke_width(1))])?;
    Ok(())
}

fn write_at(chart: &mut StressChart, at: (f64, f64), text: &str) -> ChartResult {
    chart.draw_series([Text::new(text.to_owned(), at, (FONT, 12).into_font())])?;
    Ok(())
}
