//! The files of a run, and the warnings of its report.

use super::*;
use output::cut_file::FORCED;
use output::run_files::RUN_FILES;
use output::run_results::remove_run;
use std::collections::BTreeSet;
use support::severity::Severity;

/// A run of the scene with changes, in whose folder are the cut lines of an earlier design.
fn finished(changes: &[(&str, &str)]) -> Finished {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("run")).unwrap();
    std::fs::write(folder.path().join("run/cut.dxf"), "stale").unwrap();
    Finished::within(folder, &with(changes))
}

/// A sheet of a third of the size.
const SMALL: [(&str, &str); 4] = [
    ("[1200.0, 1200.0]", "[390.0, 390.0]"),
    ("[700.0, 550.0]", "[220.0, 190.0]"),
    ("radius = 750.0", "radius = 240.0"),
    QUICK,
];

#[test]
fn a_sound_design_writes_all_files_and_only_its_miss_is_a_warning() {
    // The design of this seed opens without a jump. Its outline is 98 mm from the circle, 8 % of
    // its side.
    let run = finished(&[("seed = 3", "seed = 12")]);
    let report = &run.report;
    let warnings = report.warnings.iter();
    let found = warnings.map(|warning| (warning.concern, warning.severity));
    assert_eq!(found.collect::<Vec<_>>(), [("target-missed", Severity::Warning)]);
    assert_eq!((report.steps, report.hinges.len()), (25, 12));
    assert!(report.after.loss < report.before.loss);
    assert!(report.after.outline_error < report.before.outline_error);
    let mut hinges = report.hinges.iter();
    assert!(hinges.all(|row| row.damage.is_none() && row.inside));
    let files = std::fs::read_dir(run.scene.output()).unwrap();
    let names: BTreeSet<_> = files.map(|entry| entry.unwrap().file_name()).collect();
    let expected = "attachments.csv cut-list.csv cut-summary.csv cut.dxf cut.svg deployed-start.svg deployed.dxf \
                    deployed.svg flat.svg inputs report.json report.txt run.html scene.toml state.json";
    assert_eq!(names, expected.split(' ').map(Into::into).collect());
    let json: serde_json::Value = serde_json::from_str(&run.file("report.json")).unwrap();
    assert_eq!(json["hinges"][3]["w_lig"], report.hinges[3].w_lig);
    let text = run.file("report.txt");
    assert_says(&text, "25 steps");
    assert_says(&text, &format!("- warning: {}", report.miss));
}

#[test]
fn the_pictures_show_every_panel_hinge_and_slit() {
    let run = finished(&[QUICK]);
    let [flat, deployed] = ["flat.svg", "deployed.svg"].map(|name| run.file(name));
    // Page, nine panels, two halves of twelve windows, the outline.
    assert_eq!(flat.matches("<polygon ").count(), 1 + 9 + 24 + 1);
    // Eight slits, twelve ligaments, the scale bar and its two ends.
    assert_eq!(flat.matches("<line ").count(), 8 + 12 + 3);
    // The holes of twelve hinges, a support and a load.
    assert_eq!(flat.matches("<circle ").count(), 12 + 2);
    assert!(deployed.contains(">2 N</text>") && deployed.contains("stroke-dasharray"));
    assert!(deployed.contains(">200 mm</text>") && deployed.contains(">Test sheet</text>"));
    assert!(!deployed.contains("NaN") && !flat.contains("NaN"));
}

#[test]
fn panels_too_small_for_their_windows_are_named() {
    let report =
        finished(&[&SMALL[..], &[("start_noise = 0.05", "start_noise = 0.0")]].concat()).report;
    // Panels of about 130 mm: windows of 100 mm lie inside them but overlap the windows of the next
    // hinge.
    one(&report, "windows-overlap");
    assert_says(&report.document().to_string(), "windows of 100 mm radius overlap");
}

#[test]
fn a_target_that_crosses_itself_is_named() {
    let corners = "[[0.0, 0.0], [1400.0, 0.0], [0.0, 1200.0], [1300.0, 1200.0]]";
    let bow = format!("[target.polygon]\nvertices = {corners}");
    let report = finished(&[(TARGET, &bow), QUICK]).report;
    assert_eq!(one(&report, "target-crosses").hinges, [0; 0]);
    let crosses = "the target outline crosses or touches itself near (6";
    assert_says(&report.document().to_string(), crosses);
}

#[test]
fn ligaments_wider_than_their_slits_cannot_be_cut_and_the_report_says_so() {
    let wide = [
        ("start = 18.0", "start = 125.0"),
        ("range = [10.0, 26.0]", "range = [10.0, 140.0]"),
        ("r_win = 100.0", "r_win = 400.0"),
    ];
    let run = finished(&[&SMALL[..], &wide].concat());
    let report = &run.report;
    assert_eq!(one(report, "cannot-be-cut").hinges, [0; 0]);
    assert!(!report.cut_file && !run.scene.output().join("cut.dxf").exists());
    let first = format!("Test sheet: level linear\n{}\nNO CUT FILE\n\n- error: ", report.miss);
    let text = run.file("report.txt");
    assert!(text.starts_with(&first), "{text}");
    assert!(run.scene.output().join("deployed.svg").exists());
}

/// Ligaments that translate by more than their width are an error: no cut file is written unless it
/// is forced, and the cut file of an earlier design is removed.
#[test]
fn a_load_far_too_large_leaves_no_cut_file_unless_it_is_forced() {
    let run = finished(&[("force = [2.0, 0.0]", "force = [3e4, 0.0]"), QUICK]);
    let forced = write_results(&run.scene, &run.designed, true).unwrap();
    assert!(!found(&forced, "overstrained").is_empty());
    assert!(forced.cut_file);
    for name in ["cut.dxf", "cut.svg"] {
        let text = run.file(name);
        assert!(text.contains(FORCED) && text.contains("ERRORS"), "{name}");
    }
    let report = write_results(&run.scene, &run.designed, false).unwrap();
    assert!(!report.cut_file && report.errors().count() > 0);
    let of_a_cut = "cut.dxf cut.svg cut-list.csv attachments.csv cut-summary.csv deployed.dxf";
    for name in of_a_cut.split(' ') {
        assert!(!run.scene.output().join(name).exists(), "{name}");
    }
}

/// The table of the page is the table of the program: one line for successive files of the same
/// contents.
#[test]
fn the_page_of_a_run_lists_its_files() {
    let mut lines: Vec<(String, &str)> = Vec::new();
    for file in &RUN_FILES {
        let name = format!("`{}`", file.name);
        match lines.last_mut() {
            Some((names, contents)) if *contents == file.contents => *names += &format!(", {name}"),
            _ => lines.push((name, file.contents)),
        }
    }
    let line = |(names, contents): &(String, &str)| format!("| {names} | {contents} |\n");
    let lines = lines.iter().map(line);
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/RUN-PAGE.md");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(&lines.collect::<String>()));
}

#[test]
fn a_restart_leaves_the_inputs_of_the_run_alone() {
    let run = finished(&[QUICK]);
    // The pictures that the program draws.
    for name in ["flat", "deployed-start", "deployed", "deployment"] {
        let picture = run.scene.output().join(name).with_extension("png");
        std::fs::write(picture, "").unwrap();
    }
    let scene = read(run.folder.path(), &with(&[QUICK]));
    remove_run(&scene).unwrap();
    let left = std::fs::read_dir(scene.output()).unwrap();
    let left: BTreeSet<_> = left.map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, BTreeSet::from(["inputs".into(), "scene.toml".into()]));
}
