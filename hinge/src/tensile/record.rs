//! The record of one tensile test: load and deformation of every row, in MPa and as a ratio.

use crate::tensile::error::TensileError;
use crate::tensile::number_table::NumberTable;
use crate::tensile::quantity::Quantity::{
    Extension, Force, PlasticStrain, Strain, Stress, TrueStrain, TrueStress,
};
use crate::tensile::quantity::{Quantity, unit_of};
use std::path::{Path, PathBuf};

/// What a file does not say about its columns and its specimen.
#[derive(Clone, Debug, Default)]
pub struct RecordOptions {
    /// Quantities with the number or the name of their column; empty if the names of the columns are recognised.
    pub columns: Vec<(Quantity, String)>,
    /// Quantities with their unit, instead of that in the names of the columns.
    pub units: Vec<(Quantity, String)>,
    /// Initial gauge length (mm); needed for an extension in mm.
    pub gauge_length: Option<f64>,
    /// Width of the specimen (mm); needed for a force.
    pub width: Option<f64>,
    /// Thickness of the specimen (mm); needed for a force.
    pub thickness: Option<f64>,
}

/// One row of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RecordRow {
    /// Number of the line in the file, from 1.
    pub line: u64,
    /// Deformation, dimensionless.
    pub strain: f64,
    /// Load per area (MPa).
    pub stress: f64,
}

/// The curve of one specimen in the units of the project.
#[derive(Clone, Debug)]
pub(super) struct Record {
    /// The file.
    pub path: PathBuf,
    /// The rows as measured.
    pub rows: Vec<RecordRow>,
    /// Quantity of the column from which the stresses are.
    pub load: Quantity,
    /// Quantity of the column from which the strains are.
    pub deformation: Quantity,
    /// The columns and the units that were read, in words.
    pub read_as: String,
    /// BLAKE3 hash of the file, 16 hexadecimal digits.
    pub hash: String,
}

/// Limits of the values (dimensionless, MPa); wrong units exceed them.
const MIN_STRAIN: f64 = -0.1;
const MAX_STRAIN: f64 = 10.0;
const MAX_STRESS: f64 = 1e6;
/// A strain without unit must be smaller: it could be in per cent.
const MAX_STRAIN_WITHOUT_UNIT: f64 = 1.0;

/// A column with the factor to the units of the project.
struct Column {
    quantity: Quantity,
    index: usize,
    label: String,
    /// `None` if neither the file nor the options state one.
    unit: Option<String>,
    factor: f64,
}

impl Record {
    pub fn read(path: &Path, options: &RecordOptions) -> Result<Self, TensileError> {
        let refuse = |what| TensileError::File {
            path: path.to_owned(),
            what,
        };
        let table = NumberTable::read(path)?;
        let columns = columns(&table, options).map_err(refuse)?;
        let [load, deformation] = pair(&columns, &table.labels).map_err(refuse)?;
        let area = match load.quantity {
            Force => {
                dimension(options.width, "width").map_err(refuse)?
                    * dimension(options.thickness, "thickness").map_err(refuse)?
            }
            _ => 1.0,
        };
        let length = match deformation.quantity {
            Extension => dimension(options.gauge_length, "gauge-length").map_err(refuse)?,
            _ => 1.0,
        };
        let mut rows = Vec::with_capacity(table.rows.len());
        for row in &table.rows {
            let refuse = |what| TensileError::Row {
                path: path.to_owned(),
                line: row.line,
                what,
            };
            let number = |column: &Column| {
                table.number(row, column.index).map_err(|text| {
                    refuse(format!(
                        "`{text}` in column {} is not a number: correct the cell or delete the line",
                        column.name()
                    ))
                })
            };
            let read = RecordRow {
                line: row.line,
                strain: number(deformation)? * deformation.factor / length,
                stress: number(load)? * load.factor / area,
            };
            read.check(load.quantity, deformation.quantity)
                .map_err(refuse)?;
            rows.push(read);
        }
        let most = rows.iter().map(|row| row.strain).fold(0.0, f64::max);
        if deformation.quantity == Strain
            && deformation.unit.is_none()
            && most > MAX_STRAIN_WITHOUT_UNIT
        {
            return Err(refuse(format!(
                "has strains up to {most} in column {} without a unit: state it in the column's name, as in `strain (%)` or \
                 `strain (1)`, or with --units strain=% or --units strain=1",
                deformation.name()
            )));
        }
        Ok(Self {
            path: path.to_owned(),
            rows,
            load: load.quantity,
            deformation: deformation.quantity,
            read_as: format!("{}, {}", load.read_as(), deformation.read_as()),
            hash: table.hash,
        })
    }
}

impl RecordRow {
    fn check(&self, load: Quantity, deformation: Quantity) -> Result<(), String> {
        let Self { strain, stress, .. } = self;
        if !(MIN_STRAIN..=MAX_STRAIN).contains(strain) {
            return Err(format!(
                "strain = {strain} violates {MIN_STRAIN} <= strain <= {MAX_STRAIN}: {}, or are the columns swapped?",
                deformation.doubt("in per cent", "%")
            ));
        }
        if stress.abs() > MAX_STRESS {
            return Err(format!(
                "stress = {stress:e} MPa violates |stress| <= {MAX_STRESS:e} MPa: {}?",
                load.doubt("in Pa", "Pa")
            ));
        }
        Ok(())
    }
}

