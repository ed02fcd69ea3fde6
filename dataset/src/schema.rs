//! The columns of the database, their units and their meanings.

use crate::error::{DatasetError, refused};
use crate::rows::Row;
use fe_driver::UnknownFailure;
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, Series};

/// What a column of a database holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ColumnMeaning {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for a text and for a number without unit.
    pub unit: &'static str,
    /// What its values are, in a phrase.
    pub meaning: &'static str,
}

/// A column of numbers, with a value in every row.
pub(crate) struct Number {
    pub name: &'static str,
    pub unit: &'static str,
    pub meaning: &'static str,
    pub get: fn(&Row) -> f64,
    pub set: fn(&mut Row, f64),
}

/// A column of text.
pub(crate) struct Text {
    pub name: &'static str,
    pub meaning: &'static str,
    pub get: fn(&Row) -> String,
    pub set: fn(&mut Row, &str) -> Result<(), String>,
}

macro_rules! numbers {
    ($($name:literal [$unit:literal] = $first:ident $(. $rest:ident)*, $meaning:literal;)*) => {
        [$(Number {
            name: $name,
            unit: $unit,
            meaning: $meaning,
            get: |row| row.$first $(.$rest)*,
            set: |row, value| row.$first $(.$rest)* = value,
        }),*]
    };
}

/// A column of text, of a field that is a text or has one.
macro_rules! text {
    ($name:literal = $first:ident $(. $rest:ident)*, $meaning:literal) => {
        Text {
            name: $name,
            meaning: $meaning,
            get: |row| row.$first $(.$rest)*.to_string(),
            set: |row, text| {
                row.$first $(.$rest)* = text.parse().map_err(|error| format!("{error}"))?;
                Ok(())
            },
        }
    };
}

pub(crate) const NUMBERS: [Number; 20] = numbers! {
    "w_lig" ["mm"] = design.w_lig, "ligament width: material between the tip of the main cut and the secondary cut";
    "alpha" ["rad"] = design.alpha, "angle between the secondary and the main cut";
    "fillet_ratio" [""] = design.fillet_ratio, "radius of the hole at the tip, over w_lig";
    "kerf" ["mm"] = design.kerf, "width that the tool removes along the main cut";
    "r_win" ["mm"] = design.r_win, "radius of the window";
    "lambda" [""] = sample.lambda, "fraction of the ray, above 0, at most 1";
    "a" ["mm"] = sample.a, "axial opening at the tip";
    "s" ["mm"] = sample.s, "shear at the tip";
    "theta" ["rad"] = sample.theta, "rotation; positive where the main cut opens";
    "W" ["N mm"] = sample.w, "internal work, stored plus dissipated";
    "W_work" ["N mm"] = sample.w_work, "work of the reactions along the ray, by the trapezoidal rule";
    "W_elastic" ["N mm"] = sample.w_elastic, "elastic part of W";
    "F_a" ["N"] = sample.f_a, "axial force";
    "F_s" ["N"] = sample.f_s, "shear force";
    "M_theta" ["N mm"] = sample.m_theta, "moment";
    "plastic_integral" ["mm^3"] = sample.plastic_integral, "equivalent plastic strain integrated over the window";
    "D" [""] = sample.d, "mean plastic strain of the ligament over the fracture strain";
    "uz_max" ["mm"] = sample.uz_max, "largest displacement out of the plane";
    "energy_residual" [""] = sample.energy_residual, "difference of W and W_work over the maximum W of the ray";
    "cpu_s" ["s"] = cpu_s, "CPU time of the whole ray, repeated in each of its rows";
};

pub(crate) const TEXTS: [Text; 9] = [
    text!("job" = job, "id of the ray: one geometry, one end"),
    Text {
        name: "failure",
        meaning: "why the ray stopped before its end; empty if it did not",
        get: |row| row.failure.map_or(String::new(), |kind| kind.to_string()),
        set: |row, text| {
            let kind = (!text.is_empty()).then(|| text.parse()).transpose();
            row.failure = kind.map_err(|error: UnknownFailure| error.to_string())?;
            Ok(())
        },
    },
    text!("material" = material, "name of the material"),
    text!("material_hash" = material_hash, "hash of the law of the material"),
    text!(
        "settings_hash" = settings_hash,
        "hash of the settings that all rays of the campaign share"
    ),
    text!("tier" = tier, "requested mesh"),
    text!("solved_tier" = solved_tier, "mesh of the row"),
    text!("gmsh" = tools.gmsh, "version of gmsh"),
    text!("ccx" = tools.ccx, "version of ccx"),
];

/// The only column of numbers that may have gaps.
pub(crate) const D_PEAK: ColumnMeaning = ColumnMeaning {
    name: "D_peak",
    unit: "",
    meaning: "plastic strain of the most strained 1 % of the ligament over the fracture strain; may be missing",
};

