//! One curve in every unit gives one law; a unit that is not known, or stated nowhere, is never
//! passed over in silence.

use super::{OPTIONS, fit_with, write};
use crate::synthetic::Law;
use support::Fault;
use tensile::{MaterialFit, Quantity, RecordOptions};

/// sigma = 30.164 + 15 (1 - exp(-eps_p / 0.03)), of a specimen of 10 x 0.5 mm with a gauge length
/// of 50 mm.
const POLYMER: Law = Law {
    name: "polymer",
    young: 2500.0,
    stress: |plastic| 30.164 + 15.0 * (1.0 - (-plastic / 0.03).exp()),
    end: 0.08,
};
const YIELD: f64 = 30.57;
const STEEL: Law =
    Law { name: "steel", young: 200e3, stress: |plastic| 300.0 + 500.0 * plastic, end: 0.08 };
const AREA: f64 = 5.0;
const LENGTH: f64 = 50.0;
const LBF: f64 = 4.448_221_615_260_5;

fn specimen() -> RecordOptions {
    RecordOptions {
        gauge_length: Some(LENGTH),
        width: Some(10.0),
        thickness: Some(0.5),
        ..RecordOptions::default()
    }
}

/// Rows of deformation and load in units of `deformation` and `load`, between a time and an empty
/// column.
fn text(law: &Law, header: &str, deformation: f64, load: f64) -> String {
    let mut text = format!("{header}\n");
    for (time, [strain, stress]) in law.record(600).into_iter().enumerate() {
        let (strain, stress) = (strain / deformation, stress / load);
        text += &format!("{time},{strain:.9},{stress:.9},\n");
    }
    text
}

fn read(text: &str, options: &RecordOptions) -> Result<MaterialFit, Fault> {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "test.csv", text);
    MaterialFit::new(&[(path, options.clone())], &OPTIONS)
}

#[track_caller]
fn is_polymer(text: &str, options: &RecordOptions) {
    let case = text.lines().take(3).collect::<Vec<_>>().join(" | ");
    let fit = read(text, options).unwrap_or_else(|error| panic!("{case}: {error}"));
    let error = fit.young.mean / POLYMER.young - 1.0;
    assert!(error.abs() < 0.01, "{case}: E {:?}", fit.young);
    let error = fit.offset_yield.mean - YIELD;
    assert!(error.abs() < 0.1, "{case}: Rp0.2 {:?}", fit.offset_yield);
}

#[track_caller]
fn message(text: &str, options: &RecordOptions) -> String {
    let message = read(text, options).map(|fit| fit.young).unwrap_err();
    let message = message.to_string();
    assert!(message.contains("test.csv"), "{message}");
    message
}

/// The number of N, mm, MPa or 1 in each unit, from its definition.
#[test]
fn forces_lengths_stresses_and_strains_are_read_in_their_units() {
    assert!((POLYMER.offset_yield() - YIELD).abs() < 0.02);
    for (unit, newton) in [
        ("N", 1.0),
        ("mN", 1e-3),
        ("cN", 1e-2),
        ("daN", 10.0),
        ("dan", 10.0),
        ("KN", 1e3),
        ("MN", 1e6),
        ("gf", 9.806_65e-3),
        ("kgf", 9.806_65),
        ("lbf", LBF),
        ("lb", LBF),
        ("Lbs", LBF),
        ("kip", 1e3 * LBF),
    ] {
        for (length, mm) in [("mm", 1.0), ("um", 1e-3), ("Inch", 25.4)] {
            let header = format!("Time (s),Stroke ({length}),Load ({unit}),");
            let text = text(&POLYMER, &header, mm / LENGTH, newton / AREA);
            is_polymer(&text, &specimen());
        }
    }
    for (unit, mpa) in [
        ("MPa", 1.0),
        ("mpa", 1.0),
        ("N/mm2", 1.0),
        ("N/mm²", 1.0),
        ("N / mm^2", 1.0),
        ("MN/m2", 1.0),
        ("Pa", 1e-6),
        ("kPa", 1e-3),
        ("GPa", 1e3),
        ("bar", 0.1),
        ("N/cm²", 0.01),
        ("kgf/mm2", 9.806_65),
        ("kgf/cm^2", 0.098_066_5),
        ("psi", LBF / 645.16),
        ("ksi", 6.894_757_293_168),
    ] {
        for (strain, ratio) in [("-", 1.0), ("%", 0.01), ("\u{b5}ε", 1e-6)] {
            let header = format!("Time (s),Strain ({strain}),Stress ({unit}),");
            let text = text(&POLYMER, &header, ratio, mpa);
            is_polymer(&text, &RecordOptions::default());
        }
    }
}

