//! Moduli of records: given ones, and moduli of few or disturbed rows.

use crate::synthetic::{HEADER, LINEAR, VOCE, csv, write};
use crate::{EXACT, OPTIONS, agrees, fit_text};
use tensile::{MaterialFit, RecordOptions};

#[test]
fn a_given_modulus_removes_the_compliance_of_the_machine() {
    let rows: Vec<[f64; 2]> = VOCE
        .record(8000)
        .into_iter()
        .map(|[strain, stress]| [strain + stress / 30e3, stress])
        .collect();
    let mut options = OPTIONS;
    options.specimen.young = Some(VOCE.young);
    let fit = fit_text(&csv(HEADER, &rows), &options);
    agrees(&fit, &VOCE, "compliance", EXACT);
    assert!(fit.young_given && fit.specimens[0].linear.young < 0.35 * VOCE.young);
}

/// An extensometer whose slope is 5 % low: the given modulus is the slope of the line to Rp0.2.
#[test]
fn a_given_modulus_does_not_change_the_strain_of_an_extensometer() {
    let rows: Vec<[f64; 2]> = LINEAR.record(8000);
    let mut options = OPTIONS;
    options.specimen.young = Some(LINEAR.young / 0.95);
    let fit = fit_text(&csv(HEADER, &rows), &options);
    let specimen = &fit.specimens[0];
    assert_eq!(specimen.compliance, 0.0);
    assert!((specimen.linear.young / LINEAR.young - 1.0).abs() < 1e-3);
    // From the last elastic row on, the strain of the line is 0.2 % + s / E.
    let at_yield = |young: f64| {
        let line = |row: &&[f64; 2]| row[1] < young * (row[0] - 0.002);
        rows.iter().find(line).unwrap()[1]
    };
    let expected = at_yield(LINEAR.young / 0.95);
    assert!((specimen.offset_yield / expected - 1.0).abs() < 1e-3);
    let largest = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
    assert!((specimen.strength / largest - 1.0).abs() < 1e-12);
}

/// A metal whose first rows are steeper, because the specimen straightens: its line is that between
/// a tenth and half of the yield stress.
#[test]
fn steep_first_rows_of_a_metal_are_not_its_modulus() {
    let rows: Vec<[f64; 2]> = (LINEAR.record(8000).into_iter())
        .map(|[strain, stress]| [strain - 1e-4 * (stress / 15.0).min(1.0), stress])
        .collect();
    let fit = fit_text(&csv(HEADER, &rows), &OPTIONS);
    let linear = &fit.specimens[0].linear;
    assert!((linear.young / LINEAR.young - 1.0).abs() < 0.01, "{linear:?}");
    assert!(linear.error < 0.001 * linear.young, "{linear:?}");
}

#[test]
fn few_rows_give_a_modulus_with_its_error() {
    let fit = fit_text(&csv(HEADER, &VOCE.record(150)), &OPTIONS);
    let linear = &fit.specimens[0].linear;
    assert!(linear.rows < 5, "{linear:?}");
    let off = (linear.young - VOCE.young).abs();
    assert!(off < 2.0 * linear.error, "{linear:?}");
}

/// Three rows of which one is beyond yield: the 95 % interval of their slope reaches zero. The given
/// modulus is the slope of the line to Rp0.2, and no compliance is made of the difference.
#[test]
fn a_modulus_that_is_not_known_is_refused_and_may_be_given() {
    for rows in [20, 40, 80] {
        let text = csv(HEADER, &VOCE.record(rows));
        let folder = tempfile::tempdir().unwrap();
        let records = [(write(folder.path(), "few.csv", &text), RecordOptions::default())];
        let message = MaterialFit::new(&records, &OPTIONS).unwrap_err().to_string();
        assert!(
            message.contains("few.csv has a modulus") && message.contains("--young"),
            "{message}"
        );
        let mut options = OPTIONS;
        options.specimen.young = Some(VOCE.young);
        let fit = MaterialFit::new(&records, &options).unwrap();
        agrees(&fit, &VOCE, "few rows", [1e-12, 0.01, 0.01]);
        assert_eq!(fit.specimens[0].compliance, 0.0);
    }
}
