//! Kerf, thickness and stresses of sheets that are known, from measurements with errors.

use crate::error_budget::film;
use design::analysis::calibration::{
    Calibration, CalibrationError, LoadData, Measurements, PointData, Quantity, ReadingFault,
    calibrate,
};
use design::analysis::marks::{Mark, MeasuredPoint};
use design::analysis::real_sheet::{Deviation, RealSheet};
use design::geometry::similarity::Scale;
use design::scene::Scene;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Standard errors of a coordinate (mm) and of a load, relative to the largest.
const POINT: f64 = 0.1;
const LOAD: f64 = 0.01;

fn cut() -> Deviation {
    Deviation {
        kerf: 0.06,
        thickness: -0.003,
        stress: 0.12,
        ..Deviation::default()
    }
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (TAU * random.random::<f64>()).cos()
}

/// The corners of a cut sheet at full load, turned and moved, and its loads at ten displacements.
fn exact(sheet: &RealSheet, cut: &Deviation) -> Measurements {
    let (deployed, _) = sheet.deployed(cut).unwrap();
    let configuration = &deployed.at_full_load().unwrap().configuration;
    let (sin, cos) = 0.3f64.sin_cos();
    let point = |mark: Mark| {
        let [x, y] = mark.deployed(&deployed.sheet, configuration);
        let position = [cos * x - sin * y + 40.0, sin * x + cos * y - 15.0];
        MeasuredPoint { mark, position }
    };
    let corners = Mark::all(&deployed.sheet).filter(|mark| mark.corner.is_some());
    let parts: Vec<f64> = (1..=10).map(|i| f64::from(i) / 10.0).collect();
    let plan = sheet.reading_plan(&parts).unwrap();
    Measurements {
        points: Some(PointData {
            points: corners.map(point).collect(),
            scale: Scale::Given,
            error: POINT,
        }),
        loads: Some(LoadData {
            readings: sheet.read(&plan, cut).unwrap().points.unwrap(),
            error: LOAD,
        }),
    }
}

/// The same with errors.
fn with_errors(exact: &Measurements, seed: u64) -> Measurements {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut data = exact.clone();
    for point in &mut data.points.as_mut().unwrap().points {
        point.position = point.position.map(|x| x + POINT * normal(&mut random));
    }
    let readings = &mut data.loads.as_mut().unwrap().readings;
    let largest = readings
        .iter()
        .fold(0.0, |most: f64, [_, load]| most.max(*load));
    for [_, load] in readings {
        *load += LOAD * largest * normal(&mut random);
    }
    data
}

fn with<T>(scene: &Scene, of: impl FnOnce(&RealSheet, &Fitted) -> T) -> T {
    let problem = scene.problem().unwrap();
    let sheet = RealSheet::new(scene, &problem, &scene.start()).unwrap();
    let fit = |data: &Measurements, quantities: &[Quantity]| {
        calibrate(&problem, &sheet, data, quantities, &mut || ())
    };
    of(&sheet, &fit)
}

type Fitted<'a> =
    dyn Fn(&Measurements, &[Quantity]) -> Result<Calibration, CalibrationError> + Sync + 'a;

fn values(of: &Deviation) -> [f64; 3] {
    [of.kerf, of.thickness, of.stress]
}

#[test]
fn exact_measurements_give_the_sheet_that_was_cut() {
    with(&film(|_| ()), |sheet, fit| {
        let found = fit(&exact(sheet, &cut()), &Quantity::ALL).unwrap();
        let close = std::iter::zip(values(&found.deviation()), values(&cut()));
        for ((found, cut), guess) in close.zip([0.1, 0.005, 0.2]) {
            assert!((found - cut).abs() < 1e-4 * guess, "{found} {cut}");
        }
        let [before, after] = found.points.unwrap().residual;
        assert!(before > 0.05 && after < 1e-5, "{before} {after}");
        assert_eq!(
            (found.undetermined, found.points.unwrap().outliers),
            (vec![], 0)
        );
    });
}