/// Names, then units of which some are no unit of a column that is read.
#[test]
fn a_row_of_units_is_the_row_most_of_which_are_units() {
    for units in [
        "sec,mm,kN,",
        "(sec),(mm),(kN),",
        "segments,mm,kN,",
        "\u{b0}C,[mm],[kN],",
        "-,mm,kN,",
        "fortnights,mm,kN,",
    ] {
        for names in ["Time,Stroke,Force,", "Sample,Stroke,Force,Remark"] {
            let header = format!("\"S235\",,,\n{names}\n{units}");
            let steel = text(&STEEL, &header, 1.0 / LENGTH, 1e3 / AREA);
            let fit = read(&steel, &specimen()).unwrap();
            let error = fit.young.mean / STEEL.young - 1.0;
            assert!(error.abs() < 0.01, "{header}: {:?}", fit.young);
            let error = fit.offset_yield.mean / STEEL.offset_yield() - 1.0;
            assert!(error.abs() < 0.01, "{header}: {:?}", fit.offset_yield);
        }
    }
    // The units of columns without names, which the options choose.
    let chosen = RecordOptions {
        columns: vec![(Quantity::Extension, "2".into()), (Quantity::Force, "3".into())],
        ..specimen()
    };
    let header = "\"S235\"\nsec,mm,kN,";
    let steel = text(&STEEL, header, 1.0 / LENGTH, 1e3 / AREA);
    let fit = read(&steel, &chosen).unwrap();
    assert!((fit.young.mean / STEEL.young - 1.0).abs() < 0.01, "{:?}", fit.young);
}

#[test]
fn an_unknown_unit_of_a_column_that_is_read_is_an_error() {
    let rows = |header: &str| text(&POLYMER, header, 1.0 / LENGTH, 1.0 / AREA);
    for (header, unit, quantity) in [
        ("Time (s),Stroke (mm),Load (tons),", "tons", "force"),
        ("Time (s),Stroke (mm),Load / tons,", "tons", "force"),
        ("Time (s),Stroke (mm),Load in tons,", "tons", "force"),
        ("Time (s),Stroke (mm),Load (mm),", "mm", "force"),
        ("Time (s),Stroke (mm),Load (mn),", "mn", "force"),
        ("Time (s),Stroke (ells),Load (N),", "ells", "extension"),
        ("Time,Stroke,Load,\nsec,mm,tons,", "tons", "force"),
        ("Time,Stroke,Load,\nsec,ells,N,", "ells", "extension"),
    ] {
        let message = message(&rows(header), &specimen());
        for part in [
            format!("has the {quantity} in column "),
            format!("`{unit}`"),
            format!("--units {quantity}=UNIT"),
        ] {
            assert!(message.contains(&part), "{header}: {message}");
        }
        let known = if quantity == "force" { "daN" } else { "inches" };
        assert!(message.contains(known), "{header}: {message}");
    }
    // The options decide, and a column that is not read may have any unit.
    let stated = RecordOptions { units: vec![(Quantity::Force, "N".into())], ..specimen() };
    is_polymer(&rows("Time (s),Stroke (mm),Load (Cell 1),"), &stated);
    is_polymer(&rows("Time (moons),Stroke (mm),Load (N),Energy (ergs)"), &specimen());
    let both = text(&POLYMER, "Load (tons),Strain (1),Stress (MPa),", 1.0, 1.0);
    is_polymer(&both, &RecordOptions::default());
}

/// Every sign that separates a unit from a name, and words in place of it; a force without a unit
/// could be in any.
#[test]
fn a_unit_is_read_in_every_sign_or_refused() {
    let rows = |header: &str| text(&STEEL, header, 1.0 / LENGTH, 1e3 / AREA);
    for force in ["Force {kN}", "Force <kN>", "Force..kN.", "kN Force", "Force kilonewtons"] {
        let fit = read(&rows(&format!("Time,Stroke (mm),{force},")), &specimen()).unwrap();
        assert!((fit.young.mean / STEEL.young - 1.0).abs() < 0.01, "{force}: {:?}", fit.young);
    }
    let above = "s,mm,kN,\nTime,Stroke,Force,";
    let fit = read(&rows(above), &specimen()).unwrap();
    assert!((fit.young.mean / STEEL.young - 1.0).abs() < 0.01, "{:?}", fit.young);
    for (force, part) in [
        ("Force", " without a unit"),
        ("Force kilopounds", ": `kilopounds`"),
        ("Force (x10 N)", ": `x10`"),
        ("Force (kN) N", ": `kN`"),
        ("Force kN/s", ": `kN/s`"),
    ] {
        let message = message(&rows(&format!("Time,Stroke (mm),{force},")), &specimen());
        assert!(message.contains(part) && message.contains("--units force=UNIT"), "{message}");
    }
    let message = message(&rows("Time,Stroke ells,Force (N),"), &specimen());
    assert!(message.contains("`ells`"), "{message}");
}

