//! The quantities that a testing machine records, their usual names and units.

use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// What a column contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
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

/// The spellings of a unit with the number of N, MPa, mm or 1 in it. A spelling is as `plain`
/// leaves it.
type Unit = (&'static str, f64);

const LBF: f64 = 4.448_221_615_260_5;
const KGF: f64 = 9.806_65;
const INCH: f64 = 25.4;
const PSI: f64 = LBF / (INCH * INCH);

const FORCES: &[Unit] = &[
    ("N", 1.0),
    ("mN", 1e-3),
    ("cN", 1e-2),
    ("daN", 10.0),
    ("kN", 1e3),
    ("MN", 1e6),
    ("gf", 1e-3 * KGF),
    ("kgf kp", KGF),
    ("lbf lb lbs", LBF),
    ("kip kips", 1e3 * LBF),
];
const STRESSES: &[Unit] = &[
    ("MPa N/mm2 MN/m2", 1.0),
    ("Pa N/m2", 1e-6),
    ("kPa kN/m2", 1e-3),
    ("GPa kN/mm2", 1e3),
    ("N/cm2", 1e-2),
    ("bar", 0.1),
    ("kN/cm2 daN/mm2", 10.0),
    ("kgf/cm2 kp/cm2", 1e-2 * KGF),
    ("kgf/mm2 kp/mm2", KGF),
    ("psi lbf/in2", PSI),
    ("ksi", 1e3 * PSI),
];
const LENGTHS: &[Unit] = &[
    ("mm", 1.0),
    ("um micron microns", 1e-3),
    ("cm", 10.0),
    ("m", 1e3),
    ("in inch inches", INCH),
    ("mil mils", 1e-3 * INCH),
];
const RATIOS: &[Unit] = &[
    ("1 - mm/mm m/m in/in", 1.0),
    ("% percent pct prozent", 1e-2),
    ("‰ mm/m", 1e-3),
    ("ue um/m microstrain", 1e-6),
];
/// Units of columns that are not read, in lower case.
const OTHERS: [&str; 16] = [
    "s", "sec", "secs", "seconds", "min", "h", "hz", "c", "°c", "k", "deg", "segments", "cycles",
    "mm/min", "mm/s", "1/s",
];

impl Quantity {
    /// Whether the quantity is a force or a stress, not a deformation.
    pub(super) fn is_load(self) -> bool {
        matches!(self, Force | Stress | TrueStress)
    }

    /// The question whether a column of this quantity was read rightly, with the options that
    /// decide it. `how` are the words for the `unit` that would explain its values.
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

    fn known(self) -> &'static [Unit] {
        match self {
            Force => FORCES,
            Stress | TrueStress => STRESSES,
            Extension => LENGTHS,
            Strain | TrueStrain | PlasticStrain => RATIOS,
        }
    }

    /// The number of N, MPa, mm or 1 in a unit of this quantity; `None` for other units. Capital
    /// letters matter where two units differ by them alone, as mN and MN do.
    pub fn factor(self, unit: &str) -> Option<f64> {
        let unit = plain(unit);
        let spelt = |same: fn(&str, &str) -> bool| {
            let mut found = (self.known().iter())
                .filter(|(spellings, _)| spellings.split(' ').any(|it| same(it, &unit)));
            let (_, factor) = found.next()?;
            found.next().is_none().then_some(*factor)
        };
        spelt(|spelling, unit| spelling == unit).or_else(|| spelt(str::eq_ignore_ascii_case))
    }

    /// The units of this quantity, separated by commas; the first is the unit of the project.
    pub fn units(self) -> String {
        let known: Vec<&str> = self.known().iter().map(|(spellings, _)| *spellings).collect();
        known.join(" ").replace(' ', ", ")
    }

    /// The unit of the project for this quantity: N, MPa, mm or 1.
    pub fn own_unit(self) -> &'static str {
        let (spellings, _) = self.known()[0];
        spellings.split(' ').next().unwrap_or_default()
    }

    /// The quantity that a column's name describes, in its usual spellings in English, German,
    /// French, Spanish, Italian and Turkish.
    pub(super) fn from_label(label: &str) -> Option<Self> {
        let name = folded(label);
        let name = name.split(['(', '[']).next().unwrap_or_default();
        let words: Vec<&str> =
            (name.split(|c: char| !c.is_alphabetic())).filter(|word| !word.is_empty()).collect();
        let has = |known: &str| known.split(' ').any(|known| words.contains(&known));
        let ends = |tail: &str| words.iter().any(|word| word.ends_with(tail));
        if has(TIMES) {
            return None;
        }
        let is_true = has(TRUE);
        let is_plastic = words.iter().any(|word| word.starts_with("plasti"));
        let unit = unit_of(label);
        let measured_in = |quantity: Self| unit.is_some_and(|unit| quantity.factor(unit).is_some());
        if has(STRESS_NAMES) || ends("spannung") {
            // `Tension` is a stress in Spanish and may be a force in English.
            return Some(match is_true {
                true => TrueStress,
                false if measured_in(Force) => Force,
                false => Stress,
            });
        }
        if has(FORCE_NAMES) || ends("kraft") {
            return Some(if measured_in(Stress) { Stress } else { Force });
        }
        let strain = has(STRAIN_NAMES) || ends("dehnung");
        let extension = has(EXTENSION_NAMES) || ends("weg") || ends("verlangerung");
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

/// Words in the names of columns, as [`folded`] leaves them: of times and rates, of true values,
/// and of each quantity.
const TIMES: &str = "rate time zeit temps tiempo tempo zaman sure speed vitesse velocidad velocita";
const TRUE: &str = "true wahre logarithmic log hencky vraie verdadera verdadero reale vera";
const STRESS_NAMES: &str = "stress sigma contrainte tension esfuerzo tensione sforzo gerilme";
const FORCE_NAMES: &str = "force load charge effort fuerza carga forza carico kuvvet yuk";
const STRAIN_NAMES: &str = "strain epsilon eps deformation deformacion deformazione gerinim";
const EXTENSION_NAMES: &str = "extension displacement elongation crosshead stroke travel allongement deplacement course alargamiento \
     elongacion desplazamiento carrera allungamento spostamento corsa uzama";

/// A text in lower case, without accents.
pub(super) fn folded(text: &str) -> String {
    let plain = |c| match c {
        'à' | 'á' | 'â' | 'ä' | 'ã' => 'a',
        'è' | 'é' | 'ê' | 'ë' => 'e',
        'ì' | 'í' | 'î' | 'ï' | 'ı' => 'i',
        'ò' | 'ó' | 'ô' | 'ö' => 'o',
        'ù' | 'ú' | 'û' | 'ü' => 'u',
        'ç' => 'c',
        'ş' => 's',
        'ğ' => 'g',
        c => c,
    };
    text.to_lowercase().chars().map(plain).collect()
}

/// A unit without its spaces, superscripts and Greek letters: `kgf / mm²` is `kgf/mm2`, `µε` is
/// `ue`.
fn plain(unit: &str) -> String {
    let letter = |c| match c {
        '²' => '2',
        '\u{b5}' | '\u{3bc}' => 'u',
        'ε' => 'e',
        c => c,
    };
    let kept = unit.chars().filter(|c| !c.is_whitespace() && *c != '^');
    kept.map(letter).collect()
}

/// Whether a text is a unit of a quantity that is read.
fn is_unit(text: &str) -> bool {
    [Force, Stress, Extension, Strain].iter().any(|quantity| quantity.factor(text).is_some())
}

/// Whether the cells are the row of units below the names of the columns: most of them are units.
pub(super) fn are_units(cells: &[String]) -> bool {
    let filled: Vec<&str> =
        (cells.iter().map(|cell| bare(cell))).filter(|cell| !cell.is_empty()).collect();
    let known = |cell: &&&str| is_unit(cell) || OTHERS.contains(&cell.to_lowercase().as_str());
    2 * filled.iter().filter(known).count() > filled.len()
}

/// A unit without its brackets.
pub(super) fn bare(unit: &str) -> &str {
    unit.trim_matches(['(', ')', '[', ']']).trim()
}

/// The unit in a column's name: the last word, in brackets, or after `/`, `in` or a comma. If none
/// of these is known, the text that stands where a unit is written.
pub(super) fn unit_of(label: &str) -> Option<&str> {
    let inside = (label.split(['(', '[']).skip(1)).filter_map(|rest| rest.split([')', ']']).next());
    let after = ["/", " in ", ","]
        .into_iter()
        .filter_map(|mark| Some(label.split_once(mark)?.1.trim()))
        .filter(|text| !text.contains([' ', ')', ']']));
    let stated = inside.chain(after).map(str::trim);
    let stated = stated.filter(|text| !text.is_empty());
    // The last word of `Strain 1` is a number, no unit.
    let last = (label.rsplit([' ', '_']).next()).filter(|word| *word != "-" && *word != "1");
    let mut known = last.into_iter().chain(stated.clone());
    known.find(|text| is_unit(text)).or_else(|| stated.last())
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
            ("Force standard", Force, None),
            ("Course standard (mm)", Extension, Some("mm")),
            ("Déformation (%)", Strain, Some("%")),
            ("CONTRAINTE (MPa)", Stress, Some("MPa")),
            ("Tensión (MPa)", Stress, Some("MPa")),
            ("Tension (N)", Force, Some("N")),
            ("Alargamiento [mm]", Extension, Some("mm")),
            ("Deformazione (mm)", Extension, Some("mm")),
            ("Forza, kN", Force, Some("kN")),
            ("Verlängerung in mm", Extension, Some("mm")),
            ("Load, kN", Force, Some("kN")),
            ("Kraft/daN", Force, Some("daN")),
            ("Load (Channel 1) (N)", Force, Some("N")),
            ("Stress/Load (kg/cm2)", Stress, Some("kg/cm2")),
            ("Strain m/m", Strain, Some("m/m")),
            ("Strain 1", Strain, None),
            ("Strain_1", Strain, None),
            ("Extension 1", Extension, None),
            ("Force / stones", Force, Some("stones")),
            ("Displacement in the machine", Extension, None),
        ] {
            assert_eq!(Quantity::from_label(label), Some(quantity), "{label}");
            assert_eq!(unit_of(label), unit, "{label}");
        }
        for label in ["Time (s)", "Strain rate (1/s)", "Temps (s)", "Width (mm)", "", "Cycle"] {
            assert_eq!(Quantity::from_label(label), None, "{label}");
        }
    }

    /// Two rows of one table never claim a spelling; the first spelling of each table is the unit
    /// of the project.
    #[test]
    fn every_spelling_has_one_factor() {
        for (quantity, own) in [(Force, "N"), (Stress, "MPa"), (Extension, "mm"), (Strain, "1")] {
            assert_eq!((quantity.own_unit(), quantity.factor(own)), (own, Some(1.0)));
            for (spellings, factor) in quantity.known() {
                for spelling in spellings.split(' ') {
                    assert_eq!(quantity.factor(spelling), Some(*factor), "{spelling}");
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
