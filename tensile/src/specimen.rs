//! The evaluation of one specimen: from its record to its local hardening curve.
//!
//! 1. Unloading loops, rows after the break and falling strains are removed (`cleaning`).
//! 2. The line through the linear part is extended to zero stress; the strain there, slack and toe,
//!    is subtracted.
//! 3. If Young's modulus is given, the compliance of the testing machine is removed, e - s (1 /
//!    E_measured - 1 / E), unless the strain is the strain of an extensometer: of a slope near the
//!    modulus.
//! 4. Landmarks are read from the nominal curve (`landmarks`).
//! 5. Where the strain is uniform, nominal rows become local ones (`local_curve`).

use crate::cleaning::{Cleaned, cleaned};
use crate::in_file;
use crate::landmarks::{self, Draw, SpecimenEnd, offset_yield, uniform_end};
use crate::linear_part::LinearPart;
use crate::local_curve::{first_part, second_part, true_row};
use crate::number_table::StatedDimension;
use crate::quantity::Quantity::Extension;
use crate::record::{Exclusion, ReadColumn, Record, RecordRow, within};
use crate::regression::Regression;
use serde::Serialize;
use std::path::PathBuf;
use support::{Extremes, Fault, Point, fault};

/// What is known about the material or its specimens besides the records.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpecimenOptions {
    /// Young's modulus (MPa), instead of the slope of the linear part.
    pub young: Option<f64>,
    /// Natural draw ratio, measured on the neck: initial over drawn section.
    pub draw_ratio: Option<f64>,
}

/// Rows after the maximum of the stress, which the law does not have.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Softening {
    /// Number of rows.
    pub rows: usize,
    /// Nominal [strain, stress (MPa)] at the maximum and at the last row.
    pub ends: [Point; 2],
}

/// One evaluated specimen. Stresses are in MPa; strains are from the toe.
#[derive(Debug, Serialize)]
pub struct Specimen {
    /// The file, with the number of the specimen if it has several.
    pub path: PathBuf,
    /// The columns that were read: load and deformation.
    pub read_as: [ReadColumn; 2],
    /// The dimensions that were read from the file.
    pub stated: Vec<StatedDimension>,
    /// What the file and the options state and the evaluation does not use, in words.
    pub unused: Vec<String>,
    /// The rows after the maximum, if the specimen softens there.
    pub softening: Option<Softening>,
    /// BLAKE3 hash of the file, 16 hexadecimal digits.
    pub hash: String,
    /// Number of rows of the specimen.
    pub rows: usize,
    /// Rows that are not used.
    pub dropped: Vec<RecordRow>,
    /// Number of rows that were averaged with their neighbours, because their strain does not
    /// increase.
    pub averaged: usize,
    /// The linear part as measured.
    pub linear: LinearPart,
    /// Slack and toe that was subtracted from the strain.
    pub toe: f64,
    /// Young's modulus of the evaluation: given, or the modulus of the linear part.
    pub young: f64,
    /// Compliance of the testing machine that was removed (1/MPa), 0 if none was.
    pub compliance: f64,
    /// Nominal stress at a plastic strain of 0.2 %.
    pub offset_yield: f64,
    /// Largest nominal stress.
    pub strength: f64,
    /// The draw, if the specimen drew.
    pub draw: Option<Draw>,
    /// How the specimen ended.
    pub end: SpecimenEnd,
    /// Nominal curve [strain, stress] without the dropped rows.
    #[serde(skip)]
    pub nominal: Vec<Point>,
    /// Local curve [true stress, plastic strain] up to the upper yield or, without a draw, to the
    /// end of the uniform deformation. It starts at zero plastic strain.
    #[serde(skip)]
    pub before: Vec<Point>,
    /// Local curve from the natural draw ratio on; empty without a draw.
    #[serde(skip)]
    pub after: Vec<Point>,
}

/// Limits of Young's modulus (MPa) and of the yield strain; wrong units exceed them.
const YOUNG: [f64; 2] = [10.0, 1e6];
const YIELD_STRAIN: [f64; 2] = [2e-4, 0.1];
/// Plastic strain below which a row is elastic: the curve of the material starts there.
const ONSET: f64 = 2e-4;
/// Fraction of the maximum stress to which smoothing reduces the noise.
const SMOOTH: f64 = 0.003;
/// Limits of the measured over the given modulus: a machine's compliance lowers it by less.
const SLOPE: [f64; 2] = [0.1, 1.25];
/// Minimum of the measured over the given modulus of an extensometer: a machine's compliance lowers
/// the slope by more.
const EXTENSOMETER: f64 = 0.75;

