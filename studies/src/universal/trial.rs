//! A network of the family, tested on a material without a ray of its own and with few, beside the weights of the film.

use crate::stop::refuse_stop;
use crate::universal::cases::{
    Case, Material, Measured, Network, OWN_RAYS, Way, counts, films, inputs,
};
use crate::universal::judgement::{Errors, best_factor, scaled};
use crate::universal::states::{Film, SolvedState, training_data};
use ::train::{EnergySlopes, LawEnergy, TrainingConfig};
use anyhow::Result;
use dataset::{Database, Part, Row};
use kirigami::commands::train::kept_fit;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use surrogate::Surrogate;

/// A split of the rays of a material.
pub(super) struct Trial<'a> {
    pub material: &'a Material,
    pub database: Database,
    pub film: &'a Film,
    /// [`Network::WorksOfAll`], without a ray of the material.
    pub energy: &'a LawEnergy,
    pub tuned: &'a TrainingConfig,
    /// Folder of the fine-tuned weights of the film.
    pub fits: PathBuf,
}

impl Trial<'_> {
    pub fn run(&self, seed: u64, stop: &AtomicBool, measured: &mut Measured) -> Result<()> {
        let name = &self.material.sheet.name;
        let is_film = *name == self.film.sheet.name;
        let mut keep = |way, own_rays, errors| {
            let case = Case {
                target: name.clone(),
                way,
                laws: 0,
                own_rays,
            };
            measured.entry(case).or_default().push(errors);
        };
        let (network, energy) = (Network::WorksOfAll, self.energy);
        if !is_film {
            let all = &self.material.states;
            keep(Way::Film, 0, Errors::of(all, &films(all)));
        }
        let test = self.states(&self.database.part(Part::Test));
        let before = energy.at(&inputs(&test))?;
        keep(Way::FamilyTuned(network), 0, Errors::of(&test, &before));
        let available = self.database.manifest().split.jobs(Part::Training).len();
        for own_rays in counts(&OWN_RAYS, available.min(OWN_RAYS[OWN_RAYS.len() - 1])) {
            refuse_stop(stop)?;
            eprintln!("split {seed}, {name}, {own_rays} rays");
            let thinned = self.database.thinned(own_rays);
            let own = self.states(&thinned.part(Part::Training));
            let factor = best_factor(&own, &energy.at(&inputs(&own))?);
            let errors = Errors::of(&test, &scaled(&before, factor));
            keep(Way::FamilyTimes(network), own_rays, errors);
            let config = TrainingConfig {
                mirror: false,
                frozen_layers: 0,
                ..self.tuned.clone()
            };
            let data = training_data(&own);
            let tuned = energy.tuned(&data, &config)?;
            let errors = Errors::of(&test, &tuned.at(&inputs(&test))?);
            keep(Way::FamilyTuned(network), own_rays, errors);
            if is_film {
                continue;
            }
            let factor = best_factor(&own, &films(&own));
            let errors = Errors::of(&test, &scaled(&films(&test), factor));
            keep(Way::FilmTimes, own_rays, errors);
            let fit = format!("{name}-{own_rays}-rays-split-{seed}");
            let start = Some(&self.film.weights);
            let weights = kept_fit(&self.fits, &fit, &thinned, self.tuned, start)?;
            let errors = Errors::of(&test, &self.by(weights, &thinned.part(Part::Test)));
            keep(Way::FilmTuned, own_rays, errors);
        }
        Ok(())
    }

    fn states(&self, rows: &[Row]) -> Vec<SolvedState> {
        SolvedState::of_rows(rows, &self.material.sheet, self.film)
    }

    /// The energies of weights of this material.
    fn by(&self, weights: Surrogate, rows: &[Row]) -> Vec<EnergySlopes> {
        let sheet = self.material.sheet.clone();
        let film = Film { weights, sheet };
        films(&SolvedState::of_rows(rows, &self.material.sheet, &film))
    }
}
