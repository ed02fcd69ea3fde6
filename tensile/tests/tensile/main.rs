//! Tensile tests of known laws, with the disturbances of a testing machine: the fitted law is the
//! law of the record.

mod bad_files;
mod moduli;
mod mutations;
mod synthetic;
mod units;

use hinge::SheetMaterial;
use std::path::PathBuf;
use synthetic::{FILM, HEADER, LINEAR, Law, Noise, RAMBERG_OSGOOD, VOCE, at, csv, write};
use tensile::{
    Exclusion, FitOptions, FractureSource, MaterialFit, Origin, Quantity, RecordOptions,
    SpecimenOptions, material_file,
};

const OPTIONS: FitOptions = FitOptions {
    specimen: SpecimenOptions { young: None, draw_ratio: None },
    fracture_strain: None,
    rows: 40,
};

/// What no tensile test measures.
fn known() -> SheetMaterial {
    SheetMaterial {
        name: "fitted \"sheet\"".into(),
        thickness: 0.5,
        poisson: 0.4,
        density_kg_m3: 1390.0,
        ..SheetMaterial::default()
    }
}

/// The fit of files that say all about themselves.
fn fit(files: &[PathBuf], options: &FitOptions) -> MaterialFit {
    fit_with(files, options, &RecordOptions::default())
}

fn fit_with(files: &[PathBuf], options: &FitOptions, record: &RecordOptions) -> MaterialFit {
    let records: Vec<_> = files.iter().map(|path| (path.clone(), record.clone())).collect();
    MaterialFit::new(&records, options).unwrap()
}

/// The fit of one text.
fn fit_text(text: &str, options: &FitOptions) -> MaterialFit {
    let folder = tempfile::tempdir().unwrap();
    fit(&[write(folder.path(), "test.csv", text)], options)
}

