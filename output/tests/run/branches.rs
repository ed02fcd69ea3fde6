//! Sheets with several equilibria: a search keeps designs whose path was
//! followed from the flat sheet.

use super::*;
use design::optimise::outer_loop::Ended;
use scene::design_run::design_of_run;
use support::severity::Severity;

/// The scene linear-7x7 from a random start, with 40 steps of an optimiser that follows every tenth
/// path.
fn circle(folder: &Path, (method, noise, seed): (&str, f64, u64)) -> Scene {
    shipped("linear-7x7", |config| {
        config.optimiser.method = serde_json::from_str(&format!("\"{method}\"")).unwrap();
        config.optimiser.start_noise = noise;
        (config.optimiser.seed, config.optimiser.steps) = (seed, 40);
        config.solver.follow_every = 10;
        config.output = folder.join("run");
    })
}

fn least_loss(designed: &Designed) -> f64 {
    let losses = designed.search.history.iter().map(|step| step.scores.loss);
    losses.fold(f64::INFINITY, f64::min)
}

/// Between two followed paths, the paths of these searches go on along another branch.
#[test]
fn a_search_keeps_a_design_whose_path_was_followed() {
    for start in [("adam", 0.5, 6), ("adam", 0.5, 18), ("lbfgs", 0.7, 4)] {
        let folder = tempfile::tempdir().unwrap();
        let scene = circle(folder.path(), start);
        let designed = run(&scene, None).unwrap();
        assert!(designed.search.branch_mismatch(), "{start:?}");
        assert!(designed.best.loss < 0.5 * designed.start.loss, "{start:?}");
        // The design in the run folder has the loss that the report states, and no step found a
        // lower one.
        let stored = design_of_run(&scene).unwrap().unwrap();
        let problem = scene.problem().unwrap();
        assert_eq!(problem.loss(&stored).unwrap(), designed.best.loss);
        let least = least_loss(&designed);
        assert!(least > (1.0 - 1e-6) * designed.best.loss, "{start:?}");
        // A settled search has settled on a followed path.
        if designed.ended == Ended::Settled {
            assert!(designed.search.history.last().unwrap().followed);
        }
        let report = write_results(&scene, &designed, false).unwrap();
        let note = one(&report, "other-branch");
        assert_eq!(note.severity, Severity::Note);
    }
}

/// After a contradiction the search is one that follows every path, from the best design that was
/// followed before.
#[test]
fn every_path_is_followed_after_a_contradiction() {
    let folder = tempfile::tempdir().unwrap();
    let designed = run(&circle(folder.path(), ("adam", 0.5, 6)), None).unwrap();
    let corrected = designed.search.history.iter().rposition(|step| !step.followed);
    let history = &designed.search.history[corrected.map_or(0, |last| last + 1)..];
    assert!(history.len() > 20 && history.iter().all(|step| step.followed));
    assert_eq!(designed.search.history.len(), 41);
    let steps = designed.search.history.iter().map(|step| step.step);
    // The discarded steps are not in the history.
    assert!(steps.eq(0..41));
}

/// A pause has no effect on a search, not even between a false design and its discovery.
#[test]
fn a_stopped_search_that_is_refuted_resumes_to_the_same_trajectory() {
    for start in [("adam", 0.5, 6), ("lbfgs", 0.7, 4)] {
        let whole = tempfile::tempdir().unwrap();
        let uninterrupted = run(&circle(whole.path(), start), None).unwrap();
        for stop in [3, 7] {
            let parts = tempfile::tempdir().unwrap();
            let scene = circle(parts.path(), start);
            let stopped = run(&scene, Some(stop)).unwrap();
            assert_eq!(stopped.ended, Ended::Stopped);
            assert!(stopped.best.loss <= stopped.start.loss);
            let resumed = run(&scene, None).unwrap();
            assert_eq!(resumed.search.history, uninterrupted.search.history, "{start:?} {stop}");
            assert_eq!(resumed.search.best, uninterrupted.search.best);
        }
    }
}

#[test]
fn a_search_without_a_contradiction_is_not_noted() {
    let run = Finished::new(SCENE);
    assert!(!run.designed.search.branch_mismatch());
    assert!(found(&run.report, "other-branch").is_empty());
}

/// A search that is stopped between two followed paths returns the best design so far, not the last
/// followed one.
#[test]
fn a_stopped_search_returns_its_best_design() {
    let folder = tempfile::tempdir().unwrap();
    let designed = run(&read(folder.path(), SCENE), Some(5)).unwrap();
    assert_eq!(designed.ended, Ended::Stopped);
    let least = least_loss(&designed);
    assert!(least < designed.start.loss);
    assert_close(designed.best.loss / least, 1.0, 1e-9);
}
