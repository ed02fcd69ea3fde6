//! The rounds of a learned material as a table.

use crate::learning::LearningRound;
use support::table::{Cell, Columns, Table};

impl LearningRound {
    /// The rounds, one a row; `-` if an error is not known, without its interval if it has none.
    pub fn table(rounds: &[Self]) -> Table {
        let mut columns = Columns::new()
            .column("rays", |round: &Self| round.rays)
            .column("to their end", |round| {
                Cell::percent(round.complete as f64 / round.rays as f64, 0)
            })
            .column("solver CPU\ns", |round| Cell::fixed(round.cpu_s, 0))
            .column("training\ns", |round| Cell::fixed(round.training_s, 0))
            .column("states", |round| round.check.errors.rows)
            .column("inside", |round| round.check.inside);
        let names = ["W\n%", "F_a\n%", "F_s\n%", "M\n%", "D\n%", "D_peak\n%"];
        for (i, name) in names.into_iter().enumerate() {
            columns =
                columns.column(name, move |round| Cell::fixed(round.check.errors.percents()[i], 2));
        }
        columns
            .column("forces\n%", |round| Cell::fixed(round.check.errors.forces_percent(), 2))
            .column("W, 95 %", |round| interval(round, 0))
            .column("forces, 95 %", |round| interval(round, 1))
            .table(rounds)
    }
}

fn interval(round: &LearningRound, which: usize) -> String {
    let intervals = round.intervals.as_ref();
    intervals.map_or("-".into(), |both| {
        let [low, high] = both[which].interval;
        format!("{low:.2} to {high:.2}")
    })
}
