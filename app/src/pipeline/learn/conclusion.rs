//! What is said when a material is learned: what was reached, in which region, where the weights
//! are and what comes next.

use crate::shell_word::shell_word;
use hinge::TrainingDomain;
use std::path::Path;
use verification::{Accuracy, LearningRound};

/// Files in the folder.
pub(super) const MATERIAL: &str = "material.toml";
pub(super) const WEIGHTS: &str = "weights.safetensors";

/// The last lines of a run in the folder `out` with its last round, the training domain of its
/// weights and the region of the campaign.
pub(super) fn conclusion(
    last: Option<&LearningRound>,
    asked: Accuracy,
    out: &Path,
    (domain, region): (Option<&TrainingDomain>, &TrainingDomain),
) -> String {
    let (Some(last), Some(domain)) = (last, domain) else {
        return "no weights yet: no round was finished".into();
    };
    let (inside, states) = (last.check.inside, last.check.errors.rows);
    let reached = last.intervals.map_or_else(
        || format!("{inside} states in the trained region are too few to assess"),
        |[w, forces]| {
            format!("W {w}, asked {} %; forces {forces}, asked {} %", asked.energy, asked.forces)
        },
    );
    let holes = |of: &TrainingDomain| of.holes.map_or("one hole".into(), |holes| span(holes, ""));
    let word = |name: &str| shell_word(&out.join(name));
    let weights = word(WEIGHTS);
    format!(
        "{reached}\n\
         trained region: ligaments {}, asked {}; holes over w_lig {}, asked {}; {inside} of {states} states of the spot check\n\
         weights: {weights}\nnext:    kirigami init {} --material {} --weights {weights}",
        span(domain.w_lig, " mm"),
        span(region.w_lig, " mm"),
        holes(domain),
        holes(region),
        word("sheet"),
        word(MATERIAL),
    )
}

fn span([least, most]: [f64; 2], unit: &str) -> String {
    format!("{least:.3} to {most:.3}{unit}")
}
