//! Forward-mode automatic differentiation to second order in (a, s, theta, w_lig, rho_f), for
//! inexpensive functions.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

/// A number, its gradient and its Hessian in (a, s, theta, w_lig, rho_f).
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// The number.
    pub value: f64,
    /// Its gradient in (a, s, theta, w_lig, rho_f).
    pub gradient: [f64; 5],
    /// Its Hessian in (a, s, theta, w_lig, rho_f).
    pub hessian: [[f64; 5]; 5],
}

impl Jet {
    /// A number that does not depend on the variables.
    pub const fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; 5], hessian: [[0.0; 5]; 5] }
    }

    /// Index of the variable w_lig.
    pub(crate) const W_LIG: usize = 3;
    /// Index of the variable rho_f.
    pub(crate) const HOLE: usize = 4;

    /// One of the five variables: index 0 is a, 1 is s, 2 is theta, 3 is w_lig, 4 is rho_f.
    pub fn variable(index: usize, value: f64) -> Self {
        Self { gradient: from_fn(|i| f64::from(u8::from(i == index))), ..Self::constant(value) }
    }

    /// Applies a function f, given f, f' and f'' at this value.
    pub fn map(self, [value, first, second]: [f64; 3]) -> Self {
        let g = self.gradient;
        Self {
            value,
            gradient: g.map(|slope| first * slope),
            hessian: from_fn(|i| from_fn(|j| first * self.hessian[i][j] + second * g[i] * g[j])),
        }
    }

    pub(crate) fn powf(self, n: f64) -> Self {
        let x = self.value;
        let derivatives = [x.powf(n), n * x.powf(n - 1.0), n * (n - 1.0) * x.powf(n - 2.0)];
        self.map(derivatives)
    }

    /// The reciprocal 1/x.
    pub fn recip(self) -> Self {
        let r = 1.0 / self.value;
        self.map([r, -r * r, 2.0 * r * r * r])
    }
}

impl Add for Jet {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: from_fn(|i| self.gradient[i] + other.gradient[i]),
            hessian: from_fn(|i| from_fn(|j| self.hessian[i][j] + other.hessian[i][j])),
        }
    }
}

impl Sub for Jet {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl Mul<f64> for Jet {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self.map([factor * self.value, factor, 0.0])
    }
}

impl Mul for Jet {
    type Output = Self;

    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule adds terms")]
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        let (dx, dy) = (self.gradient, other.gradient);
        Self {
            value: x * y,
            gradient: from_fn(|i| dx[i] * y + x * dy[i]),
            hessian: from_fn(|i| {
                from_fn(|j| {
                    self.hessian[i][j] * y + x * other.hessian[i][j] + dx[i] * dy[j] + dx[j] * dy[i]
                })
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (a s - theta)^3 / (2 w) + a rho_f^2
    fn number(x: [f64; 5]) -> Jet {
        let [a, s, theta, w, hole] = from_fn(|i| Jet::variable(i, x[i]));
        (a * s - theta).powf(3.0) * w.recip() * 0.5 + a * hole * hole
    }

    #[test]
    fn derivatives_agree_with_finite_differences() {
        let x = [2.0, 1.5, 0.4, 3.0, 0.2];
        let found = number(x);
        for i in 0..5 {
            let h = 1e-5;
            let at = |step: f64| number(from_fn(|j| if i == j { x[j] + step } else { x[j] }));
            let (plus, minus) = (at(h), at(-h));
            let slope = (plus.value - minus.value) / (2.0 * h);
            assert!((found.gradient[i] - slope).abs() < 1e-8 * slope.abs(), "{i}");
            for j in 0..5 {
                let slope = (plus.gradient[j] - minus.gradient[j]) / (2.0 * h);
                assert!((found.hessian[i][j] - slope).abs() < 1e-7, "{i} {j}");
            }
        }
    }
}
