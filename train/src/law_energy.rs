//! A hinge energy over a family of sheets: the features of (13), Poisson's ratio and three numbers of
//! the hardening law.
//!
//! All energies are divided by E t^3, lengths by t. The energy of the network is one of
//!
//! ```text
//! W = S |chi(xi) - chi(xi0)|^2                          by itself; S: a scale of the state's law
//! W = sum over j of phi(e_j) (chi(xi) - chi(xi0))_j^2   phi(e): work of the law in tension to the strain e
//! W = W_known(eps, g) sum over j of exp(chi(xi)_j) / n phi(e_j) / phi_known(e_j)
//! W = W_known(eps, g) exp(chi(xi))                      a known energy of another law, corrected; chi has one output
//! ```
//!
//! Without numbers of the hardening among the features xi, the forms of works take the strains of a hinge at a state as
//! independent of its law. Forces are the derivatives in (eta_a, eta_s, theta), the first three features. The loss is (15) without
//! damage, with errors relative to S.

use crate::backend::Backend;
use crate::config::TrainingConfig;
use crate::error::TrainError;
use crate::force_tangents::with_tangents;
use crate::networks::Mlp;
use crate::optimiser::{learning_rate, optimiser};
use burn::module::Module;
use burn::optim::GradientsParams;
use burn::tensor::{DType, Tensor, TensorCreationOptions, TensorData};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::array::from_fn;

/// eta_a, eta_s, theta, ln(w_lig / t), alpha, Poisson's ratio and the numbers of the hardening.
pub const LAW_FEATURES: usize = 6 + HARDENING_FEATURES;
/// Three numbers of the hardening.
const HARDENING_FEATURES: usize = 3;

/// Number of strains e_j.
pub const LAW_STRAINS: usize = 32;

/// Number of states that are evaluated at a time.
const EVALUATED: usize = 4096;

/// An energy and its derivatives in (eta_a, eta_s, theta), over E t^3.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergySlopes {
    /// W / (E t^3)
    pub energy: f64,
    /// Its derivatives in (eta_a, eta_s, theta).
    pub slopes: [f64; 3],
}

/// A state of a hinge of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawState {
    /// The features.
    pub features: [f64; LAW_FEATURES],
    /// S: the size of the energies of this law, by which errors are divided.
    pub scale: f64,
    /// The known energy at this state.
    pub known: EnergySlopes,
    /// phi(e_j) of its law over E.
    pub works: [f64; LAW_STRAINS],
    /// phi(e_j) of the law of the known energy over E.
    pub known_works: [f64; LAW_STRAINS],
}

/// What the network computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LawForm {
    /// The energy by itself.
    Alone,
    /// A factor of the known energy.
    Factor,
    /// A sum of works of the law. The weights of the sum depend on the hinge, on Poisson's ratio and, if asked for, on the
    /// numbers of the hardening.
    Works {
        /// Whether they depend on the hardening.
        numbers: bool,
    },
    /// The known energy times a sum of ratios of works of the law and of the known law, with such weights.
    WorksOfKnown {
        /// Whether they depend on the hardening.
        numbers: bool,
    },
}

/// A trained energy.
#[derive(Clone, Debug)]
pub struct LawEnergy {
    form: LawForm,
    mean: [f64; LAW_FEATURES],
    std: [f64; LAW_FEATURES],
    /// Root mean squares over the training states of W / S and of its derivatives.
    sizes: [f64; 4],
    /// Means over the training states of phi(e_j) / S.
    work_sizes: [f64; LAW_STRAINS],
    network: LawNetwork,
    options: TensorCreationOptions,
}

#[derive(Module, Debug)]
struct LawNetwork {
    chi: Mlp,
}

/// States as tensors; energies over S and over their sizes.
struct Batch {
    /// Features of the undeformed and the deformed states, (2, n, 9).
    states: Tensor<3>,
    /// (n, 1)
    known: Tensor<2>,
    /// (n, 3)
    known_slopes: Tensor<2>,
    /// Works over S and over their sizes, or over those of the known law, (1, n, 32).
    works: Tensor<3>,
}

impl LawEnergy {
    /// Fits an energy of a form to solved states.
    pub fn fit(
        solved: &[(LawState, EnergySlopes)],
        form: LawForm,
        config: &TrainingConfig,
    ) -> Result<Self, TrainError> {
        config.validate()?;
        Self::initial(solved, form, config).tuned(solved, config)
    }

