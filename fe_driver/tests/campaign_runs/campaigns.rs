//! Campaigns run with the real solver: interrupted, resumed, rejected, stale.

use crate::common::{TWO_WORKERS, campaign, history, job_folder, jobs, run_with};
use fe_driver::{CalculiX, Campaign, Ccx, FailureKind, plan, run, status};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use testkit::fake_ccx;

fn run_to_end(campaign: &Campaign, folder: &Path, tools: &CalculiX) {
    let tally = run_with(&TWO_WORKERS, campaign, folder, tools).unwrap();
    assert_eq!(tally.to_run(), 0);
}

#[test]
fn an_interrupted_campaign_is_resumed_to_the_same_rows() {
    let (whole, parts) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let campaign = campaign(3);
    let tools = CalculiX::find().unwrap();
    run_to_end(&campaign, whole.path(), &tools);

    // Stopped as soon as one job is closed, with another in flight.
    let stop = AtomicBool::new(false);
    let progress = run(&campaign, parts.path(), &tools, &TWO_WORKERS, &stop, &mut |progress| {
        stop.store(progress.tally.closed() > 0, Ordering::Relaxed);
    });
    let closed = progress.unwrap().tally.closed();
    assert!((1..3).contains(&closed), "{closed}");
    let versions = tools.versions();
    let left = plan(&campaign, parts.path(), &versions).unwrap();
    assert_eq!((left.tally.complete, left.tally.open), (closed, 3 - closed));
    assert_eq!(left.reasons.values().sum::<usize>(), 3 - closed);
    let done_before = jobs(parts.path());

    run_to_end(&campaign, parts.path(), &tools);
    let resumed = jobs(parts.path());
    assert_eq!(resumed.len(), 3);
    for (a, b) in resumed.iter().zip(jobs(whole.path())) {
        assert_eq!((&a.id, &a.samples, a.record.failure), (&b.id, &b.samples, None));
        assert_eq!(a.samples.last().unwrap().lambda, 1.0);
    }
    // What was finished was not run again.
    assert!(done_before.iter().all(|job| resumed.contains(job)));

    let status = status(parts.path()).unwrap();
    assert_eq!((status.name.as_str(), status.tally.complete), ("tiny", 3));
    assert_eq!(status.tally.rows, resumed.iter().map(|job| job.samples.len()).sum::<usize>());
    // A successful job keeps no deck, no log and no output.
    let folder = job_folder(parts.path(), &resumed[0].id);
    let mut names: Vec<_> = folder
        .read_dir()
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort_unstable();
    assert_eq!(names, ["job.json", "result.json", "rows.csv"]);

    // A changed setting makes jobs stale; the plan names the setting.
    let mut changed = campaign.clone();
    changed.material.young += 1.0;
    let after = plan(&changed, parts.path(), &versions).unwrap();
    assert_eq!((after.tally.open, after.stale), (3, 3));
    assert_eq!(after.reasons["stale: material changed"], 3);

    // A campaign with another name is rejected.
    changed.name = "other".into();
    let refused = plan(&changed, parts.path(), &versions).unwrap_err();
    assert!(refused.to_string().contains("contains the campaign `tiny`"), "{refused}");
}

/// Writes a .sta file with one diverged increment, and prints an error.
const GIVES_UP: &str = "echo '1 1 1U 4 0. 0. 0.005' > window.sta; echo '*ERROR: too small'";

#[test]
fn a_failing_solver_is_retried_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let program = fake_ccx(folder.path(), &format!("{GIVES_UP}; exit 201"));
    let tools = CalculiX { ccx: Ccx::at(&program).unwrap(), ..CalculiX::find().unwrap() };
    run_to_end(&campaign(1), folder.path(), &tools);
    let status = status(folder.path()).unwrap();
    assert_eq!(status.tally.failed, 1);
    assert_eq!(status.tally.failures[&FailureKind::Diverged], 1);
    assert!(jobs(folder.path()).is_empty());
    // Three attempts: as requested, with shorter increments, on a finer mesh; each has a start and
    // an end event.
    let events = std::fs::read_to_string(history(folder.path(), "events-1-of-1.jsonl")).unwrap();
    assert_eq!(events.lines().count(), 6);
    assert!(events.lines().next_back().unwrap().contains("finer-tier"));
}

#[test]
fn a_missing_solver_stops_the_run_immediately() {
    let folder = tempfile::tempdir().unwrap();
    let program = fake_ccx(folder.path(), "");
    let tools = CalculiX { ccx: Ccx::at(&program).unwrap(), ..CalculiX::find().unwrap() };
    std::fs::remove_file(&program).unwrap();
    let error = run_with(&TWO_WORKERS, &campaign(5), folder.path(), &tools).unwrap_err();
    assert!(error.to_string().starts_with("the run was stopped"), "{error}");
    assert_eq!(status(folder.path()).unwrap().tally.open, 5);
}

#[test]
fn edited_rows_are_rejected_and_solved_again() {
    let folder = tempfile::tempdir().unwrap();
    let (campaign, tools) = (campaign(1), CalculiX::find().unwrap());
    run_to_end(&campaign, folder.path(), &tools);
    let before = jobs(folder.path());
    let id = &before[0].id;
    let rows = job_folder(folder.path(), id).join("rows.csv");
    let text = std::fs::read_to_string(&rows).unwrap();
    std::fs::write(&rows, text.replacen('3', "4", 1)).unwrap();
    assert_eq!(jobs(folder.path()), []);
    assert_eq!(status(folder.path()).unwrap().tally.damaged, 1);
    run_to_end(&campaign, folder.path(), &tools);
    assert_eq!(jobs(folder.path())[0].samples, before[0].samples);
}
