//! Reads the reference cases, which an independent implementation computed in float64.

use crate::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Hinge constants that a sheet needs besides w_lig and alpha; no case depends on them.
pub const PROCESS: CuttingProcess =
    CuttingProcess { hole: HoleSize::Ratio(0.16), slit_width: 0.2, r_win: 100.0 };

pub const AT_CORNER: SheetOptions =
    SheetOptions { hinge_point: HingePoint::Corner, process: PROCESS };

pub const AT_TIP: SheetOptions = SheetOptions { hinge_point: HingePoint::CutTip, process: PROCESS };

pub fn case(name: &str) -> Value {
    let path = format!("{}/tests/cases/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("the case is part of the repository");
    serde_json::from_str(&text).expect("the case is valid JSON")
}

pub fn get<T: DeserializeOwned>(value: &Value, key: &str) -> T {
    T::deserialize(&value[key]).unwrap_or_else(|error| panic!("{key}: {error}"))
}

pub fn grid(case: &Value) -> Grid {
    Grid { m: get(case, "M"), n: get(case, "N") }
}

pub fn outline(case: &Value) -> Outline {
    Outline { corners: get(case, "outline_corners") }
}

pub fn coordinates(case: &Value) -> PatternCoordinates {
    PatternCoordinates { z: get(case, "z"), ell: get(case, "ell") }
}

pub fn pattern(case: &Value) -> CutPattern {
    CutPattern::new(grid(case), outline(case), &coordinates(case)).unwrap()
}

/// The sheet of a pattern case, with equal ligaments.
pub fn sheet(case: &Value) -> Sheet {
    let pattern = pattern(case);
    Sheet::new(&pattern, &vec![0.1; pattern.grid.hinge_count()], AT_CORNER).unwrap()
}

/// (panel, degree of freedom, value) of the entries with a key.
fn by_panel(case: &Value, key: &str) -> Vec<(usize, Dof, f64)> {
    let entries: Vec<Value> = get(case, key);
    let entry = |entry: &Value| {
        let dof = Dof::ALL[get::<usize>(entry, "dof")];
        let value = entry["value"].as_f64().unwrap_or(0.0);
        (get(entry, "panel"), dof, value)
    };
    entries.iter().map(entry).collect()
}

pub fn supports(case: &Value) -> Vec<Support> {
    let to_support = |(panel, dof, value)| support(panel, dof, value);
    by_panel(case, "supports").into_iter().map(to_support).collect()
}

pub fn loads(case: &Value) -> Vec<Load> {
    let to_load = |(panel, dof, value)| load(panel, dof, value);
    by_panel(case, "loads").into_iter().map(to_load).collect()
}

/// Maximum difference between the numbers of two arrays of the same shape.
pub fn difference<const N: usize>(found: &[[f64; N]], expected: &[[f64; N]]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let pairs = std::iter::zip(found.as_flattened(), expected.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
