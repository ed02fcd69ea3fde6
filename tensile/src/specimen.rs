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

use crate::cleaning::{Cause, Cleaned, DroppedRow, cleaned};
use crate::in_file;
use crate::landmarks::{Draw, draw, offset_yield, uniform_end};
use crate::linear_part::LinearPart;
use crate::local_curve::{first_part, second_part, true_row};
use crate::preamble::StatedDimension;
use crate::quantity::Quantity::{Extension, PlasticStrain, TrueStrain, TrueStress};
use crate::record::{ReadColumn, Record};
use crate::regression::Regression;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::PathBuf;
use support::fault::{Fault, fault};

/// What is known about the material or its specimens besides the records.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpecimenOptions {
    /// Young's modulus (MPa), instead of the slope of the linear part.
    pub young: Option<f64>,
    /// Natural draw ratio, measured on the neck: initial over drawn section.
    pub draw_ratio: Option<f64>,
}

/// How a specimen ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// It broke, or the record ends, while its deformation was uniform.
    Uniform,
    /// It necked at the maximum force.
    Neck,
    /// The record ends before the neck had covered the specimen.
    Drawing,
}

/// Rows after the maximum of the stress, which the law does not have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Softening {
    /// Number of rows.
    pub rows: usize,
    /// Nominal [strain, stress (MPa)] at the maximum and at the last row.
    pub ends: [[f64; 2]; 2],
}

/// One evaluated specimen. Stresses are in MPa; strains are from the toe.
#[derive(Clone, Debug, Serialize)]
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
    pub dropped: Vec<DroppedRow>,
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
    pub end: End,
    /// Nominal curve [strain, stress] without the dropped rows.
    #[serde(skip)]
    pub nominal: Vec<[f64; 2]>,
    /// Local curve [true stress, plastic strain] up to the upper yield or, without a draw, to the
    /// end of the uniform deformation. It starts at zero plastic strain.
    #[serde(skip)]
    pub before: Vec<[f64; 2]>,
    /// Local curve from the natural draw ratio on; empty without a draw.
    #[serde(skip)]
    pub after: Vec<[f64; 2]>,
}

/// Limits of Young's modulus (MPa) and of the yield strain; wrong units exceed them.
const YOUNG: [f64; 2] = [10.0, 1e6];
const YIELD_STRAIN: [f64; 2] = [2e-4, 0.1];
/// Plastic strain below which a row is elastic: the curve of the material starts there.
const ONSET: f64 = 2e-4;
/// Fraction of the maximum stress to which smoothing reduces the noise.
const SMOOTH: f64 = 0.003;
/// Maximum and minimum of the measured over the given modulus.
const STIFFER: f64 = 1.25;
const SOFTER: f64 = 0.1;
/// Minimum of the measured over the given modulus of an extensometer: a machine's compliance lowers
/// the slope by more.
const EXTENSOMETER: f64 = 0.75;

