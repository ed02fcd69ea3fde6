//! The capacities of patterns that are searched from several starts: how far a capacity is that of one search.

use super::{CapacityStudy, Strategy, boundary};
use crate::spread::spread;
use anyhow::Result;
use design::scene::SceneConfig;
use support::table::{Cell, Table};

/// Standard deviation of the coordinates of a random start.
const NOISE: f64 = 0.3;

/// A pattern found from one start.
struct Found {
    /// The interval of rho at which it is deployed; no maximum if all tested loads above the minimum are carried.
    carried: (f64, Option<f64>),
    /// Boundary error at rho = 1 (%).
    boundary: f64,
}

/// The patterns of a strategy.
pub(super) struct Starts {
    name: &'static str,
    /// `None` from a start whose search has not settled.
    found: Vec<Option<Found>>,
}

impl CapacityStudy {
    /// The patterns of the strategies that search, from random starts with the seeds 1 to `self.starts`.
    pub(super) fn several_starts(
        &self,
        config: &SceneConfig,
        strategies: &[Strategy],
    ) -> Result<Vec<Starts>> {
        let mut all = Vec::new();
        for (i, strategy) in strategies.iter().enumerate() {
            let Some(search) = &strategy.search else {
                continue;
            };
            let found = (1..=self.starts).map(|seed| {
                let mut search = search.clone();
                search.optimiser.start_noise = NOISE;
                search.optimiser.seed = seed;
                search.output = std::path::absolute(&self.out)?.join(format!("runs/{i}-{seed}"));
                self.found_from(config, search, strategy.name)
            });
            all.push(Starts {
                name: strategy.name,
                found: found.collect::<Result<_>>()?,
            });
        }
        Ok(all)
    }

    fn found_from(
        &self,
        config: &SceneConfig,
        search: SceneConfig,
        name: &str,
    ) -> Result<Option<Found>> {
        let Some((design, _)) = self.settled(search, name)? else {
            return Ok(None);
        };
        let points = self.sweep(config, &design, name)?;
        let carried = self.carried(config, &design, &points)?;
        Ok(Some(Found {
            carried: (carried.from, carried.maximum()),
            boundary: boundary(&points).unwrap_or(f64::NAN),
        }))
    }
}

/// The table of the random starts; `to`: the largest rho that is tried.
pub(super) fn table(starts: &[Starts], to: f64) -> String {
    Table::new()
        .column("pattern", |starts: &Starts| Cell::text(starts.name))
        .column("starts", |starts| Cell::text(starts.found.len()))
        .column("settled", |starts| Cell::text(starts.settled().count()))
        .column("deployed at rho = 1", |starts| {
            let deployed = starts.settled().filter(|found| found.is_deployed());
            Cell::text(deployed.count())
        })
        .column("minimum rho", |starts| {
            starts.spread(|found| found.carried.0, 2)
        })
        .column("maximum rho", move |starts| {
            starts.spread(|found| found.carried.1.unwrap_or(to), 2)
        })
        .column("boundary rms at rho = 1, %", |starts| {
            starts.spread(|found| found.boundary, 3)
        })
        .markdown(starts)
}

impl Starts {
    fn settled(&self) -> impl Iterator<Item = &Found> {
        self.found.iter().flatten()
    }

    /// Median and range of a figure.
    fn spread(&self, of: impl Fn(&Found) -> f64, digits: usize) -> Cell {
        let values: Vec<f64> = self.settled().map(of).collect();
        spread(&values, digits)
    }
}

impl Found {
    /// Whether every void is open at the load of the designs.
    fn is_deployed(&self) -> bool {
        let (from, to) = self.carried;
        (from..=to.unwrap_or(f64::INFINITY)).contains(&super::DESIGN_LOAD)
    }
}
