//! The record of one tensile test: load and deformation of every row, in MPa and as a ratio.

use crate::in_file;
use crate::name::Name;
use crate::number_table::{self, NumberTable, StatedDimension};
use crate::quantity::Quantity::{
    self, Extension, Force, PlasticStrain, Strain, Stress, TrueStrain, TrueStress,
};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use support::text_table::TextRow;
use support::{Fault, Joined, fault};

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

/// Why a row is not used.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exclusion {
    /// Unloading and reloading up to the strain before it.
    Unloading,
    /// After the break of the specimen.
    Broken,
    /// Slack and toe, below the linear part.
    Toe,
}

/// One row of a record.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RecordRow {
    /// Number of the line in the file, from 1.
    pub line: u64,
    /// Nominal strain.
    pub strain: f64,
    /// Nominal stress (MPa).
    pub stress: f64,
    /// Why the row is not used, if it is not.
    pub cause: Option<Exclusion>,
}

/// The curve of one specimen in the units of the project.
#[derive(Debug)]
pub(super) struct Record {
    /// The file, with the number of the specimen if it has several.
    pub path: PathBuf,
    /// The rows as measured.
    pub rows: Vec<RecordRow>,
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
const STRESS: [f64; 2] = [-1e6, 1e6];
/// A strain without unit must be smaller: it could be in per cent.
const MAX_STRAIN_WITHOUT_UNIT: f64 = 1.0;
/// Largest relative difference between an option and the dimension in a file, and the difference
/// from which on a note names it.
const CONTRADICTION: f64 = 0.1;
const SAME: f64 = 1e-3;
/// How a column was read. It is printed as one phrase.
#[derive(Debug, Serialize)]
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
        let (labels, path) = (&table.labels, path.to_owned());
        let columns = columns(labels, options).map_err(refuse)?;
        let pair = pair(&columns, labels).map_err(refuse)?;
        let column = |index: usize| ReadColumn::new(pair[index], labels, options).map_err(refuse);
        let read_as = [column(0)?, column(1)?];
        let used = pair.map(|(quantity, _)| quantity);
        let (stated, mut unused) = number_table::dimensions(&table.preamble, table.style);
        let (sizes, stated) = sizes(used, stated, &mut unused, options).map_err(refuse)?;
        let units = options.units.iter().filter(|(of, _)| !used.contains(of));
        unused.extend(units.map(|(quantity, unit)| format!("--units {quantity}={unit}")));
        for (index, label) in labels.iter().enumerate() {
            let chosen = columns.iter().any(|(_, at)| *at == index);
            let read = pair.iter().any(|(_, at)| *at == index);
            if !read && (chosen || Name::of(label).is_near_quantity()) {
                unused.push(format!("column {}", title(index, label)));
            }
        }
        let at = |row: &TextRow| {
            let (path, line) = (path.display(), row.line);
            move |what: String| fault!("{path}:{line}: {what}")
        };
        for column in &read_as {
            if let Some(row) = table.thousands(column.number - 1) {
                return Err(at(row)(format!(
                    "column {} has separators of thousands, or another decimal sign: save the file with one decimal sign and \
                     without separators of thousands",
                    column.title()
                )));
            }
        }
        let rows =
            table.rows.iter().map(|row| read_row(table, row, &read_as, sizes).map_err(at(row)));
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        if read_as[1].quantity == PlasticStrain {
            return Err(refuse(
                "contains plastic strains: it is a hardening table already; write its rows into `plastic` of the material file"
                    .into(),
            ));
        }
        Ok(Self { path, rows, read_as, stated, unused, hash: hash.to_owned() })
    }

    /// Whether the file has true values, which are not searched for a neck.
    pub(super) fn is_local(&self) -> bool {
        self.read_as.iter().any(|column| matches!(column.quantity, TrueStress | TrueStrain))
    }
}

/// The nominal values of a row, whose load and deformation are divided by `sizes`.
fn read_row(
    table: &NumberTable,
    row: &TextRow,
    read_as: &[ReadColumn; 2],
    sizes: [f64; 2],
) -> Result<RecordRow, String> {
    if let Some(text) = table.beyond(row) {
        return Err(format!(
            "`{text}` is beyond the last of {} columns: save the file with semicolons or tabs between the columns, \
             or give every column a name",
            table.labels.len()
        ));
    }
    let number = |of: usize| {
        let column = &read_as[of];
        let number = table.number(row, column.number - 1).map_err(|text| {
            format!(
                "`{}` in column {} is not a number: correct the cell (one decimal sign, no separators of thousands; a unit \
                 belongs in the column's name) or delete the line",
                text.escape_debug(),
                column.title()
            )
        })?;
        Ok::<_, String>(number * column.factor / sizes[of])
    };
    let [mut stress, mut strain] = [number(0)?, number(1)?];
    let (name, most) = match (read_as[1].quantity, &read_as[1].unit) {
        (Strain, None) => (
            "strain without a unit (state one in the column's name or with --units strain=1)",
            MAX_STRAIN_WITHOUT_UNIT,
        ),
        _ => ("strain", MAX_STRAIN),
    };
    within(read_as, name, strain, [MIN_STRAIN, most], [["", "%"]; 2])?;
    within(read_as, "stress (MPa)", stress, STRESS, [["Pa", ""]; 2])?;
    if read_as[1].quantity == TrueStrain {
        strain = strain.exp_m1();
    }
    if read_as[0].quantity == TrueStress {
        stress /= 1.0 + strain;
    }
    Ok(RecordRow { line: row.line, strain, stress, cause: None })
}

