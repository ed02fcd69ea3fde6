//! Databases merged, split again, and exchanged as CSV.

use crate::common::{collect, rows};
use dataset::{ColumnMap, Constant, Database, DatasetError, Mixing, Row, SplitPlan, rows_from_csv};
use std::path::PathBuf;
use tempfile::TempDir;

fn plan(seed: u64) -> SplitPlan {
    SplitPlan {
        seed,
        ..SplitPlan::default()
    }
}

/// The rows of all jobs, with a prefix to their names.
fn renamed(prefix: &str) -> Vec<Row> {
    let rename = |row: Row| Row {
        job: format!("{prefix}-{}", row.job),
        ..row
    };
    rows().into_iter().map(rename).collect()
}

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
    let numbers = [
        ("fillet_ratio", 0.16),
        ("kerf", 0.2),
        ("r_win", 100.0),
        ("D", 0.0),
    ];
    let numbers = numbers.map(|(name, value)| (name.to_owned(), Constant::Number(value)));
    let material = [("material".to_owned(), Constant::Text("steel".into()))];
    ColumnMap {
        columns: columns
            .map(|(ours, theirs)| (ours.into(), theirs.into()))
            .into(),
        factors: [("alpha", degree), ("theta", degree), ("lambda", 0.05)]
            .map(|(name, factor)| (name.into(), factor))
            .into(),
        constants: numbers.into_iter().chain(material).collect(),
    }
}

#[test]
fn a_merge_contains_every_job_once_and_the_counts_of_rejected_rows() {
    let mut bad = renamed("other");
    bad[0].sample.w = -1.0;
    let databases = [collect(rows()).unwrap(), collect(bad).unwrap()];
    let twice = [&databases[..], &databases[..]].concat();
    let merged = Database::merge(&twice, &plan(0), Mixing::Refused).unwrap();
    assert_eq!(merged.rows().len(), 99);
    assert_eq!(merged.manifest().rays, 20);
    assert_eq!(merged.manifest().rejected.values().sum::<usize>(), 1);
    let once = Database::merge(&databases, &plan(0), Mixing::Refused).unwrap();
    assert_eq!(merged.manifest(), once.manifest());
}

#[test]
fn tiers_are_mixed_only_on_request_and_hinge_constants_never() {
    let mut coarse = renamed("coarse");
    coarse.iter_mut().for_each(|row| row.tier = "tiny".into());
    let mut narrow = renamed("narrow");
    narrow.iter_mut().for_each(|row| row.design.kerf = 0.1);
    let [default, coarse, narrow] = [rows(), coarse, narrow].map(|rows| collect(rows).unwrap());
    let merge = |other: &Database, mixing| {
        Database::merge(&[default.clone(), other.clone()], &plan(0), mixing)
    };
    let error = merge(&coarse, Mixing::Refused).unwrap_err();
    assert!(
        matches!(error, DatasetError::Mixed { column: "tier", .. }),
        "{error}"
    );
    let mixed = merge(&coarse, Mixing::Allowed).unwrap();
    assert_eq!(mixed.manifest().tier, "default + tiny");
    let error = merge(&narrow, Mixing::Allowed).unwrap_err();
    assert!(
        matches!(error, DatasetError::Mixed { column: "kerf", .. }),
        "{error}"
    );
}

#[test]
fn another_seed_splits_the_same_rows_differently() {
    let database = collect(rows()).unwrap();
    let again = database.split(&plan(0)).unwrap();
    assert_eq!(again.manifest(), database.manifest());
    let other = database.split(&plan(1)).unwrap();
    assert_eq!(other.rows(), database.rows());
    assert_eq!(other.manifest().hash, database.manifest().hash);
    assert_ne!(other.manifest().split_hash, database.manifest().split_hash);
}

#[test]
fn rows_round_trip_through_csv_exactly() {
    let database = collect(rows()).unwrap();
    let (_folder, path) = file(&String::from_utf8(database.to_csv().unwrap()).unwrap());
    let again = collect(rows_from_csv(&path, &ColumnMap::default()).unwrap()).unwrap();
    assert_eq!(again.rows(), database.rows());
    assert_eq!(again.manifest(), database.manifest());
}

#[test]
fn a_foreign_table_is_imported() {
    let (_folder, path) = file(FOREIGN);
    let rows = rows_from_csv(&path, &foreign_map()).unwrap();
    let database = Database::collect(rows, &plan(0)).unwrap();
    assert_eq!((database.manifest().rays, database.rows().len()), (3, 4));
    let row = &database.rows()[1];
    assert_eq!((row.job.as_str(), row.sample.lambda), ("A", 1.0));
    assert!((row.design.alpha - 60f64.to_radians()).abs() < 1e-15);
    assert_eq!(
        [row.sample.w, row.sample.f_s, row.sample.d],
        [6.0, 4.0, 0.0]
    );
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
        ("ray,", "\u{0}\u{1},", "no column `ray`"),
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
        assert!(
            message.contains(&format!("no column `{column}`")),
            "{message}"
        );
    }
    let mut degrees = foreign_map();
    degrees.factors.remove("theta");
    let message = error(FOREIGN, &degrees);
    assert!(
        message.contains("column `theta`, row 0: 10 is no angle"),
        "{message}"
    );
}

#[test]
fn rows_with_gaps_or_non_finite_numbers_are_rejected() {
    for cell in ["", "NaN", "inf"] {
        let (_folder, path) = file(&FOREIGN.replacen("20,6.0", &format!("20,{cell}"), 1));
        let rows = rows_from_csv(&path, &foreign_map()).unwrap();
        let database = Database::collect(rows, &plan(0)).unwrap();
        assert_eq!(database.rows().len(), 3, "{cell}");
        assert_eq!(database.manifest().rejected.values().sum::<usize>(), 1);
    }
}
