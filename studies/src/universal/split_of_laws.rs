//! Networks of the laws of one split, tested on the laws that are held out and on the materials.

use crate::stop::refuse_stop;
use crate::universal::cases::{
    Case, HELD_OUT, LAWS, Material, Measured, NETWORKS, Network, OTHER_RAYS, TEST, Way, counts,
    inputs,
};
use crate::universal::family_table::SolvedRay;
use crate::universal::judgement::{Errors, mean};
use crate::universal::states::{SolvedState, training_data};
use ::train::{EnergySlopes, LawEnergy, TrainingConfig};
use anyhow::Result;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::AtomicBool;

/// Laws for training, in the order of the family, and laws that are held out.
pub(super) struct SplitOfLaws<'a> {
    pub training: Vec<&'a SolvedRay>,
    held_out: Vec<SolvedState>,
}

impl<'a> SplitOfLaws<'a> {
    pub fn new(rays: &'a [SolvedRay], seed: u64) -> Self {
        let mut order: Vec<&SolvedRay> = rays.iter().collect();
        order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
        let (held_out, training) = order.split_at((TEST * rays.len() as f64).ceil() as usize);
        let mut training = training.to_vec();
        training.sort_by_key(|ray| ray.index);
        let held_out = held_out.iter().flat_map(|ray| ray.states.clone());
        Self {
            training,
            held_out: held_out.collect(),
        }
    }

    /// The states of the first `laws` rays.
    fn states(&self, laws: usize) -> impl Iterator<Item = &SolvedState> {
        let rays = self.training[..laws].iter();
        rays.flat_map(|ray| &ray.states)
    }

    /// Trains networks on the family alone, and tests them on the laws held out and on the materials.
    pub fn run(
        &self,
        config: &TrainingConfig,
        materials: &[Material],
        film: &str,
        stop: &AtomicBool,
        measured: &mut Measured,
    ) -> Result<()> {
        for laws in counts(&LAWS, self.training.len()) {
            let data = training_data(self.states(laws));
            let mut trained = Vec::new();
            for network in NETWORKS {
                refuse_stop(stop)?;
                eprintln!("split {}, {laws} laws, {network:?}", config.seed);
                let energy = LawEnergy::fit(&data, network.form(), config)?;
                trained.push((network, energy));
            }
            let targets = materials.iter();
            let targets = targets.map(|it| (it.sheet.name.as_str(), &it.states));
            for (target, states) in targets.chain([(HELD_OUT, &self.held_out)]) {
                let mut record = |way, found: &[EnergySlopes]| {
                    let case = Case {
                        target: target.into(),
                        way,
                        laws,
                        own_rays: 0,
                    };
                    let errors = Errors::of(states, found);
                    measured.entry(case).or_default().push(errors);
                };
                let mut of_works = Vec::new();
                let judged = (trained.iter()).filter(|(it, _)| target != film || !it.knows_film());
                for (network, energy) in judged {
                    let found = energy.at(&inputs(states))?;
                    record(Way::Family(*network), &found);
                    if network.is_of_works() {
                        of_works.push(found);
                    }
                }
                record(Way::MeanOfWorks, &mean(&of_works));
            }
        }
        Ok(())
    }

    /// The network that is trained on all laws of the split and on rays of all materials but one.
    pub fn with_others(
        &self,
        config: &TrainingConfig,
        without: &Material,
        materials: &[Material],
        stop: &AtomicBool,
    ) -> Result<LawEnergy> {
        refuse_stop(stop)?;
        let name = &without.sheet.name;
        eprintln!("split {}, all but {name}", config.seed);
        let others = materials.iter().filter(|it| it.sheet.name != *name);
        let others = others.flat_map(|it| it.rays().take(OTHER_RAYS).flatten());
        let data = training_data(self.states(self.training.len()).chain(others));
        let form = Network::WorksOfAll.form();
        Ok(LawEnergy::fit(&data, form, config)?)
    }
}
