//! Figures in README and result pages, compared with the tables that they come from.

use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Headlines {
    headline: Vec<Headline>,
}

/// A text whose numbers come from cells of a source.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Headline {
    file: String,
    text: String,
    source: String,
    cells: Vec<Cell>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Cell {
    /// Number of the table from 1, row by its first cell, or by its first cells joined by ` | `, and column.
    Table(usize, String, String),
    /// A JSON pointer.
    Pointer(String),
}

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The text with every run of white space as one space.
fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The numbers of a text as written, without those in brackets and without the ends of ranges "A to B".
fn numbers(text: &str) -> Vec<String> {
    let mut depth = 0;
    let plain: String = text
        .chars()
        .filter(|c| {
            depth += i32::from(*c == '(') - i32::from(*c == ')');
            depth == 0
        })
        .collect();
    let words: Vec<&str> = plain
        .split([' ', ',', ';', '|'])
        .map(|word| word.trim_end_matches('.'))
        .filter(|word| !word.is_empty())
        .collect();
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    let ends_range = |i: usize| i > 1 && words[i - 1] == "to" && is_number(words[i - 2]);
    (0..words.len())
        .filter(|&i| is_number(words[i]) && !ends_range(i))
        .map(|i| words[i].to_owned())
        .collect()
}

fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(str::trim).collect()
}

/// The first number in a cell of a Markdown file.
fn in_table(source: &str, number: usize, row: &str, column: &str) -> f64 {
    let lines: Vec<&str> = source.lines().collect();
    let heads: Vec<usize> = (1..lines.len())
        .filter(|&i| lines[i].starts_with("|---"))
        .map(|i| i - 1)
        .collect();
    let head = heads[number - 1];
    let column = (cells(lines[head]).iter())
        .position(|name| *name == column)
        .unwrap_or_else(|| panic!("no column {column}"));
    let rows = lines[head + 2..]
        .iter()
        .take_while(|line| line.starts_with('|'));
    let first: Vec<&str> = row.split(" | ").collect();
    let cell = rows
        .map(|line| cells(line))
        .find(|cells| cells.starts_with(&first))
        .unwrap_or_else(|| panic!("no row {row}"))[column];
    let number = cell.split([' ', ',']).next().unwrap();
    number.parse().unwrap()
}

impl Cell {
    fn value(&self, source: &str) -> f64 {
        match self {
            Self::Table(number, row, column) => in_table(source, *number, row, column),
            Self::Pointer(pointer) => {
                let json: serde_json::Value = serde_json::from_str(source).unwrap();
                100.0 * json.pointer(pointer).unwrap().as_f64().unwrap()
            }
        }
    }
}

#[test]
fn headlines_are_the_figures_of_their_tables() {
    let Headlines { headline } =
        support::toml_file::parse(&read("docs/results/headlines.toml"), Path::new("headlines"))
            .unwrap();
    for Headline {
        file,
        text,
        source,
        cells,
    } in headline
    {
        assert!(
            in_one_line(&read(&file)).contains(&text),
            "{file} does not state: {text}"
        );
        let source_text = read(&source);
        let stated = numbers(&text);
        assert_eq!(stated.len(), cells.len(), "{text}: {stated:?}");
        for (stated, cell) in stated.iter().zip(&cells) {
            let decimals = stated.split_once('.').map_or(0, |(_, digits)| digits.len());
            let found = format!("{:.decimals$}", cell.value(&source_text));
            assert_eq!(*stated, found, "{file}: {text} ({source})");
        }
    }
}

#[test]
fn the_numbers_of_a_text_are_found_in_their_order() {
    assert_eq!(
        numbers("0.5 to 0.9 % in W, 1.10 times (7 of 9), reduced to 57."),
        ["0.5", "1.10", "57"]
    );
}

#[test]
fn a_row_is_found_by_its_first_cells_and_a_cell_counts_by_its_first_number() {
    let page = "| sheet | panels | error |\n|---|---|---|\n| free | 4 | 1 % |\n| free | 9 | 0.31 mm, 0.07 % |\n";
    assert_eq!(in_table(page, 1, "free", "error"), 1.0);
    assert_eq!(in_table(page, 1, "free | 9", "error"), 0.31);
}
