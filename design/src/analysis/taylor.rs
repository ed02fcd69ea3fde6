//! Test of a gradient by its Taylor remainders:
//!
//! ```text
//! R(h) = |f(x + h d) - f(x) - h grad f . d| = O(h^2)
//! ```
//!
//! An exact gradient of a smooth function gives the order 2, a wrong one the order 1.

use crate::equilibrium::displacement_control::dot;

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
        let slope = dot(gradient, direction);
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn orders(gradient: [f64; 2]) -> Vec<f64> {
        let f = |x: &[f64]| Ok::<_, Infallible>(x[0].sin() * x[1].exp());
        TaylorRemainders::new(f, &[0.3, 0.7], &gradient, &[0.8, -0.6], 1e-3, 4)
            .unwrap()
            .orders()
    }

    #[test]
    fn an_exact_gradient_shows_order_two_and_a_wrong_one_order_one() {
        let exact = [0.3_f64.cos() * 0.7_f64.exp(), 0.3_f64.sin() * 0.7_f64.exp()];
        assert!(orders(exact).iter().all(|order| (order - 2.0).abs() < 0.02));
        let wrong = [exact[0], 1.1 * exact[1]];
        assert!(orders(wrong).iter().all(|order| *order < 1.2));
    }
}