impl Specimen {
    /// Evaluates a record.
    pub(super) fn new(mut record: Record, options: &SpecimenOptions) -> Result<Self, Fault> {
        let path = record.path.clone();
        let file = in_file(&path);
        let Cleaned { curve: nominal, averaged, noise } =
            cleaned(&mut record.rows).map_err(|line| {
                fault!(
    "{}:{line}: from here on the strain falls for most of the file: sort the rows by time, and give each specimen its \
     own file",
    path.display()
)
            })?;
        let curve = Compensated::new(&record, &nominal, noise, options).map_err(file)?;
        let Compensated { young, elastic, noise, compliance, rows: ref smooth, .. } = curve;
        let end = smooth.len() - 1;
        let offset_yield = offset_yield(smooth, young, elastic).ok_or_else(|| {
            file(format!(
                "ends at {:.3} MPa before a plastic strain of 0.2 %: it contains no yield and no hardening; is it the \
                 curve up to the break?",
                smooth[end][1]
            ))
        })?;
        let strain = offset_yield / young;
        let units = [["", "1"], ["", "%"]];
        within(&record.read_as, "elastic strain at yield", strain, YIELD_STRAIN, units)
            .map_err(file)?;
        let (draw, last, ended) = match record.is_local() {
            true => (None, end, SpecimenEnd::Uniform),
            false => curve.necking(options.draw_ratio).map_err(file)?,
        };
        if let (Some(ratio), None) = (options.draw_ratio, draw) {
            record.unused.push(format!("--draw-ratio {ratio}, as the record shows no draw"));
        }
        let onset = ONSET.max(3.0 * f64::hypot(noise[0], noise[1] / young));
        let until = draw.map_or(last, |draw| draw.top);
        let before = first_part(&smooth[..=until], young, onset, draw.is_some()).ok_or_else(|| {
            file(format!(
                "has a noise of {:.1e} in strain and {:.2} MPa in stress, or too few rows after yield: no plastic strain \
                 can be read from it",
                noise[0], noise[1]
            ))
        })?;
        let rows = record.rows.len();
        let dropped = curve.dropped(record.rows);
        let used = nominal.iter().skip_while(|row| curve.is_toe(row[0]));
        Ok(Self {
            read_as: record.read_as,
            stated: record.stated,
            unused: record.unused,
            hash: record.hash,
            softening: (ended == SpecimenEnd::Neck)
                .then(|| Softening { rows: end - last, ends: [last, end].map(|row| smooth[row]) }),
            after: draw.map_or(Vec::new(), |draw| second_part(&smooth[..=last], &draw, young)),
            strength: nominal.iter().map(|row| row[1]).largest(),
            nominal: used.map(|&[e, s]| [curve.corrected(e, s), s]).collect(),
            toe: curve.linear.toe,
            linear: curve.linear,
            compliance,
            end: ended,
            path,
            rows,
            dropped,
            averaged,
            young,
            offset_yield,
            draw,
            before,
        })
    }

    /// Number of rows dropped for a cause.
    pub fn dropped_for(&self, cause: Exclusion) -> usize {
        self.dropped.iter().filter(|row| row.cause == Some(cause)).count()
    }
}

/// A nominal curve without noise, toe and compliance of the machine.
struct Compensated {
    /// [strain, stress]
    rows: Vec<Point>,
    /// Standard deviations of the noise of strain and stress that is left.
    noise: [f64; 2],
    linear: LinearPart,
    young: f64,
    /// Compliance of the machine that is removed (1/MPa).
    compliance: f64,
    /// The first row beyond the linear part.
    elastic: usize,
}

impl Compensated {
    fn new(
        record: &Record,
        curve: &[Point],
        noise: [f64; 2],
        options: &SpecimenOptions,
    ) -> Result<Self, String> {
        let half = half_window(curve, noise[1]);
        let noise = [noise[0], noise[1] / (2.0 * half as f64 + 1.0).sqrt()];
        let mut rows = smoothed(curve, half);
        let mut linear = linear_part(&mut rows, record, noise).ok_or(
            "has no linear part: the stress does not rise with the strain; are the columns swapped?",
        )?;
        let (read_as, known) = (&record.read_as, linear.is_known());
        within(read_as, "modulus (MPa)", linear.young, YOUNG, [["GPa", "%"], ["Pa", "1"]])?;
        let young = options.young.or(known.then_some(linear.young)).ok_or_else(|| {
            format!(
                "has a modulus of {:.0} ± {:.0} MPa (standard error) from {} rows, whose 95 % interval reaches zero: state it with \
                 --young, or export the record without thinning",
                linear.young, linear.error, linear.rows
            )
        })?;
        let ratio = linear.young / young;
        if known {
            within(read_as, "initial slope over --young", ratio, SLOPE, [["UNIT"; 2]; 2])?;
        }
        let extensometer = ratio >= EXTENSOMETER && read_as[1].quantity != Extension;
        let compliance = match extensometer || !known {
            true => 0.0,
            false => 1.0 / linear.young - 1.0 / young,
        };
        rows.iter_mut().for_each(|row| row[0] -= row[1] * compliance);
        if !known {
            // The line of the given modulus through the first row of the part.
            let first = rows.iter().find(|row| row[0] >= linear.strain[0]).unwrap_or(&rows[0]);
            let zero = first[0] - first[1] / young;
            linear.strain = [first[0] - zero; 2];
            rows.iter_mut().for_each(|row| row[0] -= zero);
            linear.toe += zero;
        }
        let end = linear.strain[1] * (1.0 - linear.young * compliance);
        let elastic = rows.iter().position(|row| row[0] >= end).unwrap_or(0);
        Ok(Self { rows, noise, linear, young, compliance, elastic })
    }

