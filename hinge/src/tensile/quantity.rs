//! The quantities that a testing machine records, their usual names and units.

use std::fmt;
use std::str::FromStr;

/// What a column contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Every quantity with its name on the command line.
const NAMES: [(Quantity, &str); 7] = [
    (Force, "force"),
    (Stress, "stress"),
    (TrueStress, "true-stress"),
    (Extension, "extension"),
    (Strain, "strain"),
    (TrueStrain, "true-strain"),
    (PlasticStrain, "plastic-strain"),
];

/// Spellings of the units, in lower case, with the number of N, MPa, mm or 1 in each.
const FORCES: [(&str, f64); 4] = [
    ("n", 1.0),
    ("kn", 1e3),
    ("lbf", 4.448_221_615),
    ("kgf", 9.806_65),
];
const STRESSES: [(&str, f64); 9] = [
    ("mpa", 1.0),
    ("n/mm2", 1.0),
    ("n/mm^2", 1.0),
    ("n/mm²", 1.0),
    ("pa", 1e-6),
    ("kpa", 1e-3),
    ("gpa", 1e3),
    ("psi", 6.894_757_29e-3),
    ("ksi", 6.894_757_29),
];
const LENGTHS: [(&str, f64); 6] = [
    ("mm", 1.0),
    ("cm", 10.0),
    ("m", 1e3),
    ("um", 1e-3),
    ("µm", 1e-3),
    ("in", 25.4),
];
const RATIOS: [(&str, f64); 10] = [
    ("%", 0.01),
    ("percent", 0.01),
    ("pct", 0.01),
    ("prozent", 0.01),
    ("1", 1.0),
    ("-", 1.0),
    ("mm/mm", 1.0),
    ("m/m", 1.0),
    ("in/in", 1.0),
    ("‰", 1e-3),
];
/// Units of columns that are not read.
const OTHERS: [&str; 6] = ["s", "min", "h", "°c", "deg", "mm/min"];

impl Quantity {
    /// Whether the quantity is a force or a stress, not a deformation.
    pub(super) fn is_load(self) -> bool {
        matches!(self, Force | Stress | TrueStress)
    }

    /// The question whether a column of this quantity was read rightly, with the options that decide it. `how` are the
    /// words for the `unit` that would explain its values.
    pub(super) fn doubt(self, how: &str, unit: &str) -> String {
        match self {
            Force => {
                "are --thickness, --width and the unit of the force (--units force=UNIT) right"
                    .into()
            }
            Extension => {
                "are --gauge-length and the unit of the extension (--units extension=UNIT) right"
                    .into()
            }
            _ => format!("is the {self} {how} (--units {self}={unit})"),
        }
    }

    /// The number of N, MPa, mm or 1 in a unit of this quantity; `None` for other units.
    pub fn factor(self, unit: &str) -> Option<f64> {
        let units: &[(&str, f64)] = match self {
            Force => &FORCES,
            Stress | TrueStress => &STRESSES,
            Extension => &LENGTHS,
            Strain | TrueStrain | PlasticStrain => &RATIOS,
        };
        let unit = unit.trim().to_lowercase();
        let found = units.iter().find(|(spelling, _)| *spelling == unit);
        found.map(|(_, factor)| *factor)
    }

    /// The units of this quantity, separated by commas.
    pub(super) fn units(self) -> &'static str {
        match self {
            Force => "N, kN, lbf, kgf",
            Stress | TrueStress => "MPa, N/mm2, Pa, kPa, GPa, psi, ksi",
            Extension => "mm, cm, m, um, in",
            Strain | TrueStrain | PlasticStrain => "1, %, mm/mm",
        }
    }

    /// The quantity that a column's name describes, in its usual spellings in English and German.
    pub(super) fn from_label(label: &str) -> Option<Self> {
        let name = label.to_lowercase();
        let name = name.split(['(', '[']).next().unwrap_or_default();
        let words: Vec<&str> = (name.split(|c: char| !c.is_alphabetic()))
            .filter(|word| !word.is_empty())
            .collect();
        let has = |known: &[&str]| words.iter().any(|word| known.contains(word));
        let ends = |tail: &str| words.iter().any(|word| word.ends_with(tail));
        if has(&["rate", "time", "zeit"]) {
            return None;
        }
        let is_true = has(&["true", "wahre", "logarithmic", "log", "hencky"]);
        let is_plastic = has(&["plastic", "plastische"]);
        let unit = unit_of(label);
        let measured_in = |quantity: Self| {
            unit.as_ref()
                .is_some_and(|unit| quantity.factor(unit).is_some())
        };
        if has(&["stress", "sigma"]) || ends("spannung") {
            return Some(if is_true { TrueStress } else { Stress });
        }
        if has(&["force", "load"]) || ends("kraft") {
            return Some(if measured_in(Stress) { Stress } else { Force });
        }
        let strain = has(&["strain", "epsilon", "eps"]) || ends("dehnung");
        let extension = has(&[
            "extension",
            "displacement",
            "elongation",
            "crosshead",
            "stroke",
            "travel",
        ]) || ends("weg")
            || ends("verlängerung");
        match (strain, extension) {
            (true, _) if is_plastic => Some(PlasticStrain),
            (true, _) if is_true => Some(TrueStrain),
            (true, _) if measured_in(Extension) => Some(Extension),
            (true, _) => Some(Strain),
            (false, true) if measured_in(Strain) => Some(Strain),
            (false, true) => Some(Extension),
            (false, false) => None,
        }
    }
}

