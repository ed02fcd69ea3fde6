//! The columns of the database, their units and their meanings.

use crate::rows::Row;
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, Series};
use support::{Fault, fault, refuse};

/// What a column of a database holds.
#[derive(Debug)]
pub struct ColumnMeaning {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for a text and for a number without unit.
    pub unit: &'static str,
    /// What its values are, in a phrase.
    pub meaning: &'static str,
    value: Value,
}

/// Getter and setter of a column in a row.
#[derive(Debug)]
enum Value {
    Text(fn(&Row) -> String, fn(&mut Row, &str) -> Result<(), String>),
    Number(fn(&Row) -> f64, fn(&mut Row, f64)),
    /// D_peak, the only number that may be missing.
    Peak,
    /// A ratio of (13). It is written for readers of the table and recomputed when it is read.
    Ratio(usize),
}

impl ColumnMeaning {
    const fn new([name, unit, meaning]: [&'static str; 3], value: Value) -> Self {
        Self { name, unit, meaning, value }
    }

    /// The number in a row, NaN if it is missing; `None` in a column of text.
    pub(crate) fn number(&self, row: &Row) -> Option<f64> {
        match self.value {
            Value::Text(..) => None,
            Value::Number(get, _) => Some(get(row)),
            Value::Peak => Some(row.sample.d_peak.unwrap_or(f64::NAN)),
            Value::Ratio(index) => Some(row.eta()[index]),
        }
    }

    /// The value in a row as text, empty if it is missing.
    pub(crate) fn text(&self, row: &Row) -> String {
        match (&self.value, self.number(row)) {
            (Value::Text(get, _), _) => get(row),
            (_, number) => number
                .filter(|number| !number.is_nan())
                .map_or(String::new(), |number| number.to_string()),
        }
    }

    pub(crate) fn is_text(&self) -> bool {
        matches!(self.value, Value::Text(..))
    }
}

macro_rules! number {
    ($name:literal [$unit:literal] = $first:ident $(. $rest:ident)*, $meaning:literal) => {
        ColumnMeaning::new(
            [$name, $unit, $meaning],
            Value::Number(|row| row.$first $(.$rest)*, |row, value| row.$first $(.$rest)* = value),
        )
    };
}

macro_rules! text {
    ($name:literal = $first:ident $(. $rest:ident)*, $meaning:literal) => {
        ColumnMeaning::new(
            [$name, "", $meaning],
            Value::Text(
                |row| row.$first $(.$rest)*.to_string(),
                |row, text| {
                    row.$first $(.$rest)* = text.parse().map_err(|error| format!("{error}"))?;
                    Ok(())
                },
            ),
        )
    };
}

/// The columns of a database, in their order: the columns of text, then the columns of numbers.
pub static COLUMNS: [ColumnMeaning; 32] = [
    text!("job" = job, "id of the ray: one geometry, one end"),
    ColumnMeaning::new(
        ["failure", "", "why the ray stopped before its end; empty if it did not"],
        Value::Text(
            |row| row.failure.map_or(String::new(), |kind| kind.to_string()),
            |row, text| {
                let kind = (!text.is_empty()).then(|| text.parse()).transpose();
                row.failure = kind.map_err(|error: Fault| error.to_string())?;
                Ok(())
            },
        ),
    ),
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
    number!(
        "w_lig"["mm"] = design.w_lig,
        "ligament width: material between the tip of the main cut and the secondary cut"
    ),
    number!("alpha"["rad"] = design.alpha, "angle between the secondary and the main cut"),
    number!("fillet_ratio"[""] = design.fillet_ratio, "radius of the hole at the tip, over w_lig"),
    number!("kerf"["mm"] = design.kerf, "width that the tool removes along the main cut"),
    number!("r_win"["mm"] = design.r_win, "radius of the window"),
    number!("lambda"[""] = sample.lambda, "fraction of the ray, above 0, at most 1"),
    number!("a"["mm"] = sample.a, "axial opening at the tip"),
    number!("s"["mm"] = sample.s, "shear at the tip"),
    number!("theta"["rad"] = sample.theta, "rotation; positive where the main cut opens"),
    number!("W"["N mm"] = sample.w, "internal work, stored plus dissipated"),
    number!(
        "W_work"["N mm"] = sample.w_work,
        "work of the reactions along the ray, by the trapezoidal rule"
    ),
    number!("W_elastic"["N mm"] = sample.w_elastic, "elastic part of W"),
    number!("F_a"["N"] = sample.f_a, "axial force"),
    number!("F_s"["N"] = sample.f_s, "shear force"),
    number!("M_theta"["N mm"] = sample.m_theta, "moment"),
    number!(
        "plastic_integral"["mm^3"] = sample.plastic_integral,
        "equivalent plastic strain integrated over the window"
    ),
    number!("D"[""] = sample.d, "mean plastic strain of the ligament over the fracture strain"),
    number!("uz_max"["mm"] = sample.uz_max, "largest displacement out of the plane"),
    number!(
        "energy_residual"[""] = sample.energy_residual,
        "difference of W and W_work over the maximum W of the ray"
    ),
    number!("cpu_s"["s"] = cpu_s, "CPU time of the whole ray, repeated in each of its rows"),
    ColumnMeaning::new(
        [
            "D_peak",
            "",
            "plastic strain of the most strained 1 % of the ligament over the fracture strain; may be missing",
        ],
        Value::Peak,
    ),
    ColumnMeaning::new(
        ["eta_a", "", "a / w_lig; computed from these when a table is read"],
        Value::Ratio(0),
    ),
    ColumnMeaning::new(
        ["eta_s", "", "s / w_lig; computed from these when a table is read"],
        Value::Ratio(1),
    ),
];

/// Why a database cannot be collected, read, written or corrected.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// The table has other columns or types.
    #[error("the table is not a valid database: {0}")]
    Table(#[from] polars::error::PolarsError),
    /// Any other mistake.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// The table of `rows`.
pub(crate) fn to_frame(rows: &[Row]) -> Result<DataFrame, DatasetError> {
    let column = |column: &ColumnMeaning| -> Column {
        let (name, rows) = (column.name.into(), rows.iter());
        let series = match column.value {
            Value::Text(get, _) => Series::new(name, rows.map(get).collect::<Vec<_>>()),
            Value::Peak => Series::new(name, rows.map(|row| row.sample.d_peak).collect::<Vec<_>>()),
            _ => Series::new(name, rows.filter_map(|row| column.number(row)).collect::<Vec<_>>()),
        };
        series.into_column()
    };
    Ok(DataFrame::new(rows.len(), COLUMNS.iter().map(column).collect())?)
}

/// The rows of a table. Every column must exist with its type, without gaps except where a value
/// may be unknown, and every number must be finite. A text that many rows share is in the table
/// once and in every row: over `most_text` bytes in all rows are refused.
pub(crate) fn from_frame(frame: &DataFrame, most_text: usize) -> Result<Vec<Row>, DatasetError> {
    let mut left = most_text;
    let mut rows = vec![Row::default(); frame.height()];
    for ColumnMeaning { name, value, .. } in &COLUMNS {
        let gap = |index| fault!("column `{name}` has no value in row {index}");
        let series = frame.column(name)?;
        match value {
            Value::Text(_, set) => {
                for (index, (row, text)) in rows.iter_mut().zip(series.str()?.iter()).enumerate() {
                    let text = text.ok_or_else(|| gap(index))?;
                    left = left.checked_sub(text.len()).ok_or_else(|| {
                        fault!(
                            "the texts of the table exceed {most_text} bytes at row {index} of the \
                             column `{name}`: the file is damaged, or made to fill the memory"
                        )
                    })?;
                    set(row, text)
                        .map_err(|error| fault!("column `{name}`, row {index}: {error}"))?;
                }
            }
            Value::Number(_, set) => {
                for (index, (row, number)) in rows.iter_mut().zip(series.f64()?.iter()).enumerate()
                {
                    set(row, number.ok_or_else(|| gap(index))?);
                }
            }
            Value::Peak => {
                for (row, peak) in rows.iter_mut().zip(series.f64()?.iter()) {
                    row.sample.d_peak = peak;
                }
            }
            Value::Ratio(_) => {}
        }
    }
    match rows.iter().find(|row| !is_finite(row)) {
        Some(Row { job, sample, .. }) => refuse!(
            "job {job}, lambda = {}: the row contains a number that is not finite",
            sample.lambda
        ),
        None => Ok(rows),
    }
}

/// Whether every number of the row is finite.
pub(crate) fn is_finite(row: &Row) -> bool {
    let is_finite = |column: &ColumnMeaning| match column.value {
        Value::Number(get, _) => get(row).is_finite(),
        Value::Peak => row.sample.d_peak.is_none_or(f64::is_finite),
        _ => true,
    };
    COLUMNS.iter().all(is_finite)
}
