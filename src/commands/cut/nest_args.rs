//! The arguments of `kirigami cut --stock`, and the names of its files.

use crate::ui::width_by_height::{length, stock};
use anyhow::{Result, ensure};
use clap::Args;
use design::scene::Stock;
use std::path::PathBuf;

/// What lies where, as a table and as a picture.
pub(super) const PLACES: &str = "places.csv";
pub(super) const PLAN: &str = "plan.svg";

/// The usual gap (mm).
const GAP: f64 = 3.0;
/// Maximum number of pieces: the order of their cuts takes seconds then, and minutes for more.
const MOST: usize = 200;

/// What is laid on which stock.
#[derive(Args, Default)]
pub(super) struct Nesting {
    /// Further scenes or runs: with --stock they are laid on its sheets together with the first
    #[arg(value_name = "SCENE", requires = "stock")]
    pub(super) others: Vec<PathBuf>,
    /// Lay the designs on sheets of this stock, as few as are found: a5 to a0, letter, tabloid, or width and height (mm). Takes --for,
    /// and writes one file a sheet, a picture of what lies where, and the cut lists
    #[arg(long, value_name = "STOCK", value_parser = stock, requires = "machine")]
    pub(super) stock: Option<Stock>,
    /// Border of the stock that the machine cannot cut (mm) [default: the largest cutting.margin of the scenes]
    #[arg(long, value_name = "MM", value_parser = length, requires = "stock")]
    pub(super) margin: Option<f64>,
    /// Width of the material that remains between two pieces (mm)
    #[arg(long, value_name = "MM", value_parser = length, default_value_t = GAP, requires = "stock")]
    pub(super) gap: f64,
    /// Number of pieces of every design, or one number a design: 2,1,3
    #[arg(
        long,
        value_name = "NUMBER",
        value_delimiter = ',',
        default_value = "1",
        requires = "stock"
    )]
    pub(super) copies: Vec<usize>,
    /// Turn no piece by 90 degrees: for stock with a direction, such as a grain
    #[arg(long, requires = "stock")]
    pub(super) no_turn: bool,
}

impl Nesting {
    /// The number of pieces of each of the designs.
    pub(super) fn copies_of(&self, designs: usize) -> Result<Vec<usize>> {
        let copies = match &self.copies[..] {
            [all] => vec![*all; designs],
            each => each.to_vec(),
        };
        ensure!(
            copies.len() == designs,
            "--copies has {} numbers for {designs} designs: give one number for all, or one a design in their order",
            copies.len()
        );
        let total = copies
            .iter()
            .fold(0, |sum: usize, n| sum.saturating_add(*n));
        ensure!(
            copies.iter().all(|copies| *copies > 0) && total <= MOST,
            "--copies {copies:?}: every design has at least one piece, and all have at most {MOST}"
        );
        Ok(copies)
    }
}
