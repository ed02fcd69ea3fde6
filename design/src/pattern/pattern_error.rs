//! Errors of the numbers that define a cut pattern.

/// Why there is no cut pattern for the given numbers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum PatternError {
    #[error("a sheet of {m} x {n} panels has no interior cut: use at least 2 x 2")]
    TooFewPanels { m: usize, n: usize },
    #[error(
        "the outline {corners:?} is not a convex quadrilateral with its corners \
         counter-clockwise from the south-west"
    )]
    Outline { corners: [[f64; 2]; 4] },
    #[error("{name} has {found} entries; a sheet of {m} x {n} panels needs {expected}")]
    Count { name: &'static str, found: usize, expected: usize, m: usize, n: usize },
    #[error("{name}[{index}] = {value} is not a finite number")]
    NotFinite { name: &'static str, index: usize, value: f64 },
    #[error("{name}[{index}] = {value} violates 0 < {name} < 1, increasing along each edge")]
    Interval { name: &'static str, index: usize, value: f64 },
    #[error(
        "{name}[{index}] is so far from 0 that its chart (5) rounds to a bound: two cuts collide"
    )]
    Collision { name: &'static str, index: usize },
    #[error("the collinearity system of the pattern is singular")]
    Singular,
}
