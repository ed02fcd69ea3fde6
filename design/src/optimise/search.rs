//! How the next design is proposed: by Adam, as in Algorithm 1, or by L-BFGS with backtracking,
//! which needs a fraction of Adam's evaluations on designs with equilibrium.

use crate::optimise::{
    adam::Adam,
    lbfgs_memory::{Memory, shortened},
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use support::vectors::dot;

/// Armijo constant: the fraction of the decrease predicted by the slope that an L-BFGS step must
/// achieve.
const ARMIJO: f64 = 1e-4;
/// Fall of the loss, relative to the loss, below which it is a rounding error of the equilibria.
const RESOLUTION: f64 = 1e-13;
/// Maximum L-BFGS step in one chart coordinate; the quadratic model is not valid beyond it.
const LONGEST: f64 = 1.0;

/// The optimiser of the outer loop, as a scene names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SearchMethod {
    /// Adam, as in the paper.
    #[default]
    Adam,
    /// L-BFGS with backtracking.
    Lbfgs,
}

/// The state of the optimiser: all that a resumed run needs.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Optimiser {
    Adam(Adam),
    Lbfgs(Lbfgs),
}

/// The state of L-BFGS.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lbfgs {
    /// Length per coordinate of a step without curvature memory.
    learning_rate: f64,
    memory: Memory,
    /// The point of the last proposal; `None` before the first.
    from: Option<SearchPoint>,
}

/// An evaluated point, and the slope of the loss along the step from it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SearchPoint {
    x: Vec<f64>,
    loss: f64,
    gradient: Vec<f64>,
    slope: f64,
}

impl Optimiser {
    /// The optimiser of `n` coordinates.
    pub(crate) fn new(method: SearchMethod, learning_rate: f64, n: usize) -> Self {
        match method {
            SearchMethod::Adam => Self::Adam(Adam::new(n, learning_rate)),
            SearchMethod::Lbfgs => {
                Self::Lbfgs(Lbfgs { learning_rate, memory: Memory::default(), from: None })
            }
        }
    }

    /// The optimiser before its first step.
    pub(crate) fn restarted(&self) -> Self {
        match self {
            Self::Adam(adam) => Self::Adam(adam.restarted()),
            Self::Lbfgs(lbfgs) => {
                Self::Lbfgs(Lbfgs { memory: Memory::default(), from: None, ..*lbfgs })
            }
        }
    }

    /// The optimiser at the start of a similar problem.
    pub(crate) fn moved(mut self) -> Self {
        if let Self::Lbfgs(lbfgs) = &mut self {
            lbfgs.from = None;
        }
        self
    }

    /// Whether the state has `n` coordinates.
    pub(crate) fn fits(&self, n: usize) -> bool {
        match self {
            Self::Adam(adam) => adam.dimension() == n,
            Self::Lbfgs(lbfgs) => {
                let fits = |point: &SearchPoint| point.x.len() == n && point.gradient.len() == n;
                lbfgs.memory.fits(n) && lbfgs.from.iter().all(fits)
            }
        }
    }

    /// The step from an accepted point.
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
                lbfgs.from = Some(SearchPoint {
                    x: x.to_vec(),
                    loss,
                    gradient: gradient.to_vec(),
                    slope: 0.0,
                });
                lbfgs.step()
            }
        }
    }

    /// Whether a step may end at this loss, at this fraction of its full length.
    pub(crate) fn accepts(&self, loss: f64, fraction: f64) -> bool {
        match self {
            Self::Lbfgs(Lbfgs { from: Some(from), .. }) => {
                let fall = from.loss - loss;
                fall > (-ARMIJO * fraction * from.slope).max(RESOLUTION * from.loss.abs())
            }
            _ => true,
        }
    }

    /// Another step from the same point, after no part of the last one was accepted: along the
    /// negative gradient; `None` if the last step was that already.
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
        let direction = self.memory.direction(&from.gradient, first_length);
        let step = shortened(direction, LONGEST);
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
    fn lbfgs_follows_a_curved_valley_and_reports_when_no_step_is_left() {
        let mut search = Optimiser::new(SearchMethod::Lbfgs, 0.1, 2);
        let mut x = vec![-1.2, 1.0];
        let (mut loss, mut gradient) = valley(&x);
        let mut evaluations = 1;
        let mut step = search.increment(&x, loss, &gradient);
        'steps: loop {
            for halvings in 0..30 {
                let fraction = 0.5f64.powi(halvings);
                let stepped = [x[0] + fraction * step[0], x[1] + fraction * step[1]];
                let next = valley(&stepped);
                evaluations += 1;
                if search.accepts(next.0, fraction) {
                    x = stepped.to_vec();
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
        // Adam accepts any step and has no other to offer.
        let mut adam = Optimiser::new(SearchMethod::Adam, 0.1, 2);
        adam.increment(&x, loss, &gradient);
        assert!(adam.accepts(1e9, 1.0));
        assert_eq!(adam.retry(), None);
    }
}
