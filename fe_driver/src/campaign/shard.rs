//! A shard: every n-th job of a campaign.
//!
//! The shards of one folder may run at the same time, on one machine or on several machines that share the folder.
//! Together they solve the same jobs as one run of the whole campaign.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The part of a campaign that one run works on; written `2/4` for the second of four.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// From 1 to `count`.
    index: usize,
    count: usize,
}

impl Shard {
    /// The whole campaign.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Whether the job at index `place` in the campaign's order belongs to the shard.
    pub(crate) fn holds(self, place: usize) -> bool {
        place % self.count == self.index - 1
    }

    /// File name of the shard's history in the folder of the campaign.
    pub(crate) fn history(self) -> String {
        format!("{HISTORY}{}{}", self.index, self.siblings())
    }

    /// Whether a file is the history of a shard that may overlap with this one: of this shard itself, or of a
    /// division into another number of shards.
    pub(crate) fn overlaps(self, file_name: &str) -> bool {
        file_name.starts_with(HISTORY)
            && (!file_name.ends_with(&self.siblings()) || file_name == self.history())
    }

    /// File name ending of the histories of all shards of the same division.
    fn siblings(self) -> String {
        format!("-of-{}.jsonl", self.count)
    }
}

/// File name prefix of the histories.
const HISTORY: &str = "events-";

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// A text that is not a shard.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{0}` is not a shard: write i/n with 1 <= i <= n, for example 2/4")]
pub struct InvalidShard(String);

impl FromStr for Shard {
    type Err = InvalidShard;

    fn from_str(text: &str) -> Result<Self, InvalidShard> {
        let parse = || {
            let (index, count) = text.split_once('/')?;
            let (index, count) = (index.parse().ok()?, count.parse().ok()?);
            (1..=count)
                .contains(&index)
                .then_some(Self { index, count })
        };
        parse().ok_or_else(|| InvalidShard(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_in_exactly_one_shard() {
        let shards = ["1/3", "2/3", "3/3"].map(|text| text.parse::<Shard>().unwrap());
        for place in 0..10 {
            assert!(Shard::WHOLE.holds(place));
            assert_eq!(shards.iter().filter(|s| s.holds(place)).count(), 1);
        }
    }

    #[test]
    fn a_shard_overlaps_itself_and_every_other_division() {
        let shard: Shard = "2/4".parse().unwrap();
        for (history, overlaps) in [
            ("events-2-of-4.jsonl", true),
            ("events-1-of-1.jsonl", true),
            ("events-2-of-14.jsonl", true),
            ("events-1-of-4.jsonl", false),
            ("campaign.json", false),
        ] {
            assert_eq!(shard.overlaps(history), overlaps, "{history}");
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
