//! What the program says to wrong input, word for word: the cases of messages.txt, each in a new
//! copy of the configurations. With `KIRIGAMI_WRITE=1` the test writes the messages instead, and
//! the commit says why they changed.
//!
//! A line of a case is
//! * `edit FILE: OLD => NEW`, a replacement of text, `write FILE: TEXT`, or `remove PATH`, with
//!   `\n` for a line break,
//! * `$ COMMAND`, a run of the program, followed by what a failing one prints to standard error,
//!   each line after `| `.

use crate::common::Workplace;
use std::fmt::Write;
use std::path::Path;

/// The cases with the messages that the program prints now.
fn with_messages(cases: &str) -> String {
    let mut text = String::new();
    let mut work = None;
    for line in cases.lines().filter(|line| !line.starts_with('|')) {
        writeln!(text, "{line}").unwrap();
        if line.is_empty() {
            work = None;
        }
        let case = work.get_or_insert_with(Workplace::new);
        match line.split_once(' ') {
            Some(("$", command)) => text += &message(case, command),
            Some(("edit" | "write" | "remove", _)) => change(case, &line.replace("\\n", "\n")),
            _ => assert!(line.is_empty() || line.starts_with('#'), "{line}"),
        }
    }
    text
}

fn change(work: &Workplace, line: &str) {
    let (kind, rest) = line.split_once(' ').unwrap();
    let path = |name: &str| work.path(name);
    if kind == "remove" {
        return std::fs::remove_dir_all(path(rest)).unwrap();
    }
    let (file, text) = rest.split_once(": ").unwrap();
    match kind {
        "edit" => work.edit(file, &[text.split_once(" => ").unwrap()]),
        _ => std::fs::write(path(file), text).unwrap(),
    }
}

/// Nothing for a run without an error; an exit code other than 1 is a part of the message.
fn message(work: &Workplace, command: &str) -> String {
    let output = work.program(command).output().unwrap();
    if output.status.success() {
        return String::new();
    }
    let mut text = String::from_utf8(output.stderr).unwrap();
    match output.status.code() {
        Some(1) => {}
        code => writeln!(text, "exit code {}", code.unwrap()).unwrap(),
    }
    let folder = work.path("").display().to_string();
    let text = text.replace(folder.trim_end_matches('/'), "FOLDER");
    let lines = text.lines().map(|line| format!("| {line}"));
    lines.map(|line| line.trim_end().to_owned() + "\n").collect()
}

#[test]
fn wrong_input_gets_these_messages() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command_line/messages.txt");
    let cases = std::fs::read_to_string(&file).unwrap();
    let found = with_messages(&cases);
    if std::env::var_os("KIRIGAMI_WRITE").is_some() {
        return std::fs::write(&file, found).unwrap();
    }
    for (found, expected) in std::iter::zip(found.lines(), cases.lines()) {
        assert_eq!(found, expected);
    }
    assert_eq!(found, cases);
}
