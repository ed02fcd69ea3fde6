//! The least load that does something: found by growing or shrinking a first guess until it is
//! bracketed, then by halving the bracket on the logarithm.

/// Ratio of two guesses while a bracket is sought.
const STRIDE: f64 = 1.25;
/// How often the first guess is changed: by a factor of 800 either way.
const MOST_STRIDES: usize = 30;

/// The least value, to the ratio `1 + resolution`, from which on `passes` holds; the value returned
/// passes. `passes` should hold above one value and not below it: of several changes one is found.
///
/// `None` if every value within a factor of 800 passes or none does.
pub fn least_passing<E>(
    first: f64,
    resolution: f64,
    mut passes: impl FnMut(f64) -> Result<bool, E>,
) -> Result<Option<f64>, E> {
    let first_passes = passes(first)?;
    let stride = if first_passes { 1.0 / STRIDE } else { STRIDE };
    let (mut before, mut bracket) = (first, None);
    for _ in 0..MOST_STRIDES {
        let value = before * stride;
        if passes(value)? != first_passes {
            bracket = Some((before.min(value), before.max(value)));
            break;
        }
        before = value;
    }
    let Some((mut fails, mut least)) = bracket else {
        return Ok(None);
    };
    while least > fails * (1.0 + resolution) {
        let middle = (fails * least).sqrt();
        if passes(middle)? {
            least = middle;
        } else {
            fails = middle;
        }
    }
    Ok(Some(least))
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
    fn it_is_found_from_both_sides_and_passes() {
        for first in [1.0, 20.0, 7.0] {
            let found = least(first, 7.0).unwrap();
            assert!((7.0..7.0 * 1.001).contains(&found), "{found}");
        }
    }

    #[test]
    fn what_always_or_never_passes_has_none() {
        assert_eq!(least(1.0, 0.0), None);
        assert_eq!(least(1.0, f64::INFINITY), None);
    }

    #[test]
    fn an_error_ends_the_search() {
        assert_eq!(least_passing(1.0, 0.1, |_| Err("no")), Err("no"));
    }
}
