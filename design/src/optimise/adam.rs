//! Adam, the optimiser of Algorithm 1.
//!
//!   m <- b1 m + (1 - b1) g,  v <- b2 v + (1 - b2) g^2,
//!   dx = -rate m / (1 - b1^k) / (sqrt(v / (1 - b2^k)) + eps)

use serde::{Deserialize, Serialize};

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
const EPSILON: f64 = 1e-8;

/// The moments of the gradients of earlier steps: all that a resumed run needs.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adam {
    learning_rate: f64,
    step: i32,
    mean: Vec<f64>,
    square: Vec<f64>,
}

impl Adam {
    /// The state for `n` unknowns; the first step of every unknown has the length `learning_rate`.
    pub fn new(n: usize, learning_rate: f64) -> Self {
        Self { learning_rate, step: 0, mean: vec![0.0; n], square: vec![0.0; n] }
    }

    /// The state before the first step.
    pub fn restarted(&self) -> Self {
        Self::new(self.mean.len(), self.learning_rate)
    }

    /// Number of unknowns; zero if the stored moments have different lengths.
    pub fn dimension(&self) -> usize {
        if self.mean.len() == self.square.len() { self.mean.len() } else { 0 }
    }

    /// The increment of the unknowns for the gradient at the current point.
    ///
    /// # Panics
    /// If the length of the gradient differs from the number of unknowns.
    pub fn increment(&mut self, gradient: &[f64]) -> Vec<f64> {
        assert_eq!(gradient.len(), self.mean.len(), "length of the gradient");
        self.step += 1;
        let unbias_mean = 1.0 - BETA_1.powi(self.step);
        let unbias_square = 1.0 - BETA_2.powi(self.step);
        gradient
            .iter()
            .zip(self.mean.iter_mut().zip(&mut self.square))
            .map(|(g, (mean, square))| {
                *mean += (1.0 - BETA_1) * (g - *mean);
                *square += (1.0 - BETA_2) * (g * g - *square);
                let root = (*square / unbias_square).sqrt();
                -self.learning_rate * (*mean / unbias_mean) / (root + EPSILON)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn minimise(steps: usize) -> Vec<f64> {
        let scales = [1.0, 100.0, 0.01];
        let mut x = vec![1.0, -2.0, 0.5];
        let mut adam = Adam::new(x.len(), 0.05);
        for _ in 0..steps {
            let gradient: Vec<f64> = x.iter().zip(scales).map(|(x, c)| c * x).collect();
            for (x, dx) in x.iter_mut().zip(adam.increment(&gradient)) {
                *x += dx;
            }
        }
        x
    }

    #[test]
    fn a_badly_scaled_quadratic_is_minimised() {
        assert!(minimise(2000).iter().all(|x| x.abs() < 1e-3));
    }

    #[test]
    fn the_first_step_has_the_length_of_the_rate_at_any_scale() {
        let increment = Adam::new(2, 0.1).increment(&[1e-3, -1e3]);
        assert!((increment[0] + 0.1).abs() < 2e-6, "{increment:?}");
        assert!((increment[1] - 0.1).abs() < 2e-6, "{increment:?}");
    }
}
