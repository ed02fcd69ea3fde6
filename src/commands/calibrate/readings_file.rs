//! The CSV file of displacements and loads; errors name file and line.

use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use design::analysis::calibration::ReadingFault;
use hinge::STANDARD_GRAVITY;
use std::path::{Path, PathBuf};
use support::csv_table;

/// The columns, whether they are displacements, and their unit in mm or rad, N or N mm.
const COLUMNS: [(&str, bool, f64); 5] = [
    ("displacement_mm", true, 1.0),
    ("displacement_deg", true, std::f64::consts::PI / 180.0),
    ("load_N", false, 1.0),
    ("load_Nmm", false, 1.0),
    ("mass_g", false, 1e-3 * STANDARD_GRAVITY),
];

/// The readings of a file.
pub(super) struct ReadingsFile {
    path: PathBuf,
    /// (displacement, load): mm and N, or rad and N mm.
    pub readings: Vec<[f64; 2]>,
    /// The line of every reading.
    lines: Vec<u64>,
}

impl ReadingsFile {
    pub fn read(path: &Path) -> Result<Self> {
        let (mut reader, separator) =
            csv_table::open(path).with_context(|| format!("cannot read {}", path.display()))?;
        let broken = |error: csv::Error| Error::from(error).context(path.display().to_string());
        let header = reader.headers().map_err(broken)?.clone();
        let column = |displacement: bool| {
            let named = header.iter().enumerate().find_map(|(place, name)| {
                let known = COLUMNS.iter().find(|known| known.0 == name);
                known
                    .filter(|known| known.1 == displacement)
                    .map(|known| (place, name.to_owned(), known.2))
            });
            named.with_context(|| {
                let names = COLUMNS.iter().filter(|known| known.1 == displacement);
                let names: Vec<&str> = names.map(|known| known.0).collect();
                format!(
                    "{}: no column of the {}: {}",
                    path.display(),
                    if displacement { "displacement" } else { "load" },
                    names.join(" or ")
                )
            })
        };
        let columns = [column(true)?, column(false)?];
        let mut file = Self {
            path: path.to_owned(),
            readings: Vec::new(),
            lines: Vec::new(),
        };
        for record in reader.records() {
            let record = record.map_err(broken)?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |(place, name, unit): &(usize, String, f64)| -> Result<f64> {
                let text = record.get(*place).unwrap_or_default();
                let plain = match separator {
                    b',' => text.to_owned(),
                    _ => text.replace(',', "."),
                };
                let number: Option<f64> = plain.parse().ok();
                let number = number.filter(|number| number.is_finite());
                let number = number.with_context(|| {
                    format!(
                        "{}:{line}: column `{name}`: `{text}` is not a number",
                        path.display()
                    )
                })?;
                Ok(number * unit)
            };
            file.readings
                .push([number(&columns[0])?, number(&columns[1])?]);
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

    /// The error with the name of the file and the line of its reading.
    pub fn located(&self, index: usize, fault: &ReadingFault) -> Error {
        anyhow!("{}:{}: {fault}", self.path.display(), self.lines[index])
    }
}
