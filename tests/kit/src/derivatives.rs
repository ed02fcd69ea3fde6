//! Derivatives compared with differences, for the tests. Of a gradient the Taylor remainders:
//!
//! ```text
//! R(h) = |f(x + h d) - f(x) - h grad f . d| = O(h^2)
//! ```
//!
//! An exact gradient of a smooth function gives the order 2, a wrong one the order 1.

/// Taylor remainders along one direction, at h, h/2, h/4, ...
#[derive(Clone, Debug, PartialEq)]
pub struct TaylorRemainders {
    /// The steps h, in descending order.
    pub steps: Vec<f64>,
    /// R(h) of each step.
    pub remainders: Vec<f64>,
}

impl TaylorRemainders {
    /// Remainders of `f` about `x` along `direction` for `count` steps, beginning with `first` and
    /// halved each time.
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
        let steps = std::iter::successors(Some(first), |h| Some(0.5 * h));
        let steps: Vec<f64> = steps.take(count).collect();
        let remainder = |h: &f64| Ok((f(&moved(x, direction, *h))? - value - h * slope).abs());
        let remainders = steps.iter().map(remainder).collect::<Result<_, E>>()?;
        Ok(Self { steps, remainders })
    }

    /// The observed orders between successive steps.
    pub fn orders(&self) -> Vec<f64> {
        let pairs = self.remainders.windows(2);
        pairs.map(|pair| (pair[0] / pair[1]).log2()).collect()
    }

    /// Fails unless every observed order is in a range.
    #[track_caller]
    pub fn assert_orders(&self, expected: std::ops::Range<f64>) {
        let orders = self.orders();
        let exact = orders.iter().all(|order| expected.contains(order));
        assert!(exact, "orders {orders:?} of {self:?}");
    }
}

/// The slope of `f` at `x` along `direction`, by central differences with the step `h`.
pub fn central_slope(f: impl Fn(&[f64]) -> f64, x: &[f64], direction: &[f64], h: f64) -> f64 {
    (f(&moved(x, direction, h)) - f(&moved(x, direction, -h))) / (2.0 * h)
}

/// a . b
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    std::iter::zip(a, b).map(|(a, b)| a * b).sum()
}

/// x + h d
fn moved(x: &[f64], direction: &[f64], h: f64) -> Vec<f64> {
    let pairs = std::iter::zip(x, direction);
    pairs.map(|(x, d)| x + h * d).collect()
}

/// Fails unless each entry of a gradient is the slope of `f` along its coordinate; the error that
/// is allowed depends on the slope.
#[track_caller]
pub fn assert_gradient(
    f: impl Fn(&[f64]) -> f64,
    x: &[f64],
    gradient: &[f64],
    h: f64,
    allowed: impl Fn(f64) -> f64,
) {
    for (i, found) in gradient.iter().enumerate() {
        let unit: Vec<f64> = (0..x.len()).map(|j| f64::from(i == j)).collect();
        let slope = central_slope(&f, x, &unit, h);
        let error = (found - slope).abs();
        assert!(error < allowed(slope), "{i}: {found} instead of {slope}");
    }
}

/// Fails unless the error is below a tolerance.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    let close = (found - expected).abs() < tolerance;
    assert!(close, "{found} instead of {expected}");
}

/// Fails unless the relative error is below a tolerance.
#[track_caller]
pub fn assert_ratio(found: f64, expected: f64, tolerance: f64) {
    let close = (found / expected - 1.0).abs() < tolerance;
    assert!(close, "{found} instead of {expected}");
}
