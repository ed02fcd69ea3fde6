//! Charts of a training: predicted against computed values, learning curve, slices of the energy.

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use train::ParityPoint;

/// One chart of [`parity`].
pub struct ParityChart<'a> {
    pub title: String,
    pub points: &'a [ParityPoint],
}

const POINT: RGBColor = RGBColor(31, 110, 140);
const VALIDATION: RGBColor = RGBColor(217, 95, 2);
const SLICES: [RGBColor; 5] = [
    POINT,
    VALIDATION,
    RGBColor(117, 112, 179),
    RGBColor(102, 166, 30),
    RGBColor(166, 118, 29),
];
const GUIDE: RGBColor = RGBColor(120, 120, 120);
const FONT: &str = "DejaVu Sans";

/// Charts side by side, one a quantity, with the line of perfect agreement.
pub fn parity(charts: &[ParityChart]) -> Result<String> {
    let mut svg = String::new();
    {
        let size = (360 * charts.len() as u32, 380);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        for (area, chart) in root.split_evenly((1, charts.len())).iter().zip(charts) {
            parity_chart(area, chart).map_err(drawing)?;
        }
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawResult =
    Result<(), DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>>;

fn drawing(error: impl std::fmt::Display) -> anyhow::Error {
    anyhow!("cannot draw the chart: {error}")
}

fn parity_chart(area: &Area, ParityChart { title, points }: &ParityChart) -> DrawResult {
    let range = padded(points.iter().flat_map(|p| [p.target, p.predicted]));
    let mut chart = ChartBuilder::on(area)
        .caption(title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(range.clone(), range.clone())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_labels(5)
        .y_labels(5)
        .label_style((FONT, 12))
        .x_desc("finite elements")
        .y_desc("surrogate")
        .draw()?;
    let diagonal = [range.start, range.end].map(|v| (v, v));
    chart.draw_series(LineSeries::new(diagonal, GUIDE))?;
    let mark = |p: &ParityPoint| Circle::new((p.target, p.predicted), 2, POINT.mix(0.5).filled());
    chart.draw_series(points.iter().map(mark))?;
    Ok(())
}

/// Training and validation loss against the epoch, the loss on a logarithmic axis.
pub fn learning_curve(training: &[f64], validation: &[f64]) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (720, 420)).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        learning_chart(&root, training, validation).map_err(drawing)?;
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn learning_chart(area: &Area, training: &[f64], validation: &[f64]) -> DrawResult {
    let positive = || {
        training
            .iter()
            .chain(validation)
            .copied()
            .filter(|v| *v > 0.0)
    };
    let least = positive().fold(f64::INFINITY, f64::min);
    let greatest = positive().fold(0.0, f64::max);
    let epochs = 0..training.len().max(2) - 1;
    let mut chart = ChartBuilder::on(area)
        .caption("Learning curve", (FONT, 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .build_cartesian_2d(epochs, (0.8 * least..1.25 * greatest).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("epoch")
        .y_desc("loss (15)")
        .y_label_formatter(&|v| format!("{v:.0e}"))
        .draw()?;
    for (name, losses, colour) in [
        ("training", training, POINT),
        ("validation", validation, VALIDATION),
    ] {
        chart
            .draw_series(LineSeries::new(
                losses.iter().copied().enumerate(),
                colour.stroke_width(2),
            ))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font((FONT, 13))
        .border_style(GUIDE)
        .background_style(WHITE)
        .draw()?;
    Ok(())
}

/// W against the rotation at one hinge design: the surrogate's curve and computed points.
pub struct Slice {
    pub title: String,
    /// (theta in degrees, W in N mm)
    pub curve: Vec<(f64, f64)>,
    pub points: Vec<(f64, f64)>,
}

/// Curves of the surrogate with the points of the finite elements.
pub fn slices(slices: &[Slice]) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (720, 480)).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        slice_chart(&root, slices).map_err(drawing)?;
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn slice_chart(area: &Area, slices: &[Slice]) -> DrawResult {
    let all = || {
        slices
            .iter()
            .flat_map(|it| it.curve.iter().chain(&it.points))
    };
    let mut chart = ChartBuilder::on(area)
        .caption("Energy against rotation", (FONT, 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d(padded(all().map(|p| p.0)), padded(all().map(|p| p.1)))?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("theta (deg)")
        .y_desc("W (N mm); points: finite elements")
        .draw()?;
    for (slice, &colour) in slices.iter().zip(SLICES.iter().cycle()) {
        chart
            .draw_series(LineSeries::new(
                slice.curve.iter().copied(),
                colour.stroke_width(2),
            ))?
            .label(&slice.title)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        let marks = slice
            .points
            .iter()
            .map(|&p| Circle::new(p, 3, colour.filled()));
        chart.draw_series(marks)?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .label_font((FONT, 13))
        .border_style(GUIDE)
        .background_style(WHITE)
        .draw()?;
    Ok(())
}

/// Test errors of one network size against the number of training rays.
#[derive(Default)]
pub struct Curve {
    pub title: String,
    /// (rays, error of W in percent)
    pub energy: Vec<(f64, f64)>,
    /// (rays, error of the forces in percent)
    pub forces: Vec<(f64, f64)>,
}

/// Errors against rays, both on logarithmic axes: the energy's beside the forces'.
pub fn against_rays(curves: &[Curve]) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (1000, 420)).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        type Points = fn(&Curve) -> &[(f64, f64)];
        let quantities: [(&str, Points); 2] = [
            ("energy W", |curve| &curve.energy),
            ("forces", |curve| &curve.forces),
        ];
        for (area, (title, points)) in root.split_evenly((1, 2)).iter().zip(quantities) {
            let lines: Vec<_> = curves
                .iter()
                .map(|it| (it.title.as_str(), points(it)))
                .collect();
            rays_chart(area, title, &lines).map_err(drawing)?;
        }
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn rays_chart(area: &Area, title: &str, lines: &[(&str, &[(f64, f64)])]) -> DrawResult {
    let all = || lines.iter().flat_map(|(_, points)| *points);
    let margin = |values: Vec<f64>| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        (0.8 * least.min(greatest)..1.25 * greatest).log_scale()
    };
    let mut chart = ChartBuilder::on(area)
        .caption(title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(
            margin(all().map(|point| point.0).collect()),
            margin(all().map(|point| point.1).collect()),
        )?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("training rays")
        .y_desc("error on unseen geometries, %")
        .draw()?;
    for (&(name, points), &colour) in lines.iter().zip(SLICES.iter().cycle()) {
        chart
            .draw_series(LineSeries::new(
                points.iter().copied(),
                colour.stroke_width(2),
            ))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        chart.draw_series(
            points
                .iter()
                .map(|&point| Circle::new(point, 3, colour.filled())),
        )?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font((FONT, 13))
        .border_style(GUIDE)
        .background_style(WHITE)
        .draw()?;
    Ok(())
}

/// What a choice makes of a quantity: one line a hinge over the values of the choice.
#[derive(Default)]
pub struct StudyPanel {
    pub title: &'static str,
    pub values: Vec<String>,
    /// By hinge: (index of the value, difference in percent).
    pub lines: BTreeMap<String, Vec<(f64, f64)>>,
}

/// The panels of a study, three in a row.
pub fn studies(panels: &[StudyPanel]) -> Result<String> {
    let mut svg = String::new();
    {
        let rows = panels.len().div_ceil(3).max(1);
        let size = (1260, 340 * rows as u32);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        for (area, panel) in root.split_evenly((rows, 3)).iter().zip(panels) {
            study_chart(area, panel).map_err(drawing)?;
        }
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn study_chart(area: &Area, panel: &StudyPanel) -> DrawResult {
    let percents = panel.lines.values().flatten().map(|(_, percent)| *percent);
    let last = panel.values.len().max(2) as f64 - 1.0;
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(-0.2..last + 0.2, padded(percents))?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_labels(panel.values.len())
        .x_label_formatter(&|x| {
            let value = panel.values.get(x.round() as usize);
            value
                .filter(|_| x.fract() == 0.0)
                .cloned()
                .unwrap_or_default()
        })
        .label_style((FONT, 12))
        .y_desc("difference in W(45 deg), %")
        .draw()?;
    for (i, (hinge, line)) in panel.lines.iter().enumerate() {
        let colour = Palette99::pick(i).stroke_width(2);
        chart
            .draw_series(LineSeries::new(line.iter().copied(), colour))?
            .label(hinge)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour));
    }
    chart
        .configure_series_labels()
        .label_font((FONT, 10))
        .border_style(GUIDE)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    Ok(())
}

/// The range of the values with a margin of a twentieth at both ends.
fn padded(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (least, greatest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| {
        (l.min(v), g.max(v))
    });
    if least > greatest {
        return 0.0..1.0;
    }
    let margin = 0.05 * (greatest - least).max(1e-12);
    least - margin..greatest + margin
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parity_chart_holds_a_mark_for_every_row() {
        let points = [1.0, 2.0, 3.5].map(|target| ParityPoint {
            target,
            predicted: 1.1 * target,
        });
        let chart = |title: &str| ParityChart {
            title: title.into(),
            points: &points,
        };
        let svg = parity(&[chart("W"), chart("D")]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("finite elements"));
    }

    #[test]
    fn slices_show_every_computed_point() {
        let slice = |title: &str| Slice {
            title: title.into(),
            curve: vec![(0.0, 0.0), (30.0, 4.0)],
            points: vec![(10.0, 0.5), (20.0, 1.9), (30.0, 4.1)],
        };
        let svg = slices(&[slice("narrow"), slice("wide")]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("narrow") && svg.contains("wide"));
    }

    #[test]
    fn a_learning_curve_survives_a_single_epoch_and_zero_losses() {
        assert!(
            learning_curve(&[1.0], &[0.0])
                .unwrap()
                .contains("validation")
        );
    }
}
