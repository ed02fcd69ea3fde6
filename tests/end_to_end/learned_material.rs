//! `kirigami material learn`: rounds of rays, stopped and continued, and what its folder refuses.

use crate::common::{Workplace, failure};
use std::path::{Path, PathBuf};
use support::sealed_json;
use surrogate::Surrogate;
use toml_edit::{Array, value};

const POLYPROPYLENE: &str = "configs/materials/polypropylene-0.8mm.toml";
const OPTIONS: &str = "--tier tiny --rays 6 --spot-rays 16 --out learned";

/// The command with two networks of the film.
fn learn(material: &str, options: &str) -> String {
    learn_from(&["medium-1", "medium-2"], material, options)
}

fn learn_from(weights: &[&str], material: &str, options: &str) -> String {
    let from = weights.iter().map(|name| format!("--from {}", shipped(name).display()));
    let from: Vec<String> = from.collect();
    format!("material learn {} {material} {options}", from.join(" "))
}

/// Weights of the film, or a file with an absolute path.
fn shipped(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/pet-0.5mm");
    folder.join(name).with_added_extension("safetensors")
}

/// Twenty-four short rays of three boxes, and a short training.
fn shorten(work: &Workplace) {
    work.edit_campaign(
        "learned/campaign.toml",
        |campaign| {
            // It has a spot check and trainings of its own, and one mesh.
            for key in ["finer_tier", "spot_rays", "training"] {
                assert!(!campaign.contains_key(key), "{key}");
            }
        },
        |place, rays| {
            assert!(!rays.contains_key("finer"));
            rays["count"] = value(if place == 0 { 22 } else { 1 });
            rays["eta_a"] = value(Array::from_iter([-0.1, 0.05]));
            rays["eta_s"] = value(0.05);
            rays["theta_deg"] = value(Array::from_iter([10.0, 20.0]));
            rays["median_deg"] = value(15.0);
        },
    );
    work.edit("learned/fine-tuning.toml", &[("epochs = 80", "epochs = 3")]);
}

/// The summary of the spot check's database, and the number of states in the first round of
/// learn.csv.
fn spot_check(work: &Workplace) -> (String, String) {
    let summary = work.output("dataset summary learned/spot-check.parquet");
    let table = work.read("learned/learn.csv");
    let round = table.lines().nth(1).unwrap();
    (summary, round.split(',').nth(4).unwrap().to_owned())
}

/// Makes the damage at the end of every solved window negative.
fn spoil_last_states(solves: &Path) {
    let below = |folder: &Path| -> Vec<_> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().path()).collect()
    };
    for solve in below(solves).iter().flat_map(|digits| below(digits)) {
        let text = std::fs::read_to_string(solve.join("rows.csv")).unwrap();
        let (before, last) = text.trim_end().rsplit_once('\n').unwrap();
        let damage = text.lines().next().unwrap().split(',');
        let damage = damage.clone().position(|column| column == "d").unwrap();
        let mut cells: Vec<&str> = last.split(',').collect();
        cells[damage] = "-1.0";
        let text = format!("{before}\n{}\n", cells.join(","));
        let path = solve.join("result.json");
        let record = std::fs::read(&path).unwrap();
        let mut record: serde_json::Value = sealed_json::from_slice(&record).unwrap();
        record["rows_hash"] = blake3::hash(text.as_bytes()).to_hex().to_string().into();
        std::fs::write(solve.join("rows.csv"), text).unwrap();
        std::fs::write(path, sealed_json::to_vec(&record).unwrap()).unwrap();
    }
}

