//! The law of a material from its specimens: mean modulus, mean hardening curve, fracture strain,
//! and the table of the finite elements.

use crate::cleaning::Cause;
use crate::cold_drawing::{ColdDrawing, beyond_maximum_force};
use crate::landmarks::{Draw, End};
use crate::mean_curve::mean_curve;
use crate::record::{Record, RecordOptions};
use crate::specimen::{Specimen, SpecimenOptions};
use crate::thinning::thinned;
use serde::Serialize;
use std::path::PathBuf;
use support::fault::Fault;

/// What is known about a material besides the records of its specimens.
#[derive(Clone, Copy, Debug)]
pub struct FitOptions {
    /// For the evaluation of each specimen.
    pub specimen: SpecimenOptions,
    /// Plastic strain at fracture, ln(A0 / A) from the section A of the broken specimen, if it was
    /// measured.
    pub fracture_strain: Option<f64>,
    /// Maximum number of rows of the table, 2 to 200: CalculiX interpolates between at most 200
    /// rows.
    pub rows: usize,
}

/// Mean and standard deviation of a quantity over the specimens.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Statistic {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation of the sample; `None` for one specimen.
    pub deviation: Option<f64>,
}

/// How a row of the table was obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// From rows at which the strain is uniform.
    Measured,
    /// In the running neck, from the work of the machine; see `cold_drawing`.
    Drawn,
    /// Beyond the maximum force, by Considere's condition; see `cold_drawing`.
    Extrapolated,
}

/// A row of the hardening curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HardeningRow {
    /// True stress (MPa).
    pub stress: f64,
    /// True plastic strain.
    pub strain: f64,
    /// How the row was obtained.
    pub origin: Origin,
}

/// The source of the fracture strain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FractureSource {
    /// Given.
    Given,
    /// Plastic strain at the end of records whose specimens deform uniformly to their break.
    Break,
    /// The same, but a record ends without a break: a lower bound, because the specimen strains
    /// further.
    RecordEnd,
    /// Plastic strain at the maximum force: a lower bound, because the neck strains further.
    MaximumForce,
    /// Plastic strain at the natural draw ratio: a lower bound, because the drawn material strains
    /// further.
    DrawRatio,
}

impl FractureSource {
    /// The source in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Break => "where the specimens broke, at uniform strain",
            Self::RecordEnd => {
                "the record ends here without a break: a lower bound; measure ln(A0 / A)"
            }
            Self::MaximumForce => "at the maximum force: a lower bound, the neck strains further",
            Self::DrawRatio => "at the natural draw ratio: a lower bound",
        }
    }
}

/// The law fitted to the records of one material. Stresses are in MPa.
#[derive(Clone, Debug, Serialize)]
pub struct MaterialFit {
    /// The specimens.
    pub specimens: Vec<Specimen>,
    /// Young's modulus of the law.
    pub young: Statistic,
    /// Whether Young's modulus was given.
    pub young_given: bool,
    /// Nominal stress at a plastic strain of 0.2 %.
    pub offset_yield: Statistic,
    /// Nominal stress at the upper yield, of specimens that draw.
    pub upper_yield: Option<Statistic>,
    /// Nominal stress of the draw plateau.
    pub plateau: Option<Statistic>,
    /// Stretch of the drawn material.
    pub draw_ratio: Option<Statistic>,
    /// True stress at which the law yields, if the upper yield was cut to the mean stress of the
    /// draw.
    pub cut_yield: Option<f64>,
    /// The hardening curve before it is thinned.
    #[serde(skip)]
    pub curve: Vec<HardeningRow>,
    /// The rows of `plastic`: the curve thinned and rounded.
    pub table: Vec<HardeningRow>,
    /// Maximum deviation of the table from the curve, over the stress.
    pub table_deviation: f64,
    /// Plastic strain at fracture.
    pub fracture_strain: f64,
    /// Scatter of the fracture strain, if the fracture strain comes from the specimens.
    pub fracture_scatter: Option<f64>,
    /// Source of the fracture strain.
    pub fracture_source: FractureSource,
}

/// Number of points of the curve in the neck.
const NECK_POINTS: usize = 100;
/// Digits after the point of stresses (MPa) and strains in the table.
const DIGITS: [i32; 2] = [3, 5];

impl Statistic {
    /// The statistic of at least one value.
    pub fn new(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt());
        Self { mean, deviation }
    }
}