/// Whether a text is a unit of any quantity, as in a row of units below the names of the columns.
pub(super) fn is_unit(text: &str) -> bool {
    let known = |quantity: &Quantity| quantity.factor(text).is_some();
    [Force, Stress, Extension, Strain].iter().any(known)
        || OTHERS.contains(&text.to_lowercase().as_str())
}

/// The unit in a column's name: in brackets, or after `_`, `/`, `in` or a space.
pub(super) fn unit_of(label: &str) -> Option<String> {
    let inside = (label.split(['(', '[']).skip(1)).filter_map(|rest| rest.split([')', ']']).next());
    let after = [" in ", " / ", "/", "_", " "]
        .into_iter()
        .filter_map(|mark| {
            let (name, unit) = label.rsplit_once(mark)?;
            (!name.trim().is_empty()).then_some(unit)
        });
    let mut candidates = inside.chain(after).map(str::trim);
    candidates.find(|text| is_unit(text)).map(str::to_owned)
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let found = NAMES.iter().find(|(quantity, _)| quantity == self);
        f.write_str(found.map_or("", |(_, name)| name))
    }
}

impl FromStr for Quantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = NAMES.iter().find(|(_, name)| *name == text);
        found.map(|(quantity, _)| *quantity).ok_or_else(|| {
            let known: Vec<&str> = NAMES.iter().map(|(_, name)| *name).collect();
            format!("`{text}` is not a quantity: use {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_names_of_columns_are_recognised() {
        for (label, quantity, unit) in [
            ("Force (kN)", Force, Some("kN")),
            ("Load [N]", Force, Some("N")),
            ("Standardkraft in N", Force, Some("N")),
            ("force_n", Force, Some("n")),
            ("Extension (mm)", Extension, Some("mm")),
            ("Crosshead displacement / mm", Extension, Some("mm")),
            ("Standardweg", Extension, None),
            ("Elongation (%)", Strain, Some("%")),
            ("Dehnung [%]", Strain, Some("%")),
            ("Tensile strain (Extension) (%)", Strain, Some("%")),
            ("Strain (mm/mm)", Strain, Some("mm/mm")),
            ("engineering_strain", Strain, None),
            ("strain_percent", Strain, Some("percent")),
            ("Strain (percent)", Strain, Some("percent")),
            ("Tensile stress (MPa)", Stress, Some("MPa")),
            ("engineering_stress_mpa", Stress, Some("mpa")),
            ("Spannung N/mm2", Stress, Some("N/mm2")),
            ("true_stress_mpa", TrueStress, Some("mpa")),
            ("True strain", TrueStrain, None),
            ("plastic_strain", PlasticStrain, None),
        ] {
            assert_eq!(Quantity::from_label(label), Some(quantity), "{label}");
            assert_eq!(unit_of(label).as_deref(), unit, "{label}");
        }
        for label in ["Time (s)", "Strain rate (1/s)", "Width (mm)", "", "Cycle"] {
            assert_eq!(Quantity::from_label(label), None, "{label}");
        }
    }

    #[test]
    fn units_are_converted_to_those_of_the_project() {
        assert_eq!(Force.factor("kN"), Some(1e3));
        assert_eq!(Stress.factor("Pa"), Some(1e-6));
        assert_eq!(Strain.factor(" % "), Some(0.01));
        assert_eq!(Strain.factor("Percent"), Some(0.01));
        assert_eq!(Strain.factor("mm"), None);
        // 1 psi = 1 lbf / (25.4 mm)^2.
        let psi = Force.factor("lbf").unwrap() / 25.4f64.powi(2);
        assert!((Stress.factor("psi").unwrap() / psi - 1.0).abs() < 1e-8);
    }
}
