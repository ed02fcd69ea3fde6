//! Lists of solves whose results are needed at once: a replay, a spot check, a round of an
//! equilibrium, a study.

use crate::{
    Job, Solve, SolveEvent, SolveListError, SolveStore, Solved, Solver, ToolVersions, WindowSolve,
    Workers,
};
use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use support::refuse;

/// Solves lists of problems of one kind and keeps every result in a store: what is in the store is
/// not solved again.
pub struct SolveService<'a, S: Solve = WindowSolve> {
    /// What solves them.
    pub solver: Box<dyn Solver<S> + 'a>,
    /// Where solves are kept.
    pub store: SolveStore,
    /// Number of solves that run in parallel.
    pub workers: usize,
    /// Time limit of one attempt.
    pub limit: Duration,
    /// Terminates the attempts in flight when set.
    pub stop: &'a AtomicBool,
    /// Receives the numbers of solves done and of all.
    pub progress: Box<dyn Fn(usize, usize) + 'a>,
}

impl<S: Solve> SolveService<'_, S> {
    /// The versions that the solves of this service must have.
    pub fn versions(&self) -> ToolVersions {
        self.solver.versions()
    }

    /// The results of `solves`, in the same order; equal solves are made once. A solve that fails
    /// is a result too, after all of its attempts.
    ///
    /// A result of an earlier list is read from the store. A failure that the mechanics did not
    /// cause, as a time limit, is tried again.
    ///
    /// # Errors
    /// [`SolveListError::Stopped`] if `stop` becomes true before the last solve is done, another one
    /// if the machine ended every attempt at one of them.
    pub fn solve(&self, solves: &[S]) -> Result<Vec<Solved<S>>, SolveListError> {
        let ids: Vec<String> = solves.iter().map(S::id).collect();
        let (mut known, mut jobs) = (HashSet::new(), Vec::new());
        for (id, solve) in std::iter::zip(&ids, solves) {
            if known.insert(id) {
                let folder = self.store.solve(id);
                folder.reopen::<S>(|failure| !failure.is_repeatable())?;
                jobs.push(Job { id: id.clone(), solve: solve.clone(), folder });
            }
        }
        let workers = Workers {
            solver: &*self.solver,
            count: self.workers,
            limit: self.limit,
            deadline: None,
        };
        let (mut done, all) = (0, jobs.len());
        let mut disturbed = None;
        (self.progress)(done, all);
        workers.work_through(&jobs, self.stop, &mut |index, event| {
            match event {
                SolveEvent::Found(Some(record)) | SolveEvent::Ended { record, .. }
                    if record.is_closed() =>
                {
                    done += 1;
                    (self.progress)(done, all);
                }
                SolveEvent::Disturbed { reason, .. } => disturbed = Some((index, reason)),
                _ => {}
            }
            Ok(())
        })?;
        let mut solved: HashMap<&String, Solved<S>> = HashMap::new();
        for job in &jobs {
            solved.extend(job.folder.result()?.map(|result| (&job.id, result)));
        }
        let left = jobs.len() - solved.len();
        if left > 0 {
            match disturbed {
                Some((index, reason)) if !self.stop.load(Ordering::Relaxed) => refuse!(
                    "{left} solves are open: the machine ended each of their attempts, the last of {} because {reason}; what is \
                     solved is kept, and the same command continues",
                    jobs[index].id
                ),
                _ => return Err(SolveListError::Stopped { left }),
            }
        }
        Ok(ids.iter().map(|id| solved[id].clone()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::failure::{AttemptKind, FailureKind, SolveError};
    use crate::solve::solver::{Solution, SolvedPath};
    use crate::solve::tests::{FakeSolver, Fault, STIFFNESS, healthy, solve_to};
    use crate::solve::window_solve::StepControl;
    use mesher::Tier;
    use serde::{Deserialize, Serialize};
    use std::io;
    use std::path::Path;
    use tempfile::TempDir;

    /// Three rays.
    fn solves() -> Vec<WindowSolve> {
        [0.2, 0.4, 0.6].map(solve_to).to_vec()
    }

    /// Whether a solve is the second of the three.
    fn is_second(solve: &WindowSolve) -> bool {
        solve.problem.hinge == solves()[1].problem.hinge
    }

    fn service<'a>(
        solver: &'a (dyn Solver + 'a),
        folder: &TempDir,
        stop: &'a AtomicBool,
    ) -> SolveService<'a> {
        SolveService {
            solver: Box::new(solver),
            store: SolveStore(folder.path().join("solves")),
            workers: 1,
            limit: Duration::from_millis(5),
            stop,
            progress: Box::new(|_, _| {}),
        }
    }

    fn solve(solver: &dyn Solver, folder: &TempDir) -> Result<Vec<Solved>, SolveListError> {
        service(solver, folder, &AtomicBool::new(false)).solve(&solves())
    }

    #[test]
    fn a_window_that_fails_is_named_and_the_others_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let diverges =
            FakeSolver::new(STIFFNESS, |solve| is_second(solve).then_some(Fault::Diverges(0.35)));
        let windows = solve(&diverges, &folder).unwrap();
        let complete: Vec<bool> = windows.iter().map(|window| window.complete().is_ok()).collect();
        assert_eq!(complete, [true, false, true]);
        assert_eq!(windows[0].samples.len(), 10);
        // Three attempts: as requested, shorter increments, a finer mesh; converged increments are
        // kept.
        let failed = windows[1].complete().unwrap_err();
        assert_eq!((windows[1].record.attempts, windows[1].samples.len()), (3, 3));
        let message = failed.to_string();
        for part in ["w_lig 18.00 mm", "22.92 deg", "diverged at lambda = 0.35", &windows[1].id] {
            assert!(message.contains(part), "{message}");
        }
        assert!(windows[1].work.is_dir() && !windows[0].work.exists());
        // The mechanics would fail again: nothing is solved twice.
        assert_eq!(solve(&diverges, &folder).unwrap(), windows);
        assert_eq!(diverges.attempts(), 5);
    }

    #[test]
    fn a_failure_that_another_attempt_avoids_leaves_no_trace_but_its_cost() {
        let folder = tempfile::tempdir().unwrap();
        let needs_short = FakeSolver::new(STIFFNESS, |solve| {
            let usual = solve.problem.step == StepControl::default();
            usual.then_some(Fault::Diverges(0.0))
        });
        for (window, expected) in std::iter::zip(
            solve(&needs_short, &folder).unwrap(),
            solve(&healthy(), &tempfile::tempdir().unwrap()).unwrap(),
        ) {
            assert_eq!(window.samples, expected.samples);
            assert_eq!((window.record.attempts, window.record.cpu_seconds), (2, 2.0));
            assert_eq!(window.record.failure, None);
        }
    }

    #[test]
    fn a_list_that_is_stopped_continues_where_it_ended() {
        let folder = tempfile::tempdir().unwrap();
        let stop = AtomicBool::new(false);
        let hangs = FakeSolver::new(STIFFNESS, |solve| is_second(solve).then_some(Fault::Hangs));
        let stopped = SolveService {
            limit: Duration::from_secs(60),
            progress: Box::new(|done, _| stop.store(done == 1, Ordering::Relaxed)),
            ..service(&hangs, &folder, &stop)
        };
        let error = stopped.solve(&solves()).unwrap_err();
        assert!(matches!(error, SolveListError::Stopped { left: 2 }), "{error}");
        let rest = healthy();
        assert_eq!(solve(&rest, &folder).unwrap().len(), 3);
        assert_eq!(rest.attempts(), 2);
    }

    #[test]
    fn a_time_limit_is_tried_again_by_the_next_list() {
        let folder = tempfile::tempdir().unwrap();
        let hangs = FakeSolver::new(STIFFNESS, |solve| is_second(solve).then_some(Fault::Hangs));
        let windows = solve(&hangs, &folder).unwrap();
        assert_eq!(windows[1].record.failure, Some(FailureKind::TimedOut));
        let mended = healthy();
        let windows = solve(&mended, &folder).unwrap();
        assert!(windows.iter().all(|window| window.complete().is_ok()));
        assert_eq!(mended.attempts(), 1);
    }

    #[test]
    fn what_the_machine_ends_is_tried_as_it_is_and_stays_open() {
        let folder = tempfile::tempdir().unwrap();
        let killed = FakeSolver::new(STIFFNESS, |solve| is_second(solve).then_some(Fault::Killed));
        let error = solve(&killed, &folder).unwrap_err();
        assert!(error.to_string().starts_with("1 solves are open"), "{error}");
        assert!(error.to_string().contains("signal 9"), "{error}");
        // Each of the two others once.
        assert_eq!(killed.attempts(), 2 + 3);
        let mended = healthy();
        let windows = solve(&mended, &folder).unwrap();
        assert_eq!(mended.attempts(), 1);
        let undisturbed = solve(&healthy(), &tempfile::tempdir().unwrap()).unwrap();
        for (window, expected) in std::iter::zip(windows, undisturbed) {
            assert_eq!(window.samples, expected.samples);
            assert_eq!(window.record.tier, expected.record.tier);
        }
    }

    #[test]
    fn a_missing_solver_halts_the_list_and_what_is_done_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let lost = FakeSolver::new(STIFFNESS, |solve| is_second(solve).then_some(Fault::Missing));
        let error = solve(&lost, &folder).unwrap_err();
        assert!(error.to_string().starts_with("the run was stopped"), "{error}");
        assert!(error.to_string().contains("not found"), "{error}");
        let mended = healthy();
        solve(&mended, &folder).unwrap();
        assert!(mended.attempts() < 3);
    }

    #[test]
    fn equal_solves_are_made_once_and_damaged_ones_again() {
        let folder = tempfile::tempdir().unwrap();
        let (solver, stop) = (healthy(), AtomicBool::new(false));
        let service = service(&solver, &folder, &stop);
        let twice = [solve_to(0.2), solve_to(0.4), solve_to(0.2)];
        let windows = service.solve(&twice).unwrap();
        assert_eq!((windows.len(), solver.attempts()), (3, 2));
        assert_eq!(windows[0], windows[2]);
        let rows = service.store.solve(&windows[0].id).0.join("rows.csv");
        std::fs::write(rows, "edited").unwrap();
        let again = service.solve(&twice).unwrap();
        assert_eq!((&again[0].samples, solver.attempts()), (&windows[0].samples, 3));
    }

    /// Another kind of problem: a bar that is stretched in steps.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Bar {
        stiffness: f64,
        steps: u32,
    }

    /// The force at each step.
    #[derive(Clone, Debug, Default, PartialEq)]
    struct Forces(Vec<f64>);

    impl Solve for Bar {
        type Samples = Forces;

        fn tier(&self) -> Tier {
            Tier::Tiny
        }

        fn description(&self) -> String {
            format!("bar of {} N", self.stiffness)
        }

        fn next_attempt(
            &self,
            attempt: AttemptKind,
            _: FailureKind,
            _: f64,
        ) -> Option<AttemptKind> {
            (attempt == AttemptKind::Requested).then_some(AttemptKind::ShorterIncrements)
        }

        fn attempted(&self, attempt: AttemptKind) -> Self {
            let mut bar = self.clone();
            bar.steps *= 1 + u32::from(attempt == AttemptKind::ShorterIncrements);
            bar
        }
    }

    impl SolvedPath for Forces {
        const FILE: &'static str = "forces.json";

        fn len(&self) -> usize {
            self.0.len()
        }

        fn reached(&self) -> f64 {
            f64::from(u8::from(!self.is_empty()))
        }

        fn to_bytes(&self) -> io::Result<Vec<u8>> {
            Ok(serde_json::to_vec(&self.0)?)
        }

        fn from_bytes(bytes: &[u8]) -> io::Result<Self> {
            Ok(Self(serde_json::from_slice(bytes)?))
        }
    }

    /// Needs at least four steps.
    struct BarSolver;

    impl Solver<Bar> for BarSolver {
        fn versions(&self) -> ToolVersions {
            healthy().versions()
        }

        fn attempt(
            &self,
            bar: &Bar,
            _: &Path,
            _: Duration,
            _: &AtomicBool,
        ) -> Result<Solution<Forces>, SolveError> {
            let steps = f64::from(bar.steps);
            if bar.steps < 4 {
                return Err(crate::Cause::Problem(FailureKind::Diverged).error("diverged"));
            }
            let force = |step| bar.stiffness * f64::from(step) / steps;
            Ok(Solution {
                samples: Forces((1..=bar.steps).map(force).collect()),
                ..Solution::default()
            })
        }
    }

    #[test]
    fn another_kind_of_problem_is_attempted_kept_and_read_back() {
        let (folder, stop) = (tempfile::tempdir().unwrap(), AtomicBool::new(false));
        let windows = healthy();
        let windows = service(&windows, &folder, &stop);
        let bars = SolveService {
            solver: Box::new(BarSolver),
            store: windows.store.clone(),
            workers: 2,
            limit: Duration::from_secs(60),
            stop: &stop,
            progress: Box::new(|_, _| {}),
        };
        let [needs_more, fails] = [3, 1].map(|steps| Bar { stiffness: 0.3, steps });
        let list = [needs_more.clone(), fails];
        let solved = bars.solve(&list).unwrap();
        assert_eq!(solved[0].complete().unwrap().len(), 6);
        let record = &solved[0].record;
        assert_eq!((record.attempts, record.lambda), (2, 1.0));
        let message = solved[1].complete().unwrap_err().to_string();
        assert!(message.starts_with("bar of 0.3 N: "), "{message}");
        assert!(message.contains("diverged"), "{message}");
        // The store keeps windows next to it.
        assert_eq!(windows.solve(&solves()).unwrap().len(), 3);
        let kept = windows.store.solve(&needs_more.id());
        assert!(kept.0.join("forces.json").exists());
        assert_eq!(kept.solve().unwrap(), Some(needs_more));
        assert_eq!(bars.solve(&list).unwrap(), solved);
    }
}
