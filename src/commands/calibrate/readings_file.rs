//! The CSV file of displacements and loads, of one sheet or of the specimens of a coupon; errors name file and line.

use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use csv::StringRecord;
use design::analysis::data_error::{DataError, ReadingFault};
use design::analysis::measurements::LoadData;
use hinge::STANDARD_GRAVITY;
use std::path::{Path, PathBuf};
use support::csv_table;
use support::nearest::nearest;

/// A column of a table.
struct Column {
    name: &'static str,
    displacement: bool,
    /// Whether it is of translations and forces.
    translational: bool,
    /// mm or rad, N or N mm.
    unit: f64,
}

const fn column(name: &'static str, displacement: bool, translational: bool, unit: f64) -> Column {
    Column {
        name,
        displacement,
        translational,
        unit,
    }
}

/// A length along the loads whose first reading is before them.
const DISTANCE: &str = "distance_mm";
const SPECIMEN: &str = "specimen";
const COLUMNS: [Column; 6] = [
    column("displacement_mm", true, true, 1.0),
    column(DISTANCE, true, true, 1.0),
    column(
        "displacement_deg",
        true,
        false,
        std::f64::consts::PI / 180.0,
    ),
    column("load_N", false, true, 1.0),
    column("load_Nmm", false, false, 1.0),
    column("mass_g", false, true, 1e-3 * STANDARD_GRAVITY),
];

/// The readings of a sheet in a file.
pub(super) struct ReadingsFile {
    path: PathBuf,
    /// (displacement, load): mm and N, or rad and N mm.
    readings: Vec<[f64; 2]>,
    translational: bool,
    from_reading: bool,
    /// The line of every reading.
    lines: Vec<u64>,
}