impl Specimen {
    /// Evaluates a record.
    pub(super) fn new(record: &Record, options: &SpecimenOptions) -> Result<Self, Fault> {
        let file = in_file(&record.path);
        if record.deformation == PlasticStrain {
            return Err(file(
                "contains plastic strains: it is a hardening table already; write its rows into `plastic` of the material file"
                    .into(),
            ));
        }
        let cleaned = nominal_curve(record)?;
        let is_local = is_local(record);
        let curve =
            Compensated::new(record, &cleaned.curve, cleaned.noise, options).map_err(file)?;
        let (young, elastic, noise) = (curve.young, curve.elastic, curve.noise);
        let smooth = &curve.rows;
        let offset_yield = offset_yield(smooth, young, elastic).ok_or_else(|| {
            file(format!(
                "ends at {:.3} MPa before a plastic strain of 0.2 %: it contains no yield and no hardening; is it the \
                 curve up to the break?",
                smooth[smooth.len() - 1][1]
            ))
        })?;
        check_yield_strain(record, offset_yield / young).map_err(file)?;
        let draw = if is_local {
            None
        } else {
            draw(smooth, elastic, noise[1], options.draw_ratio).map_err(file)?
        };
        let (last, end) = match (&draw, is_local) {
            (_, true) => (smooth.len() - 1, End::Uniform),
            (Some(draw), _) => draw_end(smooth, draw, noise[1]),
            (None, _) => uniform(uniform_end(smooth, elastic, noise[1])),
        };
        let softening = (end == End::Neck).then(|| Softening {
            rows: smooth.len() - 1 - last,
            ends: [last, smooth.len() - 1].map(|row| smooth[row]),
        });
        let mut unused = record.unused.clone();
        if let (Some(ratio), None) = (options.draw_ratio, draw) {
            unused.push(format!("--draw-ratio {ratio}, as the record shows no draw"));
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
        let after = draw.map_or(Vec::new(), |draw| second_part(&smooth[..=last], &draw, young));

        let mut dropped = cleaned.dropped;
        let used = cleaned.curve.iter().position(|row| !curve.is_toe(row[0]));
        if !is_local {
            dropped.extend(toe_rows(record, &curve, &dropped));
        }
        for row in &mut dropped {
            [row.strain, row.stress] = curve.corrected([row.strain, row.stress]);
        }
        let nominal = cleaned.curve[used.unwrap_or(0)..].iter();
        let nominal = nominal.map(|row| curve.corrected(*row)).collect();
        Ok(Self {
            path: record.path.clone(),
            read_as: record.read_as.clone(),
            stated: record.stated.clone(),
            unused,
            softening,
            hash: record.hash.clone(),
            rows: record.rows.len(),
            dropped,
            averaged: cleaned.averaged,
            linear: curve.linear,
            toe: curve.toe,
            young,
            compliance: curve.compliance,
            offset_yield,
            strength: cleaned.curve.iter().map(|row| row[1]).fold(0.0, f64::max),
            draw,
            end,
            nominal,
            before,
            after,
        })
    }

    /// Whether the record shows the break of the specimen.
    pub(super) fn broke(&self) -> bool {
        self.dropped_for(Cause::Broken) > 0
    }

    /// Number of rows dropped for a cause.
    pub fn dropped_for(&self, cause: Cause) -> usize {
        self.dropped.iter().filter(|row| row.cause == cause).count()
    }
}

/// Whether a record has true values.
fn is_local(record: &Record) -> bool {
    record.load == TrueStress || record.deformation == TrueStrain
}

/// The monotone part of a record as a nominal curve.
fn nominal_curve(record: &Record) -> Result<Cleaned, Fault> {
    let mut cleaned = cleaned(&record.rows).map_err(|line| {
        fault(
            format!("{}:{line}", record.path.display()),
            "from here on the strain falls for most of the file",
            "sort the rows by time, and give each specimen its own file",
        )
    })?;
    if is_local(record) {
        for row in &mut cleaned.curve {
            *row = nominal(record, *row);
        }
    }
    Ok(cleaned)
}

/// A nominal curve without noise, toe and compliance of the machine.
struct Compensated {
    /// [strain, stress]
    rows: Vec<[f64; 2]>,
    /// Standard deviations of the noise of strain and stress that is left.
    noise: [f64; 2],
    linear: LinearPart,
    toe: f64,
    young: f64,
    /// Compliance of the machine that is removed (1/MPa).
    compliance: f64,
    /// The first row beyond the linear part.
    elastic: usize,
}

impl Compensated {
    fn new(
        record: &Record,
        curve: &[[f64; 2]],
        noise: [f64; 2],
        options: &SpecimenOptions,
    ) -> Result<Self, String> {
        let half = half_window(curve, noise[1]);
        let noise = [noise[0], noise[1] / (2.0 * half as f64 + 1.0).sqrt()];
        let mut rows = smoothed(curve, half);
        let (mut linear, mut toe) = linear_part(&mut rows, record, noise).ok_or(
            "has no linear part: the stress does not rise with the strain; are the columns swapped?",
        )?;
        let young = check_modulus(record, &linear, options)?;
        let compliance = match linear.young / young {
            _ if !linear.is_known() => 0.0,
            ratio if ratio >= EXTENSOMETER && record.deformation != Extension => 0.0,
            _ => 1.0 / linear.young - 1.0 / young,
        };
        rows.iter_mut().for_each(|row| row[0] -= row[1] * compliance);
        if !linear.is_known() {
            // The line of the given modulus through the first row of the part.
            let first = rows.iter().find(|row| row[0] >= linear.strain[0]).unwrap_or(&rows[0]);
            let zero = first[0] - first[1] / young;
            linear.strain = [first[0] - zero; 2];
            rows.iter_mut().for_each(|row| row[0] -= zero);
            toe += zero;
        }
        let end = linear.strain[1] * (1.0 - linear.young * compliance);
        let elastic = rows.iter().position(|row| row[0] >= end).unwrap_or(0);
        Ok(Self { rows, noise, linear, toe, young, compliance, elastic })
    }

    /// A measured row without toe and compliance.
    fn corrected(&self, [strain, stress]: [f64; 2]) -> [f64; 2] {
        [strain - self.toe - stress * self.compliance, stress]
    }

