//! The results of one round: its rays, its cost, and the errors of its weights at the spot check.

use crate::ui::table::number_or_dash;
use ::train::Parity;
use anyhow::Result;
use dataset::Row;
use fe_driver::Tally;
use std::fmt::{self, Write};
use surrogate::{Surrogate, TestErrors};

/// One round.
#[derive(Clone, Copy)]
pub(super) struct Round {
    /// Number of rays of all rounds so far.
    rays: usize,
    /// Number of rays that the solver followed to their end.
    ended: usize,
    /// Solver CPU time of all rays so far (s).
    cpu_s: f64,
    /// Time of all trainings of the round (s).
    training_s: f64,
    /// Number of states of the spot check that lie inside the training domain of the weights.
    inside: usize,
    /// Errors at all states of the spot check.
    errors: TestErrors,
}

/// The columns of a round.
pub(super) const HEADING: &str = "  rays  to their end  solver CPU, s  training, s  states inside    \
    W, %   F_a, %   F_s, %     M, %  forces, %     D, %  D_peak, %";

impl Round {
    pub(super) fn new(tally: &Tally, weights: &Surrogate, training_s: f64, spot: &[Row]) -> Self {
        let domain = weights.domain();
        let inside = spot.iter().filter(|row| {
            let state = row.sample.deformation();
            domain.contains(&row.design, &state)
        });
        Self {
            rays: tally.closed(),
            ended: tally.complete,
            cpu_s: tally.cpu_seconds,
            training_s,
            inside: inside.count(),
            errors: Parity::new(weights, spot).errors(),
        }
    }

    /// Whether the errors of W and of the forces are at most the given ones (%).
    pub(super) fn is_within(&self, energy: f64, forces: f64) -> bool {
        let [w, ..] = self.errors.percents();
        w <= energy && self.errors.forces_percent() <= forces
    }

    pub(super) fn errors(&self) -> TestErrors {
        self.errors
    }

    pub(super) fn inside(&self) -> usize {
        self.inside
    }

    fn ended_percent(&self) -> f64 {
        100.0 * self.ended as f64 / self.rays as f64
    }
}

impl fmt::Display for Round {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let percents = self.errors.percents();
        let w = number_or_dash(percents[0], 2);
        let [_, f_a, f_s, m_theta, d, d_peak] = percents.map(|it| number_or_dash(it, 1));
        write!(
            f,
            "{:>6}  {:>10.0} %  {:>13.0}  {:>11.0}  {:>13}  {w:>6}  {f_a:>7}  {f_s:>7}  {m_theta:>7}  {:>9}  {d:>7}  \
             {d_peak:>9}",
            self.rays,
            self.ended_percent(),
            self.cpu_s,
            self.training_s,
            format!("{} of {}", self.inside, self.errors.rows),
            number_or_dash(self.errors.forces_percent(), 1)
        )
    }
}

/// The rounds as a table.
pub(super) fn csv(rounds: &[Round]) -> Result<String> {
    let mut text = "rays,ended_percent,solver_cpu_s,training_s,states,states_inside,w_percent,f_a_percent,f_s_percent,\
        m_theta_percent,d_percent,d_peak_percent\n"
        .to_owned();
    for round in rounds {
        let Round {
            rays,
            cpu_s,
            training_s,
            inside,
            errors,
            ..
        } = round;
        let ended = round.ended_percent();
        write!(
            text,
            "{rays},{ended:.1},{cpu_s:.1},{training_s:.1},{},{inside}",
            errors.rows
        )?;
        for error in errors.percents() {
            write!(text, ",{error:.4}")?;
        }
        text += "\n";
    }
    Ok(text)
}
