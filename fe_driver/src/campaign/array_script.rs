//! The script by which a cluster's scheduler runs a campaign: an array of shards, then the
//! collection.
//!
//! A template is the script with `@key@` in place of what differs between campaigns.

use std::path::{Path, PathBuf};

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
}

/// Why there is no script.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum ScriptError {
    /// A word between two `@` of a template is not a key.
    #[error("the template has the unknown key `@{key}@`; the keys are {known}")]
    UnknownKey { key: String, known: String },
    #[error(
        "{what} {path:?}: a script cannot state this name, because of {reason}: rename it, or choose another with --folder"
    )]
    Name { what: &'static str, path: PathBuf, reason: &'static str },
}

impl ArrayScript {
    /// The last part of the time limit, in which no solve is started (s): a tenth, at most 10
    /// minutes.
    fn reserve(&self) -> u64 {
        (6 * self.minutes).min(600)
    }

    /// The time before the limit at which running solves are stopped (s): a tenth of the limit, at
    /// most a minute.
    fn grace(&self) -> u64 {
        (6 * self.minutes).min(60)
    }

    /// The keys of a template and what replaces them.
    fn keys(&self) -> [(&'static str, String); 10] {
        let quoted = |path: &PathBuf| quoted(&operand(path));
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
            ("run", command("run") + &format!(" --jobs {cores} --time-limit {limit}")),
            ("collect", command("collect") + " --replace"),
        ]
    }

    /// Refuses names that a line of a script cannot hold. The log folder stands in a line that the
    /// scheduler reads, not the shell: there is no quoting that all schedulers read alike, and
    /// Slurm replaces `%`.
    fn check_names(&self) -> Result<(), ScriptError> {
        let names = [
            ("the program", &self.program, ""),
            ("the current folder", &self.here, ""),
            ("the campaign", &self.campaign, ""),
            ("the folder of the campaign", &self.folder, ""),
            ("the folder of the logs", &self.logs, "%$"),
        ];
        for (what, path, further) in names {
            if let Some(reason) = unfit(path, further) {
                let path = path.clone();
                return Err(ScriptError::Name { what, path, reason });
            }
        }
        Ok(())
    }

    /// The script that a template gives.
    pub fn fill(&self, template: &str) -> Result<String, ScriptError> {
        self.check_names()?;
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
                return Err(ScriptError::UnknownKey { key, known });
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

/// What in a path keeps it out of a script; `further` are characters that are unfit besides.
fn unfit(path: &Path, further: &str) -> Option<&'static str> {
    let Some(name) = path.to_str() else {
        return Some("bytes that are no UTF-8");
    };
    if name.chars().any(char::is_control) {
        return Some("a line break or another control character");
    }
    if name.contains(['\'', '"', '`', '\\']) {
        return Some("a quote or a backslash");
    }
    name.contains(|c| further.contains(c)).then_some("a `%` or a `$`")
}

/// The path as an operand of a command: a relative one that begins with a dash would be read as an
/// option.
fn operand(path: &Path) -> String {
    let name = path.to_string_lossy();
    let begin = if name.starts_with('-') { "./" } else { "" };
    format!("{begin}{name}")
}

/// A word for the shell; see [`ArrayScript::check_names`] for what it holds.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:+,=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{word}'")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    fn script(minutes: u64) -> ArrayScript {
        ArrayScript {
            program: "/opt/kirigami".into(),
            here: "/home/a b/$it".into(),
            campaign: "configs/film one.toml".into(),
            folder: "runs/film".into(),
            logs: "/home/logs".into(),
            shards: 32,
            cores: 4,
            minutes,
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
        let echo = script(60).fill("printf '%s|' @here@ '@name@' @shards@").unwrap();
        let output = Command::new("sh").args(["-c", &echo]).output().unwrap();
        assert_eq!(output.stdout, b"/home/a b/$it|film-one|32|");
    }

    /// Names that a shell or a scheduler could take for more than a name; the second half is
    /// refused.
    const HOSTILE: [&str; 32] = [
        "a b",
        " blank",
        "$(touch broken-into)",
        "${HOME}",
        "$HOME",
        "a;touch broken-into",
        "a&touch broken-into",
        "a|touch broken-into",
        "a>broken-into",
        "a<b",
        "#a",
        "a #b",
        "~",
        "*",
        "a{b,c}",
        "-rf",
        "--folder=b",
        "!!",
        "(a)",
        "[a]?",
        "é 折 %j",
        "a=b",
        "a\ntouch broken-into",
        "a\n#SBATCH --wrap=true",
        "a\rb",
        "a\tb",
        "a\u{1b}[2J",
        "a'; touch broken-into; '",
        "a\" --wrap=\"touch broken-into",
        "a`touch broken-into`",
        "a\\",
        "a\u{7f}",
    ];
    /// Number of hostile names that a script can state.
    const STATED: usize = 22;

