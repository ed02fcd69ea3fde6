//! What `kirigami material learn` says at its end: what was reached, what is left, where the
//! weights are and what comes next.

use crate::ui::progress::duration;
use crate::ui::shell_word::shell_word;
use std::path::Path;
use verification::{Accuracy, LearningRound};

/// Exponent of the error in the number of rays below which more rays are no help that can be
/// foretold.
const FLAT: f64 = 0.1;

/// A month (s).
const LONGEST: f64 = 30.0 * 86400.0;

/// The last lines of a run with `rounds`, whose material and weights are in the named files.
pub(super) fn conclusion(
    rounds: &[LearningRound],
    asked: Accuracy,
    workers: usize,
    [material, weights]: [&Path; 2],
) -> String {
    let Some(last) = rounds.last() else {
        return "no weights yet: no round was finished".into();
    };
    let [w, forces] = match last.intervals {
        Some(intervals) => intervals.map(|found| found.to_string()),
        None => reached(last).map(|error| format!("{error:.2} %")),
    };
    let mut text =
        format!("W {w}, asked {} %; forces {forces}, asked {} %\n", asked.energy, asked.forces);
    if let Some(left) = time_left(rounds, asked, workers) {
        text += &left;
    }
    text + &format!(
        "weights: {}\nnext:    kirigami init SHEET --material {} --weights {} --size WIDTHxHEIGHT",
        weights.display(),
        shell_word(material),
        shell_word(weights)
    )
}

/// Errors of W and of the forces (%).
fn reached(round: &LearningRound) -> [f64; 2] {
    let errors = &round.check.errors;
    [errors.percents()[0], errors.forces_percent()]
}

/// The time that is still needed if the errors go on to fall with a power of the number of rays;
/// nothing if they are small enough, or after one round.
fn time_left(rounds: &[LearningRound], asked: Accuracy, workers: usize) -> Option<String> {
    let (last, earlier) = rounds.split_last()?;
    // The slope of a short round is noise.
    let before = earlier.iter().rfind(|round| 2 * round.rays <= last.rays)?;
    let grown = (last.rays as f64 / before.rays as f64).ln();
    let goals = [asked.energy, asked.forces];
    let needed = (0..2).filter_map(|i| {
        let ([from, to], goal) = ([reached(before)[i], reached(last)[i]], goals[i]);
        (to > goal).then(|| {
            let exponent = (from / to).ln() / grown;
            if exponent.is_nan() || exponent < FLAT {
                f64::INFINITY
            } else {
                last.rays as f64 * (to / goal).powf(exponent.recip())
            }
        })
    });
    let rays = needed.max_by(f64::total_cmp)?;
    let each = last.cpu_s / last.rays as f64;
    let seconds = (rays - last.rays as f64) * each / workers as f64;
    if seconds.is_nan() || seconds > LONGEST {
        return Some(
            "by the slope of the last rounds more rays do not reach what is asked within a month\n"
                .into(),
        );
    }
    Some(format!(
        "by the slope of the last rounds about {rays:.0} rays are needed, another {} of solves on {workers} processors\n",
        duration(seconds)
    ))
}
