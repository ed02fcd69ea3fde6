//! The columns of the database, their units and their meanings.

use crate::rays::samples;
use fe_driver::SolvedRay;
use hinge::HingeSample;
use polars::prelude::{
    Column, DataFrame, IntoColumn, NamedFrom, PolarsError, PolarsResult, Series,
};
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

/// Getter and setter of a column.
#[derive(Debug)]
enum Value {
    /// A text of a ray, which all of its rows have.
    Text(fn(&SolvedRay) -> String, fn(&mut SolvedRay, &str) -> Result<(), String>),
    /// A number of a ray, which all of its rows have.
    OfRay(fn(&SolvedRay) -> f64, fn(&mut SolvedRay, f64)),
    /// A number of a sample. One that a default sample lacks may be missing: D_peak.
    OfSample(fn(&HingeSample) -> Option<f64>, fn(&mut HingeSample, f64)),
    /// A ratio of (13). It is written for readers of the table and recomputed when it is read.
    Ratio(usize),
}

impl ColumnMeaning {
    const fn new([name, unit, meaning]: [&'static str; 3], value: Value) -> Self {
        Self { name, unit, meaning, value }
    }

    /// The number in the row of a sample; `None` if it is missing, and in a column of text.
    pub(crate) fn number(&self, ray: &SolvedRay, sample: &HingeSample) -> Option<f64> {
        match self.value {
            Value::Text(..) => None,
            Value::OfRay(get, _) => Some(get(ray)),
            Value::OfSample(get, _) => get(sample),
            Value::Ratio(index) => Some(sample.deformation().eta(ray.design.w_lig)[index]),
        }
    }

    /// The value in the row of a sample as text, empty if it is missing.
    pub(crate) fn text(&self, ray: &SolvedRay, sample: &HingeSample) -> String {
        match self.value {
            Value::Text(get, _) => get(ray),
            _ => self.number(ray, sample).map_or(String::new(), |number| number.to_string()),
        }
    }

    pub(crate) fn is_text(&self) -> bool {
        matches!(self.value, Value::Text(..))
    }
}

macro_rules! of_ray {
    ($name:literal [$unit:literal] = $first:ident $(. $rest:ident)*, $meaning:literal) => {
        ColumnMeaning::new(
            [$name, $unit, $meaning],
            Value::OfRay(|ray| ray.$first $(.$rest)*, |ray, value| ray.$first $(.$rest)* = value),
        )
    };
}

macro_rules! of_sample {
    ($name:literal [$unit:literal] = $field:ident, $meaning:literal) => {
        ColumnMeaning::new(
            [$name, $unit, $meaning],
            Value::OfSample(|sample| Some(sample.$field), |sample, value| sample.$field = value),
        )
    };
}

macro_rules! text {
    ($name:literal = $first:ident $(. $rest:ident)*, $meaning:literal) => {
        ColumnMeaning::new(
            [$name, "", $meaning],
            Value::Text(
                |ray| ray.$first $(.$rest)*.to_string(),
                |ray, text| {
                    ray.$first $(.$rest)* = text.parse().map_err(|error| format!("{error}"))?;
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
            |ray| ray.failure.map_or(String::new(), |kind| kind.to_string()),
            |ray, text| {
                let kind = (!text.is_empty()).then(|| text.parse()).transpose();
                ray.failure = kind.map_err(|error: Fault| error.to_string())?;
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
    of_ray!(
        "w_lig"["mm"] = design.w_lig,
        "ligament width: material between the tip of the main cut and the secondary cut"
    ),
    of_ray!("alpha"["rad"] = design.alpha, "angle between the secondary and the main cut"),
    of_ray!("fillet_ratio"[""] = design.fillet_ratio, "radius of the hole at the tip, over w_lig"),
    of_ray!("kerf"["mm"] = design.kerf, "width that the tool removes along the main cut"),
    of_ray!("r_win"["mm"] = design.r_win, "radius of the window"),
    of_sample!("lambda"[""] = lambda, "fraction of the ray, above 0, at most 1"),
    of_sample!("a"["mm"] = a, "axial opening at the tip"),
    of_sample!("s"["mm"] = s, "shear at the tip"),
    of_sample!("theta"["rad"] = theta, "rotation; positive where the main cut opens"),
    of_sample!("W"["N mm"] = w, "internal work, stored plus dissipated"),
    of_sample!(
        "W_work"["N mm"] = w_work,
        "work of the reactions along the ray, by the trapezoidal rule"
    ),
    of_sample!("W_elastic"["N mm"] = w_elastic, "elastic part of W"),
    of_sample!("F_a"["N"] = f_a, "axial force"),
    of_sample!("F_s"["N"] = f_s, "shear force"),
    of_sample!("M_theta"["N mm"] = m_theta, "moment"),
    of_sample!(
        "plastic_integral"["mm^3"] = plastic_integral,
        "equivalent plastic strain integrated over the window"
    ),
    of_sample!("D"[""] = d, "mean plastic strain of the ligament over the fracture strain"),
    of_sample!("uz_max"["mm"] = uz_max, "largest displacement out of the plane"),
    of_sample!(
        "energy_residual"[""] = energy_residual,
        "difference of W and W_work over the maximum W of the ray"
    ),
    of_ray!("cpu_s"["s"] = cpu_s, "CPU time of the whole ray, repeated in each of its rows"),
    ColumnMeaning::new(
        [
            "D_peak",
            "",
            "plastic strain of the most strained 1 % of the ligament over the fracture strain; may be missing",
        ],
        Value::OfSample(|sample| sample.d_peak, |sample, peak| sample.d_peak = Some(peak)),
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

/// The error of a table with other columns or types.
pub(crate) fn no_table(error: PolarsError) -> Fault {
    fault!("the table is not a valid database: {error}")
}

/// The table of rays: a row a sample.
pub(crate) fn to_frame(rays: &[SolvedRay]) -> PolarsResult<DataFrame> {
    let rows = samples(rays);
    let column = |column: &ColumnMeaning| -> Column {
        let (name, rows) = (column.name.into(), rows.clone());
        let series = match column.value {
            Value::Text(get, _) => {
                Series::new(name, rows.map(|(ray, _)| get(ray)).collect::<Vec<_>>())
            }
            _ => {
                let numbers = rows.map(|(ray, sample)| column.number(ray, sample));
                Series::new(name, numbers.collect::<Vec<_>>())
            }
        };
        series.into_column()
    };
    DataFrame::new(rows.clone().count(), COLUMNS.iter().map(column).collect())
}

/// The rays of a table: rows one after the other with the same job. Every column must exist with
/// its type, without gaps except where a value may be unknown, and every number must be finite. A
/// text that many rows share is in the file once, and in every row where a table is made: over
/// `most_text` bytes in all rows are refused.
pub(crate) fn from_frame(frame: &DataFrame, most_text: usize) -> Result<Vec<SolvedRay>, Fault> {
    let mut left = most_text;
    let texts = |name| frame.column(name).and_then(Column::str).map_err(no_table);
    let numbers = |name| frame.column(name).and_then(Column::f64).map_err(no_table);
    let jobs = texts("job")?;
    let is_first = |row: &usize| *row == 0 || jobs.get(*row) != jobs.get(row - 1);
    let starts: Vec<usize> = (0..frame.height()).filter(is_first).collect();
    let ends = starts.iter().skip(1).copied().chain([frame.height()]);
    let ray = |(start, end): (&usize, usize)| SolvedRay {
        samples: vec![HingeSample::default(); end - start],
        ..SolvedRay::default()
    };
    let mut rays: Vec<SolvedRay> = std::iter::zip(&starts, ends).map(ray).collect();
    let one_a_ray = |name: &str, same: &dyn Fn(usize) -> bool| -> Result<(), Fault> {
        if let Some(row) = (1..frame.height()).find(|row| !is_first(row) && !same(*row)) {
            refuse!("column `{name}`, row {row}: the rows of a job have different values");
        }
        Ok(())
    };
    for ColumnMeaning { name, value, .. } in &COLUMNS {
        let gap = |row| fault!("column `{name}` has no value in row {row}");
        match value {
            Value::Text(_, set) => {
                let texts = texts(name)?;
                one_a_ray(name, &|row| texts.get(row) == texts.get(row - 1))?;
                for (ray, &row) in rays.iter_mut().zip(&starts) {
                    let text = texts.get(row).ok_or_else(|| gap(row))?;
                    left = left.checked_sub(text.len() * ray.samples.len()).ok_or_else(|| {
                        fault!(
                            "the texts of the table exceed {most_text} bytes at row {row} of the \
                             column `{name}`: the file is damaged, or made to fill the memory"
                        )
                    })?;
                    set(ray, text)
                        .map_err(|error| fault!("column `{name}`, row {row}: {error}"))?;
                }
            }
            Value::OfRay(_, set) => {
                let numbers = numbers(name)?;
                one_a_ray(name, &|row| numbers.get(row) == numbers.get(row - 1))?;
                for (ray, &row) in rays.iter_mut().zip(&starts) {
                    set(ray, numbers.get(row).ok_or_else(|| gap(row))?);
                }
            }
            Value::OfSample(get, set) => {
                let samples = rays.iter_mut().flat_map(|ray| &mut ray.samples);
                for (row, (sample, number)) in samples.zip(numbers(name)?.iter()).enumerate() {
                    match number {
                        Some(number) => set(sample, number),
                        None if get(sample).is_none() => {}
                        None => return Err(gap(row)),
                    }
                }
            }
            Value::Ratio(_) => {}
        }
    }
    let bad = samples(&rays).find(|(ray, sample)| !is_finite(ray, sample));
    if let Some((SolvedRay { job, .. }, HingeSample { lambda, .. })) = bad {
        refuse!("job {job}, lambda = {lambda}: the row contains a number that is not finite");
    }
    Ok(rays)
}

/// Whether every number in the row of a sample is finite.
pub(crate) fn is_finite(ray: &SolvedRay, sample: &HingeSample) -> bool {
    COLUMNS.iter().all(|column| column.number(ray, sample).is_none_or(f64::is_finite))
}
