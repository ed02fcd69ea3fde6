//! The loads in the pictures of a run.

use super::*;

/// Every kind of load is drawn, with its magnitude at the load factor of the state.
#[test]
fn all_loads_of_a_state_are_drawn() {
    let loads = format!(
        "{PULL}\n\n[[loads]]\npanel = [1, 2]\ncouple = -25.0\n\n\
         [[edge_loads]]\nedge = \"top\"\ntraction = [0.0, 0.0025]\n\n\
         [[opening_couples]]\npanels = [[1, 0], [2, 0]]\ncouple = 37.0"
    );
    let svg = Finished::new(&with(&[(PULL, &loads), QUICK])).file("deployed.svg");
    // 0.0025 N/mm on 1200 mm, over three panels.
    for label in ["2 N", "1 N", "25 N mm", "37 N mm"] {
        assert!(svg.contains(&format!(">{label}</text>")), "{label}");
    }
    // Four forces and, on panels that rotate freely, three couples.
    assert_eq!(svg.matches("<polyline").count(), 4 + 3);
    let drive = format!("[drive]\nstroke = 20.0\n\n{TARGET}");
    let driven = Finished::new(&with(&[(TARGET, &drive), QUICK]));
    let reached = driven.designed.best.deployment.final_step().load_factor * 2.0;
    let report = driven.file("report.txt");
    let (_, load) = report.split_once("load reached").unwrap();
    let load = load.split(',').next().unwrap().trim();
    let stated: f64 = load.strip_suffix(" N").unwrap().parse().unwrap();
    assert_close(stated / reached, 1.0, 1e-3);
    assert_says(&driven.file("deployed.svg"), &format!(">{load}</text>"));
}
