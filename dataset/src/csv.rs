//! CSV export of a database.

use crate::database::Database;
use crate::error::{DatasetError, refused};
use crate::schema::{NUMBERS, TEXTS, columns};

impl Database {
    /// The table as CSV, in full precision.
    pub fn to_csv(&self) -> Result<Vec<u8>, DatasetError> {
        self.csv().map_err(|error| refused(format!("the table cannot be written as CSV: {error}")))
    }

    fn csv(&self) -> csv::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(columns().map(|column| column.name))?;
        for row in &self.rows {
            let texts = TEXTS.iter().map(|column| (column.get)(row));
            let numbers = NUMBERS.iter().map(|column| (column.get)(row).to_string());
            let d_peak = row.sample.d_peak.map_or(String::new(), |d| d.to_string());
            let ratios = row.eta().map(|ratio| ratio.to_string());
            writer.write_record(texts.chain(numbers).chain([d_peak]).chain(ratios))?;
        }
        Ok(writer.into_inner().expect("a vector takes every byte"))
    }
}
