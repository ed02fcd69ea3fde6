//! The rounds of a learned material as lines and as a table.

use anyhow::Result;
use std::fmt::Write;
use surrogate::number_or_dash;
use verification::LearningRound;

/// The columns of a line.
pub(super) const HEADING: &str = "  rays  to their end  solver CPU, s  training, s  states inside    \
    W, %   F_a, %   F_s, %     M, %  forces, %     D, %  D_peak, %";

fn complete_percent(round: &LearningRound) -> f64 {
    100.0 * round.complete as f64 / round.rays as f64
}

/// One round.
pub(super) fn line(round: &LearningRound) -> String {
    let percents = round.errors.percents();
    let w = number_or_dash(percents[0], 2);
    let [_, f_a, f_s, m_theta, d, d_peak] = percents.map(|percent| number_or_dash(percent, 1));
    format!(
        "{:>6}  {:>10.0} %  {:>13.0}  {:>11.0}  {:>13}  {w:>6}  {f_a:>7}  {f_s:>7}  {m_theta:>7}  {:>9}  {d:>7}  \
         {d_peak:>9}",
        round.rays,
        complete_percent(round),
        round.cpu_s,
        round.training_s,
        format!("{} of {}", round.inside, round.errors.rows),
        number_or_dash(round.errors.forces_percent(), 1)
    )
}

/// The rounds as a table.
pub(super) fn csv(rounds: &[LearningRound]) -> Result<String> {
    let mut text = "rays,ended_percent,solver_cpu_s,training_s,states,states_inside,w_percent,f_a_percent,f_s_percent,\
        m_theta_percent,d_percent,d_peak_percent\n"
        .to_owned();
    for round in rounds {
        let LearningRound {
            rays,
            cpu_s,
            training_s,
            inside,
            errors,
            ..
        } = round;
        let complete = complete_percent(round);
        write!(
            text,
            "{rays},{complete:.1},{cpu_s:.1},{training_s:.1},{},{inside}",
            errors.rows
        )?;
        for error in errors.percents() {
            write!(text, ",{error:.4}")?;
        }
        text += "\n";
    }
    Ok(text)
}
