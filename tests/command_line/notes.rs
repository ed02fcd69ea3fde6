//! `--verbose`: programs, files and solver statuses on standard error, and nothing of it without
//! the option.

use crate::common::{Workplace, assert_contains};

/// Standard output and standard error of a run, which must succeed.
fn printed(work: &Workplace, arguments: &str) -> [String; 2] {
    let output = work.program(arguments).output().unwrap();
    let texts = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{arguments}: {}", texts[1]);
    texts
}

#[test]
fn programs_files_and_load_steps_are_named() {
    let work = Workplace::new();
    let design = "design configs/scenes/linear-7x7.toml --steps 1 --restart";
    let [silent, notes] = printed(&work, design);
    assert_eq!(notes, "");
    let [loud, notes] = printed(&work, &format!("--verbose {design}"));
    assert_eq!(silent, loud, "the results do not change");
    assert_contains(
        &notes,
        &[
            "read configs/scenes/linear-7x7.toml (",
            "pet-0.5mm.toml (",
            "load factor 1.0000: Converged, relative residual ",
            "linear 1/1  loss ",
            "state.json (",
            "cut.dxf (",
        ],
    );

    let [_, notes] = printed(&work, "solve --tier tiny --theta-deg 5 --out solved -v");
    let ended: Vec<&str> = notes.lines().filter(|line| line.starts_with("ended after ")).collect();
    let of = |program: &str| ended.iter().any(|line| line.contains(program));
    assert!(of("gmsh") && of("ccx"), "{notes}");
    assert_contains(&notes, &["running ", "s (exit status: 0): "]);

    let output = work.program("doctor --quiet --verbose").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}
