//! The CSV file of displacements and loads; errors name file and line.

use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use design::analysis::calibration::{CalibrationError, ReadingFault};
use hinge::STANDARD_GRAVITY;
use std::path::{Path, PathBuf};
use support::csv_table;

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

const COLUMNS: [Column; 5] = [
    column("displacement_mm", true, true, 1.0),
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

/// The readings of a file.
pub(super) struct ReadingsFile {
    path: PathBuf,
    /// (displacement, load): mm and N, or rad and N mm.
    pub readings: Vec<[f64; 2]>,
    /// Whether they are mm and N.
    pub translational: bool,
    /// The line of every reading.
    lines: Vec<u64>,
}

impl ReadingsFile {
    pub fn read(path: &Path) -> Result<Self> {
        let (mut reader, separator) =
            csv_table::open(path).with_context(|| format!("cannot read {}", path.display()))?;
        let broken = |error: csv::Error| Error::from(error).context(path.display().to_string());
        let header = reader.headers().map_err(broken)?.clone();
        let one = |displacement: bool| -> Result<(usize, &Column)> {
            let known = || {
                COLUMNS
                    .iter()
                    .filter(|column| column.displacement == displacement)
            };
            let place = |column: &Column| header.iter().position(|name| name == column.name);
            let found: Vec<_> = known()
                .filter_map(|column| Some((place(column)?, column)))
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
            "{}: displacement_mm goes with load_N or mass_g, displacement_deg with load_Nmm",
            path.display()
        );
        let mut file = Self {
            path: path.to_owned(),
            readings: Vec::new(),
            translational,
            lines: Vec::new(),
        };
        for record in reader.records() {
            let record = record.map_err(broken)?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |(place, column): (usize, &Column)| -> Result<f64> {
                let text = record.get(place).unwrap_or_default();
                let plain = match separator {
                    b',' => text.to_owned(),
                    _ => text.replace(',', "."),
                };
                let number: Option<f64> = plain.parse().ok();
                let number = number.filter(|number| number.is_finite());
                let number = number.with_context(|| {
                    format!(
                        "{}:{line}: column `{}`: `{text}` is not a number",
                        path.display(),
                        column.name
                    )
                })?;
                Ok(number * column.unit)
            };
            file.readings
                .push([number(columns[0])?, number(columns[1])?]);
            file.lines.push(line);
        }
        ensure!(
            !file.readings.is_empty(),
            "{} has no readings",
            path.display()
        );
        if let Some(pair) = file
            .readings
            .iter()
            .position(|reading| *reading == [0.0; 2])
        {
            bail!(
                "{}:{}: displacement and load are 0: leave the sheet before its loads out",
                path.display(),
                file.lines[pair]
            );
        }
        Ok(file)
    }

    /// The error with the name of the file.
    pub fn of_file(&self, error: &CalibrationError) -> Error {
        anyhow!("{}: {error}", self.path.display())
    }

    /// The error with the name of the file and the line of its reading.
    pub fn located(&self, index: usize, fault: &ReadingFault) -> Error {
        anyhow!("{}:{}: {fault}", self.path.display(), self.lines[index])
    }
}
