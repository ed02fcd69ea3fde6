//! How the next design is proposed: by Adam, as Algorithm 1, or by L-BFGS with backtracking.
//!
//! L-BFGS needs a fraction of Adam's evaluations through an equilibrium; on pins it settles a little
//! above Adam's loss.

use crate::adam::Adam;
use crate::lbfgs_memory::Memory;
use crate::scene::OptimiserConfig;
use crate::stroke::dot;
use serde::{Deserialize, Serialize};

/// Share of the fall that the slope predicts which a step of L-BFGS must achieve.
const ARMIJO: f64 = 1e-4;
/// The longest step of L-BFGS in one chart coordinate: further on a quadratic model says nothing.
const LONGEST: f64 = 1.0;

/// The optimiser of the outer loop, as a scene names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SearchMethod {
    #[default]
    Adam,
    Lbfgs,
}

/// What the optimiser remembers; everything a resumed run needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Search {
    Adam(Adam),
    Lbfgs(Lbfgs),
}

/// The state of L-BFGS.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lbfgs {
    /// Length of a step without memory, per coordinate.
    learning_rate: f64,
    memory: Memory,
    /// The point of the last proposal; none before the first.
    from: Option<Point>,
}

/// A point that was evaluated, and how the loss falls along the step from it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    x: Vec<f64>,
    loss: f64,
    gradient: Vec<f64>,
    slope: f64,
}

impl Search {
    /// For `n` coordinates.
    pub(crate) fn new(config: &OptimiserConfig, n: usize) -> Self {
        let learning_rate = config.learning_rate;
        match config.method {
            SearchMethod::Adam => Self::Adam(Adam::new(n, learning_rate)),
            SearchMethod::Lbfgs => Self::Lbfgs(Lbfgs {
                learning_rate,
                memory: Memory::default(),
                from: None,
            }),
        }
    }

    /// Whether the state is one of `n` coordinates.
    pub(crate) fn fits(&self, n: usize) -> bool {
        match self {
            Self::Adam(adam) => adam.len() == n,
            Self::Lbfgs(lbfgs) => {
                let fits = |point: &Point| point.x.len() == n && point.gradient.len() == n;
                lbfgs.memory.fits(n) && lbfgs.from.iter().all(fits)
            }
        }
    }

    /// The step from a point that was accepted.
    pub(crate) fn increment(&mut self, x: &[f64], loss: f64, gradient: &[f64]) -> Vec<f64> {
        match self {
            Self::Adam(adam) => adam.increment(gradient),
            Self::Lbfgs(lbfgs) => {
                if let Some(from) = &lbfgs.from {
                    let less = |to: &[f64], from: &[f64]| {
                        std::iter::zip(to, from).map(|(t, f)| t - f).collect()
                    };
                    let change = less(gradient, &from.gradient);
                    lbfgs.memory.remember(less(x, &from.x), change);
                }
                lbfgs.from = Some(Point {
                    x: x.to_vec(),
                    loss,
                    gradient: gradient.to_vec(),
                    slope: 0.0,
                });
                lbfgs.step()
            }
        }
    }

    /// Whether a step may end at this loss, after this fraction of its full length.
    pub(crate) fn accepts(&self, loss: f64, fraction: f64) -> bool {
        match self {
            Self::Lbfgs(Lbfgs {
                from: Some(from), ..
            }) => loss < from.loss + ARMIJO * fraction * from.slope,
            _ => true,
        }
    }

    /// Another step from the same point, where no part of the last one was accepted; none is left
    /// after the one down the gradient.
    pub(crate) fn retry(&mut self) -> Option<Vec<f64>> {
        match self {
            Self::Lbfgs(lbfgs) if !lbfgs.memory.is_empty() => {
                lbfgs.memory = Memory::default();
                Some(lbfgs.step())
            }
            _ => None,
        }
    }
}

impl Lbfgs {
    fn step(&mut self) -> Vec<f64> {
        let Some(from) = &mut self.from else {
            return Vec::new();
        };
        let first_length = self.learning_rate * (from.x.len() as f64).sqrt();
        let mut step = self.memory.direction(&from.gradient, first_length);
        let longest = step
            .iter()
            .fold(0.0, |longest, s| f64::max(longest, s.abs()));
        if longest > LONGEST {
            step.iter_mut().for_each(|s| *s *= LONGEST / longest);
        }
        from.slope = dot(&step, &from.gradient);
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley and its gradient.
    fn valley(x: &[f64]) -> (f64, Vec<f64>) {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        let gradient = vec![-2.0 * a - 400.0 * x[0] * b, 200.0 * b];
        (a * a + 100.0 * b * b, gradient)
    }

    #[test]
    fn lbfgs_follows_a_curved_valley_and_says_when_nothing_is_left() {
        let config = OptimiserConfig {
            steps: 1,
            learning_rate: 0.1,
            method: SearchMethod::Lbfgs,
            start_noise: 0.0,
            seed: 0,
        };
        let mut search = Search::new(&config, 2);
        let mut x = vec![-1.2, 1.0];
        let (mut loss, mut gradient) = valley(&x);
        let mut evaluations = 1;
        let mut step = search.increment(&x, loss, &gradient);
        'steps: loop {
            for halvings in 0..30 {
                let fraction = 0.5f64.powi(halvings);
                let beside = [x[0] + fraction * step[0], x[1] + fraction * step[1]];
                let next = valley(&beside);
                evaluations += 1;
                if search.accepts(next.0, fraction) {
                    x = beside.to_vec();
                    (loss, gradient) = next;
                    step = search.increment(&x, loss, &gradient);
                    continue 'steps;
                }
            }
            match search.retry() {
                Some(other) => step = other,
                None => break,
            }
        }
        assert!(loss < 1e-20, "{loss} at {x:?}");
        assert!(evaluations < 300, "{evaluations}");
        assert!(search.fits(2) && !search.fits(3));
        // Adam takes any step, and knows no other.
        let mut adam = Search::new(
            &OptimiserConfig {
                method: SearchMethod::Adam,
                ..config
            },
            2,
        );
        adam.increment(&x, loss, &gradient);
        assert!(adam.accepts(1e9, 1.0));
        assert_eq!(adam.retry(), None);
    }
}
