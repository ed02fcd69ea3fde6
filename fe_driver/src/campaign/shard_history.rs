//! The file in which a shard of a campaign writes its history.

use support::shard::Shard;

/// File name prefix of the histories.
const HISTORY: &str = "events-";

/// File name of the shard's history in the folder of the campaign.
pub(crate) fn history_name(shard: Shard) -> String {
    format!("{HISTORY}{}.jsonl", shard.to_string().replace('/', "-of-"))
}

/// Whether a file is the history of a shard that may overlap with this one: of this shard itself, or of a division into
/// another number of shards.
pub(crate) fn overlaps(shard: Shard, file_name: &str) -> bool {
    let own = history_name(shard);
    // The end of the names of all shards of the same division.
    let siblings = own.find("-of-").map_or("", |at| &own[at..]);
    file_name.starts_with(HISTORY) && (!file_name.ends_with(siblings) || file_name == own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_overlaps_itself_and_every_other_division() {
        let shard: Shard = "2/4".parse().unwrap();
        for (history, expected) in [
            ("events-2-of-4.jsonl", true),
            ("events-1-of-1.jsonl", true),
            ("events-2-of-14.jsonl", true),
            ("events-1-of-4.jsonl", false),
            ("campaign.json", false),
        ] {
            assert_eq!(super::overlaps(shard, history), expected, "{history}");
        }
    }
}
