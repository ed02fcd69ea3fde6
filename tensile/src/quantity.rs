//! The quantities that a testing machine records, and their units.

use serde::de::{IntoDeserializer, value::Error};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use support::Joined;

/// What a column contains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Force (N).
    Force,
    /// Force over the initial section (MPa).
    Stress,
    /// Force over the current section (MPa).
    TrueStress,
    /// Increase of the gauge length (mm).
    Extension,
    /// Extension over the gauge length.
    Strain,
    /// Logarithmic strain ln(1 + extension / gauge length).
    TrueStrain,
    /// Plastic part of the logarithmic strain.
    PlasticStrain,
}

use Quantity::{Extension, Force, PlasticStrain, Strain, Stress, TrueStrain, TrueStress};

/// A quantity, the number of N, MPa, mm or 1 in a unit, and the spellings of the unit as [`plain`]
/// leaves them; the first of a quantity is the unit of the project.
const UNITS: &str = include_str!("units.txt");
/// Units of columns that are not read, in lower case.
const OTHERS: &str = "s sec secs seconds min h hz c °c k deg segments cycles mm/min mm/s 1/s";

impl Quantity {
    /// Whether the quantity is a force or a stress, not a deformation.
    pub(super) fn is_load(self) -> bool {
        matches!(self, Force | Stress | TrueStress)
    }

    /// The question whether a column of this quantity was read rightly, with the options that
    /// decide it; its values would be usual in `unit`.
    pub(super) fn doubt(self, unit: &str) -> String {
        let how = match unit {
            _ if self == Force => {
                return "are --thickness, --width and --units force=UNIT right".into();
            }
            _ if self == Extension => {
                return "are --gauge-length and --units extension=UNIT right".into();
            }
            "%" => "in per cent",
            "1" => "not in per cent",
            "UNIT" => "in another unit",
            unit => &format!("in {unit}"),
        };
        format!("is the {self} {how} (--units {self}={unit})")
    }

    /// The number of N, MPa, mm or 1 in each unit, and its spellings.
    fn known(self) -> impl Iterator<Item = (f64, &'static str)> {
        let name = match self {
            TrueStress => Stress,
            TrueStrain | PlasticStrain => Strain,
            own => own,
        };
        UNITS.lines().filter_map(move |line| {
            let (factor, spellings) = line.strip_prefix(&format!("{name} "))?.split_once(' ')?;
            Some((factor.parse().ok()?, spellings))
        })
    }

    /// The number of N, MPa, mm or 1 in a unit of this quantity; `None` for other units. Capital
    /// letters matter where two units differ by them alone, as mN and MN do.
    pub fn factor(self, unit: &str) -> Option<f64> {
        let unit = plain(unit);
        let spelt = |same: fn(&str, &str) -> bool| {
            let mut found = self
                .known()
                .filter(|(_, spellings)| spellings.split(' ').any(|it| same(it, &unit)));
            let (factor, _) = found.next()?;
            found.next().is_none().then_some(factor)
        };
        spelt(|spelling, unit| spelling == unit).or_else(|| spelt(str::eq_ignore_ascii_case))
    }

    /// The units of this quantity, each in its first spelling, separated by commas; the first is
    /// the unit of the project.
    pub fn units(self) -> String {
        let first = |(_, spellings): (f64, &'static str)| spellings.split(' ').next();
        self.known().filter_map(first).joined(", ")
    }

    /// The unit of the project for this quantity: N, MPa, mm or 1.
    pub fn own_unit(self) -> String {
        self.units().split(',').take(1).collect()
    }
}

/// A unit without its spaces, superscripts and Greek letters: `kgf / mm²` is `kgf/mm2`, `µε` is
/// `ue`.
fn plain(unit: &str) -> String {
    let kept = unit.chars().filter(|c| !c.is_whitespace() && *c != '^');
    kept.map(|c| alike(c, "²2 ³3 ⁻- ·* \u{b5}u \u{3bc}u εe")).collect()
}

/// The last character of the word in `table` that has the character, or the character itself.
pub(super) fn alike(c: char, table: &str) -> char {
    table.split(' ').find(|word| word.contains(c)).and_then(|word| word.chars().last()).unwrap_or(c)
}

/// Whether a text is a unit of a quantity that is read.
pub(super) fn is_unit(text: &str) -> bool {
    [Force, Stress, Extension, Strain].iter().any(|quantity| quantity.factor(text).is_some())
}

/// Whether the cells are the row of units below the names of the columns: most of them are units.
pub(super) fn are_units(cells: &[String]) -> bool {
    let filled: Vec<&str> =
        (cells.iter().map(|cell| bare(cell))).filter(|cell| !cell.is_empty()).collect();
    let other = |cell: &str| OTHERS.split(' ').any(|unit| unit == cell.to_lowercase());
    2 * filled.iter().filter(|cell| is_unit(cell) || other(cell)).count() > filled.len()
}

/// A unit without its brackets.
pub(super) fn bare(unit: &str) -> &str {
    unit.trim_matches(['(', ')', '[', ']', '{', '}', '<', '>']).trim()
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        self.serialize(f)
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::deserialize(text.into_deserializer()).map_err(|error: Error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of one table never claim a spelling; the first spelling of each table is the unit
    /// of the project.
    #[test]
    fn every_spelling_has_one_factor() {
        for (quantity, own) in [(Force, "N"), (Stress, "MPa"), (Extension, "mm"), (Strain, "1")] {
            assert_eq!((&*quantity.own_unit(), quantity.factor(own)), (own, Some(1.0)));
            for (factor, spellings) in quantity.known() {
                for spelling in spellings.split(' ') {
                    assert_eq!(quantity.factor(spelling), Some(factor), "{spelling}");
                }
            }
        }
    }

    #[test]
    fn units_are_converted_to_those_of_the_project() {
        for (quantity, unit, factor) in [
            (Force, "kN", Some(1e3)),
            (Force, "KN", Some(1e3)),
            (Force, "mN", Some(1e-3)),
            (Force, "MN", Some(1e6)),
            (Force, "mn", None),
            (Force, "kgf", Some(9.806_65)),
            (Force, "mm", None),
            (Stress, "Pa", Some(1e-6)),
            (Stress, "Mpa", Some(1.0)),
            (Stress, "kgf / mm²", Some(9.806_65)),
            (Stress, "N/cm^2", Some(0.01)),
            (Extension, "\u{3bc}m", Some(1e-3)),
            (Extension, "\u{b5}m", Some(1e-3)),
            (Strain, " % ", Some(0.01)),
            (Strain, "Percent", Some(0.01)),
            (Strain, "\u{3bc}ε", Some(1e-6)),
            (Strain, "mm", None),
        ] {
            assert_eq!(quantity.factor(unit), factor, "{quantity} {unit}");
        }
        // 1 psi = 1 lbf / (25.4 mm)^2.
        let ksi = Stress.factor("ksi").unwrap();
        assert!((ksi - 6.894_757_293_168).abs() < 1e-12, "{ksi}");
    }
}
