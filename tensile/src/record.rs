//! The record of one tensile test: load and deformation of every row, in MPa and as a ratio.

use crate::in_file;
use crate::name::Name;
use crate::number_table::NumberTable;
use crate::preamble::{self, StatedDimension};
use crate::quantity::Quantity::{
    self, Extension, Force, PlasticStrain, Strain, Stress, TrueStrain, TrueStress,
};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use support::fault::{Fault, fault};
use support::text_table::TextRow;

/// What a file does not say about its columns and its specimen.
#[derive(Clone, Debug, Default)]
pub struct RecordOptions {
    /// Quantities with the number or the name of their column; empty if the names of the columns
    /// are recognised.
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
    /// The file, with the number of the specimen if it has several.
    pub path: PathBuf,
    /// The rows as measured.
    pub rows: Vec<RecordRow>,
    /// Quantity of the column from which the stresses are.
    pub load: Quantity,
    /// Quantity of the column from which the strains are.
    pub deformation: Quantity,
    /// The columns that were read: load and deformation.
    pub read_as: [ReadColumn; 2],
    /// The dimensions that were read from the file.
    pub stated: Vec<StatedDimension>,
    /// What was stated and is not used, in words.
    pub unused: Vec<String>,
    /// BLAKE3 hash of the file, 16 hexadecimal digits.
    pub hash: String,
}

/// Limits of the values (dimensionless, MPa); wrong units exceed them.
const MIN_STRAIN: f64 = -0.1;
const MAX_STRAIN: f64 = 10.0;
const MAX_STRESS: f64 = 1e6;
/// A strain without unit must be smaller: it could be in per cent.
const MAX_STRAIN_WITHOUT_UNIT: f64 = 1.0;
/// Largest relative difference between an option and the dimension in a file, and the difference
/// from which on a note names it.
const CONTRADICTION: f64 = 0.1;
const SAME: f64 = 1e-3;
/// What is wrong with `1,234`, and what to do.
const THOUSANDS: &str = "has separators of thousands, or another decimal sign: save the file with one decimal sign and without \
                         separators of thousands";

/// How a column was read. It is printed as one phrase.
#[derive(Clone, Debug, Serialize)]
pub struct ReadColumn {
    /// What the column contains.
    pub quantity: Quantity,
    /// Number of the column, from 1.
    pub number: usize,
    /// Name of the column with the unit below it, empty if the file states none.
    pub name: String,
    /// The unit; `None` if neither the file nor the options state one.
    pub unit: Option<String>,
    /// The number of N, MPa, mm or 1 in a unit.
    pub factor: f64,
}

impl Record {
    /// The records of a file, one a specimen; options that name columns read one specimen.
    pub(crate) fn read_all(path: &Path, options: &RecordOptions) -> Result<Vec<Self>, Fault> {
        let (tables, hash) = NumberTable::read_all(path)?;
        let beside = |table: NumberTable| match table.side_by_side() {
            Some(tables) if options.columns.is_empty() => tables,
            _ => vec![table],
        };
        let tables: Vec<NumberTable> = tables.into_iter().flat_map(beside).collect();
        let several = tables.len() > 1;
        let named = |number: usize| match several {
            true => format!("{} (specimen {number})", path.display()).into(),
            false => path.to_owned(),
        };
        let numbered = tables.iter().zip(1..);
        numbered.map(|(table, number)| Self::new(&named(number), table, options, &hash)).collect()
    }

