//! The dimensions of a specimen that a testing machine writes above its table: `Width;10,0;mm`,
//! `Largeur (mm): 10`.

use crate::quantity::{Quantity, folded, unit_of};
use serde::Serialize;
use support::text_table::{NumberStyle, TextRow};

/// A dimension of a specimen that its file states.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StatedDimension {
    /// Which: the option of the command line without its dashes.
    pub name: &'static str,
    /// Its value (mm).
    pub value: f64,
    /// Number of the line in the file, from 1.
    pub line: u64,
}

/// What the names of a dimension contain in English, German, French, Spanish, Italian and Turkish.
const NAMES: [(&str, &str); 3] = [
    ("width", "width|breite|largeur|ancho|larghezza|genislik"),
    ("thickness", "thickness|dicke|epaisseur|espesor|spessore|kalinlik"),
    (
        "gauge-length",
        "gauge length|gage length|l0|messlange|longueur initiale|longitud inicial|longitud calibrada|lunghezza iniziale",
    ),
];

/// The dimensions in the lines above a table; a line with several numbers states none.
pub(super) fn dimensions(lines: &[TextRow], style: NumberStyle) -> Vec<StatedDimension> {
    let stated = |row: &TextRow| {
        let (name, values) = named_values(row)?;
        let folded = folded(&name);
        let has = |words: &str| words.split('|').any(|word| folded.contains(word));
        let (kind, _) = NAMES.into_iter().find(|(_, words)| has(words))?;
        let numbers = values.iter().enumerate();
        let mut numbers = numbers.filter_map(|(at, value)| Some((at, style.number(value)?)));
        let (at, number) = numbers.next().filter(|(_, number)| *number > 0.0)?;
        let unit = values.get(at + 1).map(String::as_str).or(unit_of(&name));
        let factor =
            Quantity::Extension.factor(unit.filter(|unit| !unit.is_empty()).unwrap_or("mm"))?;
        numbers.next().is_none().then_some(StatedDimension {
            name: kind,
            value: number * factor,
            line: row.line,
        })
    };
    lines.iter().filter_map(stated).collect()
}

/// The name in a line, and what stands behind it: in other cells, or behind a colon or an equals
/// sign.
fn named_values(row: &TextRow) -> Option<(String, Vec<String>)> {
    let name = row.cells[0].trim_start_matches('#').trim();
    if let Some((name, value)) = name.split_once([':', '=']).filter(|(_, value)| !value.is_empty())
    {
        let words = value.split_whitespace().map(str::to_owned);
        return Some((name.to_owned(), words.collect()));
    }
    (row.cells.len() > 1).then(|| (name.to_owned(), row.cells[1..].to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use support::text_table::TextTable;

    fn above_a_table(line: &str) -> Vec<StatedDimension> {
        let separator = if line.contains(';') { ";" } else { "," };
        let table = TextTable::parse(&format!("{line}\n1{separator}2\n3{separator}4\n"));
        dimensions(&table.rows[..1], table.style)
    }

    #[test]
    fn dimensions_are_found_in_the_words_of_machines() {
        for (text, name, value) in [
            ("Width,10.5,mm", "width", 10.5),
            ("\"Épaisseur éprouvette\",0.5,\"mm\"", "thickness", 0.5),
            ("Probenbreite b0;10;mm", "width", 10.0),
            ("Gauge length (in),2", "gauge-length", 50.8),
            ("L0 - course standard,50,mm", "gauge-length", 50.0),
            ("# Thickness: 500 um", "thickness", 0.5),
            ("Spessore = 3", "thickness", 3.0),
        ] {
            let found = above_a_table(text);
            let [one] = found[..] else { panic!("{text}: {found:?}") };
            assert_eq!((one.name, one.line), (name, 1), "{text}");
            assert!((one.value - value).abs() < 1e-12, "{text}: {one:?}");
        }
        for text in ["Bandwidth,50,Hz", "Width,10,11,12", "Width", "Load,12,N", "Width,0"] {
            assert_eq!(above_a_table(text), [], "{text}");
        }
    }
}