/// A strain across the specimen, or one of unknown words, does not replace the extension.
#[test]
fn columns_of_other_things_are_named_and_not_read() {
    for other in ["Transverse strain (1)", "Querdehnung (1)", "Rubidium strain (1)"] {
        let header = format!("{other},Stroke (mm),Load (N),");
        let text = text(&POLYMER, &header, 1.0 / LENGTH, 1.0 / AREA);
        let options = RecordOptions { units: vec![(Quantity::Stress, "GPa".into())], ..specimen() };
        is_polymer(&text, &options);
        let fit = read(&text, &options).unwrap();
        let expected = ["--units stress=GPa".to_owned(), format!("column 1 `{other}`")];
        assert_eq!(fit.specimens[0].unused, expected);
    }
}

#[test]
fn a_chosen_column_that_is_not_read_is_named() {
    let text = text(&POLYMER, "p,q,r,", 1.0, 1.0);
    let columns = [(Quantity::Extension, "1"), (Quantity::Strain, "2"), (Quantity::Stress, "3")];
    let columns = columns.map(|(quantity, number)| (quantity, number.to_owned())).to_vec();
    let units = vec![(Quantity::Strain, "1".into()), (Quantity::Stress, "MPa".into())];
    let options = RecordOptions { columns, units, ..RecordOptions::default() };
    is_polymer(&text, &options);
    assert_eq!(read(&text, &options).unwrap().specimens[0].unused, ["column 1 `p`"]);
}

#[test]
fn a_cell_with_a_unit_is_quoted() {
    let rows = "Strain,Stress\n0.0%,0 MPa\n0.1%,2.5 MPa\n";
    assert!(message(rows, &specimen()).contains("line 3 is `0.1%,2.5 MPa`"));
    let rows = "Time,Strain,Stress (MPa)\n0,0.0%,0\n1,0.1%,2.5\n";
    let message = message(rows, &specimen());
    assert!(
        message.contains("`0.0%` in column 2") && message.contains("a unit belongs"),
        "{message}"
    );
}

#[test]
fn the_record_says_how_each_column_was_read() {
    let folder = tempfile::tempdir().unwrap();
    let header = "Time,Strain 1,engineering_stress,";
    let path = write(folder.path(), "test.csv", &text(&POLYMER, header, 1.0, 1.0));
    let ksi =
        RecordOptions { units: vec![(Quantity::Stress, "ksi".into())], ..RecordOptions::default() };
    for (options, unit, factor, words) in [
        (RecordOptions::default(), None, 1.0, "no unit stated: taken as MPa"),
        (ksi, Some("ksi"), 6.894_757_293_168_361, "in ksi"),
    ] {
        let fit = fit_with(std::slice::from_ref(&path), &OPTIONS, &options);
        let [load, deformation] = &fit.specimens[0].read_as;
        assert_eq!((load.quantity, load.number), (Quantity::Stress, 3));
        assert_eq!(load.unit.as_deref(), unit);
        assert!((load.factor / factor - 1.0).abs() < 1e-14, "{}", load.factor);
        assert_eq!(load.to_string(), format!("stress from column 3 `engineering_stress`, {words}"));
        assert!((fit.young.mean / factor / POLYMER.young - 1.0).abs() < 0.01);
        // The number of a specimen is no unit.
        assert_eq!(deformation.quantity, Quantity::Strain);
        assert_eq!((deformation.number, &deformation.unit), (2, &None));
    }
}

