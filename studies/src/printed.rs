//! `kirigami-studies printed`: the commands of README and tutorial that have a time or an error beside them, run as printed.

use crate::cpu_seconds::children_cpu_seconds;
use crate::stop::refuse_stop_without_store;
use anyhow::{Context, Result, ensure};
use clap::Args;
use kirigami::ui::{interrupt, run_folder};
use serde::Deserialize;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::Instant;
use support::table::{Cell, Table};

/// Run the commands of README and tutorial that have a time or an error beside them, and compare
///
/// From the repository, with both programs on the PATH; hours. Each command of docs/results/printed.toml is run as it is printed; it must
/// succeed, within the time and with the text that the document states. Writes printed.md; a claim that is not kept is an error.
/// Example: kirigami-studies printed --only design
#[derive(Args)]
pub struct PrintedStudy {
    /// Run only commands that contain this text
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Folder for the table and the outputs
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-printed")]
    out: PathBuf,
}

/// The list of claims.
const CLAIMS: &str = "docs/results/printed.toml";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Claims {
    claim: Vec<Claim>,
}

/// What a document says of a command.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Claim {
    /// The document, in which `command` and `text` are printed.
    file: PathBuf,
    command: String,
    text: String,
    /// Times above which the text is not true (s).
    most_cpu_s: Option<f64>,
    most_wall_s: Option<f64>,
    /// What the command prints if the text is true.
    prints: Option<String>,
}

/// A command that was run.
struct Row<'a> {
    claim: &'a Claim,
    wall_s: f64,
    cpu_s: f64,
    broken: Vec<&'static str>,
}

impl PrintedStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let claims: Claims = support::toml_file::read(CLAIMS.as_ref())?;
        let only = self.only.as_deref().unwrap_or_default();
        let chosen = claims.claim.iter().filter(|it| it.command.contains(only));
        let chosen: Vec<&Claim> = chosen.collect();
        ensure!(!chosen.is_empty(), "no command contains `{only}`");
        for claim in &chosen {
            claim.is_printed()?;
        }
        let mut rows = Vec::new();
        for claim in chosen {
            eprintln!("{}", claim.command);
            rows.push(claim.run()?);
            refuse_stop_without_store(interrupt::stop_flag()?)?;
        }
        let page = format!(
            "# Commands as printed\n\n`kirigami-studies printed`.\n\n{}",
            table().markdown(&rows)
        );
        run_folder::write(&self.out, "printed.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        let broken = rows.iter().filter(|row| !row.broken.is_empty()).count();
        ensure!(broken == 0, "{broken} claims are not kept");
        Ok(())
    }
}

impl Claim {
    /// An error if the document does not print the command and the text.
    fn is_printed(&self) -> Result<()> {
        let file = self.file.display();
        let document = std::fs::read_to_string(&self.file).with_context(|| format!("{file}"))?;
        let flowing = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let document = flowing(&document);
        for printed in [&self.command, &self.text] {
            ensure!(
                document.contains(&flowing(printed)),
                "{CLAIMS}: {file} does not contain `{printed}`"
            );
        }
        Ok(())
    }

    fn run(&self) -> Result<Row<'_>> {
        let (begun, cpu) = (Instant::now(), children_cpu_seconds()?);
        let output = Command::new("sh").args(["-c", &self.command]).output();
        let output = output.context("sh does not start")?;
        let wall_s = begun.elapsed().as_secs_f64();
        let cpu_s = children_cpu_seconds()? - cpu;
        Ok(Row {
            claim: self,
            wall_s,
            cpu_s,
            broken: self.broken(&output, wall_s, cpu_s),
        })
    }

    /// What is not as the document says.
    fn broken(&self, output: &Output, wall_s: f64, cpu_s: f64) -> Vec<&'static str> {
        let printed = String::from_utf8_lossy(&output.stdout);
        let text = self.prints.as_deref().unwrap_or_default();
        let conditions = [
            ("fails", !output.status.success()),
            ("CPU time", self.most_cpu_s.is_some_and(|most| cpu_s > most)),
            ("time", self.most_wall_s.is_some_and(|most| wall_s > most)),
            ("output", !printed.contains(text)),
        ];
        let broken = conditions.into_iter().filter(|(_, is_broken)| *is_broken);
        broken.map(|(what, _)| what).collect()
    }
}

fn table<'a>() -> Table<'a, Row<'a>> {
    Table::new()
        .column("command", |row: &Row| Cell::text(&row.claim.command))
        .column("in", |row| Cell::text(row.claim.file.display()))
        .column("printed", |row| Cell::text(&row.claim.text))
        .column("wall, s", |row| Cell::fixed(row.wall_s, 1))
        .column("CPU, s", |row| Cell::fixed(row.cpu_s, 1))
        .column("", |row| match row.broken.is_empty() {
            true => Cell::text("kept"),
            false => Cell::text(format!("NOT KEPT: {}", row.broken.join(", "))),
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_documents_print_the_commands_and_what_is_said_of_them() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let claims: Claims = support::toml_file::read(&root.join(CLAIMS)).unwrap();
        for mut claim in claims.claim {
            claim.file = root.join(&claim.file);
            claim.is_printed().unwrap();
        }
    }

    #[test]
    fn a_command_that_fails_takes_too_long_or_prints_something_else_is_named() {
        let claim = |command: &str, most_wall_s: f64, prints: &str| Claim {
            file: PathBuf::new(),
            command: command.into(),
            text: String::new(),
            most_cpu_s: None,
            most_wall_s: Some(most_wall_s),
            prints: Some(prints.into()),
        };
        let broken = |claim: Claim| claim.run().unwrap().broken;
        assert!(broken(claim("echo 1.9 mm", 60.0, "1.9")).is_empty());
        assert_eq!(broken(claim("echo 2.1 mm", 60.0, "1.9")), ["output"]);
        assert_eq!(broken(claim("echo 1.9; exit 3", 60.0, "1.9")), ["fails"]);
        assert_eq!(broken(claim("echo 1.9", 0.0, "1.9")), ["time"]);
    }
}
