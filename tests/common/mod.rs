//! A working folder with small configurations, in which the program of the package under test is
//! run.
#![allow(dead_code)] // every test program uses only a part

pub(crate) mod pages;

use dataset::{Database, SolvedRay};
use serde_json::Value;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;
use toml_edit::{ArrayOfTables, DocumentMut, Table};

pub(crate) const PROGRAM: &str = env!("CARGO_BIN_EXE_kirigami");

pub(crate) struct Workplace {
    folder: TempDir,
}

impl Workplace {
    /// A folder with a copy of the shipped configurations, and a link to the shipped data.
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR"));
        copy(&shipped.join("configs"), &folder.path().join("configs"));
        symlink(shipped.join("data"), folder.path().join("data")).unwrap();
        Self { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Replaces texts in a file; each of them must occur in it.
    pub(crate) fn edit(&self, name: &str, replacements: &[(&str, &str)]) {
        let mut text = self.read(name);
        for (old, new) in replacements {
            assert!(text.contains(old), "{name} does not hold `{old}`");
            text = text.replace(old, new);
        }
        self.write(name, text);
    }

    /// Changes the keys of a campaign, and the keys of each of its boxes of rays, which are counted
    /// from 0.
    pub(crate) fn edit_campaign(
        &self,
        name: &str,
        keys: impl FnOnce(&mut Table),
        mut of_box: impl FnMut(usize, &mut Table),
    ) {
        let mut campaign: DocumentMut = self.read(name).parse().unwrap();
        keys(campaign.as_table_mut());
        let boxes = campaign["rays"].as_array_of_tables_mut();
        let boxes = boxes.into_iter().flat_map(ArrayOfTables::iter_mut);
        for (place, rays) in boxes.enumerate() {
            of_box(place, rays);
        }
        self.write(name, campaign.to_string());
    }

    /// The text of a file.
    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), contents).unwrap();
    }

    /// The program with arguments, ready to run in the folder.
    pub(crate) fn program(&self, arguments: &str) -> Command {
        let mut command = Command::new(PROGRAM);
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        command
    }

    /// The output of a run, which must succeed.
    pub(crate) fn output(&self, arguments: &str) -> String {
        let (output, message) = run(&mut self.program(arguments));
        assert!(output.status.success(), "{arguments}: {message}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Asserts that the output of a run has every one of the parts.
    #[track_caller]
    pub(crate) fn prints(&self, arguments: &str, expected: &[&str]) {
        assert_contains(&self.output(arguments), expected);
    }

    /// Asserts that the error message of a run has every one of the parts.
    #[track_caller]
    pub(crate) fn refuses(&self, arguments: &str, expected: &[&str]) {
        assert_contains(&self.error(arguments), expected);
    }

    /// What a run prints as JSON.
    pub(crate) fn json(&self, arguments: &str) -> Value {
        serde_json::from_str(&self.output(arguments)).unwrap()
    }

    /// The error message of a run, which must fail with an error and not a panic.
    pub(crate) fn error(&self, arguments: &str) -> String {
        failure(&mut self.program(arguments))
    }
}

/// The error message of a command, which must fail with an error and not a panic.
pub(crate) fn failure(command: &mut Command) -> String {
    let (output, message) = run(command);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.starts_with("error: "), "{message}");
    message
}

/// Asserts that a text has every one of the parts.
#[track_caller]
pub(crate) fn assert_contains(text: &str, expected: &[&str]) {
    for expected in expected {
        assert!(text.contains(expected), "no `{expected}` in:\n{text}");
    }
}

/// The rays of a database without the CPU times of their solves, which no two runs share.
pub(crate) fn timeless(database: &Database) -> Vec<SolvedRay> {
    let rays = database.rays().iter().cloned();
    rays.map(|ray| SolvedRay { cpu_s: 0.0, ..ray }).collect()
}

fn run(command: &mut Command) -> (Output, String) {
    let output = command.output().unwrap();
    let message = String::from_utf8(output.stderr.clone()).unwrap();
    (output, message)
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}
