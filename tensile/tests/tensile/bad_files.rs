//! Each bad file gets a message that names the file, the place and what to do.

use super::{HEADER, OPTIONS, VOCE, csv, write};
use tensile::{MaterialFit, RecordOptions};

/// The message for one text.
fn message(text: &str) -> String {
    message_with(text, &RecordOptions::default())
}

fn message_with(text: &str, options: &RecordOptions) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "test.csv", text);
    let records = [(path, options.clone())];
    let error = MaterialFit::new(&records, &OPTIONS).map(|fit| fit.table);
    let message = error.unwrap_err().to_string();
    assert!(message.contains("test.csv"), "{message}");
    message
}

/// The record of a Voce law with other units.
fn record(header: &str, strain_unit: f64, stress_unit: f64) -> String {
    let rows = VOCE.record_to(0.08, 2000).into_iter();
    let rows: Vec<[f64; 2]> = rows.map(|[e, s]| [e / strain_unit, s / stress_unit]).collect();
    csv(header, &rows)
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table")]
fn the_message_says_what_to_do() {
    let good = csv(HEADER, &VOCE.record(2000));
    let third = good.lines().nth(3).unwrap();
    let reversed: Vec<[f64; 2]> = VOCE.record(2000).into_iter().rev().collect();
    let elastic: Vec<[f64; 2]> = VOCE.record(2000).into_iter().take(20).collect();
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("empty", String::new(), &["no rows of numbers", "save the curve"]),
        ("header alone", format!("{HEADER}\n"), &["no rows of numbers"]),
        ("one column", "Stress (MPa)\n1\n2\n3\n".into(), &["one column", "needs two"]),
        (
            "text in a cell",
            good.replacen(third, "abc,12", 1),
            &[":4: `abc` in column 1 `Tensile strain (1)`", "correct the cell"],
        ),
        ("a missing cell", good.replacen(third, "0.001,", 1), &[":4: `` in column 2"]),
        ("not a number", good.replacen(third, "0.001,NaN", 1), &[":4: `NaN` in column 2"]),
        ("no names", csv("", &VOCE.record(100)), &["--columns strain=1,stress=2"]),
        (
            "two strains",
            "Strain 1 (%),Strain 2 (%),Stress (MPa)\n0,0,0\n1,1,1\n".into(),
            &["columns 1 `Strain 1 (%)` and 2 `Strain 2 (%)`", "--columns strain=NUMBER"],
        ),
        (
            "a force and an extension",
            record("Extension (mm),Force (N)", 1.0, 1.0),
            &["contains a force and a length change", "give --width, --thickness, --gauge-length"],
        ),
        ("an extension", record("Extension (mm),Stress (MPa)", 1.0, 1.0), &["give --gauge-length"]),
        ("Pa without unit", record("Strain (1),Stress", 1.0, 1e-6), &["--units stress=Pa"]),
        (
            "GPa read as MPa",
            record("Strain (1),Stress (MPa)", 1.0, 1e4),
            &["modulus", "stress in GPa"],
        ),
        (
            "per cent without unit",
            record("Strain,Stress (MPa)", 0.05, 1.0),
            &["without a unit", "--units strain=%"],
        ),
        (
            "per cent read as a fraction",
            record("Strain (1),Stress (MPa)", 0.01, 1.0),
            &["more than 0.1: is the strain in per cent"],
        ),
        (
            "a fraction read as per cent",
            record("Strain (%),Stress (MPa)", 1.0, 1.0),
            &["--units strain=1"],
        ),
        (
            "swapped names",
            record("Stress (MPa),Strain (1)", 1.0, 1.0),
            &["are the columns swapped"],
        ),
        (
            "falling strain",
            csv(HEADER, &reversed),
            &[":3: from here on the strain falls", "sort the rows"],
        ),
        ("elastic", csv(HEADER, &elastic), &["before a plastic strain of 0.2 %"]),
        (
            "decimal commas between commas",
            "Strain (%),Stress (MPa)\n0,0,0,0\n0,1,2,5\n".into(),
            &["decimal sign", "semicolons"],
        ),
        ("no load", "Strain (%),Stress (MPa)\n0,0\n1,0\n2,0\n3,0\n".into(), &["no linear part"]),
        (
            "a table",
            "true_stress_mpa,plastic_strain\n10,0\n20,1\n".into(),
            &["hardening table already"],
        ),
        (
            "a table in per cent",
            "true_stress_mpa,plastic_strain\n44,0\n50,60\n".into(),
            &["per cent"],
        ),
        ("other names", "wear,tear\n1,2\n".into(), &["has the columns 1 `wear`, 2 `tear`"]),
        ("no pair", "true_stress_mpa,engineering_strain\n1,2\n".into(), &["no pair of stress"]),
        (
            "engineering and true values",
            "engineering_stress_mpa,engineering_strain,true_stress_mpa,plastic_strain\n1,2,3,4\n"
                .into(),
            &["both engineering and true values"],
        ),
        (
            "a negative strain",
            "engineering_stress_mpa,engineering_strain\n0,0\n30,-2\n".into(),
            &["violates"],
        ),
    ];
    for (case, text, expected) in cases {
        let message = message(&text);
        for part in expected {
            assert!(message.contains(part), "{case}: {message}");
        }
    }
}

#[test]
fn specimens_of_two_kinds_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let files = [("film.csv", super::FILM), ("metal.csv", VOCE)];
    let records = files.map(|(name, law)| {
        let path = write(folder.path(), name, &csv(HEADER, &law.record(6000)));
        (path, RecordOptions::default())
    });
    let message = MaterialFit::new(&records, &OPTIONS).unwrap_err().to_string();
    assert!(
        message.contains("film.csv have a draw plateau") && message.contains("metal.csv have none"),
        "{message}"
    );
}

/// The strain and the stress of such files have no unit that could be wrong.
#[test]
fn the_messages_for_force_and_extension_name_their_own_options() {
    let text = record("Extension (mm),Force (N)", 1.0, 1.0);
    let of_load = ["--thickness", "--width", "--units force="];
    let of_deformation = ["--gauge-length", "--units extension="];
    // Strains far too small, stresses far too small, both far too large.
    for (gauge_length, width, expected) in [
        (1e6, 10.0, &of_load[..]),
        (1.0, 1e7, &of_deformation),
        (1e-3, 10.0, &of_deformation),
        (1.0, 1e-7, &of_load),
    ] {
        let options = RecordOptions {
            gauge_length: Some(gauge_length),
            width: Some(width),
            thickness: Some(0.5),
            ..RecordOptions::default()
        };
        let message = message_with(&text, &options);
        for option in expected {
            assert!(message.contains(option), "{message}");
        }
        assert!(!message.contains("strain=") && !message.contains("stress="), "{message}");
    }
}