    fn new(
        path: &Path,
        table: &NumberTable,
        options: &RecordOptions,
        hash: &str,
    ) -> Result<Self, Fault> {
        let refuse = in_file(path);
        let columns = columns(&table.labels, options).map_err(refuse)?;
        let [load, deformation] = pair(&columns, &table.labels).map_err(refuse)?;
        let load = &ReadColumn::new(load, &table.labels, options).map_err(refuse)?;
        let deformation = &ReadColumn::new(deformation, &table.labels, options).map_err(refuse)?;
        let Sizes { area, length, stated, mut unused } =
            Sizes::new([load.quantity, deformation.quantity], table, options).map_err(refuse)?;
        let used = [load.quantity, deformation.quantity];
        for (quantity, unit) in options.units.iter().filter(|(of, _)| !used.contains(of)) {
            unused.push(format!("--units {quantity}={unit}"));
        }
        for (index, label) in table.labels.iter().enumerate() {
            let read = [load.number, deformation.number].contains(&(index + 1));
            let chosen = columns.iter().any(|(_, at)| *at == index);
            if !read && (chosen || Name::of(label).is_near_quantity()) {
                unused.push(format!("column {}", title(index, label)));
            }
        }
        let at = |row: &TextRow, what: String| {
            fault(format!("{}:{}", path.display(), row.line), what, "")
        };
        for column in [load, deformation] {
            if let Some(row) = table.thousands(column.number - 1) {
                let what = format!("column {} {THOUSANDS}", column.title());
                return Err(at(row, what));
            }
        }
        let mut rows = Vec::with_capacity(table.rows.len());
        for row in &table.rows {
            let refuse = |what| at(row, what);
            if let Some(text) = table.beyond(row) {
                return Err(refuse(format!(
                    "`{text}` is beyond the last of {} columns: save the file with semicolons or tabs between the columns, \
                     or give every column a name",
                    table.labels.len()
                )));
            }
            let number = |column: &ReadColumn| {
                table.number(row, column.number - 1).map_err(|text| {
                    let text = text.escape_debug();
                    let what = format!("`{text}` in column {} is not a number", column.title());
                    refuse(if is_grouped(&text.to_string()) {
                        format!("{what}: it {THOUSANDS}")
                    } else {
                        format!("{what}: correct the cell or delete the line; a unit belongs in the column's name")
                    })
                })
            };
            let read = RecordRow {
                line: row.line,
                strain: number(deformation)? * deformation.factor / length,
                stress: number(load)? * load.factor / area,
            };
            read.check(load.quantity, deformation.quantity).map_err(refuse)?;
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
                deformation.title()
            )));
        }
        Ok(Self {
            path: path.to_owned(),
            rows,
            load: load.quantity,
            deformation: deformation.quantity,
            read_as: [load.clone(), deformation.clone()],
            stated,
            unused,
            hash: hash.to_owned(),
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

impl ReadColumn {
    /// The unit is given by the options, or else by the label.
    fn new(
        (quantity, index): (Quantity, usize),
        labels: &[String],
        options: &RecordOptions,
    ) -> Result<Self, String> {
        let label = &labels[index];
        let given = options.units.iter().find(|(of, _)| *of == quantity);
        let name = Name::of(label);
        let unit = given.map_or_else(|| name.unit(quantity), |(_, unit)| Ok(Some(unit)));
        let refuse = |unit: &str, why: &str| {
            let (title, units) = (title(index, label), quantity.units());
            format!(
                "has the {quantity} in column {title}{unit}{why}; state one of {units} with --units {quantity}=UNIT"
            )
        };
        let unknown =
            |unit: &str| refuse(&format!(": `{unit}`"), " is no unit of it that is known");
        let unit = unit.map_err(unknown)?;
        let factor = match unit {
            Some(unit) => quantity.factor(unit).ok_or_else(|| unknown(unit))?,
            None if quantity == Force => return Err(refuse("", " without a unit")),
            None => 1.0,
        };
        let name = label.clone();
        Ok(Self { quantity, number: index + 1, unit: unit.map(str::to_owned), name, factor })
    }

    fn title(&self) -> String {
        title(self.number - 1, &self.name)
    }
}

impl fmt::Display for ReadColumn {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} from column {}, ", self.quantity, self.title())?;
        match &self.unit {
            Some(unit) => write!(f, "in {unit}"),
            None => write!(f, "no unit stated: taken as {}", self.quantity.own_unit()),
        }
    }
}

/// Number and name of a column.
fn title(index: usize, label: &str) -> String {
    match label {
        "" => format!("{}", index + 1),
        label => format!("{} `{label}`", index + 1),
    }
}

/// Whether a text is a number with signs between groups of digits, as in `1,234.5` or `1'234`.
fn is_grouped(text: &str) -> bool {
    let sign = |c: char| c.is_whitespace() || ".,'’".contains(c);
    text.contains(sign) && text.replace(sign, "").parse::<f64>().is_ok()
}

/// Section (mm^2) and gauge length (mm) by which load and deformation are divided, 1 for a stress
/// and a strain.
struct Sizes {
    area: f64,
    length: f64,
    /// Those that are from the file.
    stated: Vec<StatedDimension>,
    /// What is not used, in words.
    unused: Vec<String>,
}

