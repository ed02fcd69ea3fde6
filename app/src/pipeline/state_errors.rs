//! Errors of weights at given states against finite elements.

use anyhow::Result;
use dataset::{COMPARED, ComparedState, Database, reference_rms};
use std::path::Path;
use support::table::Table;
use surrogate::{SpotCheck, Surrogate};
use train::{ErrorInterval, Parity, inside, spot_check};

/// Prints the errors of weights at the states of a database that lie inside the training domain.
pub fn print_errors(surrogate: &Surrogate, database: &Database) {
    let (manifest, rays) = (database.manifest(), database.rays());
    println!(
        "weights of tier {}, tested on tier {}, {} rays",
        surrogate.card().tier,
        manifest.tier,
        manifest.rays
    );
    let inside = Parity::new(surrogate, &inside(surrogate, rays)).states;
    println!("{} of {} states inside the training domain\n", inside.len(), manifest.rows);
    if !inside.is_empty() {
        println!("{}", distribution(&inside));
    }
    match ErrorInterval::of(surrogate, rays) {
        Some([w, forces]) => println!("all states: W {w}; forces {forces}"),
        None => println!("all states: too few for an interval"),
    }
}

/// Root mean square, median, 90th and 99th percentile and maximum of each quantity's error.
fn distribution(states: &[ComparedState]) -> Table {
    let mut table = Table::new(["error (%)", "rms", "median", "90 %", "99 %", "worst"]);
    let mut add = |name: String, i: usize, scale: &dyn Fn(&ComparedState) -> f64| {
        let known = states.iter().filter(|state| state.is_known(i));
        let mut errors: Vec<f64> = known
            .map(|state| {
                (state.value[i] - state.reference[i]).abs() / scale(state).max(f64::MIN_POSITIVE)
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let Some(last) = errors.len().checked_sub(1) else { return };
        let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        let at = |fraction: f64| errors[(fraction * last as f64).round() as usize];
        let values = [mean.sqrt(), at(0.5), at(0.9), at(0.99), at(1.0)];
        let cells = values.map(|value| format!("{:.2}", 100.0 * value));
        table.row(std::iter::once(name).chain(cells));
    };
    add("W, relative to its own value".into(), 0, &|state| state.reference[0]);
    let rms = reference_rms(states);
    for (i, name) in COMPARED.iter().enumerate() {
        add(format!("{name}, relative to its root mean square"), i, &|_| rms[i]);
    }
    table
}

/// Writes the errors at some states to the card of weights, which is changed by `recorded`.
pub fn record(
    surrogate: Surrogate,
    database: &Database,
    recorded: impl Fn(Surrogate, SpotCheck) -> Surrogate,
    weights: &Path,
) -> Result<()> {
    let check = spot_check(&surrogate, database.rays(), &database.manifest().tier.to_string());
    recorded(surrogate, check).save(weights)?;
    println!("recorded on the card of {}", weights.display());
    Ok(())
}
