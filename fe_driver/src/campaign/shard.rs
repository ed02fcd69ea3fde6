//! A shard: every n-th of a list of jobs.
//!
//! The shards of one list may run at the same time, on one machine or on several machines that
//! share the folder. Together they do the same jobs as one run of the whole list.

use std::fmt;
use std::str::FromStr;
use support::fault;
use support::fault::Fault;

/// The part of the jobs that one run works on; written `2/4` for the second of four.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, 1 to `count`.
    index: usize,
    count: usize,
}

impl Shard {
    /// All jobs.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether the job at an index of the list belongs to the shard.
    pub fn holds(self, job: usize) -> bool {
        job % self.count == self.index - 1
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Self, Fault> {
        let parse = || {
            let (index, count) = text.split_once('/')?;
            let (index, count) = (index.parse().ok()?, count.parse().ok()?);
            (1..=count).contains(&index).then_some(Self { index, count })
        };
        parse().ok_or_else(|| {
            fault!("`{text}` is not a shard: write i/n with 1 <= i <= n, for example 2/4")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_in_exactly_one_shard() {
        let shards = ["1/3", "2/3", "3/3"].map(|text| text.parse::<Shard>().unwrap());
        for index in 0..10 {
            assert!(Shard::WHOLE.holds(index));
            assert_eq!(shards.iter().filter(|s| s.holds(index)).count(), 1);
        }
    }

    #[test]
    fn invalid_shards_are_rejected() {
        for text in ["", "1", "0/2", "3/2", "-1/2", "1/0", "1/2/3", "a/b"] {
            let message = text.parse::<Shard>().unwrap_err().to_string();
            assert!(message.contains("i/n"), "{message}");
        }
    }
}
