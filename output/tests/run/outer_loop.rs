//! The outer loop on a linear 3 x 3 sheet: the loss decreases, a resumed run follows the same
//! trajectory, and designs without objective value do not end the run.

use super::*;
use design::optimise::outer_loop::{Ended, StepRecord};
use scene::design_run::design_of_run;
use support::sealed_json;

/// The run of the scene with changes.
fn designed(changes: &[(&str, &str)]) -> Designed {
    let folder = tempfile::tempdir().unwrap();
    run(&read(folder.path(), &with(changes)), None).unwrap()
}

#[test]
fn the_loss_falls_and_the_best_design_is_returned() {
    let designed = designed(&[]);
    assert_eq!(designed.ended, Ended::Completed);
    assert_eq!(designed.search.history.len(), 26);
    let losses = designed.search.history.iter().map(|step| step.scores.loss);
    let losses: Vec<f64> = losses.collect();
    assert_eq!(losses[0], designed.start.loss);
    assert!(designed.best.loss < 0.8 * losses[0]);
    let minimum = losses.into_iter().fold(f64::MAX, f64::min);
    // The last evaluation follows the path, the search may have corrected it: both to the tolerance
    // of 1e-10.
    assert_close(minimum / designed.best.loss, 1.0, 1e-9);
}

const LBFGS: (&str, &str) = ("steps = 25", "steps = 25\nmethod = \"lbfgs\"");

#[test]
fn every_step_of_lbfgs_lowers_the_loss() {
    let designed = designed(&[LBFGS]);
    let falls = |pair: &[StepRecord]| pair[1].scores.loss < pair[0].scores.loss;
    assert!(designed.search.history.windows(2).all(falls));
    assert!(designed.best.loss < 0.8 * designed.start.loss);
}

#[test]
fn lbfgs_ends_at_a_minimum() {
    let many = ("steps = 25", "steps = 3000\nmethod = \"lbfgs\"");
    // Without a penalty the best designs are those whose cuts collide.
    let shape = ("[objective]", "[objective]\npanel_shape = 0.1");
    let designed = designed(&[many, shape]);
    assert_eq!(designed.ended, Ended::Settled);
    let mut steps = designed.search.history.iter();
    assert!(steps.all(|record| record.setback.is_none()));
}

#[test]
fn a_stopped_run_resumes_to_the_same_trajectory() {
    resumes(SCENE);
    resumes(&with(&[LBFGS]));
}

fn resumes(text: &str) {
    let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let uninterrupted = run(&read(whole.path(), text), None).unwrap();
    let scene = read(parts.path(), text);
    // In the middle of steps whose paths are corrected from the path of step 10.
    let stopped = run(&scene, Some(13)).unwrap();
    assert_eq!(stopped.ended, Ended::Stopped);
    assert_eq!(stopped.search.history.len(), 14);
    assert!(uninterrupted.search.history.iter().any(|record| !record.followed));
    let resumed = run(&scene, None).unwrap();
    assert_eq!(resumed.search.history, uninterrupted.search.history);
    assert_eq!(resumed.search.best, uninterrupted.search.best);
    // A finished run makes no further steps.
    let mut steps = 0;
    inverse_design(&scene, &AtomicBool::new(false), &mut |_, _| steps += 1).unwrap();
    assert_eq!(steps, 0);
}

