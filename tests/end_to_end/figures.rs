//! Figures in the pages are what the program prints today. Comments in a page, which no reader
//! sees, name the commands and the figures; docs/DEVELOP.md describes them. With
//! `KIRIGAMI_WRITE=1` the test writes the figures into the pages instead.

use crate::common::Workplace;
use crate::common::pages::{pages, read, root};
use regex::{Captures, Regex};
use std::ops::Range;
use std::path::Path;
use std::process::Command;

const NUMBER: &str = r"(-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)";
/// A figure of a page, whose thousands may be separated, and what may stand before it.
const FIGURE: &str = r"(?:^|[^\w.])(-?\d+(?: \d{3}\b)*(?:\.\d+)?(?:e[-+]?\d+)?)";

/// A figure that is not the printed one: its place in the page, and what is printed.
struct Stale {
    place: Range<usize>,
    printed: String,
    message: String,
}

/// Compares the figures of a page, after its commands have run in their order.
fn stale_figures(page: &str, mut run: impl FnMut(&str) -> String) -> Vec<Stale> {
    let comments = Regex::new(r"(?s)<!--\s*(.*?)\s*-->").unwrap();
    let (mut output, mut command, mut read_to) = (String::new(), "", 0);
    let mut stale = Vec::new();
    for comment in comments.captures_iter(page) {
        let (place, text) = (comment.get(0).unwrap().range(), comment.get(1).unwrap().as_str());
        let found = match text.strip_prefix("$ ") {
            Some(next) => {
                command = next;
                output = run(command);
                missing_lines(page, place.end, &output).into_iter().collect()
            }
            None => other_figures(page, read_to..place.start, text, &output),
        };
        stale.extend(
            found.into_iter().map(|it| Stale {
                message: format!("{}\n  printed by: {command}", it.message),
                ..it
            }),
        );
        read_to = place.end;
    }
    stale
}

/// The lines of a block of text right below a command that the command does not print in this
/// order; a line `...` stands for others.
fn missing_lines(page: &str, from: usize, output: &str) -> Option<Stale> {
    let block = page[from..].strip_prefix("\n```text\n")?.split("```").next()?;
    let mut printed = output.lines().map(str::trim_end);
    let shown = block.lines().map(str::trim_end);
    let mut shown = shown.filter(|line| !line.is_empty() && line.trim() != "...");
    let missing = shown.find(|line| !printed.any(|printed| printed == *line))?;
    Some(Stale {
        place: from..from,
        printed: String::new(),
        message: format!("not printed: {missing}"),
    })
}

/// The last figures before a comment, one for every `#` in it, that are not the numbers at these
/// places of the output.
fn other_figures(page: &str, before: Range<usize>, comment: &str, output: &str) -> Vec<Stale> {
    let (tolerance, pattern) = match comment.strip_prefix('~').and_then(|it| it.split_once("%: ")) {
        Some((percent, pattern)) => (Some(percent.parse::<f64>().unwrap() / 100.0), pattern),
        None => (None, comment),
    };
    let words = pattern.split_whitespace().map(|word| match word {
        "*" => "*".to_owned(),
        "_" => r"\S+".to_owned(),
        word => regex::escape(word).replace(r"\#", NUMBER),
    });
    let words = words.collect::<Vec<_>>().join(r"\s+").replace(r"\s+*\s+", r"\s(?:.*?\s)?");
    let printed = Regex::new(&format!(r"(?s)(?:^|\s){words}")).unwrap();
    let at = |message| vec![Stale { place: before.clone(), printed: String::new(), message }];
    let Some(printed) = printed.captures(output) else {
        return at(format!("not printed: {pattern}"));
    };
    let printed: Vec<&str> = printed.iter().skip(1).map(|it| it.unwrap().as_str()).collect();
    let figures = Regex::new(FIGURE).unwrap();
    let shown = figures.captures_iter(&page[before.clone()]);
    let shown: Vec<Captures> = shown.collect();
    let Some(first) = shown.len().checked_sub(printed.len()) else {
        return at(format!("fewer figures than in: {pattern}"));
    };
    let pairs = std::iter::zip(&shown[first..], printed);
    let other = pairs.filter_map(|(figure, printed)| {
        let figure = figure.get(1).unwrap();
        let place = before.start + figure.start()..before.start + figure.end();
        let number = |text: &str| text.replace(' ', "").parse::<f64>().unwrap();
        let decimals = figure.as_str().split_once('.').map_or(0, |(_, digits)| digits.len());
        let value = number(printed);
        let rounding = 0.5 * 10f64.powi(-(decimals as i32)) + 1e-9;
        let allowed = tolerance.map_or(rounding, |tolerance| tolerance * value.abs());
        let message = format!("{} in the page, {printed} printed: {pattern}", figure.as_str());
        let wrong = (number(figure.as_str()) - value).abs() > allowed;
        wrong.then(|| Stale { place, printed: format!("{value:.decimals$}"), message })
    });
    other.collect()
}

/// Runs a line of a shell where the program is `kirigami`; returns what it prints.
fn run(work: &Workplace, command: &str) -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_kirigami")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap());
    let mut shell = Command::new("sh");
    shell.args(["-ec", &format!("exec 2>&1\n{command}")]).current_dir(work.path(""));
    let output = shell.env("PATH", path).output().unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{command}: {printed}");
    printed
}

#[test]
fn figures_are_what_the_commands_print() {
    let mut messages = Vec::new();
    for page in pages() {
        let mut text = read(&page);
        let work = Workplace::new();
        std::os::unix::fs::symlink(root().join("docs"), work.path("docs")).unwrap();
        let stale = stale_figures(&text, |command| run(&work, command));
        let message = |stale: &Stale| format!("{}: {}", page.display(), stale.message);
        messages.extend(stale.iter().map(message));
        if std::env::var_os("KIRIGAMI_WRITE").is_some() {
            let figures = stale.into_iter().filter(|stale| !stale.printed.is_empty());
            for Stale { place, printed, .. } in figures.rev() {
                text.replace_range(place, &printed);
            }
            std::fs::write(root().join(&page), text).unwrap();
        }
    }
    assert!(messages.is_empty(), "{}", messages.join("\n"));
}

#[test]
fn a_figure_that_is_not_printed_is_found() {
    let page = "Of 7 sheets:\n\n<!-- $ design -->\n```text\nload 3.1 N\n...\nno warnings\n```\n\n\
                Pulled by 3.1 N<!-- load # N --> it is 297 x 210 mm<!-- size # x # mm --> and -0.2\
                <!-- eta * # _ -->, in 12 345<!-- ~5%: steps # -->.\n";
    let found = |output: &str| -> Vec<String> {
        let stale = stale_figures(page, |_| output.to_owned());
        stale.into_iter().map(|it| it.message.lines().next().unwrap().to_owned()).collect()
    };
    let output = "a title\nload 3.1 N\nother\nno warnings\n size  297.3 x 209.6 mm\neta is -0.21 end\nsteps 12000\n";
    assert!(found(output).is_empty(), "{:?}", found(output));
    for (printed, other, message) in [
        ("load 3.1 N", "load 3.2 N", "not printed: load 3.1 N"),
        ("209.6", "209.4", "210 in the page, 209.4 printed: size # x # mm"),
        ("-0.21", "0.21", "-0.2 in the page, 0.21 printed: eta * # _"),
        ("12000", "11000", "12 345 in the page, 11000 printed: steps #"),
        ("steps", "rounds", "not printed: steps #"),
    ] {
        let found = found(&output.replace(printed, other));
        assert!(found.contains(&message.to_owned()), "{message}: {found:?}");
    }
}
