//! The memory of the L-BFGS method (Liu and Nocedal 1989): an approximation of the inverse Hessian
//! from the last steps.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use support::vectors::{add, dot};

/// Maximum number of stored pairs of step and gradient change.
const PAIRS: usize = 80;

/// The last steps, newest first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Memory {
    pairs: VecDeque<CurvaturePair>,
}

/// A step and the change of the gradient along it.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CurvaturePair {
    step: Vec<f64>,
    change: Vec<f64>,
    product: f64,
}

impl Memory {
    /// Stores a step, unless its curvature is not positive.
    pub(crate) fn remember(&mut self, step: Vec<f64>, change: Vec<f64>) {
        let product = dot(&step, &change);
        if product > 0.0 {
            self.pairs.truncate(PAIRS - 1);
            self.pairs.push_front(CurvaturePair { step, change, product });
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Whether all stored pairs have `n` coordinates.
    pub(crate) fn fits(&self, n: usize) -> bool {
        let fits = |pair: &CurvaturePair| pair.step.len() == n && pair.change.len() == n;
        self.pairs.iter().all(fits)
    }

    /// Minus the approximate inverse Hessian times the gradient (two-loop recursion); a step of
    /// `first_length` along the negative gradient if the memory is empty.
    pub(crate) fn direction(&self, gradient: &[f64], first_length: f64) -> Vec<f64> {
        let size = match self.pairs.front() {
            Some(last) => last.product / dot(&last.change, &last.change),
            // A zero gradient has no direction.
            None => first_length / dot(gradient, gradient).sqrt().max(f64::MIN_POSITIVE),
        };
        let mut direction: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut weights = Vec::with_capacity(self.pairs.len());
        for pair in &self.pairs {
            let weight = dot(&pair.step, &direction) / pair.product;
            add(&mut direction, &pair.change, -weight);
            weights.push(weight);
        }
        direction.iter_mut().for_each(|entry| *entry *= size);
        for (pair, weight) in std::iter::zip(&self.pairs, weights).rev() {
            let along = dot(&pair.change, &direction) / pair.product;
            add(&mut direction, &pair.step, weight - along);
        }
        direction
    }
}

/// The step, shortened until no coordinate is longer than `longest`.
pub(crate) fn shortened(mut step: Vec<f64>, longest: f64) -> Vec<f64> {
    let reach = (step.iter()).fold(0.0, |reach, entry| f64::max(reach, entry.abs()));
    if reach > longest {
        step.iter_mut().for_each(|entry| *entry *= longest / reach);
    }
    step
}
