//! Bad input of any kind: a message that names the file, the key or the program, and exit code 1.

mod common;

use common::{Workplace, failure};
use std::path::{Path, PathBuf};

const DEMO: &str = "configs/campaigns/demo.toml";
const SCENE: &str = "configs/scenes/linear-7x7.toml";

/// The message of `command` after one edit of a fresh copy of the configurations.
fn after(edited: &str, old: &str, new: &str, command: &str) -> String {
    let work = Workplace::new();
    work.edit(edited, &[(old, new)]);
    work.error(command)
}

#[test]
fn a_wrong_key_names_line_and_nearest_key() {
    let message = after(DEMO, "kerf =", "kurf =", &format!("database plan {DEMO}"));
    assert!(
        message.contains("demo.toml:") && message.contains("did you mean `kerf`"),
        "{message}"
    );
    let message = after(SCENE, "load_steps", "load_step", &format!("design {SCENE}"));
    assert!(message.contains("did you mean `load_steps`"), "{message}");
}

#[test]
fn a_wrong_type_and_a_wrong_sign_name_the_value() {
    let message = after(
        DEMO,
        "seed = 1",
        "seed = \"one\"",
        &format!("database plan {DEMO}"),
    );
    assert!(message.contains("demo.toml:"), "{message}");
    let material = "configs/materials/pet-0.5mm.toml";
    let message = after(
        material,
        "young = 3000.0",
        "young = -3000.0",
        "solve --tier tiny",
    );
    assert!(message.contains("young = -3000"), "{message}");
}

#[test]
fn unit_slips_are_suspected() {
    let work = Workplace::new();
    assert!(
        work.error("solve --w-lig 0.018")
            .contains("did you mean 18 mm")
    );
    let material = "configs/materials/pet-0.5mm.toml";
    let message = after(
        material,
        "young = 3000.0",
        "young = 3.0",
        "solve --tier tiny",
    );
    assert!(message.contains("did you mean 3000 MPa"), "{message}");
}

#[test]
fn missing_files_are_named() {
    let work = Workplace::new();
    for command in [
        "database plan nowhere.toml",
        "train nowhere.parquet",
        "design nowhere.toml",
    ] {
        assert!(work.error(command).contains("nowhere"));
    }
}

#[test]
fn missing_programs_tell_how_to_get_them() {
    let work = Workplace::new();
    for (variable, package) in [("KIRIGAMI_GMSH", "gmsh"), ("KIRIGAMI_CCX", "calculix-ccx")] {
        let mut command = work.kirigami("solve --tier tiny");
        let message = failure(command.env(variable, "/no/such/program"));
        assert!(message.contains(variable), "{message}");
        assert!(
            message.contains(&format!("apt-get install {package}")),
            "{message}"
        );
    }
    failure(
        work.kirigami("doctor")
            .env("KIRIGAMI_CCX", "/no/such/program"),
    );
}

/// A ccx that answers with its version, and else does `body` and fails.
fn failing_ccx(work: &Workplace, body: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let path = work.path("ccx");
    let script = format!(
        "#!/bin/sh\n[ \"$1\" = -v ] && echo 'This is Version 2.20' && exit 0\n{body}; exit 201\n"
    );
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}

#[test]
fn a_solver_that_fails_is_quoted_and_what_is_finished_is_kept() {
    let work = Workplace::new();
    let ccx = failing_ccx(&work, "echo ' *ERROR reading *SOLID SECTION'");
    let message = failure(work.kirigami("solve --tier tiny").env("KIRIGAMI_CCX", &ccx));
    assert!(
        message.contains("*ERROR reading *SOLID SECTION"),
        "{message}"
    );
    assert!(
        work.path("runs/solve/window.inp").exists(),
        "the deck is kept"
    );
}

#[test]
fn a_study_of_which_nothing_was_solved_is_an_error() {
    let work = Workplace::new();
    let study = |ccx: PathBuf| {
        let mut study = work.kirigami("study window --quick --out study");
        failure(study.env("KIRIGAMI_CCX", ccx))
    };
    // A broken solver is no result to keep, and a full disk ends the study.
    let kept = || {
        std::fs::read_dir(work.path("study/solutions"))
            .unwrap()
            .count()
    };
    let message = study(failing_ccx(&work, "echo ' *ERROR reading *SOLID SECTION'"));
    assert!(message.contains("before its first increment"), "{message}");
    assert_eq!(kept(), 0);
    let full = "echo '1 1 1U 4 0. 0. 0.005' > window.sta; echo 'No space left on device'";
    let message = study(failing_ccx(&work, full));
    assert!(message.contains("No space left"), "{message}");
    assert_eq!(kept(), 0);
}

#[test]
fn weights_that_are_none_are_refused() {
    let work = Workplace::new();
    let scene = "configs/scenes/demo.toml";
    let message = work.error(&format!("design {scene}"));
    assert!(message.contains("surrogate.safetensors"), "{message}");

    std::fs::create_dir_all(work.path("runs/demo")).unwrap();
    let weights = work.path("runs/demo/surrogate.safetensors");
    std::fs::write(&weights, b"not weights").unwrap();
    let message = work.error(&format!("design {scene}"));
    assert!(
        message.contains("surrogate.safetensors is no safetensors file"),
        "{message}"
    );

    // A real file whose last number, the energy scale, is not one.
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("surrogate/tests/cases");
    let mut bytes = std::fs::read(cases.join("chi_tiny.safetensors")).unwrap();
    let last = bytes.len() - 8;
    bytes[last..].copy_from_slice(&f64::NAN.to_le_bytes());
    std::fs::write(&weights, bytes).unwrap();
    let message = work.error(&format!("design {scene}"));
    assert!(
        message.contains("surrogate.json"),
        "a card is asked for: {message}"
    );
    std::fs::copy(cases.join("chi_tiny.json"), weights.with_extension("json")).unwrap();
    let message = work.error(&format!("design {scene}"));
    assert!(message.contains("w_scale"), "{message}");
}

#[test]
fn help_is_there_for_every_command() {
    let work = Workplace::new();
    for command in [
        "",
        "demo",
        "doctor",
        "mesh",
        "solve",
        "database",
        "database run",
        "train",
        "design",
        "pattern",
        "deploy",
        "equilibrium",
        "gradient",
    ] {
        assert!(
            work.output(&format!("{command} --help"))
                .contains("Usage: kirigami")
        );
    }
}
