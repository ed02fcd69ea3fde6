//! Derivatives compared with differences, for the tests. Of a gradient the Taylor remainders:
//!
//! ```text
//! R(h) = |f(x + h d) - f(x) - h grad f . d| = O(h^2)
//! ```
//!
//! An exact gradient of a smooth function gives the order 2, a wrong one the order 1.
#![allow(dead_code, reason = "every test program uses only a part")]

/// Taylor remainders along one direction, at h, h/2, h/4, ...
#[derive(Clone, Debug, PartialEq)]
pub struct TaylorRemainders {
    /// The steps h, in descending order.
    pub steps: Vec<f64>,
    /// R(h) of each step.
    pub remainders: Vec<f64>,
}

impl TaylorRemainders {
    /// Remainders of `f` about `x` along `direction` for `count` steps, beginning with `first` and halved each
    /// time.
    pub fn new<E>(
        mut f: impl FnMut(&[f64]) -> Result<f64, E>,
        x: &[f64],
        gradient: &[f64],
        direction: &[f64],
        first: f64,
        count: usize,
    ) -> Result<Self, E> {
        let value = f(x)?;
        let slope: f64 = std::iter::zip(gradient, direction)
            .map(|(g, d)| g * d)
            .sum();
        let steps: Vec<f64> = std::iter::successors(Some(first), |h| Some(0.5 * h))
            .take(count)
            .collect();
        let remainders = steps
            .iter()
            .map(|h| {
                let beside: Vec<f64> = std::iter::zip(x, direction)
                    .map(|(x, d)| x + h * d)
                    .collect();
                Ok((f(&beside)? - value - h * slope).abs())
            })
            .collect::<Result<_, E>>()?;
        Ok(Self { steps, remainders })
    }

    /// The observed orders between successive steps.
    pub fn orders(&self) -> Vec<f64> {
        self.remainders
            .windows(2)
            .map(|pair| (pair[0] / pair[1]).log2())
            .collect()
    }
}

/// The slope of `f` at `x` along `direction`, by central differences with the step `h`.
pub fn central_slope(f: impl Fn(&[f64]) -> f64, x: &[f64], direction: &[f64], h: f64) -> f64 {
    let beside = |h: f64| -> Vec<f64> {
        std::iter::zip(x, direction)
            .map(|(x, d)| x + h * d)
            .collect()
    };
    (f(&beside(h)) - f(&beside(-h))) / (2.0 * h)
}
