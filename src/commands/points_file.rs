//! The CSV file of measured points; errors name file, line and column.

use anyhow::{Context, Error, Result, anyhow, bail};
use clap::ValueEnum;
use design::analysis::marks::{Mark, MeasuredPoint};
use design::analysis::measured_sheet::{MeasurementError, PointFault};
use design::geometry::similarity::Scale;
use std::path::{Path, PathBuf};
use support::csv_table;
use support::nearest::nearest;

/// The columns of a file; the last two come from the template, and are not read.
const COLUMNS: [&str; 7] = [
    "panel",
    "corner",
    "x",
    "y",
    "unit",
    "flat_x_mm",
    "flat_y_mm",
];

/// Unit of measured lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Unit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Pixels of a picture, whose scale is not known.
    Px,
}

/// The points of a file.
#[derive(Debug)]
pub(super) struct PointsFile {
    path: PathBuf,
    /// Measured points in mm, or in pixels.
    pub points: Vec<MeasuredPoint>,
    /// The line of every point.
    lines: Vec<u64>,
    unit: Unit,
}

impl Unit {
    /// Length of the unit (mm); 1 for a pixel.
    fn length(self) -> f64 {
        match self {
            Self::Mm | Self::Px => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
        }
    }
}

impl PointsFile {
    /// Reads a file whose lengths are in mm, or in the unit of its column `unit`.
    pub fn read(path: &Path, y_down: bool) -> Result<Self> {
        let (mut reader, separator) =
            csv_table::open(path).with_context(|| format!("cannot read {}", path.display()))?;
        let broken = |error: csv::Error| Error::from(error).context(path.display().to_string());
        let header = reader.headers().map_err(broken)?.clone();
        let columns = Columns::new(&header, separator != b',')
            .with_context(|| format!("{}:{}", path.display(), line_of(&header)))?;
        let mut file = Self {
            path: path.to_owned(),
            points: Vec::new(),
            lines: Vec::new(),
            unit: Unit::Mm,
        };
        for record in reader.records() {
            let record = record.map_err(broken)?;
            let line = line_of(&record);
            let located = || format!("{}:{line}", path.display());
            let Some((mut point, own)) = columns.point(&record).with_context(located)? else {
                continue;
            };
            let own = own.unwrap_or(file.unit);
            let pixels = |unit: Unit| unit == Unit::Px;
            if !file.points.is_empty() && pixels(own) != pixels(file.unit) {
                bail!("{}: column `unit`: pixels and lengths are mixed", located());
            }
            file.unit = own;
            point.position = point.position.map(|x| x * own.length());
            if y_down {
                point.position[1] *= -1.0;
            }
            file.points.push(point);
            file.lines.push(line);
        }
        Ok(file)
    }

    /// Whether the scale of the points is known: the scale of pixels is not.
    pub fn scale(&self) -> Scale {
        match self.unit {
            Unit::Px => Scale::Free,
            _ => Scale::Given,
        }
    }

    /// The error with the name of the file, and the line of the point that it concerns.
    pub fn located(&self, error: MeasurementError) -> Error {
        let path = self.path.display();
        match error {
            MeasurementError::Point { index, mark, fault } => {
                let line = self.lines[index];
                match fault {
                    PointFault::Repeated { first } => {
                        anyhow!(
                            "{path}:{line}: {mark} is measured twice, first in line {}",
                            self.lines[first]
                        )
                    }
                    fault => anyhow!("{path}:{line}: {mark}: {fault}"),
                }
            }
            error => anyhow!("{path}: {error}"),
        }
    }
}

fn line_of(record: &csv::StringRecord) -> u64 {
    record.position().map_or(1, csv::Position::line)
}

/// Places of the columns in a row.
struct Columns {
    /// Whether numbers may have a decimal comma.
    decimal_comma: bool,
    panel: usize,
    corner: Option<usize>,
    position: [usize; 2],
    unit: Option<usize>,
}

impl Columns {
    fn new(header: &csv::StringRecord, decimal_comma: bool) -> Result<Self> {
        for name in header {
            if !COLUMNS.contains(&name) {
                let hint = match nearest(name, COLUMNS) {
                    Some(known) => format!("did you mean `{known}`?"),
                    None => "the columns are panel, corner, x, y and unit, separated by commas, semicolons or tabs"
                        .to_owned(),
                };
                bail!("unknown column `{name}`; {hint}");
            }
        }
        let place = |name: &str| header.iter().position(|found| found == name);
        let needed =
            |name: &str| place(name).with_context(|| format!("the column `{name}` is missing"));
        Ok(Self {
            decimal_comma,
            panel: needed("panel")?,
            corner: place("corner"),
            position: [needed("x")?, needed("y")?],
            unit: place("unit"),
        })
    }

    /// The point of a row and its unit; `None` if the point was not measured, with empty x and y.
    fn point(&self, row: &csv::StringRecord) -> Result<Option<(MeasuredPoint, Option<Unit>)>> {
        let text = |column: usize| row.get(column).unwrap_or_default();
        if self.position.iter().all(|&column| text(column).is_empty()) {
            return Ok(None);
        }
        let whole = |column: usize, name: &str| -> Result<usize> {
            let value = text(column);
            let number = value.strip_prefix('P').unwrap_or(value);
            number.parse().ok().with_context(|| {
                format!("column `{name}`: `{value}` is not a whole number of 0 or more")
            })
        };
        let length = |axis: usize| -> Result<f64> {
            let value = text(self.position[axis]);
            let number = match self.decimal_comma {
                true => value.replace(',', "."),
                false => value.to_owned(),
            };
            number.parse().ok().with_context(|| {
                let name = ["x", "y"][axis];
                format!("column `{name}`: `{value}` is not a number")
            })
        };
        let corner = self.corner.filter(|&column| !text(column).is_empty());
        let unit = self.unit.map(|column| {
            Unit::from_str(text(column), true)
                .map_err(|_| anyhow!("column `unit`: `{}` is none of mm, cm, m, px", text(column)))
        });
        let mark = Mark {
            panel: whole(self.panel, "panel")?,
            corner: corner.map(|column| whole(column, "corner")).transpose()?,
        };
        let position = [length(0)?, length(1)?];
        Ok(Some((MeasuredPoint { mark, position }, unit.transpose()?)))
    }
}
