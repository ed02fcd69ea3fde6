//! A deterministic solver without a program: a hinge of known stiffness, and failures on request.
//! It is used by tests.
//!
//! W = (k_a a^2 + k_s s^2 + k_theta theta^2) / 2, D = theta^2 / 100, D_peak = 10 D, in ten equal
//! increments. Nothing is written to the folder of an attempt.
#![allow(dead_code)] // every test program uses only a part

use fe_driver::{Cause, FailureKind, Solution, SolveError, Solver, ToolVersions, WindowSolve};
use hinge::{HingeDeformation, HingeSample};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Number of increments of a path.
const INCREMENTS: u32 = 10;

/// What goes wrong in an attempt of a [`FakeSolver`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The increments end at this lambda.
    Diverges(f64),
    /// The attempt ends at its time limit or on request.
    Hangs,
    /// The attempt is killed.
    Killed,
    /// There is no solver: no other attempt would succeed either.
    Missing,
}

/// A solver of hinges with a closed-form energy.
pub struct FakeSolver<F> {
    /// (k_a, k_s) (N/mm) and k_theta (N mm/rad).
    stiffness: [f64; 3],
    /// The fault of an attempt at a solve.
    fault: F,
    /// Number of attempts until now.
    attempts: AtomicUsize,
}

impl<F: Fn(&WindowSolve) -> Option<Fault>> FakeSolver<F> {
    /// Hinges with the stiffness (k_a, k_s) (N/mm) and k_theta (N mm/rad); `fault` is asked at
    /// every attempt.
    pub fn new(stiffness: [f64; 3], fault: F) -> Self {
        Self { stiffness, fault, attempts: AtomicUsize::new(0) }
    }

    /// Number of attempts until now.
    pub fn attempts(&self) -> usize {
        self.attempts.load(Ordering::Relaxed)
    }

    pub fn sample(&self, lambda: f64, state: HingeDeformation) -> HingeSample {
        let ([k_a, k_s, k_theta], [a, s, theta]) = (self.stiffness, state.to_array());
        let w = 0.5 * (k_a * a * a + k_s * s * s + k_theta * theta * theta);
        let d = 0.01 * theta * theta;
        HingeSample {
            lambda,
            a,
            s,
            theta,
            w,
            w_work: w,
            w_elastic: w,
            f_a: k_a * a,
            f_s: k_s * s,
            m_theta: k_theta * theta,
            d,
            d_peak: Some(10.0 * d),
            ..HingeSample::default()
        }
    }
}

impl<F: Fn(&WindowSolve) -> Option<Fault> + Sync> Solver for FakeSolver<F> {
    fn versions(&self) -> ToolVersions {
        let [gmsh, ccx] = ["none", "fake"].map(str::to_owned);
        ToolVersions { gmsh, ccx }
    }

    fn attempt(
        &self,
        solve: &WindowSolve,
        _work: &Path,
        limit: Duration,
        stop: &AtomicBool,
    ) -> Result<Solution, SolveError> {
        let start = Instant::now();
        self.attempts.fetch_add(1, Ordering::Relaxed);
        let (end, stopped) = match (self.fault)(solve) {
            None => (1.0, None),
            Some(Fault::Diverges(lambda)) => {
                let diverged = Cause::Problem(FailureKind::Diverged);
                (lambda, Some(diverged.error(format!("the solver diverged at lambda = {lambda}"))))
            }
            Some(Fault::Hangs) => {
                while start.elapsed() < limit {
                    if stop.load(Ordering::Relaxed) {
                        return Err(Cause::Stop.error("stopped"));
                    }
                    std::thread::sleep(Duration::from_millis(1));
                }
                let timed_out = Cause::Problem(FailureKind::TimedOut);
                (0.0, Some(timed_out.error("fake was terminated at its time limit")))
            }
            Some(Fault::Killed) => {
                return Err(Cause::Machine.error("fake was killed by signal 9"));
            }
            Some(Fault::Missing) => {
                return Err(Cause::Run.error("ccx was not found on PATH"));
            }
        };
        let lambdas = (1..=INCREMENTS).map(|k| f64::from(k) / f64::from(INCREMENTS));
        let samples = lambdas.take_while(|lambda| *lambda <= end);
        let path = &solve.problem.hinge.path;
        Ok(Solution {
            samples: samples.map(|lambda| self.sample(lambda, path.at(lambda))).collect(),
            stopped,
            elements: 1,
            cpu_seconds: Some(1.0),
            wall_seconds: start.elapsed().as_secs_f64(),
            ..Solution::default()
        })
    }
}
