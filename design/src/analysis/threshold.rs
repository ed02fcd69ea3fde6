//! The minimum load with a given property: a first guess is increased or decreased until the minimum is
//! bracketed, then the bracket is bisected on a logarithmic scale.

/// Ratio of successive guesses while a bracket is sought.
const STRIDE: f64 = 1.25;
/// Maximum number of changes of the first guess: a factor of 800 in either direction.
const MAX_STRIDES: usize = 30;

/// The smallest value, up to the ratio `1 + resolution`, above which `passes` holds; the returned value
/// passes. `passes` should hold above one value and not below it; if it changes several times, one change is
/// found.
///
/// `None` if all values within a factor of 800 pass, or none does.
pub fn least_passing<E>(
    first: f64,
    resolution: f64,
    mut passes: impl FnMut(f64) -> Result<bool, E>,
) -> Result<Option<f64>, E> {
    let first_passes = passes(first)?;
    let stride = if first_passes { 1.0 / STRIDE } else { STRIDE };
    let (mut before, mut bracket) = (first, None);
    for _ in 0..MAX_STRIDES {
        let value = before * stride;
        if passes(value)? != first_passes {
            bracket = Some((before.min(value), before.max(value)));
            break;
        }
        before = value;
    }
    let Some((mut fails, mut passing)) = bracket else {
        return Ok(None);
    };
    while passing > fails * (1.0 + resolution) {
        let middle = (fails * passing).sqrt();
        if passes(middle)? {
            passing = middle;
        } else {
            fails = middle;
        }
    }
    Ok(Some(passing))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn least(first: f64, limit: f64) -> Option<f64> {
        let mut tried = 0;
        let found = least_passing::<()>(first, 1e-3, |value| {
            tried += 1;
            Ok(value >= limit)
        });
        assert!(tried < 45, "{tried}");
        found.unwrap()
    }

    #[test]
    fn the_threshold_is_found_from_both_sides_and_passes() {
        for first in [1.0, 20.0, 7.0] {
            let found = least(first, 7.0).unwrap();
            assert!((7.0..7.0 * 1.001).contains(&found), "{found}");
        }
    }

    #[test]
    fn a_property_that_always_or_never_holds_has_no_threshold() {
        assert_eq!(least(1.0, 0.0), None);
        assert_eq!(least(1.0, f64::INFINITY), None);
    }

    #[test]
    fn an_error_ends_the_search() {
        assert_eq!(least_passing(1.0, 0.1, |_| Err("no")), Err("no"));
    }
}
