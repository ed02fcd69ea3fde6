//! Campaigns whose solver replays recorded output, which takes almost no time: all ways to run
//! them, and all kinds of solver failure, transient and persistent.

use crate::common::{TWO_WORKERS, campaign, history, job_folder, jobs, run_with};
use fe_driver::{
    CalculiX, Campaign, Ccx, FailureKind, Restored, RunOptions, Shard, SolveRecord, Solved,
    SolvedRay, Tally, plan, restore, run, status,
};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use testkit::{fake_ccx, left_running};

const RAYS: usize = 3;

/// Real solves with their recorded output.
struct Recording {
    outputs: PathBuf,
    jobs: Vec<Solved>,
}

/// Recorded once for all tests.
static RECORDING: LazyLock<Recording> = LazyLock::new(|| {
    let outputs = Path::new(env!("CARGO_TARGET_TMPDIR")).join("recording");
    let _ = std::fs::remove_dir_all(&outputs);
    std::fs::create_dir_all(&outputs).unwrap();
    let tools = CalculiX::find().unwrap();
    let recorder = format!(
        "{} \"$@\" || exit\n{JOB_ID}; for kind in sta dat; do cp window.$kind {}/$id.$kind; done",
        tools.ccx.0.program.display(),
        outputs.display()
    );
    let folder = tempfile::tempdir().unwrap();
    let ccx = Ccx::at(&fake_ccx(folder.path(), &recorder)).unwrap();
    let tally = run_with(&TWO_WORKERS, &campaign(RAYS), folder.path(), &CalculiX { ccx, ..tools });
    assert_eq!(tally.unwrap().complete, RAYS);
    Recording { outputs, jobs: jobs(folder.path()) }
});

/// Sets $id to the job's id; ccx runs in jobs/<2 digits>/<id>/work-<host>-<process>.
const JOB_ID: &str = "id=${PWD%/work-*}; id=${id##*/}";

/// gmsh, and a fake ccx that runs `fault` before it replays the recorded output.
fn replaying(folder: &Path, fault: &str) -> CalculiX {
    let outputs = RECORDING.outputs.display();
    let body = format!(
        "{JOB_ID}; output={outputs}/$id.dat; cp {outputs}/$id.sta window.sta\n{fault}\n\
         echo 'Job finished'; exec cp $output window.dat"
    );
    CalculiX { ccx: Ccx::at(&fake_ccx(folder, &body)).unwrap(), ..CalculiX::find().unwrap() }
}

fn run_whole(campaign: &Campaign, folder: &Path, tools: &CalculiX) -> Tally {
    run_with(&TWO_WORKERS, campaign, folder, tools).unwrap()
}

/// The solves without their costs and their numbers of attempts.
fn timeless(windows: &[Solved]) -> Vec<Solved> {
    let timeless = |window: &Solved| {
        let mut window = window.clone();
        window.record = SolveRecord {
            failure: window.record.failure,
            tier: window.record.tier,
            ..SolveRecord::default()
        };
        window.work = PathBuf::new();
        window
    };
    windows.iter().map(timeless).collect()
}

/// What a database contains of the solves.
fn in_database(windows: &[Solved]) -> Vec<SolvedRay> {
    windows.iter().map(|window| SolvedRay::new(window, window.samples.clone())).collect()
}

/// What the machine does to a solver, as scripts: nothing of it is said of the problem.
const FAULTS: [&str; 7] = [
    "rm window.sta; exit 127",
    // An increment in the middle is missing, from its first heading to the first heading of the
    // next increment.
    "awk '/forces .fx/ { n++ } n != 3' $output > window.dat; echo 'Job finished'; exit 0",
    "kill -9 $$",
    "head -c 150000 $output > window.dat; kill -9 $$",
    "sh -c 'kill -15 $$'; exit $?",
    // The last increment is missing, starting with its first heading.
    "last=$(grep -n 'forces (fx' $output | tail -n 1 | cut -d: -f1); \
     head -n $((last - 1)) $output > window.dat; echo 'Job finished'; exit 0",
    "head -c 150000 $output > window.dat; echo 'Job finished'; exit 0",
];
/// A solver that does not end.
const HANGS: &str = "sleep 1000 & sleep 1000";

