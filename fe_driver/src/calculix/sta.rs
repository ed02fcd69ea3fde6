//! Reader of CalculiX .sta files: one line per attempted increment.
//!
//! The file contains the progress of the solver in a machine-readable form: the lambda reached, the
//! number of iterations, and the increments that the output must contain. Reading never fails: a
//! line that is not an attempt, or that was truncated, is skipped.

/// One attempted increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Increment {
    /// Total time (lambda): at the end of the increment if it converged, otherwise at its start.
    pub lambda: f64,
    /// Newton iterations of the attempt.
    pub iterations: usize,
    /// Whether the increment converged.
    pub converged: bool,
}

/// Reads the attempted increments in their order.
pub fn read_sta(bytes: &[u8]) -> Vec<Increment> {
    let end = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
    let text = String::from_utf8_lossy(&bytes[..end]);
    text.lines().filter_map(attempt).collect()
}

/// Parses STEP INC ATT ITRS TOT-TIME STEP-TIME INC-TIME; a U after ATT means that the attempt
/// diverged.
fn attempt(line: &str) -> Option<Increment> {
    let fields: Vec<_> = line.split_whitespace().collect();
    let [step, increment, attempt, iterations, lambda, in_step, length] = fields[..] else {
        return None;
    };
    let number = attempt.trim_end_matches('U');
    for count in [step, increment, number] {
        count.parse::<usize>().ok()?;
    }
    let [lambda, ..] = [lambda, in_step, length].map(|time| {
        let time = time.parse::<f64>().ok();
        time.filter(|time| time.is_finite() && *time >= 0.0)
    });
    Some(Increment {
        lambda: lambda?,
        iterations: iterations.parse().ok()?,
        converged: number == attempt,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STATUS: &str = "SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1          1     1U    4  0.000000E+00  0.000000E+00  0.500000E-02
     1          1     2     4  0.125000E-02  0.125000E-02  0.125000E-02
     1          2     1     3  0.250000E-02  0.250000E-02  0.125000E-02
";

    #[test]
    fn attempts_are_read_with_their_outcome() {
        let attempt = |lambda, iterations, converged| Increment { lambda, iterations, converged };
        assert_eq!(
            read_sta(STATUS.as_bytes()),
            [attempt(0.0, 4, false), attempt(0.00125, 4, true), attempt(0.0025, 3, true)]
        );
        assert_eq!(read_sta(b""), []);
    }

    proptest! {
        #[test]
        fn a_truncated_file_gives_its_complete_lines(cut in 0..STATUS.len()) {
            let whole = read_sta(STATUS.as_bytes());
            let attempts = read_sta(&STATUS.as_bytes()[..cut]);
            prop_assert_eq!(&attempts[..], &whole[..attempts.len()]);
        }

        #[test]
        fn any_bytes_are_read(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            prop_assert!(read_sta(&bytes).iter().all(|attempt| attempt.lambda.is_finite()));
        }
    }
}