#[test]
fn a_run_continues_with_more_steps_but_not_with_another_scene() {
    let folder = tempfile::tempdir().unwrap();
    let run_with = |changes: &[_]| run(&read(folder.path(), &with(changes)), None);
    run_with(&[("steps = 25", "steps = 2")]).unwrap();
    let longer = run_with(&[("steps = 25", "steps = 4")]).unwrap();
    assert_eq!(longer.search.history.len(), 5);
    let harder = [("steps = 25", "steps = 4"), ("[2.0, 0.0]", "[3.0, 0.0]")];
    let error = |changes| run_with(changes).err().unwrap().to_string();
    assert_says(&error(&harder), "the key `loads` changed since");
    let path = folder.path().join("run/state.json");
    let state = std::fs::read_to_string(&path).unwrap();
    let mut state: serde_json::Value = serde_json::from_str(&state).unwrap();
    state["scene"]["optimiser"]["steps"] = 25.into();
    state["search"]["adam"]["mean"] = serde_json::json!([0.0]);
    let sealed = sealed_json::to_vec(&state).unwrap();
    for (file, expected) in [
        (state.to_string().into_bytes(), "checksum"),
        (sealed, "another size"),
        (b"{".to_vec(), "restart the run"),
    ] {
        std::fs::write(&path, file).unwrap();
        assert_says(&error(&[]), expected);
    }
}

#[test]
fn a_search_continues_with_other_tolerances() {
    let folder = tempfile::tempdir().unwrap();
    let run_with = |kerf: f64, steps: usize| {
        let sections = format!("[tolerances]\nkerf = {kerf}\n\n[objective]");
        let steps = format!("steps = {steps}");
        let text = with(&[("[objective]", &*sections), ("steps = 25", &*steps)]);
        run(&read(folder.path(), &text), None).unwrap()
    };
    run_with(0.5, 1);
    assert_eq!(run_with(1.0, 2).search.history.len(), 3);
}

#[test]
fn the_design_of_a_run_is_that_of_the_same_scene_and_model() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |changes: &[_]| read(folder.path(), &with(changes));
    assert!(design_of_run(&scene(&[])).unwrap().is_none());
    let two_steps = ("steps = 25", "steps = 2");
    let best = run(&scene(&[two_steps]), None).unwrap().search.best;
    // Title, cutting, objective and optimiser change neither the sheet nor how it deploys.
    let allowed = ("title = \"", "cutting.margin = 1.0\ntitle = \"another ");
    let found = design_of_run(&scene(&[allowed, LBFGS])).unwrap();
    assert_eq!(found, Some(best));
    let message = |scene: &Scene| design_of_run(scene).unwrap_err().to_string();
    let harder = scene(&[("[2.0, 0.0]", "[3.0, 0.0]")]);
    let loads = message(&harder);
    assert_says(&loads, "the key `loads` changed since");
    assert_says(&loads, "--design");

    let path = folder.path().join("run/state.json");
    let state = std::fs::read(&path).unwrap();
    let mut state: serde_json::Value = serde_json::from_slice(&state).unwrap();
    let model = state["model"].as_str().unwrap().to_owned();
    let parts = ["version of kirigami", "material", "target", "weights"];
    for (part, name) in parts.into_iter().enumerate() {
        let mut parts: Vec<&str> = model.split('-').collect();
        parts[part] = "another";
        state["model"] = parts.join("-").into();
        std::fs::write(&path, sealed_json::to_vec(&state).unwrap()).unwrap();
        let scene = scene(&[]);
        assert_says(&message(&scene), &format!("the {name} changed"));
    }
}

#[test]
fn a_step_to_a_design_without_value_is_halved_and_reported() {
    // A learning rate that moves the charts to their bounds, where cuts collide.
    let designed = designed(&[("learning_rate = 0.03", "learning_rate = 9.0")]);
    let mut steps = designed.search.history.iter();
    let set_back = steps.find(|record| record.halvings > 0).unwrap();
    assert!(!set_back.setback.as_ref().unwrap().is_empty());
    assert!(designed.best.loss <= designed.start.loss);
    let mut steps = designed.search.history.iter();
    assert!(steps.all(|record| record.scores.loss.is_finite()));
}

#[test]
fn a_start_with_panels_below_the_minimum_width_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let width = ("[objective]", "[objective]\nmin_panel_width = 130.0");
    let thin = with(&[width, ("start_noise = 0.05", "start_noise = 2.0")]);
    let error = run(&read(folder.path(), &thin), None).err().unwrap();
    assert_says(&error.to_string(), "objective.min_panel_width = 130 mm");
}
