//! The columns of the database and their units.

use crate::error::DatasetError;
use crate::rows::Row;
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, Series};

/// A column of numbers, with a value in every row.
pub(crate) struct Number {
    pub name: &'static str,
    pub unit: &'static str,
    pub get: fn(&Row) -> f64,
    pub set: fn(&mut Row, f64),
}

/// The column of D_peak, the only one of numbers that may have gaps.
pub(crate) const D_PEAK: &str = "D_peak";

/// A column of text.
pub(crate) struct Text {
    pub name: &'static str,
    pub get: fn(&Row) -> &str,
    pub set: fn(&mut Row, String),
}

macro_rules! numbers {
    ($($name:literal [$unit:literal] = $first:ident $(. $rest:ident)*;)*) => {
        [$(Number {
            name: $name,
            unit: $unit,
            get: |row| row.$first $(.$rest)*,
            set: |row, value| row.$first $(.$rest)* = value,
        }),*]
    };
}

macro_rules! texts {
    ($($name:ident)*) => {
        [$(Text {
            name: stringify!($name),
            get: |row| &row.$name,
            set: |row, value| row.$name = value,
        }),*]
    };
}

pub(crate) const NUMBERS: [Number; 20] = numbers! {
    "w_lig" ["mm"] = design.w_lig;
    "alpha" ["rad"] = design.alpha;
    "fillet_ratio" [""] = design.fillet_ratio;
    "kerf" ["mm"] = design.kerf;
    "r_win" ["mm"] = design.r_win;
    "lambda" [""] = sample.lambda;
    "a" ["mm"] = sample.a;
    "s" ["mm"] = sample.s;
    "theta" ["rad"] = sample.theta;
    "W" ["N mm"] = sample.w;
    "W_work" ["N mm"] = sample.w_work;
    "W_elastic" ["N mm"] = sample.w_elastic;
    "F_a" ["N"] = sample.f_a;
    "F_s" ["N"] = sample.f_s;
    "M_theta" ["N mm"] = sample.m_theta;
    "plastic_integral" ["mm^3"] = sample.plastic_integral;
    "D" [""] = sample.d;
    "uz_max" ["mm"] = sample.uz_max;
    "energy_residual" [""] = sample.energy_residual;
    "cpu_s" ["s"] = cpu_s;
};

pub(crate) const TEXTS: [Text; 9] = texts! {
    job failure material material_hash settings_hash tier solved_tier gmsh ccx
};

/// The ratios of (13). They are written for readers of the table and recomputed when it is read.
pub(crate) const RATIOS: [&str; 2] = ["eta_a", "eta_s"];

/// The unit of every column that has a unit.
pub(crate) fn units() -> impl Iterator<Item = (&'static str, &'static str)> {
    let numbers = NUMBERS.iter().map(|column| (column.name, column.unit));
    numbers.filter(|(_, unit)| !unit.is_empty())
}

/// The table of `rows`.
pub(crate) fn to_frame(rows: &[Row]) -> Result<DataFrame, DatasetError> {
    let mut columns: Vec<Column> = Vec::new();
    for column in &TEXTS {
        let values: Vec<&str> = rows.iter().map(column.get).collect();
        columns.push(Series::new(column.name.into(), values).into_column());
    }
    for column in &NUMBERS {
        let values: Vec<f64> = rows.iter().map(column.get).collect();
        columns.push(Series::new(column.name.into(), values).into_column());
    }
    let peaks: Vec<Option<f64>> = rows.iter().map(|row| row.sample.d_peak).collect();
    columns.push(Series::new(D_PEAK.into(), peaks).into_column());
    for (index, name) in RATIOS.into_iter().enumerate() {
        let values: Vec<f64> = rows.iter().map(|row| row.eta()[index]).collect();
        columns.push(Series::new(name.into(), values).into_column());
    }
    Ok(DataFrame::new(rows.len(), columns)?)
}

/// The rows of a table. Every column must exist with its type, without gaps except where a value may be unknown, and
/// every number must be finite. A text that many rows share is in the table once and in every row: over `most_text` bytes
/// in all rows are refused.
pub(crate) fn from_frame(frame: &DataFrame, most_text: usize) -> Result<Vec<Row>, DatasetError> {
    let mut left = most_text;
    for column in TEXTS.iter().map(|column| column.name) {
        for (index, text) in frame.column(column)?.str()?.iter().enumerate() {
            let length = text.map_or(0, str::len);
            left = left.checked_sub(length).ok_or(DatasetError::LongText {
                column,
                index,
                most: most_text,
            })?;
        }
    }
    let mut rows = vec![Row::default(); frame.height()];
    for column in &TEXTS {
        let texts = frame.column(column.name)?.str()?.iter();
        let owned = texts.map(|text| text.map(str::to_owned));
        fill(&mut rows, column.name, owned, column.set)?;
    }
    for column in &NUMBERS {
        let series = frame.column(column.name)?;
        fill(&mut rows, column.name, series.f64()?.iter(), column.set)?;
    }
    let peaks = frame.column(D_PEAK)?.f64()?.iter();
    for (row, peak) in rows.iter_mut().zip(peaks) {
        row.sample.d_peak = peak;
    }
    match rows.iter().find(|row| !is_finite(row)) {
        Some(row) => Err(DatasetError::NotFinite {
            job: row.job.clone(),
            lambda: row.sample.lambda,
        }),
        None => Ok(rows),
    }
}

/// Whether every number of the row is finite.
pub(crate) fn is_finite(row: &Row) -> bool {
    let mut numbers = NUMBERS.iter().map(|column| (column.get)(row));
    numbers.all(f64::is_finite) && row.sample.d_peak.is_none_or(f64::is_finite)
}

fn fill<T>(
    rows: &mut [Row],
    column: &'static str,
    values: impl IntoIterator<Item = Option<T>>,
    set: impl Fn(&mut Row, T),
) -> Result<(), DatasetError> {
    for (index, (row, value)) in rows.iter_mut().zip(values).enumerate() {
        set(row, value.ok_or(DatasetError::Gap { column, index })?);
    }
    Ok(())
}