/// Maximum relative deviation of the table from the law over plastic strains above 0.1 %, between
/// its rows too.
fn table_error(fit: &MaterialFit, law: &Law, to: f64) -> f64 {
    let table: Vec<[f64; 2]> = fit.table.iter().map(|row| [row.strain, row.stress]).collect();
    let strains = (1..=200).map(|i| 1e-3 + (to - 1e-3) * f64::from(i) / 200.0);
    strains
        .map(|strain| (at(&table, strain) / (law.stress)(strain) - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Modulus, yield stress and table agree with the law to the given relative tolerances.
#[track_caller]
fn agrees(fit: &MaterialFit, law: &Law, case: &str, [young, yields, hardening]: [f64; 3]) {
    let name = law.name;
    let error = fit.young.mean / law.young - 1.0;
    assert!(error.abs() < young, "{name}, {case}: E {error:+.4}");
    let error = fit.offset_yield.mean / law.offset_yield() - 1.0;
    assert!(error.abs() < yields, "{name}, {case}: Rp0.2 {error:+.4}");
    let end = fit.table.last().unwrap().strain.min(law.end);
    let error = table_error(fit, law, end);
    assert!(error < hardening, "{name}, {case}: hardening {error:.4}");
    assert!((end / law.end - 1.0).abs() < 0.02, "{name}, {case}: ends at {end}");
    assert_eq!(fit.table[0].strain, 0.0);
    let rising = |pair: &[tensile::HardeningRow]| {
        pair[1].strain > pair[0].strain && pair[1].stress >= pair[0].stress
    };
    assert!(fit.table.windows(2).all(rising), "{name}, {case}: {:?}", fit.table);
}

const METALS: [Law; 3] = [LINEAR, VOCE, RAMBERG_OSGOOD];
/// The line follows the bend of the Ramberg-Osgood law by 1 %; the table stays within 0.1 % of the
/// curve.
const EXACT: [f64; 3] = [0.015, 0.005, 0.005];

#[test]
fn clean_curves_give_their_law() {
    for law in METALS {
        let mut rows = law.record(8000);
        let fit = fit_text(&csv(HEADER, &rows), &OPTIONS);
        agrees(&fit, &law, "clean", EXACT);
        // A record that merely ends shows no break.
        assert_eq!(fit.fracture_source, FractureSource::RecordEnd);
        assert!(fit.specimens[0].dropped.is_empty(), "{}", law.name);
        let [strain, stress] = rows[rows.len() - 1];
        rows.extend([1e-4, 2e-4].map(|further| [strain + further, 0.01 * stress]));
        let fit = fit_text(&csv(HEADER, &rows), &OPTIONS);
        assert_eq!(fit.fracture_source, FractureSource::Break);
    }
}

/// A standard deviation of 0.3 % of the yield stress, and of the elastic strain at yield, in 2000
/// rows.
#[test]
fn noise_and_jitter_are_averaged() {
    for law in METALS {
        let mut noise = Noise(7);
        let scale = 3e-3 * law.offset_yield();
        let rows: Vec<[f64; 2]> = law
            .record(2000)
            .into_iter()
            .map(|[strain, stress]| {
                [strain + scale / law.young * noise.normal(), stress + scale * noise.normal()]
            })
            .collect();
        let fit = fit_text(&csv(HEADER, &rows), &OPTIONS);
        // The elastic part has 20 to 80 rows: its slope is known to about 1 %.
        agrees(&fit, &law, "noise", [0.04, 0.02, 0.02]);
    }
}

#[test]
fn toe_and_slack_are_compensated() {
    for law in METALS {
        let yield_strain = law.offset_yield() / law.young;
        for (slack, toe) in [(0.003, 0.0), (0.0, 0.15 * yield_strain), (0.003, 0.15 * yield_strain)]
        {
            // s = E x^2 / (4 toe) up to x = 2 toe, where the line s = E (x - toe) begins.
            let shifted = law.record(8000).into_iter().map(|[strain, stress]| {
                let soft = match strain < toe {
                    true => 2.0 * (toe * strain).sqrt(),
                    false => strain + toe,
                };
                [slack + soft, stress]
            });
            let mut rows: Vec<[f64; 2]> =
                (0..100).map(|i| [slack * f64::from(i) / 100.0, 0.0]).collect();
            rows.extend(shifted);
            let fit = fit_text(&csv(HEADER, &rows), &OPTIONS);
            let case = format!("slack {slack}, toe {toe:.5}");
            agrees(&fit, &law, &case, [0.03, 0.02, 0.01]);
            let found = fit.specimens[0].toe;
            assert!(
                (found - slack - toe).abs() < 0.1 * (slack + toe),
                "{}: {case}: {found}",
                law.name
            );
            assert!(fit.specimens[0].dropped_for(Exclusion::Toe) > 0);
        }
    }
}

#[test]
fn unloading_loops_are_removed() {
    for law in METALS {
        let mut rows = Vec::new();
        for (index, [strain, stress]) in law.record(4000).into_iter().enumerate() {
            rows.push([strain, stress]);
            if index % 1000 == 999 {
                // Unloading to a fifth, and reloading with hysteresis.
                let back = (0..40).map(|i| 1.0 - 0.8 * f64::from(i) / 40.0);
                let forth = (0..40).map(|i| 0.2 + 0.8 * f64::from(i) / 40.0);
                let unloading =
                    back.map(|share| [strain - (1.0 - share) * stress / law.young, share * stress]);
                let hysteresis = 0.02 * stress;
                let reloading = forth.map(|share| {
                    [strain - (1.0 - share) * stress / law.young, share * stress - hysteresis]
                });
                rows.extend(unloading.skip(1).chain(reloading));
            }
        }
        let fit = fit_text(&csv(HEADER, &rows), &OPTIONS);
        agrees(&fit, &law, "loops", [EXACT[0], EXACT[1], 0.01]);
        let dropped = fit.specimens[0].dropped_for(Exclusion::Unloading);
        assert!((230..=320).contains(&dropped), "{}: {dropped}", law.name);
    }
}

/// The same curve in other units, orders, separators and languages gives the same numbers.
#[test]
fn the_format_of_a_file_does_not_change_its_law() {
    let law = VOCE;
    let record = law.record(3000);
    let with = |header: &str, row: &dyn Fn(f64, f64) -> String| {
        let rows: Vec<String> =
            record.iter().map(|[strain, stress]| row(*strain, *stress)).collect();
        format!("{header}\n{}\n", rows.join("\n"))
    };
    let comma = |text: String| text.replace('.', ",");
    let specimen = RecordOptions {
        gauge_length: Some(50.0),
        width: Some(12.5),
        thickness: Some(0.5),
        ..RecordOptions::default()
    };
    let named = RecordOptions {
        columns: vec![(Quantity::Stress, "3".into()), (Quantity::Strain, "epsilon_y".into())],
        units: vec![(Quantity::Stress, "GPa".into()), (Quantity::Strain, "%".into())],
        ..RecordOptions::default()
    };
    let none = RecordOptions::default();
    let cases: [(&str, String, &RecordOptions); 8] = [
        ("per cent", with("Strain (%),Stress (MPa)", &|e, s| format!("{},{s}", 100.0 * e)), &none),
        ("swapped columns", with("Stress [N/mm^2]\tStrain", &|e, s| format!("{s}\t{e}")), &none),
        (
            "decimal commas",
            with("Dehnung [%];Spannung [MPa]", &|e, s| comma(format!("{};{s}", 100.0 * e))),
            &none,
        ),
        ("psi", with("stress_psi,strain", &|e, s| format!("{},{e}", s / 6.894_757_29e-3)), &none),
        (
            "true",
            with("True strain,True stress (MPa)", &|e, s| {
                format!("{},{}", e.ln_1p(), s * (1.0 + e))
            }),
            &none,
        ),
        (
            "force and extension",
            with("Time (s),Load (kN),Extension (mm)", &|e, s| {
                format!("{e},{},{}", s * 6.25e-3, 50.0 * e)
            }),
            &specimen,
        ),
        (
            "preamble and units row",
            with(
                "Machine;34SC-5\nWidth;12,5;mm\n\nZeit;Standardweg;Standardkraft\n(s);(mm);(N)",
                &|e, s| comma(format!("{e};{};{}", 50.0 * e, s * 6.25)),
            ),
            &specimen,
        ),
        (
            "given columns and units",
            with("t,epsilon_y,q,q", &|e, s| format!("0,{},{},1", 100.0 * e, s / 1000.0)),
            &named,
        ),
    ];
    let folder = tempfile::tempdir().unwrap();
    let reference = fit_text(&csv(HEADER, &record), &OPTIONS);
    for (case, text, options) in cases {
        let fit = fit_with(&[write(folder.path(), "test.csv", &text)], &OPTIONS, options);
        agrees(&fit, &law, case, EXACT);
        // A curve given as true values is not searched for a neck, and has none.
        let [found, expected] = [&fit, &reference].map(|fit| fit.table.last().unwrap().stress);
        assert!((found / expected - 1.0).abs() < 1e-3, "{case}");
    }
}

#[test]
fn a_film_that_draws_gives_its_local_law() {
    let plateau = FILM.plateau();
    let mut noise = Noise(3);
    for (case, scale, tolerance) in [("clean", 0.0, 0.01), ("noise", 0.15, 0.03)] {
        let rows: Vec<[f64; 2]> = FILM
            .record(6000)
            .into_iter()
            .map(|[strain, stress]| [strain, stress + scale * noise.normal()])
            .collect();
        let fit = fit_text(&csv(HEADER, &rows), &OPTIONS);
        let found = fit.specimens[0].draw.unwrap();
        assert!((fit.young.mean / FILM.young - 1.0).abs() < 0.03, "{case}: {}", fit.young.mean);
        assert!((found.upper_yield / plateau.upper_yield - 1.0).abs() < 0.01, "{case}: {found:?}");
        assert!(
            (found.plateau / plateau.stress - 1.0).abs() < tolerance,
            "{case}: {found:?} {plateau:?}"
        );
        assert!(
            (found.draw_ratio / plateau.ratio - 1.0).abs() < 0.02,
            "{case}: {found:?} {plateau:?}"
        );

        // In the neck the curve is constructed from the work alone; outside it is measured.
        let drawn = fit.table.iter().filter(|row| row.origin == Origin::Drawn);
        assert!(drawn.count() > 3);
        let table: Vec<[f64; 2]> = fit.table.iter().map(|row| [row.strain, row.stress]).collect();
        let natural = plateau.ratio.ln();
        for i in 1..=100 {
            let strain = 1.3 * f64::from(i) / 100.0;
            let error = at(&table, strain) / (FILM.stress)(strain) - 1.0;
            let allowed = if strain < natural { 0.12 } else { 0.02 };
            assert!(error.abs() < allowed, "{case}: {error:+.3} at {strain}");
        }
        // The plastic work up to the natural draw ratio is the plastic work of the law: Maxwell's
        // rule, and the elastic part.
        let work = |stress: &dyn Fn(f64) -> f64| -> f64 {
            (0..10_000).map(|i| stress(natural * (f64::from(i) + 0.5) / 1e4) * natural / 1e4).sum()
        };
        let error = work(&|strain| at(&table, strain)) / work(&FILM.stress) - 1.0;
        assert!(error.abs() < 0.01, "{case}: work {error:+.4}");
    }
}

#[test]
fn a_film_that_breaks_while_drawing_needs_its_draw_ratio() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<[f64; 2]> =
        FILM.record(6000).into_iter().take_while(|row| row[0] < 1.0).collect();
    let path = write(folder.path(), "film.csv", &csv(HEADER, &rows));
    let records = [(path, RecordOptions::default())];
    let message = MaterialFit::new(&records, &OPTIONS).unwrap_err().to_string();
    assert!(message.contains("film.csv draws at") && message.contains("--draw-ratio"), "{message}");
    let mut options = OPTIONS;
    let plateau = FILM.plateau();
    options.specimen.draw_ratio = Some(plateau.ratio);
    let fit = MaterialFit::new(&records, &options).unwrap();
    assert_eq!(fit.fracture_source, FractureSource::DrawRatio);
    let last = fit.table.last().unwrap();
    let expected = plateau.stress * plateau.ratio;
    assert!((last.stress / expected - 1.0).abs() < 0.01, "{last:?} {expected}");
}

#[test]
fn a_metal_that_necks_is_measured_to_its_maximum_force() {
    // Voce necks where d(sigma)/d(eps) = sigma: 1560 x = 250 - 130 x with x = exp(-12 eps_p).
    let necking = -(250.0f64 / 1690.0).ln() / 12.0;
    let mut rows = VOCE.record_to(0.3, 6000);
    // The neck makes the force fall faster than the uniform curve; the specimen breaks.
    let top = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
    let start = rows.iter().find(|row| row[1] >= top).unwrap()[0];
    rows.iter_mut().for_each(|row| row[1] -= 3000.0 * (row[0] - start).max(0.0).powi(2));
    let broken = rows[rows.len() - 1][0];
    rows.extend([[broken + 1e-4, 30.0], [broken + 2e-4, 0.5]]);
    let text = csv(HEADER, &rows);
    let fit = fit_text(&text, &OPTIONS);
    assert_eq!(fit.fracture_source, FractureSource::MaximumForce);
    assert_eq!(fit.specimens[0].dropped_for(Exclusion::Broken), 2);
    // The maximum is flat: 0.1 % of the force is 0.01 in strain.
    let last = fit.table.last().unwrap();
    assert!((last.strain - necking).abs() < 0.01, "{last:?} {necking}");
    assert!(table_error(&fit, &VOCE, last.strain) < 0.005);

    let given = FitOptions { fracture_strain: Some(0.8), ..OPTIONS };
    let fit = fit_text(&text, &given);
    let last = fit.table.last().unwrap();
    assert_eq!((last.strain, last.origin, fit.fracture_strain), (0.8, Origin::Extrapolated, 0.8));
    // Considere's tangent is above the law that saturates.
    assert!(last.stress > 1.2 * (VOCE.stress)(0.8), "{last:?}");
}

#[test]
fn the_mean_over_specimens_has_their_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let files: Vec<PathBuf> = [0.95, 1.0, 1.05]
        .into_iter()
        .enumerate()
        .map(|(index, factor)| {
            let rows: Vec<[f64; 2]> = VOCE
                .record_to(0.10 + 0.02 * index as f64, 5000)
                .into_iter()
                .map(|[strain, stress]| [strain, factor * stress])
                .collect();
            write(folder.path(), &format!("{index}.csv"), &csv(HEADER, &rows))
        })
        .collect();
    let fit = fit(&files, &OPTIONS);
    agrees(&fit, &VOCE, "three specimens", [0.01, 0.005, 0.01]);
    let scatter = fit.offset_yield.deviation.unwrap() / fit.offset_yield.mean;
    assert!((scatter / 0.05 - 1.0).abs() < 0.02, "{scatter}");
    let scatter = fit.fracture_scatter.unwrap();
    assert!((scatter - 0.02).abs() < 2e-3, "{scatter}");
}

/// A polymer that softens to its break without a plateau: what the law leaves out is stated.
#[test]
fn softening_and_a_ratio_without_a_draw_are_named() {
    let rows: Vec<[f64; 2]> = (0..1200)
        .map(|i| 5e-4 * f64::from(i))
        .map(|e| [e, 50.0 * (1.0 - (-50.0 * e).exp()) - 20.0 * (e - 0.06).max(0.0)])
        .collect();
    let mut options = OPTIONS;
    options.specimen.draw_ratio = Some(3.0);
    let fit = fit_text(&csv(HEADER, &rows), &options);
    let specimen = &fit.specimens[0];
    assert_eq!(specimen.unused, ["--draw-ratio 3, as the record shows no draw"]);
    let softening = specimen.softening.unwrap();
    let [top, end] = softening.ends;
    assert!((top[0] - 0.0966).abs() < 0.001 && (top[1] - 48.87).abs() < 0.01, "{softening:?}");
    assert!((end[0] - 0.6).abs() < 0.01 && (end[1] - 39.2).abs() < 0.2, "{softening:?}");
    assert!(softening.rows > 1000, "{softening:?}");
    assert!(fit_text(&csv(HEADER, &VOCE.record(3000)), &OPTIONS).specimens[0].softening.is_none());
}

#[test]
fn the_material_file_is_read_and_its_table_is_the_law() {
    let folder = tempfile::tempdir().unwrap();
    for law in [LINEAR, VOCE, RAMBERG_OSGOOD, FILM] {
        let fit = fit_text(&csv(HEADER, &law.record(6000)), &OPTIONS);
        let material = fit.material(known()).unwrap();
        let text = material_file(&fit, &material, true);
        let path = write(folder.path(), "material.toml", &text);
        let read = SheetMaterial::load(&path).unwrap();
        assert_eq!(read, material, "{text}");
        // Comments are no part of the law.
        let bare: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        let path = write(folder.path(), "bare.toml", &bare.join("\n"));
        assert_eq!(SheetMaterial::load(&path).unwrap().law_hash(), read.law_hash());
    }
}