/// The ratios of (13). They are written for readers of the table and recomputed when it is read.
pub(crate) const RATIOS: [ColumnMeaning; 2] = [
    ColumnMeaning {
        name: "eta_a",
        unit: "",
        meaning: "a / w_lig; computed from these when a table is read",
    },
    ColumnMeaning {
        name: "eta_s",
        unit: "",
        meaning: "s / w_lig; computed from these when a table is read",
    },
];

/// Number of columns of numbers.
pub(crate) const NUMERIC: usize = NUMBERS.len() + 1 + RATIOS.len();

/// The columns of a database, in their order: the columns of text, then the columns of numbers.
pub fn columns() -> impl Iterator<Item = ColumnMeaning> {
    texts().chain(numbers())
}

/// The columns of text.
pub(crate) fn texts() -> impl Iterator<Item = ColumnMeaning> {
    TEXTS.iter().map(|column| ColumnMeaning {
        name: column.name,
        unit: "",
        meaning: column.meaning,
    })
}

/// The columns of numbers.
pub(crate) fn numbers() -> impl Iterator<Item = ColumnMeaning> {
    let given = NUMBERS.iter().map(|column| ColumnMeaning {
        name: column.name,
        unit: column.unit,
        meaning: column.meaning,
    });
    given.chain([D_PEAK]).chain(RATIOS)
}

/// The numbers of a row, in the order of [`numbers`]; NaN where it has none.
pub(crate) fn values(row: &Row) -> impl Iterator<Item = f64> {
    let given = NUMBERS.iter().map(|column| (column.get)(row));
    let peak = row.sample.d_peak.unwrap_or(f64::NAN);
    given.chain([peak]).chain(row.eta())
}

/// The unit of every column that has a unit.
pub(crate) fn units() -> impl Iterator<Item = (&'static str, &'static str)> {
    let units = numbers().map(|column| (column.name, column.unit));
    units.filter(|(_, unit)| !unit.is_empty())
}

/// The table of `rows`.
pub(crate) fn to_frame(rows: &[Row]) -> Result<DataFrame, DatasetError> {
    let mut columns: Vec<Column> = Vec::new();
    for column in &TEXTS {
        let values: Vec<String> = rows.iter().map(column.get).collect();
        columns.push(Series::new(column.name.into(), values).into_column());
    }
    for column in &NUMBERS {
        let values: Vec<f64> = rows.iter().map(column.get).collect();
        columns.push(Series::new(column.name.into(), values).into_column());
    }
    let peaks: Vec<Option<f64>> = rows.iter().map(|row| row.sample.d_peak).collect();
    columns.push(Series::new(D_PEAK.name.into(), peaks).into_column());
    for (index, ratio) in RATIOS.iter().enumerate() {
        let values: Vec<f64> = rows.iter().map(|row| row.eta()[index]).collect();
        columns.push(Series::new(ratio.name.into(), values).into_column());
    }
    Ok(DataFrame::new(rows.len(), columns)?)
}

/// The rows of a table. Every column must exist with its type, without gaps except where a value
/// may be unknown, and every number must be finite. A text that many rows share is in the table
/// once and in every row: over `most_text` bytes in all rows are refused.
pub(crate) fn from_frame(frame: &DataFrame, most_text: usize) -> Result<Vec<Row>, DatasetError> {
    let mut left = most_text;
    for column in TEXTS.iter().map(|column| column.name) {
        for (index, text) in frame.column(column)?.str()?.iter().enumerate() {
            let length = text.map_or(0, str::len);
            left = left.checked_sub(length).ok_or_else(|| {
                refused(format!(
                    "the texts of the table exceed {most_text} bytes at row {index} of the column \
                     `{column}`: the file is damaged, or made to fill the memory"
                ))
            })?;
        }
    }
    let mut rows = vec![Row::default(); frame.height()];
    for column in &TEXTS {
        fill(&mut rows, column.name, frame.column(column.name)?.str()?.iter(), column.set)?;
    }
    for column in &NUMBERS {
        let series = frame.column(column.name)?;
        fill(&mut rows, column.name, series.f64()?.iter(), |row, value| {
            (column.set)(row, value);
            Ok(())
        })?;
    }
    let peaks = frame.column(D_PEAK.name)?.f64()?.iter();
    for (row, peak) in rows.iter_mut().zip(peaks) {
        row.sample.d_peak = peak;
    }
    match rows.iter().find(|row| !is_finite(row)) {
        Some(Row { job, sample, .. }) => Err(refused(format!(
            "job {job}, lambda = {}: the row contains a number that is not finite",
            sample.lambda
        ))),
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
    set: impl Fn(&mut Row, T) -> Result<(), String>,
) -> Result<(), DatasetError> {
    for (index, (row, value)) in rows.iter_mut().zip(values).enumerate() {
        let gap = || refused(format!("column `{column}` has no value in row {index}"));
        set(row, value.ok_or_else(gap)?)
            .map_err(|error| refused(format!("column `{column}`, row {index}: {error}")))?;
    }
    Ok(())
}
