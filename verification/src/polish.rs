//! A design searched once more with the hinge law corrected to finite elements.
//!
//! The sheet is balanced with finite elements for its hinges, the search continues from the design with the corrected
//! law, and the sheet that it finds is balanced again: both designs are judged by finite elements at their own hinges.

use crate::balanced_sheet::{BalanceEnd, Balanced, balanced};
use crate::replay::{ElementWindows, UnsolvedHinge};
use crate::verification_error::VerificationError;
use design::objective::design_problem::Evaluation;
use design::objective::scores::Scores;
use design::optimise::outer_loop::{Ended, SearchState, StepRecord, optimise};
use design::pattern::design_vector::DesignVector;
use design::scene::Scene;
use design::scene::design_run::Designed;
use serde::Serialize;
use std::convert::Infallible;
use std::fmt;
use std::sync::atomic::AtomicBool;

/// A polished design.
pub struct Polished {
    /// The search with the corrected law. Start and best are evaluated with the law corrected at their own hinges; the
    /// problem is that of the best.
    pub designed: Designed,
    /// The equilibrium of the design that it found, by finite elements.
    pub after: Balanced,
    /// What the polish changed.
    pub gain: PolishGain,
}

/// The objective of a design before and after its polish, and what is known of the numbers.
#[derive(Debug, Serialize)]
pub struct PolishGain {
    /// The given design, for a person.
    given: String,
    /// By the hinge law of the scene: the given design, and the one that was found.
    by_law: [Scores; 2],
    /// By finite elements for all hinges.
    by_elements: [Scores; 2],
    /// Search steps with the corrected law, and why they ended.
    steps: usize,
    ended: Ended,
    /// Why the rounds of both sheets ended.
    ended_rounds: [BalanceEnd; 2],
    /// The hinges of both sheets that were not solved in the last round: the law stands for them.
    unsolved: [Vec<UnsolvedHinge>; 2],
    /// CPU time of all window solves (s).
    cpu_seconds: f64,
}

/// A design to be polished.
#[derive(Clone, Copy)]
pub struct PolishTask<'a> {
    /// The scene of the design.
    pub scene: &'a Scene,
    /// The design.
    pub design: &'a DesignVector,
    /// Its name for a person.
    pub name: &'a str,
    /// Maximum number of rounds in which a sheet is balanced.
    pub rounds: usize,
    /// Number of steps of the search.
    pub steps: usize,
}

/// Balances a design, searches on from it, and balances the design that was found.
///
/// # Errors
/// [`VerificationError::Stopped`] if `stop` becomes true during the search; windows that were solved are kept.
pub fn polish(
    task: PolishTask,
    windows: &ElementWindows,
    stop: &AtomicBool,
    progress: &mut dyn FnMut(&StepRecord),
) -> Result<Polished, VerificationError> {
    let PolishTask {
        scene,
        design,
        rounds,
        steps,
        ..
    } = task;
    let law = scene.problem()?;
    let (before, corrected) = balanced(scene, design, windows, rounds)?;
    let start = corrected.evaluate(design)?;
    let optimiser = &scene.config.optimiser;
    let mut search = SearchState::new(
        &corrected,
        design.clone(),
        &start,
        optimiser.method,
        optimiser.learning_rate,
    );
    let show = &mut |search: &SearchState| {
        progress(search.last());
        Ok::<_, Infallible>(())
    };
    let ended = match optimise(&corrected, &mut search, steps, stop, show) {
        Ok(Ended::Stopped) => {
            let left = steps + 1 - search.history.len();
            return Err(VerificationError::Stopped { left });
        }
        Ok(ended) => ended,
        Err(never) => match never {},
    };
    let found = search.best.clone();
    let (after, problem) = balanced(scene, &found, windows, rounds)?;
    let best = problem.evaluate(&found)?;
    let scores = |evaluation: &Evaluation| Scores::new(&law.objective, evaluation);
    let gain = PolishGain {
        given: task.name.to_owned(),
        by_law: [
            scores(&law.evaluate(design)?),
            scores(&law.evaluate(&found)?),
        ],
        by_elements: [scores(&start), scores(&best)],
        steps: search.history.len() - 1,
        ended: ended.clone(),
        unsolved: [&before, &after].map(|sheet| sheet.unsolved().to_vec()),
        ended_rounds: [before.ended, after.ended.clone()],
        cpu_seconds: before.cpu_seconds + after.cpu_seconds,
    };
    let designed = Designed {
        problem,
        ended,
        contradicted: search.contradicted(),
        history: search.history,
        design: found,
        start,
        best,
        residual: after.residual(),
    };
    Ok(Polished {
        designed,
        after,
        gain,
    })
}

impl PolishGain {
    /// Whether finite elements confirm that the loss decreased.
    pub fn improved(&self) -> bool {
        let [before, after] = &self.by_elements;
        after.loss < before.loss
    }
}

impl fmt::Display for PolishGain {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "# The design, polished\n\n\
             Given: {}. Searched for {} steps with the hinge law corrected to finite elements at the hinges of the given \
             design, {:.0} CPU minutes of windows. \"By finite elements\" is the equilibrium with finite elements for all hinges of the design \
             of that column.\n\n\
             | | given design | polished design |\n|---|---|---|",
            self.given,
            self.steps,
            self.cpu_seconds / 60.0,
        )?;
        for (name, [before, after]) in [
            ("by the hinge law", &self.by_law),
            ("by finite elements", &self.by_elements),
        ] {
            let mut row = |quantity: &str, value: fn(&Scores) -> f64| {
                let [before, after] = [before, after].map(value);
                writeln!(f, "| {quantity}, {name} | {before:.4} | {after:.4} |")
            };
            row("outline error (mm)", |scores| scores.outline_error)?;
            row("loss", |scores| scores.loss)?;
            row("damage functional", |scores| scores.terms["damage"])?;
            row("fraction inside the domain", |scores| scores.share_inside)?;
        }
        if let Ended::Stuck { reason } = &self.ended {
            writeln!(f, "\nThe search is stuck: {reason}")?;
        }
        if !self.improved() {
            writeln!(
                f,
                "\nNOT IMPROVED: by finite elements the given design has the lower loss. Use that one."
            )?;
        }
        for (i, sheet) in ["given", "polished"].into_iter().enumerate() {
            if let Some(warning) = self.ended_rounds[i].warning() {
                writeln!(f, "\nNOT BALANCED, {sheet} design: {warning}.")?;
            }
            for hinge in &self.unsolved[i] {
                writeln!(f, "\nNOT SOLVED, {sheet} design: {hinge}")?;
            }
        }
        Ok(())
    }
}
