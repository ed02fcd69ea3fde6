//! Errors of weights at given states against finite elements, and the states with the largest
//! errors.

use anyhow::Result;
use dataset::{COMPARED, ComparedState, Database, Row, reference_rms};
use std::path::Path;
use support::{document::Document, table::Table};
use surrogate::Surrogate;
use train::{ErrorInterval, Parity, spot_check};

/// Number of states listed as the worst.
const LISTED: usize = 5;

/// States of a database inside the training domain of weights, with what the weights predict.
struct StateErrors {
    /// Number of states outside the domain, which are not evaluated.
    outside: usize,
    rows: Vec<Row>,
    states: Vec<ComparedState>,
}

impl StateErrors {
    fn new(surrogate: &Surrogate, rows: &[Row]) -> Self {
        let inside = |row: &&Row| {
            let state = row.sample.deformation();
            surrogate.contains(&row.design, &state)
        };
        let inside: Vec<Row> = rows.iter().filter(inside).cloned().collect();
        let outside = rows.len() - inside.len();
        Self { outside, states: Parity::new(surrogate, &inside).states, rows: inside }
    }

    /// |error| of the quantity `i` divided by `scale`, over the states where it is known, in ascending order.
    fn sorted(&self, i: usize, scale: impl Fn(&ComparedState) -> f64) -> Vec<f64> {
        let known = self.states.iter().filter(|state| state.is_known(i));
        let mut errors: Vec<f64> =
            known.map(|state| (state.value[i] - state.reference[i]).abs() / scale(state)).collect();
        errors.sort_by(f64::total_cmp);
        errors
    }

    /// |error| of each energy relative to its own value, in ascending order.
    fn of_own_energy(&self) -> Vec<f64> {
        self.sorted(0, |state| state.reference[0].max(f64::MIN_POSITIVE))
    }

    /// Root mean square, median, 90th and 99th percentile and maximum of each quantity's error.
    fn distribution(&self) -> Table {
        let mut table = Table::new(["error (%)", "rms", "median", "90 %", "99 %", "worst"]);
        let rms = reference_rms(&self.states);
        let mut add = |name: String, errors: Vec<f64>| {
            let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64;
            let at = |fraction: f64| {
                let index = (fraction * errors.len().saturating_sub(1) as f64).round() as usize;
                errors.get(index).copied().unwrap_or(f64::NAN)
            };
            let values = [mean.sqrt(), at(0.5), at(0.9), at(0.99), at(1.0)];
            let cells = values.map(|value| format!("{:.2}", 100.0 * value));
            table.row(std::iter::once(name).chain(cells));
        };
        add("W, relative to its own value".into(), self.of_own_energy());
        for (i, name) in COMPARED.iter().enumerate() {
            let errors = self.sorted(i, |_| rms[i].max(f64::MIN_POSITIVE));
            if !errors.is_empty() {
                add(format!("{name}, relative to its root mean square"), errors);
            }
        }
        table
    }

    /// The states with the largest error of the energy, relative to its own value.
    fn worst(&self) -> Table {
        let mut table = Table::new([
            "worst states",
            "w_lig",
            "alpha",
            "eta_a",
            "eta_s",
            "theta",
            "W, FE",
            "W",
            "error (%)",
        ]);
        let error = |state: &ComparedState| {
            let [value, reference] = [state.value[0], state.reference[0]];
            (value - reference) / reference.max(f64::MIN_POSITIVE)
        };
        let mut order: Vec<usize> = (0..self.states.len()).collect();
        order.sort_by(|&i, &j| {
            let [i, j] = [i, j].map(|k| error(&self.states[k]).abs());
            j.total_cmp(&i)
        });
        for (rank, &k) in order.iter().take(LISTED).enumerate() {
            let (row, state) = (&self.rows[k], &self.states[k]);
            let [eta_a, eta_s] = row.eta();
            table.row([
                format!("{}", rank + 1),
                format!("{:.1} mm", row.design.w_lig),
                format!("{:.0} deg", row.design.alpha.to_degrees()),
                format!("{eta_a:.3}"),
                format!("{eta_s:.3}"),
                format!("{:.1} deg", row.sample.theta.to_degrees()),
                format!("{:.2}", state.reference[0]),
                format!("{:.2}", state.value[0]),
                format!("{:.1}", 100.0 * error(state)),
            ]);
        }
        table
    }

    /// The errors as parts for people.
    fn document(&self) -> Document {
        let (inside, all) = (self.rows.len(), self.rows.len() + self.outside);
        let mut page = Document::default();
        page.text(format!("{inside} of {all} states inside the training domain"));
        if inside == 0 {
            return page;
        }
        page.table(self.distribution());
        let own = self.of_own_energy();
        let percentage = |limit: f64| {
            let met = own.iter().filter(|error| **error <= limit).count();
            100.0 * met as f64 / inside as f64
        };
        page.text(format!(
            "W within 5 % in {:.1} % of the states, within 25 % in {:.1} %",
            percentage(0.05),
            percentage(0.25)
        ));
        page.table(self.worst());
        page
    }
}

/// Prints the errors of weights at the states of a database.
pub fn print_errors(surrogate: &Surrogate, database: &Database) {
    let manifest = database.manifest();
    println!(
        "weights of tier {}, tested on tier {}, {} rays",
        surrogate.card().tier,
        manifest.tier,
        manifest.rays
    );
    print!("{}", StateErrors::new(surrogate, database.rows()).document());
    match ErrorInterval::of(surrogate, database.rows()) {
        Some([w, forces]) => println!("all states: W {w}; forces {forces}"),
        None => println!("all states: too few for an interval"),
    }
}

/// Writes the errors to the card of weights.
pub fn record(surrogate: Surrogate, spot: &Database, weights: &Path) -> Result<()> {
    let check = spot_check(&surrogate, spot.rows(), &spot.manifest().tier.to_string());
    surrogate.with_spot_check(check).save(weights)?;
    println!("recorded on the card of {}", weights.display());
    Ok(())
}