impl Column {
    fn name(&self) -> String {
        match self.label.as_str() {
            "" => format!("{}", self.index + 1),
            label => format!("{} `{label}`", self.index + 1),
        }
    }

    fn read_as(&self) -> String {
        let unit = match &self.unit {
            Some(unit) => format!("in {unit}"),
            None => format!(
                "taken as {}",
                self.quantity.units().split(',').next().unwrap_or_default()
            ),
        };
        format!("{} from column {}, {unit}", self.quantity, self.name())
    }
}

/// A dimension of the specimen that is needed, in mm.
fn dimension(given: Option<f64>, option: &str) -> Result<f64, String> {
    match given {
        Some(value) if value > 0.0 && value.is_finite() => Ok(value),
        Some(value) => Err(format!("needs a positive --{option} (mm), not {value}")),
        None => Err(format!(
            "contains a {}: give --{option} of the specimen (mm)",
            if option == "gauge-length" {
                "length change"
            } else {
                "force"
            }
        )),
    }
}

/// The columns that the options name, or else all that are recognised.
fn columns(table: &NumberTable, options: &RecordOptions) -> Result<Vec<Column>, String> {
    let recognised = || {
        let labels = table.labels.iter().enumerate();
        labels
            .filter_map(|(index, label)| Some((Quantity::from_label(label)?, index)))
            .collect()
    };
    let named = |(quantity, text): &(Quantity, String)| {
        let by_name = table
            .labels
            .iter()
            .position(|label| label.eq_ignore_ascii_case(text));
        let number = text
            .parse()
            .ok()
            .filter(|n| (1..=table.labels.len()).contains(n));
        let index = by_name.or(number.map(|n| n - 1));
        let index = index.ok_or_else(|| {
            format!(
                "has no column `{text}`: its columns are {}",
                listed(&table.labels)
            )
        })?;
        Ok((*quantity, index))
    };
    let chosen: Vec<(Quantity, usize)> = if options.columns.is_empty() {
        recognised()
    } else {
        let named = options.columns.iter().map(named);
        named.collect::<Result<_, String>>()?
    };
    chosen
        .into_iter()
        .map(|(quantity, index)| {
            let label = table.labels[index].clone();
            let given = options.units.iter().find(|(of, _)| *of == quantity);
            let unit = given.map(|(_, unit)| unit.clone()).or_else(|| unit_of(&label));
            let factor = match &unit {
                None => 1.0,
                Some(unit) => quantity.factor(unit).ok_or_else(|| {
                    format!(
                        "has the {quantity} in column {} in `{unit}`, which is not one of {}: state it with \
                         --units {quantity}=UNIT",
                        index + 1,
                        quantity.units()
                    )
                })?,
            };
            Ok(Column {
                quantity,
                index,
                label,
                unit,
                factor,
            })
        })
        .collect()
}

/// The column of the load and that of the deformation. Stress is preferred to force, and strain to extension.
fn pair<'a>(columns: &'a [Column], labels: &[String]) -> Result<[&'a Column; 2], String> {
    let one = |quantities: &[Quantity]| {
        let found = quantities.iter().find_map(|quantity| {
            let mut columns = columns.iter().filter(|column| column.quantity == *quantity);
            Some((columns.next()?, columns.next()))
        });
        match found {
            Some((first, Some(second))) => Err(format!(
                "has the {} in the columns {} and {}: choose one with --columns {}=NUMBER and another for the {}",
                first.quantity,
                first.name(),
                second.name(),
                first.quantity,
                if first.quantity.is_load() {
                    "strain"
                } else {
                    "stress"
                }
            )),
            found => Ok(found.map(|(column, _)| column)),
        }
    };
    let nominal = one(&[Stress, Force])?.zip(one(&[Strain, Extension])?);
    let local = one(&[TrueStress])?.zip(one(&[PlasticStrain, TrueStrain])?);
    match (nominal, local) {
        (Some((load, deformation)), None) | (None, Some((load, deformation))) => {
            Ok([load, deformation])
        }
        (Some(_), Some(_)) => Err(format!(
            "has both engineering and true values in the columns {}: choose two with --columns, such as \
             --columns strain=1,stress=2",
            listed(labels)
        )),
        (None, None) => Err(format!(
            "has the columns {}: no pair of stress (or force) and strain (or extension) is recognised; choose two \
             with --columns, such as --columns strain=1,stress=2 or --columns extension=1,force=2",
            listed(labels)
        )),
    }
}

/// Number and name of each column.
fn listed(labels: &[String]) -> String {
    let named = |(index, label): (usize, &String)| match label.as_str() {
        "" => format!("{} (without name)", index + 1),
        label => format!("{} `{label}`", index + 1),
    };
    let columns: Vec<String> = labels.iter().enumerate().map(named).collect();
    columns.join(", ")
}
