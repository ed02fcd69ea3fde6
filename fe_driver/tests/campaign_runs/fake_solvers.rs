//! Solvers that crash, hang, report false success or truncate their output: the errors are typed,
//! and no process remains.

use crate::common::problem;
use fe_driver::{CalculiX, Cause, Ccx, FailureKind, Solution, SolveError, Solver, WindowSolve};
use mesher::Gmsh;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use testkit::fake_ccx;

fn solve(body: &str, folder: &Path, limit: Duration) -> Result<Solution, SolveError> {
    let solver = CalculiX {
        gmsh: Gmsh::find().unwrap(),
        ccx: Ccx::at(&fake_ccx(folder, body)).unwrap(),
        print_all: false,
    };
    let solve = WindowSolve::new(problem(90.0, [0.0, 0.0], 8.0), &solver.versions());
    solver.attempt(&solve, folder, limit, &AtomicBool::new(false))
}

fn failure(body: &str) -> SolveError {
    let folder = tempfile::tempdir().unwrap();
    let solution = solve(body, folder.path(), Duration::from_secs(60)).unwrap();
    assert!(solution.samples.is_empty());
    solution.stopped.unwrap()
}

#[test]
fn the_error_of_a_failed_solver_quotes_the_end_of_its_log() {
    let words = "echo '*ERROR: increment size smaller than minimum'; exit 201";
    let attempted = format!("echo '1 1 1U 4 0. 0. 0.005' > window.sta; {words}");
    for (body, expected) in [(words, FailureKind::NotStarted), (&attempted, FailureKind::Diverged)]
    {
        let error = failure(body);
        assert_eq!(error.cause, Cause::Problem(expected));
        assert!(error.to_string().contains("smaller than minimum"), "{error}");
    }
}

/// The next kind of attempt is made only if the solver refuses the problem.
#[test]
fn a_solver_that_says_nothing_of_the_problem_was_ended_by_the_machine() {
    let real = Ccx::find().unwrap().0.program;
    let wrapped = format!("{} \"$@\" & kill $!; wait $!", real.display());
    for body in [
        "kill -9 $$",
        "exit 143",
        &wrapped,
        "exit 127",
        "exit 1",
        "echo 'Job finished'",
        "echo '*ERROR in u_malloc: error allocating memory'; exit 201",
    ] {
        let error = failure(body);
        assert_eq!(error.cause, Cause::Machine, "{body}: {error}");
    }
}

#[test]
fn success_with_invalid_output_is_an_error() {
    let error = failure("echo 'rubbish' > window.dat; echo 'Job finished'");
    assert_eq!(error.cause, Cause::Machine);
    assert!(error.to_string().contains("line 1"), "{error}");
}

#[test]
fn a_hanging_solver_is_terminated_with_its_children() {
    let folder = tempfile::tempdir().unwrap();
    let body = "sleep 1000 & echo $! > child; trap '' TERM; while true; do sleep 1; done";
    // Long enough for gmsh, which has the same limit, on a busy machine.
    let limit = Duration::from_secs(3);
    let stopped = solve(body, folder.path(), limit).unwrap().stopped;
    assert_eq!(stopped.unwrap().cause, Cause::Problem(FailureKind::TimedOut));
    let child = std::fs::read_to_string(folder.path().join("child")).unwrap();
    let stat = Path::new("/proc").join(child.trim()).join("stat");
    let running = || std::fs::read_to_string(&stat).is_ok_and(|stat| !stat.contains(") Z"));
    let deadline = Instant::now() + Duration::from_secs(5);
    while running() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(!running());
}

#[test]
fn output_of_an_earlier_solve_is_not_taken_for_a_result() {
    let folder = tempfile::tempdir().unwrap();
    let limit = Duration::from_secs(120);
    let real = Ccx::find().unwrap().0.program;
    solve(&format!("exec {} \"$@\"", real.display()), folder.path(), limit).unwrap();
    let again = solve("echo 'Job finished'", folder.path(), limit).unwrap();
    assert!(again.samples.is_empty());
    let message = again.stopped.unwrap().message;
    assert!(message.contains("its output ends"), "{message}");
}

/// A real solve whose output is truncated: the complete increments are kept.
#[test]
fn a_truncated_output_keeps_its_complete_increments() {
    let folder = tempfile::tempdir().unwrap();
    let real = Ccx::find().unwrap().0.program;
    let body = format!(
        "{} \"$@\" || exit\nhead -c 300000 window.dat > cut && mv cut window.dat",
        real.display()
    );
    let solution = solve(&body, folder.path(), Duration::from_secs(120)).unwrap();
    let reached = solution.samples.last().unwrap().lambda;
    assert!(0.0 < reached && reached < 1.0);
    let message = solution.stopped.unwrap().message;
    assert!(message.ends_with(&format!("its output ends at lambda = {reached}")), "{message}");
}
