//! The rounds of a learned material as lines and as a table.

use crate::learning::LearningRound;
use std::fmt;
use support::table::number_or_dash;

impl LearningRound {
    /// The columns of a round that is displayed.
    pub const HEADING: &str = "  rays  to their end  solver CPU, s  training, s  states inside    \
        W, %   F_a, %   F_s, %     M, %  forces, %     D, %  D_peak, %";

    fn complete_percent(&self) -> f64 {
        100.0 * self.complete as f64 / self.rays as f64
    }

    /// The rounds as a table.
    pub fn csv(rounds: &[Self]) -> String {
        let mut text = "rays,ended_percent,solver_cpu_s,training_s,states,states_inside,w_percent,f_a_percent,\
            f_s_percent,m_theta_percent,d_percent,d_peak_percent,\
            w_low_percent,w_high_percent,forces_percent,forces_low_percent,forces_high_percent\n"
            .to_owned();
        for round in rounds {
            let (complete, inside) = (round.complete_percent(), round.check.inside);
            let (cpu_s, training_s, states) =
                (round.cpu_s, round.training_s, round.check.errors.rows);
            text += &format!(
                "{},{complete:.1},{cpu_s:.1},{training_s:.1},{states},{inside}",
                round.rays
            );
            for error in round.check.errors.percents() {
                text += &format!(",{error:.4}");
            }
            let unknown = [[f64::NAN; 2]; 2];
            let intervals = round.intervals.map(|both| both.map(|error| error.interval));
            let [[w_low, w_high], [low, high]] = intervals.unwrap_or(unknown);
            let error = round.check.errors.forces_percent();
            text += &format!(",{w_low:.4},{w_high:.4},{error:.4},{low:.4},{high:.4}\n");
        }
        text
    }
}

impl fmt::Display for LearningRound {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let percents = self.check.errors.percents();
        let w = number_or_dash(percents[0], 2);
        let [_, f_a, f_s, m_theta, d, d_peak] = percents.map(|percent| number_or_dash(percent, 1));
        write!(
            f,
            "{:>6}  {:>10.0} %  {:>13.0}  {:>11.0}  {:>13}  {w:>6}  {f_a:>7}  {f_s:>7}  {m_theta:>7}  {:>9}  {d:>7}  \
             {d_peak:>9}",
            self.rays,
            self.complete_percent(),
            self.cpu_s,
            self.training_s,
            format!("{} of {}", self.check.inside, self.check.errors.rows),
            number_or_dash(self.check.errors.forces_percent(), 1)
        )
    }
}