    /// The energy of a fit that continues with other states; scales and layers remain.
    pub fn tuned(
        &self,
        solved: &[(LawState, EnergySlopes)],
        config: &TrainingConfig,
    ) -> Result<Self, TrainError> {
        config.validate()?;
        if solved.is_empty() {
            return Err(TrainError::NoRows { part: "training" });
        }
        let mut energy = self.clone();
        let mut optimiser = optimiser(config);
        let steps = solved.len().div_ceil(config.batch_size);
        for epoch in 0..config.epochs {
            let mut order: Vec<usize> = (0..solved.len()).collect();
            let mut random = ChaCha8Rng::seed_from_u64(config.seed);
            random.set_stream(epoch as u64 + 1);
            order.shuffle(&mut random);
            for (step, indices) in order.chunks(config.batch_size).enumerate() {
                let rate = learning_rate(config, epoch * steps + step, config.epochs * steps);
                let chosen: Vec<_> = indices.iter().map(|&index| solved[index]).collect();
                let loss = energy.loss(&chosen, config.energy_weight);
                if !loss.clone().try_into_scalar::<f64>()?.is_finite() {
                    let (epoch, learning_rate) = (epoch + 1, rate);
                    return Err(TrainError::Diverged {
                        epoch,
                        learning_rate,
                    });
                }
                let gradients = GradientsParams::from_grads(loss.backward(), &energy.network);
                energy.network = optimiser.step(rate, energy.network.clone(), gradients);
            }
        }
        Ok(energy)
    }

    /// The energies at states; their scales and known energies must be given as in the training.
    pub fn at(&self, states: &[LawState]) -> Result<Vec<EnergySlopes>, TrainError> {
        let mut found = Vec::with_capacity(states.len());
        for states in states.chunks(EVALUATED) {
            let (energies, slopes) = self.predict(&self.batch(states));
            let energies: Vec<f64> = energies.inner().try_into_vec_as()?;
            let slopes: Vec<f64> = slopes.inner().try_into_vec_as()?;
            let [size, sizes @ ..] = self.sizes;
            let rows = states.iter().zip(energies).zip(slopes.chunks_exact(3));
            found.extend(rows.map(|((state, energy), slopes)| EnergySlopes {
                energy: energy * size * state.scale,
                slopes: from_fn(|k| slopes[k] * sizes[k] * state.scale),
            }));
        }
        Ok(found)
    }

    fn initial(
        solved: &[(LawState, EnergySlopes)],
        form: LawForm,
        config: &TrainingConfig,
    ) -> Self {
        let count = solved.len() as f64;
        let mean_of = |value: &dyn Fn(&(LawState, EnergySlopes)) -> f64| {
            solved.iter().map(value).sum::<f64>() / count
        };
        let mean = from_fn(|k| mean_of(&|(state, _)| state.features[k]));
        let std: [f64; LAW_FEATURES] =
            from_fn(|k| mean_of(&|(state, _)| (state.features[k] - mean[k]).powi(2)).sqrt());
        let size = |value: &dyn Fn(&EnergySlopes) -> f64| {
            mean_of(&|(state, solved)| (value(solved) / state.scale).powi(2)).sqrt()
        };
        let slope = |k: usize| size(&|solved| solved.slopes[k]);
        let mut widths = config.embedding.clone();
        let outputs = &mut widths[config.embedding.len() - 1];
        match form {
            LawForm::Alone => {}
            LawForm::Factor => *outputs = 1,
            LawForm::Works { .. } | LawForm::WorksOfKnown { .. } => *outputs = LAW_STRAINS,
        }
        let options =
            TensorCreationOptions::new(Backend::default().device()).with_dtype(DType::F32);
        Self {
            form,
            mean,
            std: from_fn(|k| match std[k] {
                _ if !form.has_numbers() && k >= LAW_FEATURES - HARDENING_FEATURES => f64::INFINITY,
                std => {
                    if std > 0.0 {
                        std
                    } else {
                        1.0
                    }
                }
            }),
            work_sizes: from_fn(|j| mean_of(&|(state, _)| state.works[j] / state.scale)),
            sizes: [size(&|solved| solved.energy), slope(0), slope(1), slope(2)],
            network: LawNetwork {
                chi: Mlp::plain(LAW_FEATURES, &widths, config.seed, &options),
            },
            options,
        }
    }

