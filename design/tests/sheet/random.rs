//! Seeded random numbers for tests.

use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub struct Random(ChaCha8Rng);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// A number in (-size, size).
    pub fn number(&mut self, size: f64) -> f64 {
        self.0.random_range(-size..size)
    }

    pub fn numbers(&mut self, count: usize, size: f64) -> Vec<f64> {
        (0..count).map(|_| self.number(size)).collect()
    }

    pub fn arrays<const N: usize>(&mut self, count: usize, size: f64) -> Vec<[f64; N]> {
        let mut array = || std::array::from_fn(|_| self.number(size));
        (0..count).map(|_| array()).collect()
    }
}