/// Refuses a value outside of its limits; `units` of load and deformation would explain one below
/// and one above, empty if none would.
pub(super) fn within(
    read_as: &[ReadColumn; 2],
    name: &str,
    value: f64,
    [least, most]: [f64; 2],
    units: [[&str; 2]; 2],
) -> Result<(), String> {
    let (than, limit, units) = match value {
        value if value < least => ("less", least, units[0]),
        value if value > most => ("more", most, units[1]),
        _ => return Ok(()),
    };
    let suspects = read_as.iter().zip(units).filter(|(_, unit)| !unit.is_empty());
    let doubts: String =
        suspects.map(|(column, unit)| column.quantity.doubt(unit) + ", or ").collect();
    Err(format!(
        "violates the limits of the {name}, as {value:.3e} is {than} than {limit}: {doubts}are the columns swapped?"
    ))
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
        let factor = match unit {
            Ok(Some(unit)) => quantity.factor(unit).ok_or(Some(unit)),
            Ok(None) if quantity == Force => Err(None),
            Ok(None) => Ok(1.0),
            Err(unit) => Err(Some(unit)),
        };
        let factor = factor.map_err(|unit| {
            let (title, units) = (title(index, label), quantity.units());
            let unknown = |unit| format!(": `{unit}` is no unit of it that is known");
            let why = unit.map_or(" without a unit".into(), unknown);
            format!(
                "has the {quantity} in column {title}{why}; state one of {units} with --units {quantity}=UNIT"
            )
        })?;
        let unit = unit.unwrap_or_default().map(str::to_owned);
        let name = label.clone();
        Ok(Self { quantity, number: index + 1, unit, name, factor })
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
    let number = index + 1;
    if label.is_empty() { number.to_string() } else { format!("{number} `{label}`") }
}

/// Section (mm^2) and gauge length (mm) by which load and deformation are divided, 1 for a stress
/// and a strain, and the dimensions in the file that are used for them. The options decide; a file
/// that contradicts them is refused.
fn sizes(
    [load, deformation]: [Quantity; 2],
    stated: Vec<StatedDimension>,
    unused: &mut Vec<String>,
    options: &RecordOptions,
) -> Result<([f64; 2], Vec<StatedDimension>), String> {
    let near = unused.join(", ");
    let needed = [(load == Force, "a force"), (deformation == Extension, "a length change")];
    let (mut sizes, mut missing, mut used) = ([1.0; 2], Vec::new(), Vec::new());
    for (of, name, given) in [
        (0, "width", options.width),
        (0, "thickness", options.thickness),
        (1, "gauge-length", options.gauge_length),
    ] {
        let option = format!("--{name}");
        let found = stated.iter().find(|it| it.name == name);
        match given.or(found.map(|it| it.value)) {
            _ if !needed[of].0 => {
                unused.extend(found.map(ToString::to_string));
                // The thickness is the sheet's too.
                unused.extend(given.filter(|_| name != "thickness").map(|_| option));
            }
            None => missing.push(option),
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                return Err(format!("needs a positive {option} (mm), not {value}"));
            }
            Some(value) => {
                sizes[of] *= value;
                let apart = found.map_or(0.0, |it| (it.value / value - 1.0).abs());
                match found {
                    Some(found) if apart > CONTRADICTION => {
                        let what = format!("states {found}, against {option} {value}");
                        return Err(what + ": correct one of them");
                    }
                    Some(found) if apart > SAME => unused.push(found.to_string()),
                    found => used.extend(found.copied()),
                }
            }
        }
    }
    if missing.is_empty() {
        return Ok((sizes, used));
    }
    let read = needed.iter().filter(|(is, _)| *is).map(|(_, name)| *name);
    let near = if near.is_empty() { near } else { format!("; not taken for one: {near}") };
    Err(format!(
        "contains {}: give {} of the specimen (mm){near}",
        read.joined(" and "),
        missing.join(", ")
    ))
}

/// The columns that the options name, or else all that are recognised; those with words that are not
/// known only if there are no others.
fn columns(labels: &[String], options: &RecordOptions) -> Result<Vec<(Quantity, usize)>, String> {
    if options.columns.is_empty() {
        let names = labels.iter().enumerate().map(|(index, label)| (Name::of(label), index));
        let all =
            names.filter_map(|(name, index)| Some((name.quantity()?, index, name.is_known())));
        let all: Vec<(Quantity, usize, bool)> = all.collect();
        let known = |load| all.iter().any(|(of, _, known)| *known && of.is_load() == load);
        let best = all.iter().filter(|(of, _, is_known)| *is_known || !known(of.is_load()));
        return Ok(best.map(|(quantity, index, _)| (*quantity, *index)).collect());
    }
    let named = |(quantity, text): &(Quantity, String)| {
        let same = |(index, label): &(usize, &String)| {
            label.eq_ignore_ascii_case(text) || (index + 1).to_string() == *text
        };
        let found = labels.iter().enumerate().find(same);
        let (index, _) = found
            .ok_or_else(|| format!("has no column `{text}`: its columns are {}", listed(labels)))?;
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
    let what = match (nominal, local) {
        (Some(pair), None) | (None, Some(pair)) => return Ok(pair.into()),
        (Some(_), Some(_)) => "both engineering and true values",
        (None, None) => "no pair of stress (or force) and strain (or extension)",
    };
    Err(format!(
        "has the columns {}, {what}: choose two with --columns, such as --columns strain=1,stress=2",
        listed(labels)
    ))
}

/// Number and name of each column.
fn listed(labels: &[String]) -> String {
    labels.iter().enumerate().map(|(index, label)| title(index, label)).joined(", ")
}