/// What the columns of a file are.
struct Header {
    path: PathBuf,
    /// Places of displacement and load.
    columns: [(usize, &'static Column); 2],
    /// Place of the name of the specimen.
    specimen: Option<usize>,
    /// Whether the decimal sign may be a comma.
    comma: bool,
}

impl ReadingsFile {
    /// The readings of one sheet.
    pub fn read(path: &Path) -> Result<Self> {
        let (header, records) = Header::read(path)?;
        ensure!(
            header.specimen.is_none(),
            "{} has a column `{SPECIMEN}`: name the folder of the coupon, not a scene",
            path.display()
        );
        let mut rows = Vec::new();
        for record in &records {
            rows.extend(header.row(record)?);
        }
        header.sheet(&rows)
    }

    /// The readings of the specimens of a coupon that have any, each with the place of its name in `names`.
    pub fn read_specimens(path: &Path, names: &[String]) -> Result<Vec<(usize, Self)>> {
        let (header, records) = Header::read(path)?;
        let place = header.specimen.with_context(|| {
            format!(
                "{} has no column `{SPECIMEN}`: {}",
                path.display(),
                names.join(", ")
            )
        })?;
        let mut rows = vec![Vec::new(); names.len()];
        for record in &records {
            let name = record.get(place).unwrap_or_default();
            let known = names.iter().position(|own| own == name);
            let known = known.with_context(|| {
                let near = nearest(name, names.iter().map(String::as_str));
                let near = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
                format!(
                    "{}: the coupon has no specimen `{name}`: use {}{near}",
                    header.at(line_of(record)),
                    names.join(", ")
                )
            })?;
            rows[known].extend(header.row(record)?);
        }
        let read = rows.iter().enumerate().filter(|(_, rows)| !rows.is_empty());
        let found: Vec<(usize, Self)> = read
            .map(|(specimen, rows)| Ok((specimen, header.sheet(rows)?)))
            .collect::<Result<_>>()?;
        ensure!(!found.is_empty(), "{} has no readings", path.display());
        Ok(found)
    }

    /// The data with a standard error, relative to the largest reading.
    pub fn data(&self, error: f64) -> LoadData {
        LoadData {
            readings: self.readings.clone(),
            translational: self.translational,
            error,
            from_reading: self.from_reading,
        }
    }

    /// The error with the name of the file and, for a reading, its line.
    pub fn located(&self, error: &DataError) -> Error {
        match error {
            DataError::Reading { index, fault } => self.at_reading(*index, fault),
            error => anyhow!("{}: {error}", self.path.display()),
        }
    }

    fn at_reading(&self, index: usize, fault: &ReadingFault) -> Error {
        anyhow!("{}:{}: {fault}", self.path.display(), self.lines[index])
    }
}

/// A reading with its line.
type Row = (u64, [f64; 2]);

impl Header {
    fn read(path: &Path) -> Result<(Self, Vec<StringRecord>)> {
        let (mut reader, separator) =
            csv_table::open(path).with_context(|| format!("cannot read {}", path.display()))?;
        let broken = |error: csv::Error| Error::from(error).context(path.display().to_string());
        let names = reader.headers().map_err(broken)?.clone();
        let place = |name: &str| names.iter().position(|own| own == name);
        let one = |displacement: bool| -> Result<(usize, &'static Column)> {
            let known = || {
                COLUMNS
                    .iter()
                    .filter(|column| column.displacement == displacement)
            };
            let found: Vec<_> = known()
                .filter_map(|column| Some((place(column.name)?, column)))
                .collect();
            let names: Vec<&str> = known().map(|column| column.name).collect();
            ensure!(
                found.len() == 1,
                "{} has {} columns of the {}: write one, {}",
                path.display(),
                found.len(),
                if displacement { "displacement" } else { "load" },
                names.join(" or ")
            );
            Ok(found[0])
        };
        let columns = [one(true)?, one(false)?];
        let [translational, other] = columns.map(|(_, column)| column.translational);
        ensure!(
            translational == other,
            "{}: displacement_mm and {DISTANCE} go with load_N or mass_g, displacement_deg with load_Nmm",
            path.display()
        );
        let header = Self {
            path: path.to_owned(),
            columns,
            specimen: place(SPECIMEN),
            comma: separator != b',',
        };
        let records = reader.records().collect::<Result<_, _>>().map_err(broken)?;
        Ok((header, records))
    }

    /// A row of the table; `None` if it is that of a specimen and its displacement is empty: it was not read.
    fn row(&self, record: &StringRecord) -> Result<Option<Row>> {
        let line = line_of(record);
        let number = |(place, column): (usize, &Column)| -> Result<f64> {
            let text = record.get(place).unwrap_or_default();
            let plain = match self.comma {
                false => text.to_owned(),
                true => text.replace(',', "."),
            };
            let number: Option<f64> = plain.parse().ok();
            let number = number.filter(|number| number.is_finite());
            let number = number.with_context(|| {
                format!(
                    "{}: column `{}`: `{text}` is not a number",
                    self.at(line),
                    column.name
                )
            })?;
            Ok(number * column.unit)
        };
        let [displacement, load] = self.columns;
        let is_empty = record.get(displacement.0).unwrap_or_default().is_empty();
        if is_empty && self.specimen.is_some() {
            return Ok(None);
        }
        Ok(Some((line, [number(displacement)?, number(load)?])))
    }

    /// The readings of one sheet from its rows.
    fn sheet(&self, rows: &[Row]) -> Result<ReadingsFile> {
        let [(_, displacement), _] = self.columns;
        let from_reading = displacement.name == DISTANCE;
        let rows = if from_reading {
            self.since_first(rows)?
        } else {
            rows.to_vec()
        };
        ensure!(!rows.is_empty(), "{} has no readings", self.path.display());
        if let Some((line, _)) = rows.iter().find(|(_, reading)| *reading == [0.0; 2]) {
            bail!(
                "{}: displacement and load are 0: leave the sheet before its loads out",
                self.at(*line)
            );
        }
        Ok(ReadingsFile {
            path: self.path.clone(),
            readings: rows.iter().map(|(_, reading)| *reading).collect(),
            translational: displacement.translational,
            from_reading,
            lines: rows.iter().map(|(line, _)| *line).collect(),
        })
    }

    /// Distances less the first, which is before the loads.
    fn since_first(&self, rows: &[Row]) -> Result<Vec<Row>> {
        let Some((&(line, [first, load]), loaded)) = rows.split_first() else {
            return Ok(Vec::new());
        };
        if load != 0.0 {
            let swapped = rows.iter().any(|(_, [distance, _])| *distance == 0.0);
            bail!(
                "{}: distances begin with that before the loads, in a row with a load of 0{}",
                self.at(line),
                if swapped {
                    "; the columns of distance and load seem to be swapped"
                } else {
                    ""
                }
            );
        }
        ensure!(
            !loaded.is_empty(),
            "{}: a distance before the loads alone says nothing: write one under a load below it",
            self.at(line)
        );
        let moved = loaded
            .iter()
            .map(|(line, [distance, load])| (*line, [distance - first, *load]));
        Ok(moved.collect())
    }

    fn at(&self, line: u64) -> String {
        format!("{}:{line}", self.path.display())
    }
}

fn line_of(record: &StringRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
}
