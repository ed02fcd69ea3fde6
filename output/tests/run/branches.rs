//! Sheets with several equilibria: a search keeps designs whose path was
//! followed from the flat sheet.

use super::{SCENE, read, run};
use design::optimise::outer_loop::Ended;
use design::scene::design_run::design_of_run;
use design::scene::{Scene, SceneConfig};
use output::report::Concern;
use output::run_results::write_results;
use std::path::Path;
use support::severity::Severity;
use support::toml_file;

/// The scene linear-7x7 from a random start, with 40 steps of an optimiser.
fn circle(folder: &Path, (method, noise, seed): (&str, f64, u64), follow_every: usize) -> Scene {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/scenes");
    let file = configs.join("linear-7x7.toml");
    let mut config: SceneConfig = toml_file::read(&file).unwrap();
    config.optimiser.method = serde_json::from_str(&format!("\"{method}\"")).unwrap();
    config.optimiser.start_noise = noise;
    (config.optimiser.seed, config.optimiser.steps) = (seed, 40);
    config.solver.follow_every = follow_every;
    config.output = folder.join("run");
    Scene::new(config, &file).unwrap()
}

/// Between two followed paths, the paths of these searches go on along another branch.
#[test]
fn a_search_keeps_a_design_whose_path_was_followed() {
    for start in [("adam", 0.5, 6), ("adam", 0.5, 18), ("lbfgs", 0.7, 7)] {
        let folder = tempfile::tempdir().unwrap();
        let scene = circle(folder.path(), start, 10);
        let designed = run(&scene, None).unwrap();
        assert!(designed.contradicted, "{start:?}");
        assert!(designed.best.loss < 0.5 * designed.start.loss, "{start:?}");
        // The design in the run folder has the loss that the report states, and no step found a lower one.
        let stored = design_of_run(&scene).unwrap().unwrap();
        let problem = scene.problem().unwrap();
        assert_eq!(problem.loss(&stored).unwrap(), designed.best.loss);
        let least = designed.history.iter().map(|step| step.scores.loss);
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(least > (1.0 - 1e-6) * designed.best.loss, "{start:?}");
        // A settled search has settled on a followed path.
        if designed.ended == Ended::Settled {
            assert!(designed.history.last().unwrap().followed);
        }
        let report = write_results(&scene, &designed, false).unwrap();
        let notes = report
            .warnings
            .iter()
            .filter(|warning| warning.concern == Concern::OtherBranch);
        assert_eq!(
            notes.map(|note| note.severity).collect::<Vec<_>>(),
            [Severity::Note]
        );
    }
}

/// After a contradiction the search is one that follows every path, from the best design that was followed before.
#[test]
fn every_path_is_followed_after_a_contradiction() {
    let folder = tempfile::tempdir().unwrap();
    let designed = run(&circle(folder.path(), ("adam", 0.5, 6), 10), None).unwrap();
    let corrected = designed.history.iter().rposition(|step| !step.followed);
    let history = &designed.history[corrected.map_or(0, |last| last + 1)..];
    assert!(history.len() > 20 && history.iter().all(|step| step.followed));
    assert_eq!(designed.history.len(), 41);
    let steps = designed.history.iter().map(|step| step.step);
    assert!(
        steps.eq(0..41),
        "the discarded steps are not in the history"
    );
}

/// A pause has no effect on a search, not even between a false design and its discovery.
#[test]
fn a_stopped_search_that_is_refuted_resumes_to_the_same_trajectory() {
    for start in [("adam", 0.5, 6), ("lbfgs", 0.7, 7)] {
        let whole = tempfile::tempdir().unwrap();
        let uninterrupted = run(&circle(whole.path(), start, 10), None).unwrap();
        for stop in [3, 7] {
            let parts = tempfile::tempdir().unwrap();
            let scene = circle(parts.path(), start, 10);
            let stopped = run(&scene, Some(stop)).unwrap();
            assert_eq!(stopped.ended, Ended::Stopped);
            assert!(stopped.best.loss <= stopped.start.loss);
            let resumed = run(&scene, None).unwrap();
            assert_eq!(resumed.history, uninterrupted.history, "{start:?} {stop}");
            assert_eq!(resumed.design, uninterrupted.design);
        }
    }
}

#[test]
fn a_search_without_a_contradiction_is_not_noted() {
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), SCENE);
    let designed = run(&scene, None).unwrap();
    assert!(!designed.contradicted);
    let report = write_results(&scene, &designed, false).unwrap();
    assert!(
        report
            .warnings
            .iter()
            .all(|warning| warning.concern != Concern::OtherBranch)
    );
}

/// A search that is stopped between two followed paths returns the best design so far, not the last followed one.
#[test]
fn a_stopped_search_returns_its_best_design() {
    let folder = tempfile::tempdir().unwrap();
    let designed = run(&read(folder.path(), SCENE), Some(5)).unwrap();
    assert_eq!(designed.ended, Ended::Stopped);
    let least = designed.history.iter().map(|step| step.scores.loss);
    let least = least.fold(f64::INFINITY, f64::min);
    assert!(least < designed.start.loss);
    assert!((designed.best.loss / least - 1.0).abs() < 1e-9);
}