#[test]
fn a_transient_fault_does_not_change_the_results() {
    for script in FAULTS {
        let folder = tempfile::tempdir().unwrap();
        let campaign = campaign(RAYS);
        // The script runs only in the first two attempts of each job.
        let twice =
            format!("echo >> ../failed; if [ $(wc -l < ../failed) -lt 3 ]; then {script}; fi");
        let tools = replaying(folder.path(), &twice);
        let tally = run_whole(&campaign, folder.path(), &tools);
        assert_eq!(tally.complete, RAYS, "{script}");
        assert_eq!(timeless(&jobs(folder.path())), timeless(&RECORDING.jobs), "{script}");
        assert_eq!(left_running(folder.path()), Vec::<PathBuf>::new(), "{script}");
    }
}

/// The same attempt is made three times, never another one, and the job stays open.
#[test]
fn a_persistent_fault_of_the_machine_leaves_jobs_open() {
    for script in FAULTS {
        let folder = tempfile::tempdir().unwrap();
        let count = format!("echo >> ../attempts; {script}");
        let tools = replaying(folder.path(), &count);
        let tally = run_whole(&campaign(RAYS), folder.path(), &tools);
        assert_eq!((tally.open, tally.closed()), (RAYS, 0), "{script}");
        for job in &RECORDING.jobs {
            let home = job_folder(folder.path(), &job.id);
            let attempts = std::fs::read_to_string(home.join("attempts")).unwrap();
            assert_eq!(attempts.lines().count(), 3, "{script}");
            assert!(home.join("work").is_dir(), "{script}");
        }
        let mended = replaying(folder.path(), "");
        let tally = run_whole(&campaign(RAYS), folder.path(), &mended);
        assert_eq!(tally.complete, RAYS);
        assert_eq!(timeless(&jobs(folder.path())), timeless(&RECORDING.jobs), "{script}");
    }
}

/// A time limit closes a job: no shorter increments follow.
#[test]
fn a_solver_that_hangs_is_ended_and_tried_again_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let mut campaign = campaign(RAYS);
    campaign.time_limit = Duration::from_secs(4);
    let tally = run_whole(&campaign, folder.path(), &replaying(folder.path(), HANGS));
    assert_eq!(tally.failures[&FailureKind::TimedOut], RAYS);
    assert_eq!(left_running(folder.path()), Vec::<PathBuf>::new());

    // Jobs that failed permanently are not run again until it is asked for. Stopped before its first
    // solve, the run has reopened them.
    campaign.time_limit = Duration::from_secs(120);
    let mended = replaying(folder.path(), "");
    assert_eq!(run_whole(&campaign, folder.path(), &mended).complete, 0);
    let again = RunOptions { retry: true, ..TWO_WORKERS };
    let stop = AtomicBool::new(true);
    run(&campaign, folder.path(), &mended, &again, &stop, &mut |_| {}).unwrap();
    let planned = plan(&campaign, folder.path(), &mended.versions()).unwrap();
    assert_eq!(planned.reasons["timed-out, next requested"], RAYS);
    assert_eq!(run_with(&again, &campaign, folder.path(), &mended).unwrap().complete, RAYS);
    assert_eq!(timeless(&jobs(folder.path())), timeless(&RECORDING.jobs));
}

