//! What a database holds, as text to print.

use crate::database::Database;
use crate::schema;
use crate::split::Part;
use std::fmt;

/// Counts, rejected rows, split, and the range of every column of numbers.
impl fmt::Display for Database {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let manifest = self.manifest();
        writeln!(
            f,
            "{} rows of {} rays ({} partial) over {} geometries; {}, tier {}; {:.0} CPU s",
            manifest.rows,
            manifest.rays,
            manifest.partial_rays,
            manifest.geometries,
            manifest.material,
            manifest.tier,
            manifest.cpu_s,
        )?;
        for (reason, count) in &manifest.rejected {
            writeln!(f, "rejected {count} rows: {reason:?}")?;
        }
        let rays = |part| manifest.split.jobs(part).len();
        writeln!(
            f,
            "split by geometry: {} rays for training, {} for validation, {} for test",
            rays(Part::Training),
            rays(Part::Validation),
            rays(Part::Test),
        )?;
        writeln!(
            f,
            "{:18} {:>14} {:>14}  unit",
            "column", "least", "greatest"
        )?;
        for column in &schema::NUMBERS {
            let values = || self.rows().iter().map(column.get);
            writeln!(
                f,
                "{:18} {:14.6} {:14.6}  {}",
                column.name,
                values().fold(f64::INFINITY, f64::min),
                values().fold(f64::NEG_INFINITY, f64::max),
                column.unit,
            )?;
        }
        Ok(())
    }
}