/// Of a hundred measurements with known errors, each quantity is within two standard errors in 95; at least 90 leave that to
/// chance in one of fifty.
#[test]
fn the_sheet_is_within_two_standard_errors() {
    with(
        &film(|config| config.solver.tolerance = 1e-10),
        |sheet, fit| {
            let (mut within, exact) = ([0; 3], exact(sheet, &cut()));
            for seed in 0..100 {
                let found = fit(&with_errors(&exact, seed), &Quantity::ALL).unwrap();
                for estimate in &found.estimates {
                    let k = Quantity::ALL
                        .iter()
                        .position(|own| *own == estimate.quantity)
                        .unwrap();
                    let error = estimate.deviation - values(&cut())[k];
                    within[k] += usize::from(error.abs() <= 2.0 * estimate.standard_error);
                }
            }
            assert!(within.iter().all(|count| *count >= 90), "{within:?}");
        },
    );
}

/// Under a prescribed stroke the stresses move no point, and loads alone do not tell them from the thickness and the kerf.
#[test]
fn what_the_measurements_do_not_determine_is_named() {
    with(&film(|_| ()), |sheet, fit| {
        let all = with_errors(&exact(sheet, &cut()), 1);
        let points = Measurements {
            loads: None,
            ..all.clone()
        };
        let found = fit(&points, &Quantity::ALL).unwrap();
        let left: Vec<Quantity> = found
            .undetermined
            .iter()
            .map(|(quantity, _)| *quantity)
            .collect();
        assert!(left.contains(&Quantity::Stress), "{left:?}");
        assert_eq!(found.deviation().stress, 0.0);
        let error = fit(&points, &[Quantity::Stress]).unwrap_err();
        assert!(matches!(error, CalibrationError::Undetermined), "{error}");
        let loads = Measurements {
            points: None,
            ..all
        };
        let found = fit(&loads, &[Quantity::Stress]).unwrap();
        assert_eq!(found.estimates.len(), 1);
    });
}

#[test]
fn measurements_that_contradict_each_other_widen_the_errors() {
    with(&film(|_| ()), |sheet, fit| {
        let good = with_errors(&exact(sheet, &cut()), 2);
        let mut bad = good.clone();
        let readings = &mut bad.loads.as_mut().unwrap().readings;
        for (i, [_, load]) in readings.iter_mut().enumerate() {
            *load *= if i % 2 == 0 { 1.3 } else { 0.75 };
        }
        let [good, bad] = [good, bad].map(|data| fit(&data, &Quantity::ALL).unwrap());
        assert!(good.loads.unwrap().chi_squared < 2.5);
        assert!(bad.loads.unwrap().chi_squared > 20.0);
        let error = |of: &Calibration| {
            let stress = of
                .estimates
                .iter()
                .find(|own| own.quantity == Quantity::Stress);
            stress.unwrap().standard_error
        };
        assert!(error(&bad) > 3.0 * error(&good));
    });
}

#[test]
fn wrong_readings_are_refused() {
    with(&film(|_| ()), |sheet, fit| {
        let data = exact(sheet, &cut());
        let with_readings = |change: &dyn Fn(&mut Vec<[f64; 2]>)| {
            let mut data = Measurements {
                points: None,
                ..data.clone()
            };
            change(&mut data.loads.as_mut().unwrap().readings);
            match fit(&data, &[Quantity::Stress]).unwrap_err() {
                CalibrationError::Reading { index, fault } => (index, fault),
                other => panic!("{other}"),
            }
        };
        let (_, fault) = with_readings(&|rows| rows.iter_mut().for_each(|row| row.reverse()));
        assert!(fault.to_string().contains("swapped"), "{fault}");
        let (index, fault) = with_readings(&|rows| rows.swap(3, 4));
        assert_eq!((index, fault), (4, ReadingFault::NotAscending));
        let (index, _) = with_readings(&|rows| rows[9][0] *= 1.5);
        assert_eq!(index, 9);
        let none = fit(&Measurements::default(), &[Quantity::Kerf]).unwrap_err();
        assert!(matches!(none, CalibrationError::NoData));
    });
}
