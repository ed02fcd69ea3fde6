//! The samples of a window solve as the file `rows.csv`.

use crate::SolvedPath;
use hinge::HingeSample;
use std::io;

impl SolvedPath for Vec<HingeSample> {
    const FILE: &'static str = "rows.csv";

    fn len(&self) -> usize {
        self.len()
    }

    fn reached(&self) -> f64 {
        self.last().map_or(0.0, |last| last.lambda)
    }

    fn to_bytes(&self) -> io::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for sample in self {
            writer.serialize(sample)?;
        }
        Ok(writer.into_inner().expect("a vector takes every byte"))
    }

    fn from_bytes(bytes: &[u8]) -> io::Result<Self> {
        let rows = csv::Reader::from_reader(bytes).into_deserialize();
        rows.collect::<Result<_, csv::Error>>()
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
    }
}