    fn loss(&self, solved: &[(LawState, EnergySlopes)], energy_weight: f64) -> Tensor<1> {
        let states: Vec<LawState> = solved.iter().map(|(state, _)| *state).collect();
        let (energies, slopes) = self.predict(&self.batch(&states));
        let [size, sizes @ ..] = self.sizes;
        let energy = |index: usize| [solved[index].1.energy / size / states[index].scale];
        let slope = |index: usize| -> [f64; 3] {
            from_fn(|k| solved[index].1.slopes[k] / sizes[k] / states[index].scale)
        };
        let mean_square = |found: Tensor<2>, target: Tensor<2>| (found - target).square().mean();
        mean_square(energies, self.table(solved.len(), energy)).mul_scalar(energy_weight)
            + mean_square(slopes, self.table(solved.len(), slope)).mul_scalar(1.0 - energy_weight)
    }

    /// (W / S, its derivatives), each over its size.
    fn predict(&self, batch: &Batch) -> (Tensor<2>, Tensor<2>) {
        let [_, n, _] = batch.states.dims();
        let chi = with_tangents(&self.network.chi.affine(), batch.states.clone());
        let [size, sizes @ ..] = self.sizes;
        // From derivatives in the standardised features to those in the scales of the targets.
        let factors = self.table(n, |_| {
            from_fn::<_, 3, _>(|k| size / (self.std[k] * sizes[k]))
        });
        let by_state = |tangents: Tensor<3>| tangents.sum_dim(2).reshape([3, n]).transpose();
        match self.form {
            LawForm::Alone => {
                let r = chi.values.clone().narrow(0, 1, 1) - chi.values.narrow(0, 0, 1);
                let slopes = by_state(r.clone() * chi.tangents).mul_scalar(2.0);
                (r.square().sum_dim(2).reshape([n, 1]), slopes * factors)
            }
            LawForm::Works { .. } => {
                let r = chi.values.clone().narrow(0, 1, 1) - chi.values.narrow(0, 0, 1);
                let works = batch.works.clone();
                let slopes = by_state(works.clone() * r.clone() * chi.tangents).mul_scalar(2.0);
                let energy = (works * r.square()).sum_dim(2).reshape([n, 1]);
                (energy, slopes * factors)
            }
            LawForm::WorksOfKnown { .. } => {
                let parts = chi.values.narrow(0, 1, 1).exp() * batch.works.clone();
                let factor = parts.clone().sum_dim(2).reshape([n, 1]);
                let own = by_state(parts * chi.tangents) * factors * batch.known.clone();
                let slopes = own + batch.known_slopes.clone() * factor.clone();
                (batch.known.clone() * factor, slopes)
            }
            LawForm::Factor => {
                let factor = chi.values.narrow(0, 1, 1).reshape([n, 1]).exp();
                let own = by_state(chi.tangents) * factors * batch.known.clone();
                let slopes = (own + batch.known_slopes.clone()) * factor.clone();
                (batch.known.clone() * factor, slopes)
            }
        }
    }

    fn batch(&self, states: &[LawState]) -> Batch {
        let standardised = |features: [f64; LAW_FEATURES]| -> [f64; LAW_FEATURES] {
            from_fn(|k| (features[k] - self.mean[k]) / self.std[k])
        };
        let undeformed = |index: usize| {
            let mut features = states[index].features;
            features[..3].fill(0.0);
            standardised(features)
        };
        let deformed = |index: usize| standardised(states[index].features);
        let n = states.len();
        let [size, sizes @ ..] = self.sizes;
        Batch {
            states: Tensor::stack(vec![self.table(n, undeformed), self.table(n, deformed)], 0),
            known: self.table(n, |i| [states[i].known.energy / size / states[i].scale]),
            works: self.table(n, |i| self.works(&states[i])).unsqueeze_dim(0),
            known_slopes: self.table(n, |i| {
                from_fn::<_, 3, _>(|k| states[i].known.slopes[k] / sizes[k] / states[i].scale)
            }),
        }
    }

    fn works(&self, state: &LawState) -> [f64; LAW_STRAINS] {
        from_fn(|j| {
            let size = match self.form {
                LawForm::WorksOfKnown { .. } => state.known_works[j],
                _ => state.scale * self.work_sizes[j],
            };
            state.works[j] / size / LAW_STRAINS as f64
        })
    }

