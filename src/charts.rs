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

/// Charts side by side, one a quantity, with the line of perfect agreement; `axes` names what is
/// computed and what is judged by it.
pub fn parity(charts: &[ParityChart], axes: [&str; 2]) -> Result<String> {
    let mut svg = String::new();
    {
        let size = (360 * charts.len() as u32, 380);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        for (area, chart) in root.split_evenly((1, charts.len())).iter().zip(charts) {
            parity_chart(area, chart, axes).map_err(drawing)?;
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

fn parity_chart(
    area: &Area,
    ParityChart { title, points }: &ParityChart,
    [computed, judged]: [&str; 2],
) -> DrawResult {
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
        .x_desc(computed)
        .y_desc(judged)
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

/// One line of [`taylor`]: remainders over the loss against the step.
pub struct TaylorLine<'a> {
    pub name: &'a str,
    pub points: Vec<(f64, f64)>,
}

/// Taylor remainders on logarithmic axes, with the slopes 1 and 2 to compare.
pub fn taylor(lines: &[TaylorLine]) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (640, 480)).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        taylor_chart(&root, lines).map_err(drawing)?;
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn taylor_chart(area: &Area, lines: &[TaylorLine]) -> DrawResult {
    let points = || {
        lines
            .iter()
            .flat_map(|line| &line.points)
            .filter(|p| p.1 > 0.0)
    };
    let across = decades(points().map(|p| p.0));
    let up = decades(points().map(|p| p.1));
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(64)
        .build_cartesian_2d(across.clone().log_scale(), up.clone().log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .x_desc("step h")
        .y_desc("Taylor remainder over the loss")
        .draw()?;
    for (order, name) in [(1, "order 1"), (2, "order 2")] {
        // Through the upper right corner, as far as it is in sight.
        let at = |x: f64| up.end * (x / across.end).powi(order);
        let first = across.end * (up.start / up.end).powf(1.0 / f64::from(order));
        let ends = [first.max(across.start), across.end].map(|x| (x, at(x)));
        chart
            .draw_series(DashedLineSeries::new(
                ends,
                2 * order as u32,
                4,
                GUIDE.into(),
            ))?
            .label(name)
            .legend(|(x, y)| PathElement::new([(x, y), (x + 14, y)], GUIDE));
    }
    for (i, line) in lines.iter().enumerate() {
        let colour = SLICES[i % SLICES.len()];
        let marks = line.points.iter().filter(|p| p.1 > 0.0);
        chart
            .draw_series(LineSeries::new(marks.copied(), colour.stroke_width(2)))?
            .label(line.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .label_font((FONT, 12))
        .border_style(GUIDE)
        .background_style(WHITE.mix(0.8))
        .draw()?;
    Ok(())
}

/// What the study of the solution set draws.
pub struct SolutionChart<'a> {
    /// Starts, and the solutions of each family, in the plane of the principal components.
    pub starts: &'a [[f64; 2]],
    pub families: &'a [Vec<[f64; 2]>],
    /// Eigenvalues of the Hessian over the greatest, and below which they are no more than rounding.
    pub curvatures: &'a [f64],
    pub negligible: f64,
    /// Outline error (%) against the step, one line a family's median run.
    pub errors: &'a [Vec<f64>],
}

/// The solution set in three panels.
pub fn solutions(chart: &SolutionChart) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (1320, 420)).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        let areas = root.split_evenly((1, 3));
        plane_chart(&areas[0], chart).map_err(drawing)?;
        curvature_chart(&areas[1], chart).map_err(drawing)?;
        error_chart(&areas[2], chart.errors).map_err(drawing)?;
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn plane_chart(area: &Area, chart: &SolutionChart) -> DrawResult {
    let all = || chart.starts.iter().chain(chart.families.iter().flatten());
    let mut context = ChartBuilder::on(area)
        .caption("starts (grey) and solutions by family", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(padded(all().map(|p| p[0])), padded(all().map(|p| p[1])))?;
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("first principal component")
        .y_desc("second principal component")
        .draw()?;
    let dot =
        |p: &[f64; 2], colour: RGBColor| Circle::new((p[0], p[1]), 3, colour.mix(0.7).filled());
    context.draw_series(chart.starts.iter().map(|p| dot(p, GUIDE)))?;
    for (i, family) in chart.families.iter().enumerate() {
        let colour = SLICES[i % SLICES.len()];
        context.draw_series(family.iter().map(|p| dot(p, colour)))?;
    }
    Ok(())
}

fn curvature_chart(area: &Area, chart: &SolutionChart) -> DrawResult {
    /// Smaller shares are drawn at it.
    const LEAST: f64 = 1e-14;
    let points: Vec<_> = (chart.curvatures.iter().enumerate())
        .map(|(k, share)| (k as f64 + 1.0, share.abs().max(LEAST)))
        .collect();
    let across = 0.0..points.len() as f64 + 1.0;
    let mut context = ChartBuilder::on(area)
        .caption("curvature of the shape term", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(64)
        .build_cartesian_2d(
            across.clone(),
            decades(points.iter().map(|p| p.1)).log_scale(),
        )?;
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .x_desc("direction")
        .y_desc("|eigenvalue| over the greatest")
        .draw()?;
    let limit = [across.start, across.end].map(|x| (x, chart.negligible));
    context.draw_series(DashedLineSeries::new(limit, 4, 4, GUIDE.into()))?;
    context.draw_series(points.iter().map(|p| Circle::new(*p, 3, POINT.filled())))?;
    Ok(())
}

fn error_chart(area: &Area, errors: &[Vec<f64>]) -> DrawResult {
    let longest = errors.iter().map(Vec::len).max().unwrap_or(1).max(2);
    let up = decades(
        errors
            .iter()
            .flatten()
            .copied()
            .filter(|error| *error > 0.0),
    );
    let mut context = ChartBuilder::on(area)
        .caption("outline error of each family's median run", (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..longest as f64, up.log_scale())?;
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("step")
        .y_desc("outline error, % of the side")
        .draw()?;
    for (i, line) in errors.iter().enumerate() {
        let points = line
            .iter()
            .enumerate()
            .map(|(step, error)| (step as f64, *error));
        let colour = SLICES[i % SLICES.len()].stroke_width(2);
        context.draw_series(LineSeries::new(points, colour))?;
    }
    Ok(())
}

/// What the study of path dependence draws.
pub struct SeparationChart<'a> {
    /// Routes solved twice: (separation, relative difference).
    pub pairs: &'a [(f64, f64)],
    /// Exponent and factor of the line through them, if there is one.
    pub fit: Option<[f64; 2]>,
    /// Separations of every route recorded, for the histogram behind the marks.
    pub all: &'a [f64],
    pub quantity: &'a str,
}

/// Difference against separation on logarithmic axes, one chart a quantity.
pub fn separations(charts: &[SeparationChart]) -> Result<String> {
    let mut svg = String::new();
    {
        let size = (480 * charts.len() as u32, 420);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        for (area, chart) in root.split_evenly((1, charts.len())).iter().zip(charts) {
            separation_chart(area, chart).map_err(drawing)?;
        }
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn separation_chart(area: &Area, chart: &SeparationChart) -> DrawResult {
    /// Differences below this are drawn at it.
    const LEAST: f64 = 1e-6;
    /// Bars of the histogram.
    const BARS: usize = 24;
    let marks: Vec<_> = (chart.pairs.iter())
        .map(|(x, y)| (x.max(LEAST), y.max(LEAST)))
        .collect();
    let across = decades(
        marks
            .iter()
            .map(|p| p.0)
            .chain(chart.all.iter().map(|x| x.max(LEAST))),
    );
    let up = decades(marks.iter().map(|p| p.1));
    let mut context = ChartBuilder::on(area)
        .caption(chart.quantity, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(64)
        .build_cartesian_2d(across.clone().log_scale(), up.clone().log_scale())?;
    let (width, height) = ((across.end / across.start).ln(), (up.end / up.start).ln());
    let mut counts = [0usize; BARS];
    for x in chart.all {
        let share = (x.max(LEAST) / across.start).ln() / width;
        counts[((share * BARS as f64) as usize).min(BARS - 1)] += 1;
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
    context
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .x_desc("separation of route and ray, ligament widths")
        .y_desc("relative difference at the end")
        .draw()?;
    if let Some([exponent, factor]) = chart.fit {
        let line = [across.start, across.end].map(|x| (x, factor * x.powf(exponent)));
        context.draw_series(LineSeries::new(line, VALIDATION))?;
    }
    context.draw_series(marks.iter().map(|p| Circle::new(*p, 4, POINT.filled())))?;
    Ok(())
}

/// The decades that hold the values, which are positive.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (least, greatest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| {
        (l.min(v), g.max(v))
    });
    if least > greatest {
        return 1e-3..1.0;
    }
    let (from, to) = (least.log10().floor(), greatest.log10().floor() + 1.0);
    10f64.powf(from)..10f64.powf(to)
}

/// Choices of one kind: (scene, choice, cost in ms, error); an error of 0 is that of the reference.
pub struct CostPanel {
    pub title: &'static str,
    pub points: Vec<(&'static str, String, f64, f64)>,
}

/// Errors below this one are drawn at it, without their names.
const LEAST_ERROR: f64 = 1e-12;

/// The panels of [`CostPanel`], three in a row, both axes logarithmic.
pub fn costs(panels: &[CostPanel]) -> Result<String> {
    let mut svg = String::new();
    {
        let rows = panels.len().div_ceil(3).max(1);
        let root = SVGBackend::with_string(&mut svg, (1260, 380 * rows as u32)).into_drawing_area();
        root.fill(&WHITE).map_err(drawing)?;
        for (area, panel) in root.split_evenly((rows, 3)).iter().zip(panels) {
            cost_chart(area, panel).map_err(drawing)?;
        }
        root.present().map_err(drawing)?;
    }
    Ok(svg)
}

fn cost_chart(area: &Area, panel: &CostPanel) -> DrawResult {
    let decades = panel.points.iter().map(|(.., cost, _)| cost.log10());
    let (least, most) = decades.fold((0.0_f64, 1.0_f64), |(l, m), x| (l.min(x), m.max(x)));
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, (FONT, 15))
        .margin(10)
        .x_label_area_size(38)
        .y_label_area_size(56)
        .build_cartesian_2d(
            (least.floor()..most.ceil() + 1.6).step(1.0),
            (LEAST_ERROR.log10()..0.6).step(2.0),
        )?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_label_formatter(&|x| 10_f64.powf(*x).to_string())
        .y_label_formatter(&|y| format!("1e{y:.0}"))
        .label_style((FONT, 12))
        .x_desc("cost with gradient, ms")
        .y_desc("error of the gradient")
        .draw()?;
    let mut scenes: Vec<&str> = panel.points.iter().map(|(scene, ..)| *scene).collect();
    scenes.dedup();
    for (scene, colour) in std::iter::zip(scenes, SLICES) {
        let of_scene = panel.points.iter().filter(|(of, ..)| *of == scene);
        let marks = of_scene.map(|(_, choice, cost, error)| {
            let at = (cost.log10(), error.max(LEAST_ERROR).log10());
            let label = if *error > LEAST_ERROR {
                choice.as_str()
            } else {
                ""
            };
            let label = Text::new(
                label.to_owned(),
                (6, -6),
                (FONT, 10).into_font().color(&colour),
            );
            EmptyElement::at(at) + Circle::new((0, 0), 3, colour.filled()) + label
        });
        chart
            .draw_series(marks)?
            .label(scene)
            .legend(move |(x, y)| Circle::new((x + 7, y), 3, colour.filled()));
    }
    chart
        .configure_series_labels()
        .label_font((FONT, 10))
        .position(SeriesLabelPosition::UpperRight)
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
        let svg = parity(&[chart("W"), chart("D")], ["finite elements", "surrogate"]).unwrap();
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
    fn separations_are_drawn_whatever_their_size() {
        let pairs = [(0.0, 0.0), (1e-3, 1e-4), (0.2, 0.05)];
        let chart = SeparationChart {
            pairs: &pairs,
            fit: Some([2.0, 1.0]),
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

    #[test]
    fn a_learning_curve_survives_a_single_epoch_and_zero_losses() {
        assert!(
            learning_curve(&[1.0], &[0.0])
                .unwrap()
                .contains("validation")
        );
    }
}
