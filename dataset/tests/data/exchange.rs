//! Databases exchanged as CSV.

use crate::common::{collect, finer, rows};
use dataset::{ColumnMap, Constant, columns, rows_from_csv};
use std::path::PathBuf;
use tempfile::TempDir;

fn file(text: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    std::fs::write(&path, text).unwrap();
    (folder, path)
}

/// A table of three hinges as another solver writes it.
const FOREIGN: &str = "ray,width,angle,u,v,turn,energy,Fu,Fv,M\n\
    A,8,60,0.1,0.2,10,1.5,1,2,3\n\
    A,8,60,0.2,0.4,20,6.0,2,4,6\n\
    B,12,75,0.1,0.0,10,2.5,1,0,3\n\
    C,20,90,0.0,0.1,10,3.5,0,1,3\n";

fn foreign_map() -> ColumnMap {
    let columns = [
        ("job", "ray"),
        ("w_lig", "width"),
        ("alpha", "angle"),
        ("a", "u"),
        ("s", "v"),
        ("theta", "turn"),
        ("lambda", "turn"),
        ("W", "energy"),
        ("F_a", "Fu"),
        ("F_s", "Fv"),
        ("M_theta", "M"),
    ];
    let degree = 1f64.to_radians();
    let numbers = [("fillet_ratio", 0.16), ("kerf", 0.2), ("r_win", 100.0), ("D", 0.0)];
    let numbers = numbers.map(|(name, value)| (name.to_owned(), Constant::Number(value)));
    let material = [("material".to_owned(), Constant::Text("steel".into()))];
    ColumnMap {
        columns: columns.map(|(ours, theirs)| (ours.into(), theirs.into())).into(),
        factors: [("alpha", degree), ("theta", degree), ("lambda", 0.05)]
            .map(|(name, factor)| (name.into(), factor))
            .into(),
        constants: numbers.into_iter().chain(material).collect(),
    }
}

#[test]
fn rows_round_trip_through_csv_exactly() {
    for rows in [rows(), [rows(), finer(4)].concat()] {
        let database = collect(rows).unwrap();
        let text = String::from_utf8(database.to_csv().unwrap()).unwrap();
        let names: Vec<&str> = columns().map(|column| column.name).collect();
        assert_eq!(text.lines().next(), Some(names.join(",").as_str()));
        let (_folder, path) = file(&text);
        let again = collect(rows_from_csv(&path, &ColumnMap::default()).unwrap()).unwrap();
        assert_eq!(again.rows(), database.rows());
        assert_eq!(again.manifest(), database.manifest());
    }
}

#[test]
fn a_foreign_table_is_imported() {
    let (_folder, path) = file(FOREIGN);
    let rows = rows_from_csv(&path, &foreign_map()).unwrap();
    let database = collect(rows).unwrap();
    assert_eq!((database.manifest().rays, database.rows().len()), (3, 4));
    let row = &database.rows()[1];
    assert_eq!((row.job.as_str(), row.sample.lambda), ("A", 1.0));
    assert!((row.design.alpha - 60f64.to_radians()).abs() < 1e-15);
    assert_eq!([row.sample.w, row.sample.f_s, row.sample.d], [6.0, 4.0, 0.0]);
    assert_eq!((row.material.as_str(), row.design.kerf), ("steel", 0.2));
}

#[test]
fn a_constant_fills_a_column_that_may_have_gaps() {
    let (_folder, path) = file(FOREIGN);
    let mut map = foreign_map();
    (map.constants).insert("D_peak".into(), Constant::Number(0.25));
    map.factors.insert("D_peak".into(), 2.0);
    for row in rows_from_csv(&path, &map).unwrap() {
        assert_eq!(row.sample.d_peak, Some(0.5));
    }
}

#[test]
fn errors_in_tables_and_column_maps_name_the_place() {
    let error = |text: &str, map: &ColumnMap| {
        let (_folder, path) = file(text);
        let all = |error: &dyn std::error::Error| {
            let source = error.source().map(|source| source.to_string());
            format!("{error} {}", source.unwrap_or_default())
        };
        all(&rows_from_csv(&path, map).unwrap_err())
    };
    let map = foreign_map();
    for (from, to, expected) in [
        ("20,6.0", "20,six", "column `W`, row 1: `six`"),
        (",M\n", ",Moment\n", "no column `M`"),
        ("ray,", "\u{0}\u{1},", "NUL bytes"),
    ] {
        let message = error(&FOREIGN.replacen(from, to, 1), &map);
        assert!(message.contains(expected), "{message}");
    }
    assert!(error("", &map).contains("table.csv"));
    assert!(error("ray,width\nA", &map).contains("table.csv"));
    let mut typo = foreign_map();
    typo.columns.insert("w_lug".into(), "width".into());
    assert!(error(FOREIGN, &typo).contains("w_lug"));
    for column in ["kerf", "D"] {
        let mut bare = foreign_map();
        bare.constants.remove(column);
        let message = error(FOREIGN, &bare);
        assert!(message.contains(&format!("no column `{column}`")), "{message}");
    }
    let mut degrees = foreign_map();
    degrees.factors.remove("theta");
    let message = error(FOREIGN, &degrees);
    assert!(message.contains("column `theta`, row 0: 10 is no angle"), "{message}");
}

#[test]
fn rows_with_gaps_or_non_finite_numbers_are_rejected() {
    for cell in ["", "NaN", "inf"] {
        let (_folder, path) = file(&FOREIGN.replacen("20,6.0", &format!("20,{cell}"), 1));
        let rows = rows_from_csv(&path, &foreign_map()).unwrap();
        let database = collect(rows).unwrap();
        assert_eq!(database.rows().len(), 3, "{cell}");
        assert_eq!(database.manifest().rejected.values().sum::<usize>(), 1);
    }
}
