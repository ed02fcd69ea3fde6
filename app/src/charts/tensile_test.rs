//! Chart of a fitted material: the records of its specimens at small strains and in full, and the
//! hardening curve.

use super::{
    axes::{Axis, Look, Series, chart, series},
    *,
};
use support::Extremes;
use tensile::{HardeningRow, MaterialFit, Origin, Specimen};

/// Maximum number of points of a drawn curve; a record may have a hundred thousand.
const POINTS: usize = 1500;
/// Size of one panel (px).
const PANEL: (u32, u32) = (500, 440);
/// Half the size of the cross of a dropped row (px).
const CROSS: i32 = 3;

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
    let mut all = record_series(&fit.specimens, [start, end]);
    for offset in [0.0, 0.2] {
        let at = |stress: f64| (offset + 100.0 * stress / young, stress);
        all.push(guide([at(0.0), at(0.97 * top)]));
    }
    let at_yield = 100.0 * yields / young + 0.2;
    let label_x = at_yield + 0.03 * (end - start);
    all.extend([
        mark((at_yield, yields)),
        text(format!("E = {young:.0} MPa"), (label_x, 0.5 * yields)),
        text(format!("Rp0.2 = {yields:.1} MPa"), (label_x, 0.4 * yields)),
    ]);
    let names = SeriesLabelPosition::LowerRight;
    chart(area, "Modulus and offset yield", (strain, stress), all, names)
}

/// The whole records, with upper yield, plateau and natural draw ratio.
fn records(area: &Area, fit: &MaterialFit, name: &str) -> ChartResult {
    let rows = || fit.specimens.iter().flat_map(|specimen| &specimen.nominal);
    let end = 100.0 * rows().map(|row| row[0]).largest();
    let top = 1.25 * rows().map(|row| row[1]).largest();
    let strain = Axis::new(-0.02 * end..1.03 * end, "strain, %");
    let axes = (strain, Axis::new(0.0..top, "stress, MPa"));
    let mut all = record_series(&fit.specimens, [-end, end]);
    if let (Some(upper), Some(plateau), Some(ratio)) =
        (fit.upper_yield, fit.plateau, fit.draw_ratio)
    {
        let (stress, natural) = (plateau.mean, 100.0 * (ratio.mean - 1.0));
        all.push(guide([(0.0, stress), (natural, stress)]));
        all.push(guide([(natural, 0.0), (natural, 1.06 * stress)]));
        let draws = fit.specimens.iter().filter_map(|specimen| specimen.draw);
        all.extend(draws.map(|draw| mark((100.0 * draw.upper_yield_strain, draw.upper_yield))));
        // The text takes a third of the width.
        let label_x =
            if natural + 0.36 * end < end { natural + 0.02 * end } else { natural - 0.36 * end };
        all.extend([
            text(format!("upper yield {:.1} MPa", upper.mean), (0.04 * end, 1.06 * upper.mean)),
            text(format!("draw plateau {stress:.1} MPa"), (0.15 * end, 1.13 * stress)),
            text(format!("natural draw ratio {:.2}", ratio.mean), (label_x, 0.5 * stress)),
        ]);
    }
    chart(area, name, axes, all, SeriesLabelPosition::UpperRight)
}

/// The hardening curve by its origin, the rows of the table, and the fracture strain.
fn hardening(area: &Area, fit: &MaterialFit) -> ChartResult {
    let end = 1.05 * fit.fracture_strain.max(fit.curve[fit.curve.len() - 1].strain);
    let top = 1.25 * fit.curve.iter().map(|row| row.stress).largest();
    let strain = Axis::new(-0.02 * end..1.02 * end, "true plastic strain");
    let stress = Axis::new(0.0..top, "true stress, MPa");
    let mut all = Vec::new();
    for (origin, name, colour) in [
        (Origin::Measured, "measured", POINT),
        (Origin::Drawn, "neck: equal work", VALIDATION),
        (Origin::Extrapolated, "Considere's tangent", COLOURS[2]),
    ] {
        for part in parts(&fit.curve, origin) {
            let points = part.iter().map(|row| (row.strain, row.stress));
            all.push(series(name, points, Look::Line, colour.stroke_width(2)));
        }
    }
    let (rows, strains) = (fit.table.len(), [fit.fracture_strain; 2]);
    let table = fit.table.iter().map(|row| (row.strain, row.stress));
    all.push(series(format!("table, {rows} rows"), table, Look::Circles(3), BLACK));
    let fracture = std::iter::zip(strains, [0.0, 0.8 * top]);
    let name = format!("fracture strain {:.3}", fit.fracture_strain);
    all.push(series(name, fracture, Look::Dashed, COLOURS[4].stroke_width(1)));
    let axes = (strain, stress);
    chart(area, "Hardening table", axes, all, SeriesLabelPosition::UpperLeft)
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
fn record_series(specimens: &[Specimen], [from, to]: [f64; 2]) -> Vec<Series> {
    let mut all = Vec::new();
    let within = move |strain: f64| (from..=to).contains(&(100.0 * strain));
    let name = if specimens.len() == 1 { "record" } else { "records" };
    for specimen in specimens {
        let seen: Vec<_> = specimen.nominal.iter().filter(|row| within(row[0])).collect();
        let step = seen.len().div_ceil(POINTS).max(1);
        let points = seen.iter().step_by(step).chain(seen.last());
        let points = points.map(|row| (100.0 * row[0], row[1]));
        all.push(series(name, points, Look::Line, POINT.mix(0.8).stroke_width(1)));
    }
    let dropped = specimens.iter().flat_map(|specimen| &specimen.dropped);
    let dropped: Vec<_> = dropped.filter(|row| within(row.strain) && row.stress >= 0.0).collect();
    if !dropped.is_empty() {
        let step = dropped.len().div_ceil(POINTS / 5).max(1);
        let crosses = dropped.iter().step_by(step).map(|row| (100.0 * row.strain, row.stress));
        let style = VALIDATION.stroke_width(1);
        all.push(series("rows not used", crosses, Look::Crosses(CROSS), style));
    }
    all
}

fn guide(ends: [(f64, f64); 2]) -> Series {
    series("", ends, Look::Dashed, GUIDE.stroke_width(1))
}

fn mark(at: (f64, f64)) -> Series {
    series("", [at], Look::Circles(4), BLACK.stroke_width(1))
}

fn text(text: String, at: (f64, f64)) -> Series {
    series(text, [at], Look::Text(12), BLACK)
}