impl MaterialFit {
    /// Relative standard deviation of the stress over the specimens: the largest of modulus, yield
    /// and plateau, to two digits.
    pub fn stress_deviation(&self) -> Option<f64> {
        let stresses = [self.young, self.offset_yield].into_iter();
        let drawn = [self.upper_yield, self.plateau].into_iter().flatten();
        let relative = |of: Statistic| Some(of.deviation? / of.mean);
        let largest = stresses.chain(drawn).filter_map(relative).reduce(f64::max)?;
        Some(rounded(largest, 4))
    }

    /// Reads and evaluates the record of each specimen with its own options, and fits one law to
    /// all.
    pub fn new(records: &[(PathBuf, RecordOptions)], options: &FitOptions) -> Result<Self, Fault> {
        let mut specimens = Vec::new();
        for (path, record) in records {
            for record in Record::read_all(path, record)? {
                specimens.push(Specimen::new(record, &options.specimen)?);
            }
        }
        same_kind(&specimens)?;
        let over = |value: fn(&Specimen) -> f64| Statistic::new(specimens.iter().map(value));
        let drawn = |value: fn(&Draw) -> f64| {
            let draws: Option<Vec<f64>> =
                (specimens.iter()).map(|specimen| specimen.draw.as_ref().map(value)).collect();
            draws.map(|values| Statistic::new(values.into_iter()))
        };
        let young = over(|specimen| specimen.young);
        let (plateau, draw_ratio) = (drawn(|draw| draw.plateau), drawn(|draw| draw.draw_ratio));
        let (mut curve, cut_yield) = hardening(&specimens, young.mean, plateau.zip(draw_ratio))?;
        let fracture = fracture(&specimens, options, &curve)?;
        let necks = specimens.iter().all(|specimen| specimen.end == End::Neck);
        let end = curve[curve.len() - 1];
        if necks && fracture.strain > end.strain {
            curve.push(HardeningRow {
                stress: beyond_maximum_force([end.stress, end.strain], fracture.strain, young.mean),
                strain: fracture.strain,
                origin: Origin::Extrapolated,
            });
        }
        let rows: Vec<[f64; 2]> = curve.iter().map(|row| [row.stress, row.strain]).collect();
        let (kept, table_deviation) = thinned(&rows, options.rows);
        Ok(Self {
            young: Statistic { mean: rounded(young.mean, 1), ..young },
            young_given: options.specimen.young.is_some(),
            offset_yield: over(|specimen| specimen.offset_yield),
            upper_yield: drawn(|draw| draw.upper_yield),
            plateau,
            draw_ratio,
            cut_yield,
            table: table(kept.into_iter().map(|row| curve[row])),
            curve,
            table_deviation,
            fracture_strain: rounded(fracture.strain, 4),
            fracture_scatter: fracture.scatter,
            fracture_source: fracture.source,
            specimens,
        })
    }
}

/// The mean hardening curve, and the true stress to which the upper yield is cut, if it is. `draw`
/// has the plateau and the natural draw ratio.
fn hardening(
    specimens: &[Specimen],
    young: f64,
    draw: Option<(Statistic, Statistic)>,
) -> Result<(Vec<HardeningRow>, Option<f64>), Fault> {
    let before: Vec<&[[f64; 2]]> = specimens.iter().map(|specimen| &*specimen.before).collect();
    let end = Statistic::new(before.iter().map(|curve| last(curve)[1])).mean;
    let mut uniform = mean_curve(&before, end);
    let Some((plateau, ratio)) = draw else {
        return Ok((marked(&uniform, Origin::Measured), None));
    };
    let top = last(&uniform);
    let drawing = ColdDrawing::new(top, plateau.mean, ratio.mean, young).ok_or_else(|| {
        refused(format!(
            "the natural draw ratio {:.3} is not beyond the upper yield at the plastic strain {:.3}: check --draw-ratio, \
             the initial section over the section of the drawn neck",
            ratio.mean, top[1]
        ))
    })?;
    let yields = drawing.yields_at();
    uniform.iter_mut().for_each(|row| row[0] = row[0].min(yields));
    let mut curve = marked(&uniform, Origin::Measured);
    curve.extend(marked(&drawing.points(NECK_POINTS), Origin::Drawn));
    curve.extend(marked(&drawn_curve(specimens, drawing.to), Origin::Measured));
    Ok((curve, (yields < top[0]).then_some(yields)))
}