    /// The arguments that kirigami receives from a filled template, which `bash` runs with the
    /// argument `role`.
    fn words(script: &ArrayScript, template: &str, role: &str) -> Vec<String> {
        let text = script.fill(template).unwrap();
        let recorded = script.here.join("recorded");
        let _ = std::fs::remove_file(&recorded);
        let mut command = Command::new("bash");
        command.args(["-c", &text, "bash", role]).env("ROLE", role);
        for task in ["SLURM_ARRAY_TASK_ID", "PBS_ARRAY_INDEX", "LSB_JOBINDEX"] {
            command.env(task, "3");
        }
        let path = std::env::var("PATH").unwrap();
        let bin = script.program.parent().unwrap().display();
        let output = command.env("PATH", format!("{bin}:{path}")).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{output:?}\n{text}");
        let words = std::fs::read_to_string(recorded).unwrap();
        words.split_terminator('\0').map(str::to_owned).collect()
    }

    #[test]
    fn hostile_names_are_words_of_a_script_or_refused() {
        let root = tempfile::tempdir().unwrap();
        let program = root.path().join("kirigami");
        // It writes to the folder in which it runs, which is `here`.
        std::fs::write(&program, "#!/bin/sh\nprintf '%s\\0' \"$@\" > recorded\n").unwrap();
        let squeue = root.path().join("squeue");
        std::fs::write(&squeue, "#!/bin/sh\n").unwrap();
        for path in [&program, &squeue] {
            let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
            std::fs::set_permissions(path, mode).unwrap();
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../configs/cluster");
        let templates = std::fs::read_dir(folder).unwrap();
        let templates: Vec<String> = templates
            .map(|entry| std::fs::read_to_string(entry.unwrap().path()).unwrap())
            .collect();
        for (i, name) in HOSTILE.into_iter().enumerate() {
            let here = root.path().join("here").join(name);
            std::fs::create_dir_all(&here).unwrap();
            let hostile = ArrayScript {
                program: program.clone(),
                here: here.clone(),
                campaign: name.into(),
                folder: name.into(),
                ..script(60)
            };
            for template in &templates {
                if i >= STATED {
                    let error = hostile.fill(template).unwrap_err().to_string();
                    assert!(error.contains("cannot state this name"), "{error}");
                    assert!(!error.contains('\n'), "{error}");
                    continue;
                }
                let operand = operand(Path::new(name));
                let shared = [operand.as_str(), "--folder", &operand];
                let run = ["--jobs", "4", "--time-limit", "54", "--shard", "3/32"];
                let run = [&["campaign", "run"], &shared[..], &run].concat();
                assert_eq!(words(&hostile, template, ""), run);
                let collect = [&["campaign", "collect"], &shared[..], &["--replace"]].concat();
                assert_eq!(words(&hostile, template, "collect"), collect);
                let left = std::fs::read_dir(&here).unwrap().count();
                assert_eq!(left, 1, "{name:?} ran a command");
            }
        }
    }

    #[test]
    fn the_name_of_the_log_folder_is_one_that_every_scheduler_reads_alike() {
        for (i, name) in HOSTILE.into_iter().enumerate() {
            let mut script = script(60);
            script.logs = Path::new("/home").join(name);
            let is_fit = i < STATED && !name.contains(['%', '$']);
            assert_eq!(script.fill(SLURM).is_ok(), is_fit, "{name:?}");
        }
        let bytes = std::os::unix::ffi::OsStrExt::from_bytes(b"/home/\xff");
        let mut script = script(60);
        script.logs = Path::new::<std::ffi::OsStr>(bytes).to_owned();
        assert!(script.fill(SLURM).is_err());
    }

    /// Slurm checks its time limits every 30 s: even the shortest limit leaves time for solves.
    #[test]
    fn a_short_limit_keeps_most_of_its_time() {
        for (minutes, expected) in [(1, "0.9 6"), (10, "9 60"), (240, "230 60")] {
            let text = script(minutes).fill("@run@ @grace@").unwrap();
            assert!(text.ends_with(&format!("--time-limit {expected}")), "{text}");
        }
    }

    #[test]
    fn a_word_that_is_no_key_is_named_and_other_at_signs_remain() {
        assert_eq!(script(1).fill("B:TERM@@grace@ a@B@ @").unwrap(), "B:TERM@6 a@B@ @");
        let message = script(1).fill("@nodes@").unwrap_err().to_string();
        assert!(message.contains("`@nodes@`") && message.contains("@shards@"), "{message}");
    }
}
