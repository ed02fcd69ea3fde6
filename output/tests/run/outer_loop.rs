//! The outer loop on a linear 3 x 3 sheet: the loss decreases, a resumed run follows the same trajectory, and
//! designs without objective value do not end the run.

use super::{SCENE, read, run, with};
use design::optimise::outer_loop::{Ended, StepRecord};
use design::scene::Scene;
use design::scene::design_run::{design_of_run, inverse_design};
use std::sync::atomic::AtomicBool;
use support::sealed_json;

#[test]
fn the_loss_falls_and_the_best_design_is_returned() {
    let folder = tempfile::tempdir().unwrap();
    let designed = run(&read(folder.path(), SCENE), None).unwrap();
    assert_eq!(designed.ended, Ended::Completed);
    assert_eq!(designed.history.len(), 26);
    let first = &designed.history[0];
    assert_eq!(first.scores.loss, designed.start.loss);
    assert!(
        designed.best.loss < 0.8 * first.scores.loss,
        "{} {}",
        designed.best.loss,
        first.scores.loss
    );
    let minimum = designed
        .history
        .iter()
        .map(|record| record.scores.loss)
        .fold(f64::MAX, f64::min);
    // The last evaluation follows the path, the search may have corrected it: both to the tolerance of 1e-10.
    assert!((minimum / designed.best.loss - 1.0).abs() < 1e-9);
}

const LBFGS: (&str, &str) = ("steps = 25", "steps = 25\nmethod = \"lbfgs\"");

#[test]
fn every_step_of_lbfgs_lowers_the_loss() {
    let folder = tempfile::tempdir().unwrap();
    let designed = run(&read(folder.path(), &with(&[LBFGS])), None).unwrap();
    let falls = |pair: &[StepRecord]| pair[1].scores.loss < pair[0].scores.loss;
    assert!(designed.history.windows(2).all(falls));
    assert!(designed.best.loss < 0.8 * designed.start.loss);
}

#[test]
fn lbfgs_ends_at_a_minimum() {
    let folder = tempfile::tempdir().unwrap();
    let many = ("steps = 25", "steps = 3000\nmethod = \"lbfgs\"");
    // Without a penalty the best designs are those whose cuts collide.
    let shape = (
        "compression = 0.01",
        "compression = 0.01\npanel_shape = 0.1",
    );
    let designed = run(&read(folder.path(), &with(&[many, shape])), None).unwrap();
    assert_eq!(designed.ended, Ended::Settled);
    assert!(
        designed
            .history
            .iter()
            .all(|record| record.setback.is_none())
    );
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
    // In the middle of steps whose paths are corrected from that of step 10.
    let stopped = run(&scene, Some(13)).unwrap();
    assert_eq!(stopped.ended, Ended::Stopped);
    assert_eq!(stopped.history.len(), 14);
    let followed = uninterrupted
        .history
        .iter()
        .filter(|record| record.followed);
    assert!(followed.count() < uninterrupted.history.len());
    let resumed = run(&scene, None).unwrap();
    assert_eq!(resumed.history, uninterrupted.history);
    assert_eq!(resumed.design, uninterrupted.design);
    // A finished run makes no further steps.
    let mut steps = 0;
    inverse_design(&scene, &AtomicBool::new(false), &mut |_| steps += 1).unwrap();
    assert_eq!(steps, 0);
}