/// Specimens that draw and specimens that do not have no common curve.
fn same_kind(specimens: &[Specimen]) -> Result<(), Fault> {
    let draws = |specimen: &&Specimen| specimen.draw.is_some();
    let names = |these: Vec<&Specimen>| {
        let names: Vec<String> =
            these.iter().map(|specimen| specimen.path.display().to_string()).collect();
        names.join(", ")
    };
    let (drawn, others): (Vec<_>, Vec<_>) = specimens.iter().partition(draws);
    if drawn.is_empty() || others.is_empty() {
        Ok(())
    } else {
        Err(refused(format!(
            "{} have a draw plateau, {} have none: fit them apart, or leave out specimens that broke early",
            names(drawn),
            names(others)
        )))
    }
}

/// The mean curve from the natural draw ratio at `start` to the mean end.
fn drawn_curve(specimens: &[Specimen], start: [f64; 2]) -> Vec<[f64; 2]> {
    let shifted: Vec<Vec<[f64; 2]>> = (specimens.iter())
        .map(|specimen| {
            let after = &specimen.after;
            let rows = after.iter().map(|row| [row[0], row[1] - after[0][1]]);
            rows.collect()
        })
        .collect();
    let curves: Vec<&[[f64; 2]]> = shifted.iter().map(Vec::as_slice).collect();
    let end = Statistic::new(curves.iter().map(|curve| last(curve)[1])).mean;
    if end <= 0.0 {
        return Vec::new();
    }
    let mean = mean_curve(&curves, end);
    let offset = start[0] - mean[0][0];
    let rows = mean[1..].iter();
    rows.map(|row| [row[0] + offset, row[1] + start[1]]).collect()
}

/// What is wrong with the specimens together.
fn refused(what: String) -> Fault {
    Fault::from(what)
}

struct Fracture {
    strain: f64,
    scatter: Option<f64>,
    source: FractureSource,
}

fn fracture(
    specimens: &[Specimen],
    options: &FitOptions,
    curve: &[HardeningRow],
) -> Result<Fracture, Fault> {
    let end = curve[curve.len() - 1].strain;
    if let Some(strain) = options.fracture_strain {
        return if strain >= end {
            Ok(Fracture { strain, scatter: None, source: FractureSource::Given })
        } else {
            Err(refused(format!(
                "--fracture-strain {strain} is less than the plastic strain {end:.4} that the specimens reach on \
                 average: it is ln(A0 / A), from the section A of the broken specimen"
            )))
        };
    }
    let worst = |of| specimens.iter().any(|specimen| specimen.end == of);
    let source = match (worst(End::Drawing), worst(End::Neck)) {
        (true, _) => FractureSource::DrawRatio,
        (_, true) => FractureSource::MaximumForce,
        _ if specimens.iter().all(|specimen| specimen.dropped_for(Cause::Broken) > 0) => {
            FractureSource::Break
        }
        _ => FractureSource::RecordEnd,
    };
    let reached = |specimen: &Specimen| {
        let drawn = !specimen.after.is_empty();
        last(if drawn { &specimen.after } else { &specimen.before })[1]
    };
    let scatter = Statistic::new(specimens.iter().map(reached)).deviation;
    if let Some(scatter) = scatter.filter(|scatter| *scatter > end) {
        return Err(refused(format!(
            "the specimens have a fracture strain of {end:.4} ± {scatter:.4}, which is none: give --fracture-strain, or \
             leave out specimens that broke early"
        )));
    }
    Ok(Fracture { strain: end, scatter, source })
}

/// The rows of the table, rounded. A row that rounding moves onto the one before is left out.
fn table(rows: impl Iterator<Item = HardeningRow>) -> Vec<HardeningRow> {
    let mut table: Vec<HardeningRow> = Vec::new();
    for row in rows {
        let row = HardeningRow {
            stress: rounded(row.stress, DIGITS[0]),
            strain: rounded(row.strain, DIGITS[1]),
            ..row
        };
        if table.last().is_none_or(|before| row.strain > before.strain) {
            table.push(row);
        }
    }
    table
}

fn rounded(value: f64, digits: i32) -> f64 {
    let unit = 10f64.powi(digits);
    (value * unit).round() / unit
}

fn marked(rows: &[[f64; 2]], origin: Origin) -> Vec<HardeningRow> {
    let row = |&[stress, strain]: &[f64; 2]| HardeningRow { stress, strain, origin };
    rows.iter().map(row).collect()
}

/// The last row of a curve, which has at least one.
fn last(curve: &[[f64; 2]]) -> [f64; 2] {
    curve[curve.len() - 1]
}
