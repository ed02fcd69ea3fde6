//! Errors of predicted energies on solved states.

use crate::universal::states::SolvedState;
use train::EnergySlopes;

/// Root mean squares of the errors over those of the quantity, in per cent. Every energy is divided by the size of its
/// law, so that laws with small energies count as much as others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of W.
    pub w: f64,
    /// Of (F_a, F_s, M_theta).
    pub forces: [f64; 3],
    /// Of W after multiplication by the one factor that is best at these states.
    pub w_with_factor: f64,
    /// This factor, minus one.
    pub factor: f64,
}

impl Errors {
    pub fn of(states: &[SolvedState], found: &[EnergySlopes]) -> Self {
        let factor = best_factor(states, found);
        let w = |factor: f64| {
            relative(states.iter().zip(found).map(|(state, found)| {
                let size = state.law.energy_size();
                [state.solved.energy / size, factor * found.energy / size]
            }))
        };
        let force = |k: usize| {
            relative(states.iter().zip(found).map(|(state, found)| {
                [&state.solved, found].map(|it| state.forces(it)[k] / state.law.energy_size())
            }))
        };
        Self {
            w: w(1.0),
            forces: [force(0), force(1), force(2)],
            w_with_factor: w(factor),
            factor: 100.0 * (factor - 1.0),
        }
    }

    /// Root mean squares over several splits; the mean of the factor.
    pub fn averaged(all: &[Self]) -> Self {
        let count = all.len() as f64;
        let rms = |of: &dyn Fn(&Self) -> f64| {
            (all.iter().map(|it| of(it).powi(2)).sum::<f64>() / count).sqrt()
        };
        Self {
            w: rms(&|it| it.w),
            forces: std::array::from_fn(|k| rms(&|it| it.forces[k])),
            w_with_factor: rms(&|it| it.w_with_factor),
            factor: all.iter().map(|it| it.factor).sum::<f64>() / count,
        }
    }

    /// Root mean square of the errors of the three forces.
    pub fn all_forces(&self) -> f64 {
        (self.forces.iter().map(|it| it * it).sum::<f64>() / 3.0).sqrt()
    }
}

/// The factor of the predicted energies that is nearest to the solved ones, by least squares.
pub fn best_factor(states: &[SolvedState], found: &[EnergySlopes]) -> f64 {
    let (mut products, mut squares) = (0.0, 0.0);
    for (state, found) in states.iter().zip(found) {
        let size = state.law.energy_size();
        products += found.energy * state.solved.energy / (size * size);
        squares += (found.energy / size).powi(2);
    }
    products / squares
}

/// Every energy and slope times a factor.
pub fn scaled(found: &[EnergySlopes], factor: f64) -> Vec<EnergySlopes> {
    let scaled = |it: &EnergySlopes| EnergySlopes {
        energy: factor * it.energy,
        slopes: it.slopes.map(|slope| factor * slope),
    };
    found.iter().map(scaled).collect()
}

/// The mean of several predictions at the same states.
pub fn mean(all: &[Vec<EnergySlopes>]) -> Vec<EnergySlopes> {
    let states = all.first().map_or(0, Vec::len);
    let over =
        |of: &dyn Fn(&Vec<EnergySlopes>) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let mean = (0..states).map(|state| EnergySlopes {
        energy: over(&|it| it[state].energy),
        slopes: std::array::from_fn(|k| over(&|it| it[state].slopes[k])),
    });
    mean.collect()
}

/// Root mean square of the differences of pairs [target, found], over that of the targets, in per cent.
fn relative(pairs: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut errors, mut squares) = (0.0, 0.0);
    for [target, found] in pairs {
        errors += (found - target).powi(2);
        squares += target * target;
    }
    100.0 * (errors / squares).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::universal::law::Law;

    #[test]
    fn a_factor_of_all_energies_is_found_and_removed() {
        let state = |energy: f64| SolvedState {
            law: Law {
                poisson: 0.3,
                yield_strain: 0.01,
                plateau: 1.0,
                hardening: 0.0,
            },
            ligament: 20.0,
            alpha: 1.5,
            at: [0.1, 0.0, 0.5],
            solved: EnergySlopes {
                energy,
                slopes: [energy, 0.5, 2.0],
            },
            film: EnergySlopes::default(),
            works: [0.0; train::LAW_STRAINS],
            film_works: [0.0; train::LAW_STRAINS],
        };
        let states = [0.2, 0.5, 1.0].map(state);
        let solved = states.map(|it| it.solved);
        let errors = Errors::of(&states, &scaled(&solved, 0.8));
        assert!((errors.w - 20.0).abs() < 1e-9 && errors.w_with_factor < 1e-9);
        assert!((errors.factor - 25.0).abs() < 1e-9);
        assert!((errors.all_forces() - 20.0).abs() < 1e-9);
        assert_eq!(Errors::averaged(&[errors, errors]), errors);
        let halfway = mean(&[scaled(&solved, 0.8), scaled(&solved, 1.0)]);
        assert!((Errors::of(&states, &halfway).w - 10.0).abs() < 1e-9);
    }
}
