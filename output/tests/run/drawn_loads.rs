//! The loads in the pictures of a run.

use super::{read, run, with};
use output::run_results::write_results;
use std::path::Path;

/// The results of a scene: `report.txt` and `deployed.svg`.
fn results(folder: &Path, scene: &str) -> [String; 2] {
    let scene = read(folder, scene);
    let designed = run(&scene, None).unwrap();
    write_results(&scene, &designed, false).unwrap();
    ["report.txt", "deployed.svg"]
        .map(|name| std::fs::read_to_string(scene.output().join(name)).unwrap())
}

/// Every kind of load is drawn, with its magnitude at the load factor of the state.
#[test]
fn all_loads_of_a_state_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let changes = [
        (
            "force = [2.0, 0.0]",
            "force = [2.0, 0.0]\n\n[[loads]]\npanel = [1, 2]\ncouple = -25.0\n\n\
             [[edge_loads]]\nedge = \"top\"\ntraction = [0.0, 0.0025]\n\n\
             [[opening_couples]]\npanels = [[1, 0], [2, 0]]\ncouple = 37.0",
        ),
        ("steps = 25", "steps = 1"),
    ];
    let [_, svg] = results(folder.path(), &with(&changes));
    // 0.0025 N/mm on 1200 mm, over three panels.
    for label in ["2 N", "1 N", "25 N mm", "37 N mm"] {
        assert!(svg.contains(&format!(">{label}</text>")), "{label}");
    }
    // Four forces and, on panels that rotate freely, three couples.
    assert_eq!(svg.matches("<polyline").count(), 4 + 3);
    let driven = with(&[
        (
            "[target.circle]",
            "[drive]\nstroke = 20.0\n\n[target.circle]",
        ),
        ("steps = 25", "steps = 1"),
    ]);
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), &driven);
    let designed = run(&scene, None).unwrap();
    let reached = designed.best.deployment.final_step().load_factor * 2.0;
    let [report, svg] = results(folder.path(), &driven);
    let (_, load) = report.split_once("load reached").unwrap();
    let load = load.split(',').next().unwrap().trim();
    assert!(
        (load.strip_suffix(" N").unwrap().parse::<f64>().unwrap() / reached - 1.0).abs() < 1e-3
    );
    assert!(svg.contains(&format!(">{load}</text>")), "{load}");
}