    fn table<const N: usize>(&self, rows: usize, row: impl Fn(usize) -> [f64; N]) -> Tensor<2> {
        let flat: Vec<f64> = (0..rows).flat_map(row).collect();
        Tensor::from_data(TensorData::new(flat, [rows, N]), self.options.clone())
    }
}

impl LawForm {
    /// Whether the numbers of the hardening are features.
    fn has_numbers(self) -> bool {
        match self {
            Self::Alone | Self::Factor => true,
            Self::Works { numbers } | Self::WorksOfKnown { numbers } => numbers,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Precision;

    fn config() -> TrainingConfig {
        TrainingConfig {
            seed: 1,
            embedding: vec![16, 16, 8],
            damage: vec![2],
            mirror: false,
            epochs: 60,
            patience: None,
            precision: Precision::F32,
            batch_size: 32,
            learning_rate: 1e-2,
            learning_rate_end: 0.0,
            gradient_norm_max: 1.0,
            energy_weight: 0.5,
            damage_weight: 0.0,
            damage_sharpness: 8.0,
            frozen_layers: 0,
        }
    }

    /// States of the energy q (2 eta_a^2 + eta_s^2 + theta^2), where q is the last feature; the energy with q = 1 is known.
    fn solved(count: usize) -> Vec<(LawState, EnergySlopes)> {
        let wave = |row: usize, k: usize| (1.7 * row as f64 + 2.3 * k as f64).sin();
        let state = |row: usize| {
            let mut features: [f64; LAW_FEATURES] = from_fn(|k| 0.6 * wave(row, k));
            features[LAW_FEATURES - 1] += 1.5;
            let [a, s, theta, .., q] = features;
            let of = |q: f64| EnergySlopes {
                energy: q * (2.0 * a * a + s * s + theta * theta),
                slopes: [4.0 * q * a, 2.0 * q * s, 2.0 * q * theta],
            };
            let state = LawState {
                features,
                scale: q,
                known: of(1.0),
                works: [q; LAW_STRAINS],
                known_works: [1.0; LAW_STRAINS],
            };
            (state, of(q))
        };
        (0..count).map(state).collect()
    }

    #[test]
    fn every_form_learns_an_energy_and_its_forces_are_its_derivatives() {
        let solved = solved(600);
        for (form, limit) in [
            (LawForm::Alone, 0.06),
            (LawForm::Factor, 0.02),
            (LawForm::Works { numbers: false }, 0.06),
            (LawForm::Works { numbers: true }, 0.06),
            (LawForm::WorksOfKnown { numbers: false }, 0.02),
            (LawForm::WorksOfKnown { numbers: true }, 0.02),
        ] {
            let energy = LawEnergy::fit(&solved, form, &config()).unwrap();
            let states: Vec<LawState> = solved.iter().map(|(state, _)| *state).collect();
            let found = energy.at(&states).unwrap();
            let [mut errors, mut squares] = [0.0; 2];
            for (found, (_, solved)) in found.iter().zip(&solved) {
                errors += (found.energy - solved.energy).powi(2);
                squares += solved.energy.powi(2);
            }
            assert!(
                (errors / squares).sqrt() < limit,
                "{form:?} {}",
                (errors / squares).sqrt()
            );
            // Central differences along theta; the known energy moves with the state.
            let (state, step) = (states[7], 0.01);
            let moved = |step: f64| {
                let mut state = state;
                state.features[2] += step;
                let theta = state.features[2];
                state.known.energy += theta.powi(2) - (theta - step).powi(2);
                energy.at(&[state]).unwrap()[0].energy
            };
            let difference = (moved(step) - moved(-step)) / (2.0 * step);
            let slope = found[7].slopes[2];
            assert!(
                (difference - slope).abs() < 0.01 * slope.abs().max(0.1),
                "{form:?}"
            );
        }
    }

    #[test]
    fn a_fit_continues_from_a_trained_energy() {
        let solved = solved(200);
        let first = LawEnergy::fit(&solved, LawForm::Alone, &config()).unwrap();
        let still = TrainingConfig {
            learning_rate: 1e-12,
            epochs: 1,
            ..config()
        };
        let next = first.tuned(&solved[..50], &still).unwrap();
        let state = [solved[3].0];
        let [before, after] = [&first, &next].map(|energy| energy.at(&state).unwrap()[0].energy);
        assert!((before - after).abs() < 1e-4 * before);
        assert!(first.tuned(&[], &still).is_err());
        assert!(LawEnergy::fit(&[], LawForm::Alone, &still).is_err());
    }
}