/// The message of the solver is kept with the increments that converged.
#[test]
fn a_solve_that_diverges_keeps_its_converged_increments() {
    let folder = tempfile::tempdir().unwrap();
    // Not in the last attempt: the recorded output does not fit its finer mesh.
    let script = "echo >> ../attempts; [ $(wc -l < ../attempts) -gt 2 ] || head -c 150000 $output > window.dat; \
                  echo '*ERROR: increment size smaller than minimum'; exit 201";
    let tools = replaying(folder.path(), script);
    let tally = run_whole(&campaign(RAYS), folder.path(), &tools);
    assert_eq!(tally.partial, RAYS);
    let kept = jobs(folder.path());
    for (job, whole) in kept.iter().zip(&RECORDING.jobs) {
        let samples = job.samples.len();
        assert!(0 < samples && samples < whole.samples.len());
        for (kept, solved) in job.samples.iter().zip(&whole.samples) {
            assert_eq!(
                (kept.lambda, kept.w, kept.forces()),
                (solved.lambda, solved.w, solved.forces())
            );
        }
    }
}

/// A full disk is not a failure of the job: the run stops, and no job is counted as failed.
#[test]
fn a_full_disk_stops_the_run_without_losing_jobs() {
    let folder = tempfile::tempdir().unwrap();
    let full = "head -c 150000 $output > window.dat; \
                echo 'Fortran runtime error: No space left on device'; exit 2";
    let tools = replaying(folder.path(), full);
    for _ in 0..2 {
        let error = run_with(&TWO_WORKERS, &campaign(RAYS), folder.path(), &tools).unwrap_err();
        assert!(error.to_string().starts_with("the run was stopped"), "{error}");
        assert!(error.to_string().contains("No space left"), "{error}");
        assert_eq!(status(folder.path()).unwrap().tally.open, RAYS);
    }
    let tools = replaying(folder.path(), "");
    assert_eq!(run_whole(&campaign(RAYS), folder.path(), &tools).complete, RAYS);
    assert_eq!(timeless(&jobs(folder.path())), timeless(&RECORDING.jobs));
}

#[test]
fn cpu_time_of_a_timed_out_solve_is_counted() {
    let folder = tempfile::tempdir().unwrap();
    let mut campaign = campaign(1);
    campaign.time_limit = Duration::from_millis(600);
    let tools = replaying(folder.path(), "while true; do :; done");
    let tally = run_whole(&campaign, folder.path(), &tools);
    assert_eq!(tally.failures[&FailureKind::TimedOut], 1);
    assert!(0.0 < tally.cpu_seconds && tally.cpu_seconds < tally.wall_seconds, "{tally:?}");
}

#[test]
fn shards_run_in_parallel_and_complete_the_campaign() {
    let folder = tempfile::tempdir().unwrap();
    let (folder, tools) = (folder.path(), replaying(folder.path(), "sleep 0.2"));
    let shard = |text: &str| RunOptions { shard: text.parse().unwrap(), ..TWO_WORKERS };
    std::thread::scope(|scope| {
        let run = |text| run_with(&shard(text), &campaign(RAYS), folder, &tools);
        let first = scope.spawn(move || run("1/2"));
        let second = scope.spawn(move || run("2/2"));
        // While both are running, every overlapping shard is rejected.
        let history = |name: &str| history(folder, name).exists();
        while !history("events-1-of-2.jsonl") || !history("events-2-of-2.jsonl") {
            std::thread::sleep(Duration::from_millis(1));
        }
        for text in ["1/2", "2/2", "1/1", "3/3"] {
            let error = run(text).unwrap_err();
            assert!(error.to_string().contains("another run has locked"), "{text}: {error}");
        }
        assert_eq!(first.join().unwrap().unwrap().complete, 2);
        assert_eq!(second.join().unwrap().unwrap().complete, 1);
    });
    assert_eq!(timeless(&jobs(folder)), timeless(&RECORDING.jobs));
    // A later run finds all jobs done.
    assert_eq!(run_whole(&campaign(RAYS), folder, &tools).complete, RAYS);
    assert_eq!(std::fs::read(history(folder, "events-1-of-1.jsonl")).unwrap(), b"");
}

#[test]
fn after_the_time_limit_no_attempt_starts_and_no_result_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let (folder, tools) = (folder.path(), replaying(folder.path(), "sleep 0.5"));
    let short = RunOptions {
        shard: Shard::WHOLE,
        workers: 1,
        time_limit: Some(Duration::from_millis(100)),
        retry: false,
    };
    for done in 1..=RAYS {
        let tally = run_with(&short, &campaign(RAYS), folder, &tools).unwrap();
        assert_eq!((tally.complete, tally.open), (done, RAYS - done));
    }
}

