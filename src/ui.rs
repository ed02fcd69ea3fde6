//! The user interface of the commands: values of options, signals, exit codes.

pub mod count;
pub mod exit;
pub mod interrupt;
pub(crate) mod with_unit;

use anyhow::Result;
use serde::Serialize;
use std::fmt::Display;

/// What was found about a design, with the name of the design.
#[derive(Serialize)]
struct Of<'a, T> {
    design: &'a str,
    #[serde(flatten)]
    found: &'a T,
}

/// Prints what was found about a design as JSON, or the text that says it.
pub fn print_of(
    json: bool,
    design: &str,
    found: &impl Serialize,
    text: impl Display,
) -> Result<()> {
    print(json, &Of { design, found }, format!("{design}\n\n{text}"))
}

/// Prints a value as JSON, or the text that says it.
pub fn print(json: bool, value: &impl Serialize, text: impl Display) -> Result<()> {
    let text = if json { serde_json::to_string_pretty(value)? } else { text.to_string() };
    println!("{}", text.trim_end());
    Ok(())
}

/// Number of processors of this machine.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