    /// Whether a measured strain is below the linear part.
    fn is_toe(&self, strain: f64) -> bool {
        strain - self.toe < self.linear.strain[0]
    }
}

/// The rows below the linear part that are not dropped already.
fn toe_rows(record: &Record, curve: &Compensated, dropped: &[DroppedRow]) -> Vec<DroppedRow> {
    let known: BTreeSet<u64> = dropped.iter().map(|row| row.line).collect();
    let others = record.rows.iter().filter(|row| !known.contains(&row.line));
    let below = others.take_while(|row| curve.is_toe(row.strain));
    below
        .map(|row| DroppedRow {
            line: row.line,
            strain: row.strain,
            stress: row.stress,
            cause: Cause::Toe,
        })
        .collect()
}

/// A row [strain, stress] of a record with true values as nominal values.
fn nominal(record: &Record, [strain, stress]: [f64; 2]) -> [f64; 2] {
    let stretch = match record.deformation {
        TrueStrain => strain.exp(),
        _ => 1.0 + strain,
    };
    match record.load {
        TrueStress => [stretch - 1.0, stress / stretch],
        _ => [stretch - 1.0, stress],
    }
}

/// The linear part and the toe, which is subtracted from the curve. Its rows are found on the
/// nominal curve, whose slope is largest at the start; its modulus is the slope of the true stress
/// over the logarithmic strain, as the solver reads it.
fn linear_part(
    curve: &mut [[f64; 2]],
    record: &Record,
    noise: [f64; 2],
) -> Option<(LinearPart, f64)> {
    let nominal = LinearPart::find(curve, noise)?;
    curve.iter_mut().for_each(|row| row[0] -= nominal.toe);
    let end = nominal.first + nominal.rows;
    let yields = offset_yield(curve, nominal.young, end).filter(|_| !is_local(record));
    let rows = record.rows.iter().map(|row| true_row(&[row.strain - nominal.toe, row.stress]));
    let rows: Vec<[f64; 2]> = rows.collect();
    if let Some(metal) = yields.and_then(|yields| nominal.of_metal(&rows, yields)) {
        curve.iter_mut().for_each(|row| row[0] -= metal.toe);
        let toe = nominal.toe + metal.toe;
        return Some((metal, toe));
    }
    let last = nominal.first + nominal.rows - 1;
    let true_curve: Vec<[f64; 2]> = curve[..=last].iter().map(true_row).collect();
    let part = LinearPart::through(&true_curve, nominal.first, last)?;
    curve.iter_mut().for_each(|row| row[0] -= part.toe);
    let toe = nominal.toe + part.toe;
    Some((part, toe))
}

/// Young's modulus of the evaluation, if it is not in other units.
fn check_modulus(
    record: &Record,
    linear: &LinearPart,
    options: &SpecimenOptions,
) -> Result<f64, String> {
    let (load, deformation) = (record.load, record.deformation);
    let measured = linear.young;
    let [least, most] = YOUNG;
    if measured < least {
        return Err(format!(
            "has a modulus of {measured:.3} MPa, less than {least} MPa: {}, or {}?",
            deformation.doubt("in per cent", "%"),
            load.doubt("in GPa", "GPa")
        ));
    }
    if measured > most {
        return Err(format!(
            "has a modulus of {measured:.3e} MPa, more than {most:e} MPa: {}, or {}?",
            load.doubt("in Pa", "Pa"),
            deformation.doubt("not in per cent", "1")
        ));
    }
    let young = match options.young {
        None if !linear.is_known() => {
            return Err(format!(
                "has a modulus of {measured:.0} ± {:.0} MPa (standard error) from {} rows, whose 95 % interval reaches zero: state it with \
                 --young, or export the record without thinning",
                linear.error, linear.rows
            ));
        }
        given => given.unwrap_or(measured),
    };
    if linear.is_known() && !(SOFTER * young..=STIFFER * young).contains(&measured) {
        return Err(format!(
            "has the initial slope {measured:.0} MPa, but Young's modulus is {young:.0} MPa: a machine's compliance lowers \
             the slope by less; {}, or {}?",
            load.doubt("in another unit", "UNIT"),
            deformation.doubt("in another unit", "UNIT")
        ));
    }
    Ok(young)
}

fn check_yield_strain(record: &Record, strain: f64) -> Result<(), String> {
    let [least, most] = YIELD_STRAIN;
    if strain < least {
        return Err(format!(
            "yields at an elastic strain of {strain:.1e}, less than {least:e}: {}?",
            record.deformation.doubt("not in per cent", "1")
        ));
    }
    if strain > most {
        return Err(format!(
            "yields at an elastic strain of {strain:.2}, more than {most}: {}?",
            record.deformation.doubt("in per cent", "%")
        ));
    }
    Ok(())
}

/// Half the number of rows over which the stress is smoothed, from its noise; few enough to leave
/// the yield peak.
fn half_window(curve: &[[f64; 2]], noise: f64) -> usize {
    let maximum = curve.iter().map(|row| row[1]).fold(0.0, f64::max);
    let rise = curve.iter().position(|row| row[1] >= 0.5 * maximum);
    let needed = 0.5 * (noise / (SMOOTH * maximum).max(f64::MIN_POSITIVE)).powi(2);
    (needed as usize).min(rise.unwrap_or(0) / 4)
}

/// The curve with each stress replaced by the stress of the regression line through the rows around
/// it.
fn smoothed(curve: &[[f64; 2]], half: usize) -> Vec<[f64; 2]> {
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

/// The last row of a drawn specimen at which its deformation is uniform.
fn draw_end(curve: &[[f64; 2]], draw: &Draw, noise: f64) -> (usize, End) {
    let drawn = curve.partition_point(|row| 1.0 + row[0] < draw.draw_ratio);
    if drawn == curve.len() {
        return (drawn - 1, End::Drawing);
    }
    uniform(uniform_end(curve, drawn, noise))
}

/// The last row of a uniform deformation, and how it ended.
fn uniform((row, necks): (usize, bool)) -> (usize, End) {
    (row, if necks { End::Neck } else { End::Uniform })
}
