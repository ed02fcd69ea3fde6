//! The dimensions of a specimen that a testing machine writes above its table: `Width;10,0;mm`,
//! `Largeur (mm): 10`.

use crate::name::Name;
use crate::quantity::{Quantity::Extension, bare};
use serde::Serialize;
use std::fmt;
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

impl fmt::Display for StatedDimension {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} {} mm (line {})", self.name.replace('-', " "), self.value, self.line)
    }
}

/// The dimensions in the lines above a table, and the lines that name one and state none of the
/// specimen: the width of a layer or of the grips, several numbers in a line, several values of one
/// dimension.
pub(super) fn dimensions(
    lines: &[TextRow],
    style: NumberStyle,
) -> (Vec<StatedDimension>, Vec<String>) {
    let (mut stated, mut others) = (Vec::<StatedDimension>::new(), Vec::new());
    for row in lines {
        let Some((text, values)) = named_values(row) else { continue };
        let name = Name::of(text);
        match dimension(&name, &values, style) {
            Some((name, value)) => stated.push(StatedDimension { name, value, line: row.line }),
            None if name.is_near_dimension() => others.push(format!("line {} `{text}`", row.line)),
            None => {}
        }
    }
    let one_value = |one: &StatedDimension| {
        stated.iter().all(|other| other.name != one.name || other.value == one.value)
    };
    let (used, several): (Vec<_>, Vec<_>) = stated.iter().partition(|one| one_value(one));
    others.extend(several.iter().map(|one| format!("{one}, one of several values")));
    (used, others)
}

/// The dimension of a specimen that a line states (mm).
fn dimension(name: &Name, values: &[&str], style: NumberStyle) -> Option<(&'static str, f64)> {
    let numbers = values.iter().enumerate();
    let mut numbers = numbers.filter_map(|(at, value)| Some((at, style.number(value)?)));
    let (at, number) = numbers.next().filter(|(_, number)| *number > 0.0)?;
    let unit = match values.get(at + 1).filter(|unit| !unit.is_empty()) {
        Some(unit) => bare(unit),
        None => name.unit(Extension).ok()?.unwrap_or("mm"),
    };
    let value = number * Extension.factor(unit)?;
    numbers.next().is_none().then_some((name.dimension()?, value))
}

/// The name in a line, and what stands behind it: behind a colon or an equals sign, and in other
/// cells.
fn named_values(row: &TextRow) -> Option<(&str, Vec<&str>)> {
    let name = row.cells[0].trim_start_matches('#').trim();
    let (name, value) = name.split_once([':', '=']).unwrap_or((name, ""));
    let words = value.split_whitespace().chain(row.cells[1..].iter().map(String::as_str));
    let values: Vec<&str> = words.collect();
    (!values.is_empty()).then_some((name, values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use support::text_table::TextTable;

    fn above_a_table(line: &str) -> Vec<StatedDimension> {
        let separator = if line.contains(';') { ";" } else { "," };
        let table = TextTable::parse(&format!("{line}\n1{separator}2\n3{separator}4\n"));
        dimensions(&table.rows[..1], table.style).0
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
        for text in ["Width,10,11,12", "Width", "Load,12,N", "Width,0"] {
            assert_eq!(above_a_table(text), [], "{text}");
        }
    }

    /// Each is named, and none is taken for the specimen's.
    #[test]
    fn dimensions_of_other_things_are_not_taken() {
        for text in [
            "Bandwidth,50,Hz",
            "Layer thickness (mm),0.2",
            "Wandstärke;1,2;mm",
            "Enddicke;2,1;mm",
            "Thickness tolerance,0.1,mm",
            "Thickness of coating,12,um",
            "Extrusion width: 0.42 mm",
            "Grip width,25,mm",
            "Largeur des mors,25,mm",
            "Gauge length after fracture,72,mm",
            "Grip length,90,mm",
            "Spessore finale = 3",
            "Width (furlongs),10",
        ] {
            let separator = if text.contains(';') { ";" } else { "," };
            let table = TextTable::parse(&format!("{text}\n1{separator}2\n3{separator}4\n"));
            let (stated, others) = dimensions(&table.rows[..1], table.style);
            assert_eq!((stated.len(), others.len()), (0, 1), "{text}");
            assert!(others[0].starts_with("line 1 `"), "{others:?}");
        }
    }
}
