//! Random sheets: sizes, hinge laws, supports, loads, drives, contacts, weight and ratios of stiffness from common to
//! extreme. Every equilibrium is judged by full matrices written independently of the solver; the mirror image, a sheet of half the size
//! and other load steps must deploy alike; corrected paths and searches must tell the loss of the followed path.
//!
//! `RUNS=n` draws n sheets instead of the few of every day, `FIRST=k` begins with the seed k, and a table is printed with
//! `--nocapture`. The findings at a sheet are repeated by `FIRST=k RUNS=1`.

mod checks;
mod dense;
mod drawn;

use checks::{Finding, findings};
use drawn::Drawn;
use std::collections::BTreeMap;
use std::panic::catch_unwind;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// The sheets of every day.
const FEW: u64 = 300;
/// Time from which a sheet is named (s).
const LONG: f64 = 20.0;

fn number(name: &str, default: u64) -> u64 {
    match std::env::var(name) {
        Ok(text) => text.parse().expect("a whole number"),
        Err(_) => default,
    }
}

#[test]
fn random_sheets_deploy_as_they_must() {
    let (first, runs) = (number("FIRST", 0), number("RUNS", FEW));
    let next = AtomicU64::new(first);
    let table = Mutex::new(BTreeMap::<Finding, Vec<u64>>::new());
    let work = || {
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= first + runs {
                break;
            }
            let began = Instant::now();
            let found = catch_unwind(|| findings(seed))
                .unwrap_or_else(|_| panic!("the sheet {seed} ends in a panic"));
            let seconds = began.elapsed().as_secs_f64();
            if seconds > LONG {
                println!("{seed}: {seconds:.0} s ({})", Drawn::new(seed));
            }
            let mut table = table.lock().unwrap();
            for (finding, details) in found {
                if finding.is_fault() || !details.is_empty() {
                    println!(
                        "{seed} ({}): {}: {details}",
                        Drawn::new(seed),
                        finding.words()
                    );
                }
                let seeds = table.entry(finding).or_default();
                if seeds.last() != Some(&seed) {
                    seeds.push(seed);
                }
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let table = table.into_inner().unwrap();
    println!("| of {runs} random sheets | |\n|---|---|");
    for (finding, seeds) in &table {
        println!("| {} | {} |", finding.words(), seeds.len());
    }
    let faults: Vec<_> = table
        .iter()
        .filter(|(finding, _)| finding.is_fault())
        .collect();
    assert!(faults.is_empty(), "{faults:?}");
}
