//! Counts on the command line, each with an upper bound that catches typing errors.

/// Maximum of a count.
const MOST: usize = 1_000_000;
/// Maximum number of solves in parallel.
const MOST_JOBS: usize = 1024;

/// A count of at most a million.
pub fn count<T: TryFrom<usize>>(text: &str) -> Result<T, String> {
    bounded(text, MOST)
}

/// A number of solves in parallel, at most 1024.
pub fn jobs<T: TryFrom<usize>>(text: &str) -> Result<T, String> {
    bounded(text, MOST_JOBS)
}

fn bounded<T: TryFrom<usize>>(text: &str, most: usize) -> Result<T, String> {
    let number = text.parse::<usize>().ok().filter(|number| *number <= most);
    let number = number.and_then(|number| T::try_from(number).ok());
    let first = usize::from(T::try_from(0).is_err());
    number.ok_or_else(|| format!("not a number from {first} to {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroUsize;

    #[test]
    fn a_count_is_in_its_range() {
        assert_eq!(count("0"), Ok(0_usize));
        assert_eq!(count::<NonZeroUsize>("1000000").unwrap().get(), MOST);
        for text in ["1000001", "99999999999999999999", "-1", "x", ""] {
            let message = count::<usize>(text).unwrap_err();
            assert_eq!(message, "not a number from 0 to 1000000");
        }
        let message = jobs::<NonZeroUsize>("0").unwrap_err();
        assert_eq!(message, "not a number from 1 to 1024");
        assert!(jobs::<NonZeroUsize>("1025").is_err());
    }
}