#[test]
fn a_run_continues_with_more_steps_but_not_with_another_scene() {
    let folder = tempfile::tempdir().unwrap();
    let run_with = |changes: &[_]| run(&read(folder.path(), &with(changes)), None);
    run_with(&[("steps = 25", "steps = 2")]).unwrap();
    let longer = run_with(&[("steps = 25", "steps = 4")]).unwrap();
    assert_eq!(longer.history.len(), 5);
    let harder = [("steps = 25", "steps = 4"), ("[2.0, 0.0]", "[3.0, 0.0]")];
    let error = run_with(&harder).err().unwrap().to_string();
    assert!(error.contains("the key `loads` changed since"), "{error}");
    let path = folder.path().join("run/state.json");
    let state = std::fs::read_to_string(&path).unwrap();
    let mut state: serde_json::Value = serde_json::from_str(&state).unwrap();
    state["scene"]["optimiser"]["steps"] = 25.into();
    state["search"]["adam"]["mean"] = serde_json::json!([0.0]);
    std::fs::write(&path, state.to_string()).unwrap();
    let error = run_with(&[]).err().unwrap().to_string();
    assert!(error.contains("checksum"), "{error}");
    std::fs::write(&path, sealed_json::to_vec(&state).unwrap()).unwrap();
    let error = run_with(&[]).err().unwrap().to_string();
    assert!(error.contains("another size"), "{error}");
    std::fs::write(&path, "{").unwrap();
    let error = run_with(&[]).err().unwrap().to_string();
    assert!(error.contains("restart the run"), "{error}");
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
    assert_eq!(run_with(1.0, 2).history.len(), 3);
}

#[test]
fn the_design_of_a_run_is_that_of_the_same_scene_and_model() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |changes: &[_]| read(folder.path(), &with(changes));
    assert!(design_of_run(&scene(&[])).unwrap().is_none());
    let two_steps = ("steps = 25", "steps = 2");
    let best = run(&scene(&[two_steps]), None).unwrap().design;
    // Title, cutting, objective and optimiser change neither the sheet nor how it deploys.
    let allowed = ("title = \"", "cutting.margin = 1.0\ntitle = \"another ");
    let found = design_of_run(&scene(&[allowed, LBFGS])).unwrap();
    assert_eq!(found, Some(best));
    let message = |scene: &Scene| design_of_run(scene).unwrap_err().to_string();
    let harder = scene(&[("[2.0, 0.0]", "[3.0, 0.0]")]);
    let loads = message(&harder);
    assert!(loads.contains("the key `loads` changed since"), "{loads}");
    assert!(loads.contains("--design"), "{loads}");

    let path = folder.path().join("run/state.json");
    let state = std::fs::read(&path).unwrap();
    let mut state: serde_json::Value = serde_json::from_slice(&state).unwrap();
    let model = state["model"].as_str().unwrap().to_owned();
    for (part, name) in ["version of kirigami", "material", "target", "weights"]
        .into_iter()
        .enumerate()
    {
        let mut parts: Vec<&str> = model.split('-').collect();
        parts[part] = "another";
        state["model"] = parts.join("-").into();
        std::fs::write(&path, sealed_json::to_vec(&state).unwrap()).unwrap();
        let scene = scene(&[]);
        let error = message(&scene);
        assert!(error.contains(&format!("the {name} changed")), "{error}");
    }
}

#[test]
fn a_step_to_a_design_without_value_is_halved_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    // A learning rate that moves the charts to their bounds, where cuts collide.
    let wild = with(&[("learning_rate = 0.03", "learning_rate = 9.0")]);
    let designed = run(&read(folder.path(), &wild), None).unwrap();
    let set_back = |record: &&StepRecord| record.halvings > 0;
    let reason = designed
        .history
        .iter()
        .find(set_back)
        .unwrap()
        .setback
        .as_ref();
    assert!(!reason.unwrap().is_empty());
    assert!(designed.best.loss <= designed.start.loss);
    assert!(
        designed
            .history
            .iter()
            .all(|record| record.scores.loss.is_finite())
    );
}

#[test]
fn a_start_with_panels_below_the_minimum_width_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let thin = with(&[
        (
            "compression = 0.01",
            "compression = 0.01\nmin_panel_width = 130.0",
        ),
        ("start_noise = 0.05", "start_noise = 2.0"),
    ]);
    let error = run(&read(folder.path(), &thin), None)
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("objective.min_panel_width = 130 mm"),
        "{error}"
    );
}
