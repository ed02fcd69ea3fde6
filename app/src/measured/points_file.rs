//! The CSV file of measured points; errors name file, line and column.

use analysis::measured_points::{Mark, MeasuredPoint};
use anyhow::{Context, Result, anyhow, bail, ensure};
use design::geometry::similarity::Scale;
use std::{collections::HashMap, path::Path};
use support::{
    csv_table::{NamedTable, name_and_unit},
    nearest::nearest,
};

/// The columns of a file; the last two come from the template, and are not read.
const COLUMNS: [&str; 7] = ["panel", "corner", "x", "y", "unit", "flat_x_mm", "flat_y_mm"];

/// Length of the unit of measured lengths (mm); `None` for pixels of a picture, whose scale is not
/// known.
type LengthUnit = Option<f64>;

/// The points of a file.
#[derive(Debug)]
pub(super) struct PointsFile {
    /// Measured points in mm, or in pixels.
    pub(super) points: Vec<MeasuredPoint>,
    unit: LengthUnit,
}

impl PointsFile {
    /// Reads a file of points of a sheet with so many panels; lengths are in mm, or in the unit of
    /// the column `unit`.
    pub(super) fn read(path: &Path, panels: usize, y_down: bool) -> Result<Self> {
        let NamedTable { head, rows } =
            NamedTable::read(path).map_err(|error| anyhow!("cannot read {error}"))?;
        let located = |line: u64| format!("{}:{line}", path.display());
        let columns = PointColumns::new(&head.1).with_context(|| located(head.0))?;
        let mut file = Self { points: Vec::new(), unit: Some(1.0) };
        let mut lines = HashMap::new();
        for (line, row) in rows {
            let Some((mut point, own)) = columns.point(&row).with_context(|| located(line))? else {
                continue;
            };
            let mark = point.mark;
            ensure!(
                mark.panel < panels,
                "{}: {mark}: the sheet has the panels 0 to {}",
                located(line),
                panels - 1
            );
            if let Some(first) = lines.insert(mark, line) {
                bail!("{}: {mark} is measured twice, first in line {first}", located(line));
            }
            let own = own.unwrap_or(file.unit);
            ensure!(
                file.points.is_empty() || own.is_some() == file.unit.is_some(),
                "{}: column `unit`: pixels and lengths are mixed",
                located(line)
            );
            file.unit = own;
            point.position = point.position.map(|x| x * own.unwrap_or(1.0));
            if y_down {
                point.position[1] *= -1.0;
            }
            file.points.push(point);
        }
        Ok(file)
    }

    /// Whether the scale of the points is known: the scale of pixels is not.
    pub(super) fn scale(&self) -> Scale {
        if self.unit.is_some() { Scale::Given } else { Scale::Free }
    }
}

/// The unit of this name in a column.
fn unit(column: &str, name: &str) -> Result<LengthUnit> {
    Ok(match &*name.to_lowercase() {
        "mm" => Some(1.0),
        "cm" => Some(10.0),
        "m" => Some(1000.0),
        "px" => None,
        _ => bail!("column `{column}`: `{name}` is none of mm, cm, m, px"),
    })
}

/// Places of the columns in a row.
struct PointColumns {
    panel: usize,
    corner: Option<usize>,
    position: [usize; 2],
    unit: Option<usize>,
    /// The unit behind the name `x`.
    unit_of_x: Option<LengthUnit>,
}

impl PointColumns {
    fn new(header: &csv::StringRecord) -> Result<Self> {
        let (names, units): (Vec<String>, Vec<String>) = header.iter().map(name_and_unit).unzip();
        for name in names.iter().map(String::as_str) {
            if !COLUMNS.contains(&name) {
                let hint = match nearest(name, COLUMNS) {
                    Some(known) => format!("did you mean `{known}`?"),
                    None => "the columns are panel, corner, x, y and unit, separated by commas, semicolons or tabs"
                        .to_owned(),
                };
                bail!("unknown column `{name}`; {hint}");
            }
        }
        let place = |name: &str| names.iter().position(|found| found == name);
        let needed =
            |name: &str| place(name).with_context(|| format!("the column `{name}` is missing"));
        let position = [needed("x")?, needed("y")?];
        let [of_x, of_y] = position.map(|column| units[column].as_str());
        ensure!(
            of_x == of_y,
            "the columns `x` and `y` have the units `{of_x}` and `{of_y}`: give both in one"
        );
        Ok(Self {
            panel: needed("panel")?,
            corner: place("corner"),
            position,
            unit: place("unit"),
            unit_of_x: (!of_x.is_empty()).then(|| unit("x", of_x)).transpose()?,
        })
    }

    /// The point of a row and its unit; `None` if the point was not measured, with empty x and y.
    fn point(
        &self,
        row: &csv::StringRecord,
    ) -> Result<Option<(MeasuredPoint, Option<LengthUnit>)>> {
        let text = |column: usize| row.get(column).unwrap_or_default();
        if self.position.iter().all(|&column| text(column).is_empty()) {
            return Ok(None);
        }
        let whole = |column: usize, name: &str| -> Result<usize> {
            let value = text(column);
            let number = value.strip_prefix('P').unwrap_or(value);
            number.parse().ok().with_context(|| {
                let hint = match name {
                    "corner" => ": corners count 0 to 3 counter-clockwise from the lower left one in the flat sheet",
                    _ => "",
                };
                format!("column `{name}`: `{value}` is not a whole number of 0 or more{hint}")
            })
        };
        let length = |axis: usize| -> Result<f64> {
            let value = text(self.position[axis]);
            let number = value.parse().ok().filter(|x: &f64| x.is_finite());
            number.with_context(|| {
                let (name, value) = (["x", "y"][axis], value.escape_debug());
                format!("column `{name}`: `{value}` is not a finite number")
            })
        };
        let corner = self.corner.filter(|&column| !text(column).is_empty());
        let own = self.unit.map(|column| unit("unit", text(column))).transpose()?;
        let mark = Mark {
            panel: whole(self.panel, "panel")?,
            corner: corner.map(|column| whole(column, "corner")).transpose()?,
        };
        ensure!(
            mark.corner.is_none_or(|corner| corner < 4),
            "{mark}: a panel has the corners 0 to 3"
        );
        let position = [length(0)?, length(1)?];
        Ok(Some((MeasuredPoint { mark, position }, own.or(self.unit_of_x))))
    }
}