#[test]
fn collected_jobs_are_not_solved_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // One of the rays ended early, on a finer tier.
    let mut collected = in_database(&RECORDING.jobs);
    collected[1].failure = Some(FailureKind::Diverged);
    collected[1].solved_tier = collected[1].solved_tier.finer().unwrap();
    collected[1].samples.pop();
    let restored = |windows: &[_]| restore(&campaign(RAYS), folder, windows).unwrap();
    let expected = |written, there, foreign| Restored { written, there, foreign };
    assert_eq!(restored(&collected[..2]), expected(2, 0, 0));
    assert_eq!(in_database(&jobs(folder)), collected[..2]);
    let mut foreign = collected[0].clone();
    foreign.job = "of another campaign".into();
    foreign.tools.ccx += " before";
    let mut further = collected.clone();
    further.insert(0, foreign);
    assert_eq!(restored(&further), expected(1, 2, 1));
    assert_eq!(in_database(&jobs(folder)), collected);

    let broken = replaying(folder, "exit 1");
    let tally = run_whole(&campaign(RAYS), folder, &broken);
    assert_eq!((tally.complete, tally.partial), (2, 1));
    assert_eq!(in_database(&jobs(folder)), collected);

    let mut other = campaign(RAYS);
    other.material.young += 1.0;
    let error = restore(&other, folder, &collected).unwrap_err();
    assert!(error.to_string().contains("none of the jobs belongs"), "{error}");
}

/// Every file of a job, damaged or deleted, makes the job open; nothing of it reaches the database,
/// and the next run repairs it.
#[test]
fn a_damaged_job_is_open_and_is_solved_again() {
    let replay = tempfile::tempdir().unwrap();
    let tools = replaying(replay.path(), "");
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_eq!(run_whole(&campaign(RAYS), folder, &tools).complete, RAYS);
    let whole = timeless(&jobs(folder));
    let home = job_folder(folder, &whole[1].id);
    let edit = |name: &str, from: &str, to: &str| {
        let text = std::fs::read_to_string(home.join(name)).unwrap();
        assert!(text.contains(from), "{name} has no {from}");
        std::fs::write(home.join(name), text.replacen(from, to, 1)).unwrap();
    };
    let other = job_folder(folder, &whole[2].id);
    let damages: [&dyn Fn(); 8] = [
        &|| edit("job.json", "\"young\": ", "\"young\": 1"),
        &|| std::fs::remove_file(home.join("job.json")).unwrap(),
        &|| edit("job.json", "{", ""),
        &|| edit("result.json", "{", ""),
        &|| edit("result.json", "\"checksum\"", "\"sum\""),
        // Two jobs whose records and rows have changed places: only one of them is compared here.
        &|| {
            for name in ["result.json", "rows.csv"] {
                std::fs::copy(other.join(name), home.join(name)).unwrap();
            }
        },
        &|| edit("rows.csv", "0.", "1."),
        &|| std::fs::remove_file(home.join("rows.csv")).unwrap(),
    ];
    for (i, damage) in damages.into_iter().enumerate() {
        damage();
        let tally = status(folder).unwrap().tally;
        assert_eq!((tally.damaged, tally.open), (1, 1), "damage {i}");
        let planned = plan(&campaign(RAYS), folder, &tools.versions()).unwrap();
        let reasons: Vec<&String> = planned.reasons.keys().collect();
        assert!(reasons.len() == 1 && reasons[0].starts_with("damaged: "), "{reasons:?}");
        assert_eq!(jobs(folder).len(), RAYS - 1, "damage {i}");
        assert_eq!(run_whole(&campaign(RAYS), folder, &tools).complete, RAYS);
        assert_eq!(timeless(&jobs(folder)), whole, "damage {i}");
    }
}