#[test]
fn a_stopped_run_is_continued_and_its_folder_belongs_to_one_material() {
    let work = Workplace::new();
    let stopped =
        work.program(&learn(POLYPROPYLENE, &format!("{OPTIONS} --time 0s"))).output().unwrap();
    assert_eq!(stopped.status.code(), Some(75), "{stopped:?}");
    let said = String::from_utf8_lossy(&stopped.stdout);
    assert!(said.contains("no weights yet"), "{said}");
    assert!(!work.path("learned/weights.safetensors").exists());
    shorten(&work);

    // No round reaches an error of zero, so that all rays are solved.
    let options = format!("{OPTIONS} --accuracy 0.0001%");
    work.refuses(&learn(POLYPROPYLENE, &options), &["all 24 rays"]);
    let table = work.read("learned/learn.csv");
    let numbers = |row: &str| -> Vec<f64> {
        let cells = row.split(',').take(7);
        cells.map(|cell| cell.parse().unwrap()).collect()
    };
    let rows: Vec<Vec<f64>> = table.lines().skip(1).map(numbers).collect();
    let rays: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(rays, [6.0, 12.0, 24.0]);
    // All rays reach their ends, and W has an error.
    assert!(rows.iter().all(|row| row[1] == 1.0 && row[6] > 0.0), "{table}");

    // The finished rounds are read again, not solved or trained.
    let fits = work.path("learned/fits/6-rays.safetensors");
    let before = std::fs::metadata(&fits).unwrap().modified().unwrap();
    let printed =
        work.output(&learn(POLYPROPYLENE, &format!("{OPTIONS} --accuracy 100% --forces 100%")));
    for text in ["accurate enough", "asked 100 %", "95 % interval", "holes over w_lig"] {
        assert!(printed.contains(text), "{text}: {printed}");
    }
    let next = printed.lines().find_map(|line| line.strip_prefix("next:    kirigami "));
    work.output(next.unwrap());
    let scene = work.read("learned/sheet/scene.toml");
    assert!(scene.contains("weights = \"../weights.safetensors\""), "{scene}");
    assert_eq!(std::fs::metadata(&fits).unwrap().modified().unwrap(), before);
    // Accurate enough are also the weights of six rays, but more are solved.
    let card = work.read("learned/weights.json");
    let card: serde_json::Value = serde_json::from_str(&card).unwrap();
    assert!(card["training_rays"].as_u64().unwrap() > 6, "{card}");
    assert_eq!(card["spot_check"]["errors"]["rows"], 64);
    // Rows that the database of the spot check rejects test no weights.
    let (summary, states) = spot_check(&work);
    assert!(summary.contains("64 rows of 16 rays"), "{summary}");
    assert_eq!(states, "64");
    spoil_last_states(&work.path("learned/spot-check/solves"));
    work.output(&learn(POLYPROPYLENE, &format!("{OPTIONS} --accuracy 100% --forces 100%")));
    let (summary, states) = spot_check(&work);
    assert!(summary.contains("rejected"), "{summary}");
    assert!(
        states != "64" && summary.contains(&format!("{states} rows of 16 rays")),
        "{states} states: {summary}"
    );

    let card = work.output("surrogate card learned/weights.safetensors");
    assert!(
        card.contains("polypropylene-0.8mm")
            && card.contains("fine-tuned from")
            && card.matches("distilled from").count() == 2,
        "{card}"
    );
    // One network alone, of other sizes than the configuration has, is fine-tuned and kept.
    let options = format!("{OPTIONS} --accuracy 100% --forces 100%");
    work.output(&learn_from(&["small"], POLYPROPYLENE, &options));
    let card = work.output("surrogate card learned/weights.safetensors");
    assert!(card.contains("fine-tuned from") && !card.contains("distilled from"), "{card}");
    // Several networks must have the same sizes.
    let message =
        failure(&mut work.program(&learn_from(&["medium-1", "small"], POLYPROPYLENE, &options)));
    assert!(message.contains("small.safetensors: its layers have other sizes"), "{message}");

    for (material, options, expected) in [
        ("configs/materials/s235-1.5mm.toml", OPTIONS, "another material law"),
        (POLYPROPYLENE, "--out learned", "pass --tier tiny"),
    ] {
        let message = failure(&mut work.program(&learn(material, options)));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn no_weights_are_trained_that_too_few_states_would_test() {
    let work = Workplace::new();
    let options = "--tier tiny --spot-rays 3 --accuracy 6% --forces 6% --out learned";
    work.refuses(&learn(POLYPROPYLENE, options), &["12 states on 3 rays are too few to assess"]);
    assert!(!work.path("learned/campaign").exists());
}

#[test]
fn unsuitable_weights_are_refused_before_a_window_is_solved() {
    let work = Workplace::new();
    let small = Surrogate::load(&shipped("small")).unwrap();
    let mut card = small.card().clone();
    card.damage_sharpness = 9.0;
    let sharper = Surrogate::from_parts(small.layers(), card).unwrap();
    let path = work.path("sharper");
    sharper.save(&path.with_added_extension("safetensors")).unwrap();
    work.refuses(
        &learn_from(&[path.to_str().unwrap()], POLYPROPYLENE, OPTIONS),
        &["sharper.safetensors", "damage_sharpness"],
    );
    assert!(!work.path("learned/campaign").exists());
}
