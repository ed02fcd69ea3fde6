//! What `kirigami material learn` says at its end: what was reached, what is left, where the weights are and what comes next.

use crate::ui::progress::duration;
use crate::ui::shell_word::shell_word;
use std::path::Path;
use verification::{Accuracy, LearningRound};

/// Exponent of the error in the number of rays below which more rays are no help that can be foretold.
const FLAT: f64 = 0.1;

/// The last lines of a run with `rounds`, whose material and weights are in the named files.
pub(super) fn conclusion(
    rounds: &[LearningRound],
    asked: Accuracy,
    workers: usize,
    [material, weights]: [&Path; 2],
) -> String {
    let Some(last) = rounds.last() else {
        return "no weights yet: not enough rays are solved for a training".into();
    };
    let mut text = String::new();
    if let Some([w, forces]) = last.intervals {
        text += &format!(
            "W {w}, asked {} %; forces {forces}, asked {} %\n",
            asked.energy, asked.forces
        );
    }
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

/// The time that is still needed if the errors go on to fall with a power of the number of rays; nothing if they are small
/// enough, or after one round.
fn time_left(rounds: &[LearningRound], asked: Accuracy, workers: usize) -> Option<String> {
    let [.., before, last] = rounds else {
        return None;
    };
    let errors = |round: &LearningRound| {
        let errors = &round.check.errors;
        [errors.percents()[0], errors.forces_percent()]
    };
    let grown = (last.rays as f64 / before.rays as f64).ln();
    let goals = [asked.energy, asked.forces];
    let needed = (0..2).filter_map(|i| {
        let ([from, to], goal) = ([errors(before)[i], errors(last)[i]], goals[i]);
        (to > goal).then(|| {
            let exponent = (from / to).ln() / grown;
            if exponent < FLAT {
                f64::INFINITY
            } else {
                last.rays as f64 * (to / goal).powf(exponent.recip())
            }
        })
    });
    let rays = needed.max_by(f64::total_cmp)?;
    if rays.is_infinite() {
        return Some(
            "an error hardly fell in the last round: more rays may not reach what is asked\n"
                .into(),
        );
    }
    let each = last.cpu_s / last.rays as f64;
    let seconds = (rays - last.rays as f64) * each / workers as f64;
    Some(format!(
        "by the slope of the last round about {rays:.0} rays are needed, another {} of solves on {workers} processors\n",
        duration(seconds)
    ))
}