/// 1,234 N is not 1.234 N: separators of thousands are read where the file tells them from a
/// decimal sign, and else refused.
#[test]
fn separators_of_thousands_are_read_or_refused() {
    let rows = |header: &str, row: &dyn Fn(f64, f64) -> String| {
        let rows = POLYMER.record(400).into_iter();
        let rows: Vec<String> = rows.map(|[e, s]| row(50.0 * e, 100.0 * s)).collect();
        format!("{header}\n{}\n", rows.join("\n"))
    };
    let grouped = |number: f64, sign: &str| match number {
        n if n < 999.5 => format!("{n:.0}"),
        n => format!("{}{sign}{:03.0}", (n / 1e3).floor(), (n % 1e3).floor()),
    };
    let wide = RecordOptions { width: Some(20.0), thickness: Some(5.0), ..specimen() };
    let comma = |sign: &str| {
        rows("Weg (mm);Kraft (N)", &|x, f| {
            let way = format!("{x:.5}").replace('.', ",");
            format!("{way};{},5", grouped(f, sign))
        })
    };
    let states =
        rows("Extension (mm),Load (N)", &|x, f| format!("\"{x:.5}\",\"{}.5\"", grouped(f, ",")));
    let swiss = rows("Weg (mm);Kraft (N)", &|x, f| format!("{x:.5};{}.5", grouped(f, "'")));
    for text in [states, swiss, comma("."), comma("\u{202f}")] {
        is_polymer(&text, &wide);
    }
    for (case, text) in [
        (
            "whole numbers, comma",
            rows("Weg (um);Kraft (N)", &|x, f| format!("{:.0};{}", 1e3 * x, grouped(f, ","))),
        ),
        (
            "whole numbers, point",
            rows("Weg (um);Kraft (N)", &|x, f| format!("{:.0};{}", 1e3 * x, grouped(f, "."))),
        ),
    ] {
        let message = message(&text, &wide);
        assert!(message.contains("separators of thousands"), "{case}: {message}");
    }
    // Other separators are found between such numbers: an error too.
    let unquoted = rows("Extension (mm),Load (N)", &|x, f| format!("{x:.5},{}", grouped(f, ",")));
    message(&unquoted, &wide);
}

/// Words and numbers of a machine in four languages, with the dimensions above the table.
#[test]
fn records_in_other_languages_state_the_dimensions_of_their_specimens() {
    for (above, header) in [
        (
            "Épaisseur,0.5,mm\nLargeur,1,cm\nL0 - course standard,50,mm",
            "Temps (s),Course (mm),Force (N),",
        ),
        (
            "Probenbreite (mm),10,\nProbendicke (mm),0.5\nMesslänge (mm),50",
            "Zeit (s),Weg (mm),Kraft (N),",
        ),
        ("Ancho,10\nEspesor,0.5\nLongitud inicial,50", "Tiempo (s),Alargamiento (mm),Fuerza (N),"),
        (
            "Larghezza: 10 mm\nSpessore: 500 um\nLunghezza iniziale = 50",
            "Tempo (s),Corsa (mm),Forza (N),",
        ),
    ] {
        let header = format!("{above}\n{header}");
        let text = text(&POLYMER, &header, 1.0 / LENGTH, 1.0 / AREA);
        is_polymer(&text, &RecordOptions::default());
        let fit = read(&text, &RecordOptions::default()).unwrap();
        let stated = fit.specimens[0].stated.iter();
        let stated: Vec<_> = stated.map(|it| (it.name, it.value)).collect();
        let expected = [("width", 10.0), ("thickness", 0.5), ("gauge-length", 50.0)];
        assert_eq!(stated, expected, "{above}");
        // An option decides, and a file that contradicts it is refused.
        let wider = RecordOptions { width: Some(10.5), ..RecordOptions::default() };
        let fit = read(&text, &wider).unwrap();
        assert!((fit.young.mean / (POLYMER.young / 1.05) - 1.0).abs() < 0.01);
        let [unused] = &fit.specimens[0].unused[..] else { panic!() };
        assert!(unused.starts_with("width 10 mm (line "), "{unused}");
        let wide = RecordOptions { width: Some(20.0), ..RecordOptions::default() };
        let message = message(&text, &wide);
        assert!(message.contains("states width 10 mm (line ") && message.contains("--width 20"));
    }
}

#[test]
fn specimens_of_one_file_are_evaluated_one_by_one() {
    let second = Law { young: 2600.0, ..POLYMER };
    let [one, two] = [&POLYMER, &second].map(|law| {
        let header = "Specimen,,,\nTime (s),Strain (1),Stress (MPa),";
        text(law, header, 1.0, 1.0)
    });
    let lines = one.lines().zip(two.lines());
    let columns: Vec<String> = lines.map(|(one, two)| format!("{one},{two}")).collect();
    for text in [format!("{one}{two}"), columns.join("\n")] {
        let fit = read(&text, &RecordOptions::default()).unwrap();
        let [first, second] = &fit.specimens[..] else {
            panic!("{} specimens", fit.specimens.len())
        };
        assert!(second.path.ends_with("test.csv (specimen 2)"));
        for (specimen, young) in [(first, 2500.0), (second, 2600.0)] {
            assert!((specimen.young / young - 1.0).abs() < 0.01, "{}", specimen.young);
        }
    }
}

#[test]
fn the_documentation_lists_the_known_units() {
    let page = include_str!("../../../docs/MATERIALS.md");
    for quantity in [Quantity::Force, Quantity::Stress, Quantity::Extension, Quantity::Strain] {
        let row = format!("\n| {quantity} | ");
        let (_, row) = page.split_once(&row).unwrap();
        let units = format!("| {} |", quantity.units());
        assert!(row.lines().next().unwrap().ends_with(&units), "{units}");
    }
}
