//! The script by which a cluster's scheduler runs a campaign: an array of shards, then the collection.
//!
//! A template is the script with `@key@` in place of what differs between campaigns.

use std::path::PathBuf;

/// The template for Slurm.
pub const SLURM: &str = include_str!("../../../configs/cluster/slurm.sh");

/// What a script states.
#[derive(Clone, Debug)]
pub struct ArrayScript {
    /// The kirigami program.
    pub program: PathBuf,
    /// The folder in which the commands are run.
    pub here: PathBuf,
    /// The campaign file.
    pub campaign: PathBuf,
    /// The folder of the campaign.
    pub folder: PathBuf,
    /// The folder of the logs.
    pub logs: PathBuf,
    /// Number of shards, one a task.
    pub shards: usize,
    /// Number of solves that a task runs in parallel.
    pub cores: usize,
    /// Time limit of a task (min).
    pub minutes: u64,
    /// How often a task that was stopped is queued again.
    pub requeues: u32,
}

/// A word between two `@` of a template that is not a key.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the template has the unknown key `@{key}@`; the keys are {known}")]
pub struct UnknownTemplateKey {
    key: String,
    known: String,
}

impl ArrayScript {
    /// The last part of the time limit, in which no solve is started (s): a tenth, at most 10 minutes.
    fn reserve(&self) -> u64 {
        (6 * self.minutes).min(600)
    }

    /// The time before the limit at which running solves are stopped (s): a tenth of the limit, at most a minute.
    fn grace(&self) -> u64 {
        (6 * self.minutes).min(60)
    }

    /// The keys of a template and what replaces them.
    fn keys(&self) -> [(&'static str, String); 11] {
        let quoted = |path: &PathBuf| quoted(&path.to_string_lossy());
        let stem = self.campaign.file_stem().unwrap_or_default();
        let name = |c: char| if c.is_alphanumeric() { c } else { '-' };
        let command = |verb: &str| {
            let (program, campaign) = (quoted(&self.program), quoted(&self.campaign));
            let folder = quoted(&self.folder);
            format!("{program} campaign {verb} {campaign} --folder {folder}")
        };
        let (cores, minutes) = (self.cores, self.minutes);
        let limit = minutes as f64 - self.reserve() as f64 / 60.0;
        [
            ("name", stem.to_string_lossy().chars().map(name).collect()),
            ("here", quoted(&self.here)),
            ("logs", self.logs.display().to_string()),
            ("shards", self.shards.to_string()),
            ("cores", cores.to_string()),
            ("minutes", minutes.to_string()),
            ("hms", format!("{:02}:{:02}:00", minutes / 60, minutes % 60)),
            ("grace", self.grace().to_string()),
            ("requeues", self.requeues.to_string()),
            (
                "run",
                command("run") + &format!(" --jobs {cores} --time-limit {limit}"),
            ),
            ("collect", command("collect") + " --replace"),
        ]
    }

    /// The script that a template gives.
    pub fn fill(&self, template: &str) -> Result<String, UnknownTemplateKey> {
        let keys = self.keys();
        let (mut script, mut rest) = (String::new(), template);
        while let Some((before, after)) = rest.split_once('@') {
            script.push_str(before);
            let word = after.split_once('@').filter(|(word, _)| is_word(word));
            let Some((word, after)) = word else {
                script.push('@');
                rest = after;
                continue;
            };
            let Some((_, value)) = keys.iter().find(|(key, _)| *key == word) else {
                let known = keys.map(|(key, _)| format!("@{key}@")).join(", ");
                let key = word.to_owned();
                return Err(UnknownTemplateKey { key, known });
            };
            script.push_str(value);
            rest = after;
        }
        Ok(script + rest)
    }
}

fn is_word(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_lowercase() || c == '_')
}

/// A word for the shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:+,=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    fn script(minutes: u64) -> ArrayScript {
        ArrayScript {
            program: "/opt/kirigami".into(),
            here: "/home/a b/it's".into(),
            campaign: "configs/film one.toml".into(),
            folder: "runs/film".into(),
            logs: "/home/logs".into(),
            shards: 32,
            cores: 4,
            minutes,
            requeues: 20,
        }
    }

    #[test]
    fn the_shipped_templates_are_valid_shell_scripts_that_name_every_shard() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../configs/cluster");
        let mut count = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let template = std::fs::read_to_string(entry.unwrap().path()).unwrap();
            let text = script(240).fill(&template).unwrap();
            assert!(text.contains("/32\""), "{text}");
            assert!(text.contains("--jobs 4 --time-limit 230 "), "{text}");
            let checked = Command::new("bash").args(["-n", "-c", &text]).output();
            let checked = checked.unwrap();
            assert!(checked.status.success(), "{checked:?}\n{text}");
            count += 1;
        }
        assert_eq!(count, 3);
    }

    #[test]
    fn paths_are_words_of_the_shell() {
        let echo = script(60)
            .fill("printf '%s|' @here@ '@name@' @shards@")
            .unwrap();
        let output = Command::new("sh").args(["-c", &echo]).output().unwrap();
        assert_eq!(output.stdout, b"/home/a b/it's|film-one|32|");
    }

    /// Slurm checks its time limits every 30 s: even the shortest limit leaves time for solves.
    #[test]
    fn a_short_limit_keeps_most_of_its_time() {
        for (minutes, expected) in [(1, "0.9 6"), (10, "9 60"), (240, "230 60")] {
            let text = script(minutes).fill("@run@ @grace@").unwrap();
            assert!(
                text.ends_with(&format!("--time-limit {expected}")),
                "{text}"
            );
        }
    }

    #[test]
    fn a_word_that_is_no_key_is_named_and_other_at_signs_remain() {
        assert_eq!(
            script(1).fill("B:TERM@@grace@ a@B@ @").unwrap(),
            "B:TERM@6 a@B@ @"
        );
        let message = script(1).fill("@nodes@").unwrap_err().to_string();
        assert!(
            message.contains("`@nodes@`") && message.contains("@shards@"),
            "{message}"
        );
    }
}
