//! The studies, end to end on small scenes: the files they write, and their errors for unsuitable scenes.

#[path = "../../tests/common/mod.rs"]
mod common;
#[path = "../../tests/common/failing_ccx.rs"]
mod failing_ccx;

use common::{Workplace, failure};
use failing_ccx::failing_ccx;
use std::path::{Path, PathBuf};

/// The page that a study writes when run with the given arguments.
fn page(work: &Workplace, arguments: &str, file: &str) -> String {
    work.output(&format!("{arguments} --out out"));
    std::fs::read_to_string(work.path("out").join(file)).unwrap()
}

/// Sets the number of search steps of a scene.
fn set_steps(work: &Workplace, scene: &str, steps: usize) {
    let text = std::fs::read_to_string(work.path(scene)).unwrap();
    let old = text.lines().find(|line| line.starts_with("steps")).unwrap();
    work.edit(scene, &[(old, &format!("steps = {steps}"))]);
}

/// Copies the shipped weights of the film, including the ensemble of its scenes.
fn shipped_weights(work: &Workplace) {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/pet-0.5mm");
    std::fs::create_dir_all(work.path("data/pet-0.5mm")).unwrap();
    for name in ["small", "medium", "medium-1", "medium-2", "medium-3"] {
        for file in ["safetensors", "json"].map(|kind| format!("{name}.{kind}")) {
            let there = work.path("data/pet-0.5mm").join(&file);
            std::fs::copy(data.join(&file), there).unwrap();
        }
    }
}

#[test]
fn the_chain_is_compared_with_the_given_reference() {
    let work = Workplace::new();
    let scene = "configs/scenes/pet-3x3.toml";
    shipped_weights(&work);
    set_steps(&work, scene, 2);
    // The card of a network trained on a coarser mesh.
    let card = work.path("data/pet-0.5mm/small.json");
    let mut content: serde_json::Value =
        support::sealed_json::from_slice(&std::fs::read(&card).unwrap()).unwrap();
    content["tier"] = "tiny".into();
    std::fs::write(&card, support::sealed_json::to_vec(&content).unwrap()).unwrap();
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
    assert!(chain.contains("window tier,small,") && chain.contains("network,medium,"));
    // The reference differs from itself by its tolerance and load steps only.
    assert!(shape("network,medium,") < 1e-6, "{chain}");
    assert!(shape("tier,small,") > 1e-4, "{chain}");
    let linear = "chain configs/scenes/linear-7x7.toml --reference data/pet-0.5mm/small.safetensors --out out";
    assert!(work.error(linear).contains("hinge = \"surrogate\""));
}

#[test]
fn a_study_without_any_solution_is_an_error() {
    let work = Workplace::new();
    let study = |ccx: PathBuf| {
        let mut study = work.program("window --quick --out study");
        failure(study.env("KIRIGAMI_CCX", ccx))
    };
    // A broken solver leaves no rows, its windows are tried again, and a full disk ends the study.
    let below = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().path())
    };
    let kept = || {
        let solves = below(work.path("study/solves")).flat_map(below);
        solves
            .filter(|solve| solve.join("rows.csv").exists())
            .count()
    };
    let message = study(failing_ccx(
        &work.path(""),
        "echo ' *ERROR reading *SOLID SECTION'",
    ));
    assert!(message.contains("refused its input"), "{message}");
    assert_eq!(kept(), 0);
    let full = "echo '1 1 1U 4 0. 0. 0.005' > window.sta; echo 'No space left on device'";
    let message = study(failing_ccx(&work.path(""), full));
    assert!(message.contains("No space left"), "{message}");
    assert_eq!(kept(), 0);
}

#[test]
fn the_tables_of_the_studies_are_joined_in_one_page() {
    let work = Workplace::new();
    let row = "| choice | cost | error |\n|---|---|---|\n| fine | 30 s | 1 % |\n";
    std::fs::create_dir_all(work.path("results/tiers")).unwrap();
    std::fs::write(work.path("results/tiers/tradeoff.md"), row).unwrap();
    work.output("tradeoff --results results --out page.md");
    let page = std::fs::read_to_string(work.path("page.md")).unwrap();
    assert!(page.starts_with("# Speed against accuracy") && page.contains("30 s"));
    let error = work.error("tradeoff --results configs --out other.md");
    assert!(error.contains("kirigami-studies"), "{error}");
}
