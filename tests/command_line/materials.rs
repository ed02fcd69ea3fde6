//! `kirigami material`: the shipped records become a material that the other commands read.

use crate::common::Workplace;
use serde_json::Value;

/// The command of docs/MATERIALS.md.
const FIT: &str = "material fit configs/tensile/strip-1.csv configs/tensile/strip-2.csv configs/tensile/strip-3.csv \
                   --name film --thickness 0.5 --width 10 --gauge-length 50 --density-kg-m3 1390 --poisson 0.4";

fn number(json: &Value, path: &str) -> f64 {
    let value = json.pointer(path).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("no number {path}: {json:#}"))
}

/// Mean of the factors of the three records.
const FACTOR: f64 = (1.0 + 0.975 + 1.03) / 3.0;

/// The records are curves of sigma = 46 - 12 exp(-p / 0.003) + 8 (L^2 - 1 / L) with L = exp(p) and
/// E = 3000 MPa, times 1, 0.975 and 1.03. The expected numbers follow from this law; plateau and
/// natural draw ratio by Maxwell's rule.
#[test]
fn records_of_a_film_become_a_material_file_that_is_checked() {
    let work = Workplace::new();
    let printed = work.output(FIT);
    for text in
        ["strip-2.csv", "natural draw ratio", "note: between the plastic strains", "material check"]
    {
        assert!(printed.contains(text), "{text}: {printed}");
    }
    work.refuses(FIT, &["film.toml exists", "--replace"]);
    let json = work.json(&format!("{FIT} --replace --json"));
    for (path, expected, tolerance) in [
        ("/fit/young/mean", 3000.0, 0.03),
        ("/fit/offset_yield/mean", FACTOR * 38.654, 0.02),
        ("/fit/upper_yield/mean", FACTOR * 44.896, 0.01),
        ("/fit/plateau/mean", FACTOR * 37.529, 0.01),
        ("/fit/draw_ratio/mean", 3.3157, 0.02),
    ] {
        let found = number(&json, path);
        assert!((found / expected - 1.0).abs() < tolerance, "{path}: {found} {expected}");
    }
    let scatter =
        number(&json, "/fit/offset_yield/deviation") / number(&json, "/fit/offset_yield/mean");
    // The standard deviation of 1, 0.975 and 1.03.
    assert!((scatter / 0.0275 - 1.0).abs() < 0.4, "{scatter}");
    let causes = json["fit"]["specimens"][1]["dropped"].as_array().unwrap();
    for cause in ["toe", "unloading", "broken"] {
        assert!(causes.iter().any(|row| row["cause"] == cause), "{cause}");
    }
    for picture in ["film.svg", "film.png"] {
        assert!(work.path("runs/material").join(picture).exists());
    }

    let check = "material check runs/material/film.toml configs/scenes/pet-7x7.toml";
    work.prints(check, &["*PLASTIC", "buckles at"]);
    let checked: Value = work.json(&format!("{check} --json"));
    assert_eq!(checked["law_hash"], json["law_hash"]);
}

/// The same force is in N by the file, in kN by an option, and in no stated unit.
#[test]
fn the_unit_of_every_column_is_printed() {
    let work = Workplace::new();
    let row = |printed: &str, quantity: &str| -> Vec<String> {
        let line = printed.lines().find(|line| line.contains(quantity));
        let words = line.unwrap_or_else(|| panic!("{printed}")).split_whitespace();
        words.map(str::to_owned).collect()
    };
    let printed = work.output(FIT);
    let force = row(&printed, " force ");
    let expected = ["strip-1.csv", "force", "3", "Load", "(N)", "N", "1", "N"];
    assert_eq!(force, expected);
    let extension = row(&printed, " extension ");
    assert_eq!(extension[1..3], ["extension", "2"]);
    assert!(!printed.contains("note: no unit"), "{printed}");

    work.edit("configs/tensile/strip-1.csv", &[("(s);(mm);(N)\n", "")]);
    work.refuses(&format!("{FIT} --replace"), &["has the force in column 3 `Load` without a unit"]);
    let printed = work.output(&format!("{FIT} --replace --units force=N"));
    let extension = row(&printed, " extension ");
    assert_eq!(extension[4..], ["not", "stated", "1", "mm"]);
    let note = "note: no unit of the extension is stated in strip-1.csv: taken as mm; --units extension=UNIT states another";
    assert!(printed.contains(note), "{printed}");
}

/// A tough polymer whose stress falls after its maximum: what the table leaves out, and what that
/// means for a hinge.
#[test]
fn what_a_fit_does_not_use_is_printed() {
    let work = Workplace::new();
    let rows = (0..1200).map(|i| 5e-4 * f64::from(i)).map(|e| {
        let stress = 50.0 * (1.0 - (-50.0 * e).exp()) - 20.0 * (e - 0.06).max(0.0);
        format!("{e},{stress}\n")
    });
    let text = format!(
        "Width,10,mm\nLayer thickness,0.2,mm\nStrain (1),Stress (MPa)\n{}",
        rows.collect::<String>()
    );
    work.write("tough.csv", text);
    let printed = work.output(
        "material fit tough.csv --name tough --thickness 2 --density-kg-m3 1000 --draw-ratio 3 --gauge-length 50",
    );
    for note in [
        "note: tough.csv, not used: line 2 `Layer thickness`; width 10 mm (line 1); --gauge-length; --draw-ratio 3",
        "note: tough.csv softens from 48.87 MPa",
        "is said to tear where the specimen begins to neck",
    ] {
        assert!(printed.contains(note), "{note}: {printed}");
    }
}

#[test]
fn a_brittle_material_fails_its_check() {
    let work = Workplace::new();
    let output =
        work.program("material check configs/materials/paper-0.2mm.toml").output().unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("error: a film that opens by 60 deg, as most do, tears"), "{printed}");
    work.output("material check configs/materials/s235-1.5mm.toml");
    // A plate of the shipped scene: neither its width nor its buckling is a finding.
    let plate = "material check configs/materials/polypropylene-3mm.toml configs/scenes/a4-plate-service.toml";
    let plate = work.output(plate);
    assert!(!plate.contains("warning: "), "{plate}");
    work.edit(
        "configs/materials/s235-1.5mm.toml",
        &[("fracture_strain = 0.92", "fracture_strain = 0.02")],
    );
    work.error("material check configs/materials/s235-1.5mm.toml");
}
