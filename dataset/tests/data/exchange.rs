//! Databases written as CSV.

use crate::common::{collect, finer, rays};
use dataset::{COLUMNS, samples};

#[test]
fn every_row_is_written_as_csv_in_full_precision() {
    for rays in [rays(), [rays(), finer(4)].concat()] {
        let database = collect(rays).unwrap();
        let table = database.to_csv().unwrap();
        let mut reader = csv::Reader::from_reader(&table[..]);
        let head: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let names: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
        assert_eq!(head, names);
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), samples(database.rays()).count());
        for (record, (ray, sample)) in records.iter().zip(samples(database.rays())) {
            let cell = |name: &str| &record[names.iter().position(|other| *other == name).unwrap()];
            let number = |name: &str| cell(name).parse::<f64>().unwrap();
            let failure = ray.failure.map_or(String::new(), |kind| kind.to_string());
            assert_eq!([cell("job"), cell("failure")], [&ray.job, &failure]);
            assert_eq!([number("alpha"), number("W")], [ray.design.alpha, sample.w]);
            assert_eq!(
                [number("eta_a"), number("eta_s")],
                sample.deformation().eta(ray.design.w_lig)
            );
            assert_eq!(cell("D_peak"), "", "not known");
        }
    }
}
