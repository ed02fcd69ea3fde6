//! The studies, end to end on small scenes: the files they write, and their errors for unsuitable scenes.

#[path = "../../tests/common/mod.rs"]
mod common;
#[path = "../../tests/common/failing_ccx.rs"]
mod failing_ccx;

use common::{Workplace, failure};
use failing_ccx::failing_ccx;
use std::path::{Path, PathBuf};

const PIN: &str = "configs/scenes/pin-7x7.toml";

/// The page that a study writes when run with the given arguments.
fn page(work: &Workplace, arguments: &str, file: &str) -> String {
    work.output(&format!("{arguments} --out out"));
    std::fs::read_to_string(work.path("out").join(file)).unwrap()
}

/// The numbers in the columns of the first table row that begins with `name`.
fn numbers(page: &str, name: &str) -> Vec<f64> {
    let begins = format!("| {name} |");
    let row = page.lines().find(|line| line.starts_with(&begins));
    let row = row.unwrap_or_else(|| panic!("no row {name} in {page}"));
    let cells = row.split('|').filter_map(|cell| cell.trim().parse().ok());
    cells.collect()
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

/// Sets the number of search steps of a scene.
fn set_steps(work: &Workplace, scene: &str, steps: usize) {
    let text = std::fs::read_to_string(work.path(scene)).unwrap();
    let old = text.lines().find(|line| line.starts_with("steps")).unwrap();
    work.edit(scene, &[(old, &format!("steps = {steps}"))]);
}

#[test]
fn silhouettes_and_their_stored_runs() {
    let work = Workplace::new();
    let scene = "configs/scenes/shield-16x22.toml";
    work.edit(scene, &[("panels = [16, 22]", "panels = [4, 6]")]);
    set_steps(&work, scene, 40);
    let study = format!("silhouettes {scene} configs/targets/leaf.svg configs/targets/bell.svg");
    let first = page(&work, &study, "silhouettes.md");
    // Twenty-four panels match a leaf to a few per cent.
    for corners in ["free", "all"] {
        let row = numbers(&first, &format!("leaf, {corners}, 10"));
        let [free, all, union_free, union_all, _, _, thinnest] = row[..7] else {
            panic!("{first}");
        };
        let (distance, union) = match corners {
            "free" => (free, union_free),
            _ => (all, union_all),
        };
        assert!(distance < 5.0 && (0.8..1.0).contains(&union), "{first}");
        assert!(thinnest > 10.0, "{first}");
    }
    assert!(work.path("out/silhouettes.png").exists());
    // Finished runs are stored; a repeated study makes no further steps.
    let kept = work.path("out/runs/leaf-free-10/state.json");
    let before = std::fs::read(&kept).unwrap();
    page(&work, &study, "silhouettes.md");
    assert!(std::fs::read(&kept).unwrap() == before);
    let twice = format!("silhouettes {scene} a/leaf.svg b/leaf.svg --out out");
    assert!(work.error(&twice).contains("b/leaf.svg: another"));
}

#[test]
fn optimisers_and_approaches_on_pins() {
    let work = Workplace::new();
    work.edit(PIN, &[("panels = [7, 7]", "panels = [4, 4]")]);
    set_steps(&work, PIN, 20);
    let optimisers = page(&work, &format!("optimisers {PIN}"), "optimisers.md");
    for row in [
        "samples | Adam",
        "samples | L-BFGS",
        "samples | Gauss-Newton",
        "curve | Adam",
        "curve | L-BFGS",
        "curve | Gauss-Newton",
    ] {
        let [evaluations, quarter, half, end, ..] =
            numbers(&optimisers, &format!("pin-7x7 | {row}"))[..]
        else {
            panic!("{optimisers}");
        };
        assert!(evaluations <= 21.0, "{optimisers}");
        assert!(end <= half && half <= quarter, "{optimisers}");
    }
    let approaches = format!("approaches {PIN} --steps 20");
    let approaches = page(&work, &approaches, "approaches.md");
    // Free corners have gaps at their hinges, the charts cannot have any.
    let gap = |name: &str| numbers(&approaches, name)[4];
    assert!(
        gap("**free corners**") > 0.1 && gap("**charts**") < 1e-9,
        "{approaches}"
    );
}

/// Three rays of the family, solved on the coarsest mesh; networks after one epoch on them.
#[test]
fn the_family_of_laws_is_solved_once_and_judged_on_three_materials() {
    let work = Workplace::new();
    shipped_weights(&work);
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    for (folder, name) in [
        ("pet-0.5mm", "unseen"),
        ("s235-1.5mm", "hinges"),
        ("polypropylene-0.8mm", "hinges"),
    ] {
        std::fs::create_dir_all(work.path("data").join(folder)).unwrap();
        let target = if name == "unseen" { "region" } else { name };
        for kind in ["parquet", "json"] {
            let from = data.join(folder).join(name).with_extension(kind);
            let to = work.path("data").join(folder).join(target);
            std::fs::copy(from, to.with_extension(kind)).unwrap();
        }
    }
    let config = "configs/training/fine-tuning.toml";
    work.edit(config, &[("epochs = 80", "epochs = 1")]);
    assert!(work.error("universal").contains("default.parquet"));
    let solve = |count: u8, out: &str| {
        let rays = format!("universal --solve {count} --tier tiny --three-numbers 0 --out {out}");
        assert!(work.output(&rays).starts_with(&format!("{count} rays")));
        std::fs::read(work.path("data/universal/tiny.parquet")).unwrap()
    };
    let first = solve(2, "first");
    assert!(first == solve(2, "first"));
    // The rays of the table are not solved again: only the third one is.
    let all = solve(3, "third");
    let solutions = std::fs::read_dir(work.path("third/solutions")).unwrap();
    assert_eq!(solutions.count(), 1);
    assert!(all != first);
    let other = "configs/campaigns/pet-0.5mm-corner.toml";
    let other = format!("universal --solve 4 --tier tiny --three-numbers 0 --campaign {other}");
    assert!(work.error(&other).contains("choose another --folder"));
    let judged = page(
        &work,
        "universal --tier tiny --splits 1 --epochs 1",
        "universal.md",
    );
    for row in [
        "laws held out | works",
        "s235-1.5mm | film",
        "pet-0.5mm | numbers",
    ] {
        let errors = numbers(&judged, row);
        assert!(
            errors.len() > 5 && errors.iter().all(|it| it.is_finite()),
            "{judged}"
        );
    }
    assert!(judged.contains("| polypropylene-0.8mm | film, fine-tuned | 50 |"));
    assert!(work.path("out/universal.png").exists());
}

#[test]
fn the_five_actuations_and_a_missing_one() {
    let work = Workplace::new();
    for case in 1..=5 {
        let scene = format!("configs/scenes/actuation-{case}.toml");
        set_steps(&work, &scene, 1);
    }
    let actuations = page(&work, "actuations", "actuations.md");
    assert!(actuations.contains("15 x 10 panels"), "{actuations}");
    assert!(actuations.contains("Voids of the 35 "), "{actuations}");
    let removed = "configs/scenes/actuation-3.toml";
    std::fs::remove_file(work.path(removed)).unwrap();
    assert!(work.error("actuations --out out").contains(removed));
}

#[test]
fn the_load_capacity_of_an_opened_sheet() {
    let work = Workplace::new();
    let scene = "configs/scenes/capacity.toml";
    set_steps(&work, scene, 1);
    let capacity = page(&work, "capacity --to 1", "capacity.md");
    // In both directions, by the tables of both orders: both loads together are carried up to the maximum tested.
    let after = capacity.split("The pull first").nth(1).unwrap();
    for pattern in ["uniform sheet", "with compression and shear"] {
        let carried = numbers(after, pattern);
        assert!(
            carried[0] > 2.0 && (1.0..2.0).contains(&carried[1]),
            "{capacity}"
        );
    }
    let ways = std::fs::read_to_string(work.path("out/ways.csv")).unwrap();
    assert!(ways.lines().count() > 8 * 100, "{ways}");
    work.edit(scene, &[("panel = [7, 9] ", "panel = [7, 10] ")]);
    assert!(work.error("capacity --out out").contains("[7, 10]"));
}

#[test]
fn sheets_whose_panels_stay_flat() {
    let work = Workplace::new();
    let text = page(&work, "localisation", "localisation.md");
    // L* of (22) in cm, and Table 2.
    for material in ["pet-0.5mm", "s235-1.5mm"] {
        let [.., found, _, printed] = numbers(&text, material)[..] else {
            panic!("{text}");
        };
        assert!((found - printed).abs() < 0.051, "{text}");
    }
    assert!(
        work.error("localisation --edge=-1 --out out")
            .contains("--edge")
    );
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
        serde_json::from_slice(&std::fs::read(&card).unwrap()).unwrap();
    content["tier"] = "tiny".into();
    content.as_object_mut().unwrap().remove("checksum");
    std::fs::write(&card, content.to_string()).unwrap();
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
    assert!(chain.contains("window tier,\"small\"") && chain.contains("network,\"medium\""));
    // The reference differs from itself by its tolerance and load steps only.
    assert!(shape("\"medium\"") < 1e-6, "{chain}");
    assert!(shape("\"small\"") > 1e-4, "{chain}");
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
    // The result of a broken solver is not stored, and a full disk ends the study.
    let kept = || {
        std::fs::read_dir(work.path("study/solutions"))
            .unwrap()
            .count()
    };
    let message = study(failing_ccx(
        &work.path(""),
        "echo ' *ERROR reading *SOLID SECTION'",
    ));
    assert!(message.contains("before its first increment"), "{message}");
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

/// The path study solves two recorded paths of a sheet with the shipped weights on the coarsest mesh.
#[test]
fn recorded_paths_and_their_rays_are_solved() {
    let work = Workplace::new();
    shipped_weights(&work);
    let study = "path configs/scenes/pet-3x3.toml --routes 2 --tier tiny --out path";
    assert!(work.output(study).contains("2 of 12 paths"));
    assert!(work.path("path/path.png").exists());
}

/// Where a window diverges with the usual increments, shorter ones are tried.
#[test]
fn a_window_that_diverges_is_solved_by_a_second_attempt() {
    let work = Workplace::new();
    shipped_weights(&work);
    let diverged = "echo '1 1 1U 4 0. 0. 0.005' > window.sta; exit 201";
    let usual = format!("if grep -q 'INC=400' window.inp; then {diverged}; fi");
    let ccx = failing_ccx(&work.path(""), &format!("{usual}; exec ccx \"$@\""));
    let mut solve = work.program("universal --solve 1 --tier tiny --three-numbers 0 --out solved");
    let outcome = solve.env("KIRIGAMI_CCX", ccx).output().unwrap();
    assert!(outcome.status.success(), "{outcome:?}");
    assert!(String::from_utf8_lossy(&outcome.stdout).starts_with("1 rays"));
    let solutions = std::fs::read_dir(work.path("solved/solutions")).unwrap();
    assert_eq!(solutions.count(), 2);
}
