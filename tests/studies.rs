//! Studies of sheets, end to end on small ones: what they write, and what they say to a scene that is none of
//! theirs.

mod common;

use common::Workplace;
use std::path::Path;

const PIN: &str = "configs/scenes/pin-7x7.toml";

/// What a study wrote of a run with arguments.
fn page(work: &Workplace, arguments: &str, file: &str) -> String {
    work.output(&format!("study {arguments} --out out"));
    std::fs::read_to_string(work.path("out").join(file)).unwrap()
}

/// The numbers in the columns of the first table row that begins with `name`.
fn numbers(page: &str, name: &str) -> Vec<f64> {
    let begins = format!("| {name} |");
    let row = page.lines().find(|line| line.starts_with(&begins)).unwrap();
    let cells = row.split('|').filter_map(|cell| cell.trim().parse().ok());
    cells.collect()
}

#[test]
fn silhouettes_and_what_they_keep() {
    let work = Workplace::new();
    let scene = "configs/scenes/shield-16x22.toml";
    let edits = [
        ("panels = [16, 22]", "panels = [4, 6]"),
        ("steps = 600", "steps = 40"),
    ];
    work.edit(scene, &edits);
    let study = format!("silhouettes {scene} configs/targets/leaf.svg configs/targets/bell.svg");
    let first = page(&work, &study, "silhouettes.md");
    let [panel_shape, distance, rms, iou] = numbers(&first, "leaf")[..4] else {
        panic!("{first}");
    };
    assert_eq!(panel_shape, 0.03);
    assert!(0.0 < distance && distance < rms && rms < 10.0, "{first}");
    assert!((0.5..1.0).contains(&iou), "{first}");
    // The runs are kept, so that the second time nothing is searched.
    let again = page(&work, &study, "silhouettes.md");
    assert_eq!(numbers(&again, "bell")[..4], numbers(&first, "bell")[..4]);
    assert!(work.path("out/silhouettes.png").exists());
}

#[test]
fn optimisers_and_approaches_on_pins() {
    let work = Workplace::new();
    work.edit(PIN, &[("panels = [7, 7]", "panels = [4, 4]")]);
    let text = std::fs::read_to_string(work.path(PIN)).unwrap();
    let steps = text.lines().find(|line| line.starts_with("steps")).unwrap();
    work.edit(PIN, &[(steps, "steps = 20")]);
    let optimisers = page(&work, &format!("optimisers {PIN}"), "optimisers.md");
    for name in ["Adam", "L-BFGS"] {
        assert!(optimisers.contains(name), "{optimisers}");
    }
    let approaches = page(
        &work,
        &format!("approaches {PIN} --steps 20"),
        "approaches.md",
    );
    assert!(approaches.contains("chart"), "{approaches}");
}

#[test]
fn the_five_actuations_and_a_missing_one() {
    let work = Workplace::new();
    for case in 1..=5 {
        let scene = format!("configs/scenes/actuation-{case}.toml");
        let text = std::fs::read_to_string(work.path(&scene)).unwrap();
        let steps = text.lines().find(|line| line.starts_with("steps")).unwrap();
        work.edit(&scene, &[(steps, "steps = 1")]);
    }
    let actuations = page(&work, "actuations", "actuations.md");
    assert!(actuations.contains("15 x 10 panels"), "{actuations}");
    assert!(actuations.contains("Voids of the 35 "), "{actuations}");
    let removed = "configs/scenes/actuation-3.toml";
    std::fs::remove_file(work.path(removed)).unwrap();
    assert!(work.error("study actuations --out out").contains(removed));
}

#[test]
fn where_the_panels_stay_flat() {
    let work = Workplace::new();
    let text = page(&work, "localisation", "localisation.md");
    // (22) for the film: L* in cm, beside Table 2.
    let film = text.lines().find(|line| line.starts_with("| pet")).unwrap();
    assert!(film.ends_with("| 6.3 |"), "{film}");
    assert!(
        work.error("study localisation --edge=-1 --out out")
            .contains("--edge")
    );
}

#[test]
fn the_chain_is_judged_by_the_weights_it_is_told() {
    let work = Workplace::new();
    let scene = "configs/scenes/pet-3x3.toml";
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/pet-0.5mm");
    std::fs::create_dir_all(work.path("data/pet-0.5mm")).unwrap();
    for file in [
        "small.safetensors",
        "small.json",
        "medium.safetensors",
        "medium.json",
    ] {
        let there = work.path("data/pet-0.5mm").join(file);
        std::fs::copy(data.join(file), there).unwrap();
    }
    let text = std::fs::read_to_string(work.path(scene)).unwrap();
    let steps = text.lines().find(|line| line.starts_with("steps")).unwrap();
    work.edit(scene, &[(steps, "steps = 2")]);
    let weights = |name: &str| format!("data/pet-0.5mm/{name}.safetensors");
    let study = format!(
        "chain {scene} {} {} --reference {}",
        weights("small"),
        weights("medium"),
        weights("medium")
    );
    let chain = page(&work, &study, "chain.csv");
    let shape = |choice: &str| -> f64 {
        let row = chain.lines().find(|line| line.contains(choice)).unwrap();
        row.split(',').nth(5).unwrap().parse().unwrap()
    };
    // The reference differs from itself by its tolerance and load steps alone.
    assert!(shape("\"medium\"") < 1e-6, "{chain}");
    assert!(shape("\"small\"") > 1e-4, "{chain}");
    let linear = "study chain configs/scenes/linear-7x7.toml --reference data/pet-0.5mm/small.safetensors --out out";
    assert!(work.error(linear).contains("hinge = \"surrogate\""));
}