impl Sizes {
    /// The options decide; a file that contradicts them is refused.
    fn new(
        [load, deformation]: [Quantity; 2],
        table: &NumberTable,
        options: &RecordOptions,
    ) -> Result<Self, String> {
        let (in_file, mut unused) = preamble::dimensions(&table.preamble, table.style);
        let near = match &unused[..] {
            [] => String::new(),
            lines => format!("; not taken for one: {}", lines.join(", ")),
        };
        let (mut missing, mut stated) = (Vec::new(), Vec::new());
        let mut size = |needed: bool, name: &str, given: Option<f64>| {
            let found = in_file.iter().find(|it| it.name == name).copied();
            match given.or(found.map(|it| it.value)) {
                _ if !needed => {
                    unused.extend(found.iter().map(StatedDimension::to_string));
                    // The thickness is the sheet's too.
                    let option = given.filter(|_| name != "thickness");
                    unused.extend(option.map(|_| format!("--{name}")));
                    Ok(1.0)
                }
                Some(value) if !(value > 0.0 && value.is_finite()) => {
                    Err(format!("needs a positive --{name} (mm), not {value}"))
                }
                Some(value) => {
                    let apart = found.map_or(0.0, |it| (it.value / value - 1.0).abs());
                    if let Some(found) = found.filter(|_| apart > CONTRADICTION) {
                        let what = format!("states {found}, against --{name} {value}");
                        return Err(format!("{what}: correct one of them"));
                    }
                    match found.filter(|_| apart > SAME) {
                        Some(found) => unused.push(found.to_string()),
                        None => stated.extend(found),
                    }
                    Ok(value)
                }
                None => {
                    missing.push(format!("--{name}"));
                    Ok(1.0)
                }
            }
        };
        let (force, extension) = (load == Force, deformation == Extension);
        let area =
            size(force, "width", options.width)? * size(force, "thickness", options.thickness)?;
        let length = size(extension, "gauge-length", options.gauge_length)?;
        if missing.is_empty() {
            return Ok(Self { area, length, stated, unused });
        }
        let contains = match (force, extension) {
            (true, true) => "a force and a length change",
            (true, false) => "a force",
            _ => "a length change",
        };
        let options = missing.join(", ");
        Err(format!("contains {contains}: give {options} of the specimen (mm){near}"))
    }
}

/// The columns that the options name, or else all that are recognised; those with words that are not
/// known only if there are no others.
fn columns(labels: &[String], options: &RecordOptions) -> Result<Vec<(Quantity, usize)>, String> {
    if options.columns.is_empty() {
        let names = || labels.iter().map(|label| Name::of(label)).enumerate();
        let all =
            || names().filter_map(|(index, name)| Some((name.quantity()?, index, name.is_known())));
        let better = |load: bool| all().any(|(of, _, known)| known && of.is_load() == load);
        let best = all().filter(|(of, _, known)| *known || !better(of.is_load()));
        return Ok(best.map(|(quantity, index, _)| (quantity, index)).collect());
    }
    let named = |(quantity, text): &(Quantity, String)| {
        let by_name = (labels.iter()).position(|label| label.eq_ignore_ascii_case(text));
        let number = (text.parse().ok()).filter(|n| (1..=labels.len()).contains(n));
        let index = by_name.or(number.map(|n| n - 1)).ok_or_else(|| {
            let columns = listed(labels);
            format!("has no column `{text}`: its columns are {columns}")
        })?;
        Ok((*quantity, index))
    };
    options.columns.iter().map(named).collect()
}

/// The column of the load and the column of the deformation. Stress is preferred to force, and
/// strain to extension.
fn pair(
    columns: &[(Quantity, usize)],
    labels: &[String],
) -> Result<[(Quantity, usize); 2], String> {
    let one = |quantities: &[Quantity]| {
        let found = quantities.iter().find_map(|quantity| {
            let mut columns = columns.iter().filter(|(of, _)| of == quantity);
            Some((*columns.next()?, columns.next()))
        });
        match found {
            Some(((quantity, first), Some((_, second)))) => Err(format!(
                "has the {quantity} in the columns {} and {}: choose one with --columns {quantity}=NUMBER and another for \
                 the {}",
                title(first, &labels[first]),
                title(*second, &labels[*second]),
                if quantity.is_load() { "strain" } else { "stress" }
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
