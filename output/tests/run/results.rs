//! The files of a run, and the warnings of its report.

use super::{read, run, with};
use output::cut_file::FORCED;
use output::report::{Concern, Report};
use output::run_files::RUN_FILES;
use output::run_results::{remove_run, write_results};
use std::collections::BTreeSet;
use support::severity::Severity;

fn report(changes: &[(&str, &str)]) -> (tempfile::TempDir, Report) {
    let folder = tempfile::tempdir().unwrap();
    // Cut lines of an earlier design.
    std::fs::create_dir(folder.path().join("run")).unwrap();
    std::fs::write(folder.path().join("run/cut.dxf"), "stale").unwrap();
    let scene = read(folder.path(), &with(changes));
    let designed = run(&scene, None).unwrap();
    let report = write_results(&scene, &designed, false).unwrap();
    (folder, report)
}

fn hinges(report: &Report, concern: Concern) -> Option<usize> {
    let mut found = report
        .warnings
        .iter()
        .filter(|warning| warning.concern == concern);
    found.next().map(|warning| warning.hinges.len())
}

#[test]
fn a_sound_design_writes_all_files_and_only_its_miss_is_a_warning() {
    // The design of this seed opens without a jump. Its outline is 98 mm from the circle, 8 % of its side.
    let (folder, report) = report(&[("seed = 3", "seed = 12")]);
    let found: Vec<_> = report
        .warnings
        .iter()
        .map(|warning| (warning.concern, warning.severity))
        .collect();
    assert_eq!(found, [(Concern::TargetMissed, Severity::Warning)]);
    assert_eq!((report.steps, report.hinges.len()), (25, 12));
    assert!(report.after.loss < report.before.loss);
    assert!(report.after.outline_error < report.before.outline_error);
    assert!(
        report
            .hinges
            .iter()
            .all(|row| row.damage.is_none() && row.inside)
    );
    let run = folder.path().join("run");
    let mut names: Vec<_> = std::fs::read_dir(&run)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "attachments.csv",
            "cut-list.csv",
            "cut-summary.csv",
            "cut.dxf",
            "cut.svg",
            "deployed-start.svg",
            "deployed.dxf",
            "deployed.svg",
            "flat.svg",
            "inputs",
            "report.json",
            "report.txt",
            "run.html",
            "scene.toml",
            "state.json"
        ]
    );
    let json = std::fs::read_to_string(run.join("report.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["hinges"][3]["w_lig"], report.hinges[3].w_lig);
    let text = std::fs::read_to_string(run.join("report.txt")).unwrap();
    assert!(
        text.contains("25 steps") && text.contains(&format!("- warning: {}", report.miss())),
        "{text}"
    );
}

#[test]
fn the_pictures_show_every_panel_hinge_and_slit() {
    let (folder, _) = report(&[("steps = 25", "steps = 1")]);
    let read = |name: &str| std::fs::read_to_string(folder.path().join("run").join(name)).unwrap();
    let flat = read("flat.svg");
    // Page, nine panels, two halves of twelve windows, the outline.
    assert_eq!(flat.matches("<polygon ").count(), 1 + 9 + 24 + 1);
    // Eight slits, twelve ligaments, the scale bar and its two ends.
    assert_eq!(flat.matches("<line ").count(), 8 + 12 + 3);
    // The holes of twelve hinges, a support and a load.
    assert_eq!(flat.matches("<circle ").count(), 12 + 2);
    let deployed = read("deployed.svg");
    assert!(deployed.contains(">2 N</text>") && deployed.contains("stroke-dasharray"));
    assert!(deployed.contains(">200 mm</text>") && deployed.contains(">Test sheet</text>"));
    assert!(!deployed.contains("NaN") && !flat.contains("NaN"));
}

#[test]
fn panels_too_small_for_their_windows_are_named() {
    let small = [
        ("[1200.0, 1200.0]", "[390.0, 390.0]"),
        ("[700.0, 550.0]", "[220.0, 190.0]"),
        ("radius = 750.0", "radius = 240.0"),
        ("start_noise = 0.05", "start_noise = 0.0"),
        ("steps = 25", "steps = 1"),
    ];
    let (_, report) = report(&small);
    // Panels of about 130 mm: windows of 100 mm lie inside them but overlap those of the next hinge.
    assert!(
        hinges(&report, Concern::WindowsOverlap).is_some(),
        "{report}"
    );
    assert!(
        report
            .to_string()
            .contains("windows of 100 mm radius overlap"),
        "{report}"
    );
}

#[test]
fn a_target_that_crosses_itself_is_named() {
    let bow =
        "[target.polygon]\nvertices = [[0.0, 0.0], [1400.0, 0.0], [0.0, 1200.0], [1300.0, 1200.0]]";
    let (_, report) = report(&[
        (
            "[target.circle]\ncentre = [700.0, 550.0]\nradius = 750.0",
            bow,
        ),
        ("steps = 25", "steps = 1"),
    ]);
    assert_eq!(hinges(&report, Concern::TargetCrosses), Some(0));
    let text = report.to_string();
    assert!(
        text.contains("the target outline crosses or touches itself near (6"),
        "{text}"
    );
}

#[test]
fn ligaments_wider_than_their_slits_cannot_be_cut_and_the_report_says_so() {
    let (folder, report) = report(&[
        ("[1200.0, 1200.0]", "[390.0, 390.0]"),
        ("[700.0, 550.0]", "[220.0, 190.0]"),
        ("radius = 750.0", "radius = 240.0"),
        ("start = 18.0", "start = 125.0"),
        ("range = [10.0, 26.0]", "range = [10.0, 140.0]"),
        ("r_win = 100.0", "r_win = 400.0"),
        ("steps = 25", "steps = 1"),
    ]);
    assert_eq!(hinges(&report, Concern::CannotBeCut), Some(0));
    assert!(!report.cut_file && !folder.path().join("run/cut.dxf").exists());
    let text = std::fs::read_to_string(folder.path().join("run/report.txt")).unwrap();
    assert!(
        text.starts_with(&format!(
            "Test sheet\n{}\nNO CUT FILE\n- error: ",
            report.miss()
        )),
        "{text}"
    );
    assert!(folder.path().join("run/deployed.svg").exists());
}

/// Ligaments that translate by more than their width are an error: no cut file is written unless it is forced, and
/// that of an earlier design is removed.
#[test]
fn a_load_far_too_large_leaves_no_cut_file_unless_it_is_forced() {
    let folder = tempfile::tempdir().unwrap();
    let overloaded = [
        ("force = [2.0, 0.0]", "force = [3e4, 0.0]"),
        ("steps = 25", "steps = 1"),
    ];
    let scene = read(folder.path(), &with(&overloaded));
    let designed = run(&scene, None).unwrap();
    let report = write_results(&scene, &designed, true).unwrap();
    assert!(hinges(&report, Concern::Overstrained).is_some(), "{report}");
    assert!(report.cut_file);
    for name in ["run/cut.dxf", "run/cut.svg"] {
        let text = std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert!(text.contains(FORCED) && text.contains("ERRORS"), "{name}");
    }
    let report = write_results(&scene, &designed, false).unwrap();
    assert!(!report.cut_file && report.errors().count() > 0);
    for name in [
        "cut.dxf",
        "cut.svg",
        "cut-list.csv",
        "attachments.csv",
        "cut-summary.csv",
        "deployed.dxf",
    ] {
        assert!(!folder.path().join("run").join(name).exists(), "{name}");
    }
}

/// The table of the tutorial is that of the program: one line for successive files of the same contents.
#[test]
fn the_tutorial_lists_the_files_of_a_run() {
    let mut lines: Vec<(String, &str)> = Vec::new();
    for file in &RUN_FILES {
        let name = format!("`{}`", file.name);
        match lines.last_mut() {
            Some((names, contents)) if *contents == file.contents => *names += &format!(", {name}"),
            _ => lines.push((name, file.contents)),
        }
    }
    let lines = lines
        .iter()
        .map(|(names, contents)| format!("| {names} | {contents} |\n"));
    let tutorial = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/TUTORIAL.md");
    let tutorial = std::fs::read_to_string(tutorial).unwrap();
    assert!(
        tutorial.contains(&lines.collect::<String>()),
        "docs/TUTORIAL.md"
    );
}

#[test]
fn a_restart_leaves_the_inputs_of_the_run_alone() {
    let (folder, _) = report(&[("steps = 25", "steps = 1")]);
    let run = folder.path().join("run");
    // The pictures that the program draws.
    for name in [
        "flat.png",
        "deployed-start.png",
        "deployed.png",
        "deployment.png",
    ] {
        std::fs::write(run.join(name), "").unwrap();
    }
    let scene = read(folder.path(), &with(&[("steps = 25", "steps = 1")]));
    remove_run(&scene).unwrap();
    let left = std::fs::read_dir(&run).unwrap();
    let left: BTreeSet<_> = left.map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, BTreeSet::from(["inputs".into(), "scene.toml".into()]));
}
