//! Networks of the laws of one split, tested on the laws that are held out and on the materials.

use crate::stop::refuse_stop;
use crate::universal::cases::{
    Case, HELD_OUT, LAWS, Material, Measured, NETWORKS, Network, OTHER_RAYS, TEST, Way, counts,
    inputs, thinned,
};
use crate::universal::family_table::SolvedRay;
use crate::universal::judgement::Errors;
use crate::universal::states::{SolvedState, training_data};
use ::train::{LawEnergy, TrainingConfig};
use anyhow::{Context, Result};
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
        rays.flat_map(|ray| thinned(&ray.states))
    }

    /// Trains networks on the family alone, and tests them on the laws held out and on the materials. Returns the last one
    /// of [`NETWORKS`], trained on all laws of the split.
    pub fn run(
        &self,
        config: &TrainingConfig,
        materials: &[Material],
        film: &str,
        stop: &AtomicBool,
        measured: &mut Measured,
    ) -> Result<LawEnergy> {
        let mut last = None;
        for laws in counts(&LAWS, self.training.len()) {
            let data = training_data(self.states(laws));
            for network in NETWORKS {
                refuse_stop(stop)?;
                eprintln!("split {}, {laws} laws, {network:?}", config.seed);
                let energy = LawEnergy::fit(&data, network.form(), config, None)?;
                let targets = materials.iter();
                let targets = targets.map(|it| (it.sheet.name.as_str(), &it.states));
                let targets = targets.filter(|(name, _)| *name != film || !network.knows_film());
                for (target, states) in targets.chain([(HELD_OUT, &self.held_out)]) {
                    let case = Case {
                        target: target.into(),
                        way: Way::Family(network),
                        laws,
                        own_rays: 0,
                    };
                    let errors = Errors::of(states, &energy.at(&inputs(states))?);
                    measured.entry(case).or_default().push(errors);
                }
                last = Some(energy);
            }
        }
        last.context("there is no law to train on")
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
        let others = others.flat_map(|it| it.rays().take(OTHER_RAYS).flat_map(thinned));
        let data = training_data(self.states(self.training.len()).chain(others));
        let form = Network::WorksOfAll.form();
        Ok(LawEnergy::fit(&data, form, config, None)?)
    }
}
