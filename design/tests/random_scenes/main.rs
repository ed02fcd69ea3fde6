//! Random sheets: sizes, hinge laws, supports, loads, drives, contacts, weight and ratios of
//! stiffness from common to extreme. Every equilibrium is checked by full matrices written
//! independently of the solver; the mirror image, a sheet of half the size and other load steps
//! must deploy alike; corrected paths and searches must have the loss of the followed path.
//!
//! `RUNS=n` draws n sheets instead of the few of every day, `FIRST=k` begins with the seed k, and a
//! table is printed with `--nocapture`. The findings at a sheet are repeated by `FIRST=k RUNS=1`.
//! Of 12 000 sheets that no change of the program had seen (`FIRST=28000`), every equilibrium was
//! balanced and stable, and no search ended above its start. After a jump, 6 similar sheets and one
//! with other load steps deployed otherwise, and 3 corrected paths had other stable states; so had 3
//! without a jump.

mod checks;
mod dense;
mod drawn;

use checks::{Finding, findings};
use drawn::Drawn;
use std::collections::{BTreeMap, BTreeSet};
use std::panic::catch_unwind;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// The sheets of every day.
const FEW: u64 = 300;
/// Sheets whose paths once went to and fro between the same states, ended for want of increments or
/// depended on the load steps.
const KNOWN: [u64; 7] = [832, 904, 1464, 12066, 16370, 16551, 19709];
/// Time from which a sheet is named (s).
const LONG: f64 = 20.0;

fn number(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().expect("a whole number"))
}

fn seeds() -> Vec<u64> {
    let first = number("FIRST").unwrap_or(0);
    match number("RUNS") {
        Some(runs) => (first..first + runs).collect(),
        None => (first..first + FEW).chain(KNOWN).collect(),
    }
}

#[test]
fn random_sheets_deploy_as_they_must() {
    let seeds = seeds();
    let next = AtomicUsize::new(0);
    let table = Mutex::new(BTreeMap::<Finding, BTreeSet<u64>>::new());
    let work = || {
        while let Some(&seed) = seeds.get(next.fetch_add(1, Ordering::Relaxed)) {
            let began = Instant::now();
            let found = catch_unwind(|| findings(seed))
                .unwrap_or_else(|_| panic!("the sheet {seed} ends in a panic"));
            let seconds = began.elapsed().as_secs_f64();
            if seconds > LONG {
                println!("{seed}: {seconds:.0} s ({})", Drawn::new(seed));
            }
            let mut table = table.lock().unwrap();
            for (finding, details) in found {
                if finding.2 || !details.is_empty() {
                    println!("{seed} ({}): {}: {details}", Drawn::new(seed), finding.1);
                }
                table.entry(finding).or_default().insert(seed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let table = table.into_inner().unwrap();
    println!("| of {} random sheets | |\n|---|---|", seeds.len());
    for (finding, seeds) in &table {
        println!("| {} | {} |", finding.1, seeds.len());
    }
    let faults: Vec<_> = table.iter().filter(|(finding, _)| finding.2).collect();
    assert!(faults.is_empty(), "{faults:?}");
}