    /// The draw, if the specimen drew, and the last row of its uniform deformation with how it
    /// ended.
    fn necking(&self, ratio: Option<f64>) -> Result<(Option<Draw>, usize, SpecimenEnd), String> {
        let (rows, noise) = (&self.rows, self.noise[1]);
        let draw = landmarks::draw(rows, self.elastic, noise, ratio)?;
        let drawn = |draw: Draw| rows.partition_point(|row| 1.0 + row[0] < draw.draw_ratio);
        let (last, end) = uniform_end(rows, draw.map_or(self.elastic, drawn), noise);
        Ok((draw, last, end))
    }

    /// The rows that are not used, among them the toe, with corrected strains.
    fn dropped(&self, mut rows: Vec<RecordRow>) -> Vec<RecordRow> {
        let unmarked = rows.iter_mut().filter(|row| row.cause.is_none());
        for row in unmarked.take_while(|row| self.is_toe(row.strain)) {
            row.cause = Some(Exclusion::Toe);
        }
        rows.retain(|row| row.cause.is_some());
        rows.iter_mut().for_each(|row| row.strain = self.corrected(row.strain, row.stress));
        rows
    }

    /// A measured strain without toe and compliance.
    fn corrected(&self, strain: f64, stress: f64) -> f64 {
        strain - self.linear.toe - stress * self.compliance
    }

    /// Whether a measured strain is below the linear part.
    fn is_toe(&self, strain: f64) -> bool {
        strain - self.linear.toe < self.linear.strain[0]
    }
}

/// The linear part, whose toe is subtracted from the curve. Its rows are found on the
/// nominal curve, whose slope is largest at the start; its modulus is the slope of the true stress
/// over the logarithmic strain, as the solver reads it.
fn linear_part(curve: &mut [Point], record: &Record, noise: [f64; 2]) -> Option<LinearPart> {
    let nominal = LinearPart::find(curve, noise)?;
    curve.iter_mut().for_each(|row| row[0] -= nominal.toe);
    let end = nominal.first + nominal.rows;
    let rows = record.rows.iter().map(|row| true_row(&[row.strain - nominal.toe, row.stress]));
    let metal = offset_yield(curve, nominal.young, end)
        .and_then(|yields| nominal.of_metal(&rows.collect::<Vec<_>>(), yields));
    let part = metal.or_else(|| {
        let rows: Vec<Point> = curve[..end].iter().map(true_row).collect();
        LinearPart::through(&rows, nominal.first..end)
    })?;
    curve.iter_mut().for_each(|row| row[0] -= part.toe);
    Some(LinearPart { toe: nominal.toe + part.toe, ..part })
}

/// Half the number of rows over which the stress is smoothed, from its noise; few enough to leave
/// the yield peak.
fn half_window(curve: &[Point], noise: f64) -> usize {
    let maximum = curve.iter().map(|row| row[1]).largest();
    let rise = curve.iter().position(|row| row[1] >= 0.5 * maximum);
    let needed = 0.5 * (noise / (SMOOTH * maximum).max(f64::MIN_POSITIVE)).powi(2);
    (needed as usize).min(rise.unwrap_or(0) / 4)
}

/// The curve with each stress replaced by the stress of the regression line through the rows around
/// it.
fn smoothed(curve: &[Point], half: usize) -> Vec<Point> {
    let last = curve.len().saturating_sub(1);
    let value = |row: usize| {
        let half = half.min(row).min(last - row);
        let line = Regression::new(&curve[row - half..=row + half]);
        let slope = if line.squares > 0.0 { line.slope } else { 0.0 };
        let [strain, stress] = line.mean;
        [curve[row][0], stress + slope * (curve[row][0] - strain)]
    };
    (0..curve.len()).map(value).collect()
}
