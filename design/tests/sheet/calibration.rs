//! Kerf, thickness and stresses of sheets that are known, from measurements with errors.

use crate::error_budget::film;
use design::analysis::calibration::{Calibration, CalibrationError, Quantity, calibrate};
use design::analysis::data_error::{DataError, ReadingFault};
use design::analysis::measurements::Measurements;
use design::analysis::real_sheet::RealSheet;
use design::analysis::sheet_residuals::CutAndMeasured;
use design::analysis::simulated_measurements::{StandardErrors, equal_parts};
use design::scene::Scene;
use design::sheet::deviation::Deviation;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use support::statistics::normal;

const ERRORS: StandardErrors = StandardErrors {
    point: 0.1,
    reading: 0.01,
};

fn cut() -> Deviation {
    Deviation {
        kerf: 0.06,
        thickness: -0.003,
        stress: 0.12,
        ..Deviation::default()
    }
}

/// The corners of a cut sheet at full load, turned and moved, and its loads at ten displacements.
fn exact(sheet: &RealSheet, cut: &Deviation) -> Measurements {
    let mut data = Measurements::exact(sheet, cut, &equal_parts(10), ERRORS).unwrap();
    let (sin, cos) = 0.3f64.sin_cos();
    for point in &mut data.points.as_mut().unwrap().points {
        let [x, y] = point.position;
        point.position = [cos * x - sin * y + 40.0, sin * x + cos * y - 15.0];
    }
    data
}

fn with_errors(sheet: &RealSheet, exact: &Measurements, seed: u64) -> Measurements {
    (exact.clone()).with_errors(sheet, &mut ChaCha8Rng::seed_from_u64(seed))
}

fn with<T>(scene: &Scene, of: impl FnOnce(&RealSheet, &Fitted) -> T) -> T {
    let problem = scene.problem().unwrap();
    let sheet = RealSheet::new(scene, &problem, &scene.start()).unwrap();
    let fit = |data: &Measurements, quantities: &[Quantity]| {
        let measured = CutAndMeasured {
            problem: &problem,
            sheet: &sheet,
            data,
        };
        let known = Deviation::default();
        calibrate(&[measured], quantities, &known, &mut || ())
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
        let mut data = exact(sheet, &cut());
        data.points.as_mut().unwrap().error = 1e-4;
        data.loads.as_mut().unwrap().error = 1e-5;
        let found = fit(&data, &Quantity::ALL).unwrap();
        let close = std::iter::zip(values(&found.deviation()), values(&cut()));
        for ((found, cut), guess) in close.zip([0.1, 0.005, 0.2]) {
            assert!((found - cut).abs() < 1e-4 * guess, "{found} {cut}");
        }
        let [before, after] = found.points.unwrap().residual;
        assert!(before > 0.05 && after < 1e-5, "{before} {after}");
        assert_eq!(found.points.unwrap().outliers, 0);
    });
}

/// Of sheets as they come, each quantity is within two standard errors in 95 of 100. Fewer than 22 of 24 are left to chance once in ten.
#[test]
fn a_sheet_is_within_two_standard_errors() {
    with(
        &film(|config| config.solver.tolerance = 1e-10),
        |sheet, fit| {
            let mut within = [0; 3];
            for seed in 0..24 {
                let mut random = ChaCha8Rng::seed_from_u64(seed);
                let mut guess = |quantity: Quantity| {
                    quantity.guess(sheet.thickness()) * normal([random.random(), random.random()])
                };
                let cut = Deviation {
                    kerf: guess(Quantity::Kerf),
                    thickness: guess(Quantity::Thickness),
                    stress: guess(Quantity::Stress),
                    ..Deviation::default()
                };
                let data = Measurements::exact(sheet, &cut, &equal_parts(3), ERRORS).unwrap();
                let found = fit(&data.with_errors(sheet, &mut random), &Quantity::ALL).unwrap();
                let pairs = std::iter::zip(&found.estimates, values(&cut));
                for (k, (estimate, cut)) in pairs.enumerate() {
                    let error = (estimate.deviation - cut).abs();
                    within[k] += usize::from(error <= 2.0 * estimate.standard_error);
                }
            }
            assert!(within.iter().all(|count| *count >= 22), "{within:?}");
        },
    );
}

/// Under a prescribed stroke the stresses move no point, and loads alone do not tell them from the thickness and the kerf.
#[test]
fn what_the_measurements_do_not_determine_is_named() {
    with(&film(|_| ()), |sheet, fit| {
        let all = with_errors(sheet, &exact(sheet, &cut()), 1);
        let points = Measurements {
            loads: None,
            ..all.clone()
        };
        let found = fit(&points, &Quantity::ALL).unwrap();
        let stress = found
            .estimates
            .iter()
            .find(|own| own.quantity == Quantity::Stress);
        let stress = stress.unwrap();
        assert!(
            !stress.determined && stress.deviation.abs() < 1e-3,
            "{stress:?}"
        );
        assert!((stress.standard_error - 0.2).abs() < 1e-3, "{stress:?}");
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
        let good = with_errors(sheet, &exact(sheet, &cut()), 2);
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
                CalibrationError::Data {
                    error: DataError::Reading { index, fault },
                    ..
                } => (index, fault),
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
        let none = matches!(
            none,
            CalibrationError::Data {
                error: DataError::NoData,
                ..
            }
        );
        assert!(none);
    });
}

/// Correct readings are no misfit, however few: the degrees of freedom are those that what was known before leaves.
#[test]
fn few_correct_readings_are_no_misfit() {
    with(&film(|_| ()), |sheet, fit| {
        let mut data = Measurements::exact(sheet, &cut(), &equal_parts(4), ERRORS).unwrap();
        data.points = None;
        let chi_squared = |seed: u64| {
            let found = fit(&with_errors(sheet, &data, seed), &Quantity::ALL).unwrap();
            let loads = found.loads.unwrap();
            assert!(loads.free > 2.0 && loads.free < 4.0, "{loads:?}");
            loads.chi_squared
        };
        let mean = (0..20).map(chi_squared).sum::<f64>() / 20.0;
        assert!((mean - 1.0).abs() < 0.6, "{mean}");
    });
}
