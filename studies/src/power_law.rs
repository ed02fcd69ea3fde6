//! A power law fitted to measured pairs, y = c x^p, with the standard error of its exponent.

use std::fmt;

/// A power law y = c x^p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLaw {
    /// p
    exponent: f64,
    /// Standard error of p, from the scatter of log y about the line.
    error: f64,
    /// c
    factor: f64,
}

impl PowerLaw {
    /// The least-squares line through the logarithms of the positive points; `None` for fewer than three of them, or if
    /// all x are equal.
    pub fn fit(points: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        let positive = points.into_iter().filter(|(x, y)| *x > 0.0 && *y > 0.0);
        let logs: Vec<_> = positive.map(|(x, y)| (x.ln(), y.ln())).collect();
        let n = logs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / n;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let across: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
        let along: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        (logs.len() >= 3 && across > 0.0).then(|| {
            let exponent = along / across;
            let residual = |p: &(f64, f64)| p.1 - y - exponent * (p.0 - x);
            let squares: f64 = logs.iter().map(|p| residual(p).powi(2)).sum();
            Self {
                exponent,
                error: (squares / (n - 2.0) / across).sqrt(),
                factor: (y - exponent * x).exp(),
            }
        })
    }

    /// y at x.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }

    /// The x at which the law reaches y.
    pub fn reaches(&self, y: f64) -> f64 {
        (y / self.factor).powf(1.0 / self.exponent)
    }
}

impl fmt::Display for PowerLaw {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:.1} +- {:.1}", self.exponent, self.error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_with_the_error_of_its_exponent() {
        let exact = |x: f64| 3.0 * x.powf(2.3);
        let points = [0.01, 0.1, 0.5].map(|x| (x, exact(x)));
        let law = PowerLaw::fit(points).unwrap();
        assert!((law.exponent - 2.3).abs() < 1e-12 && (law.factor - 3.0).abs() < 1e-12);
        assert!(law.error < 1e-12);
        assert!((law.reaches(law.at(0.2)) - 0.2).abs() < 1e-12);
        // Four points, e above and below the line: x = 0, 1, 2, 3 in logarithms, residuals +e, -e, -e, +e.
        let off = [0.1, -0.1, -0.1, 0.1];
        let points = [0.0_f64, 1.0, 2.0, 3.0].map(|x| (x.exp(), (2.0 * x + off[x as usize]).exp()));
        let law = PowerLaw::fit(points).unwrap();
        assert!((law.exponent - 2.0).abs() < 1e-12);
        assert!((law.error - (0.04_f64 / 2.0 / 5.0).sqrt()).abs() < 1e-12);
        assert_eq!(PowerLaw::fit([(1.0, 1.0), (0.0, 2.0), (2.0, 2.0)]), None);
        assert_eq!(PowerLaw::fit([]), None);
    }
}
