//! What the name of a column or of a dimension says, word by word: `Standardkraft [kN]` is a force
//! in kN, `Layer thickness` no thickness of the specimen.

use crate::quantity::Quantity::{
    self, Extension, Force, PlasticStrain, Strain, Stress, TrueStrain, TrueStress,
};
use crate::quantity::{alike, is_unit};

/// Whole words as [`folded`] leaves them, in English, German, French, Spanish, Italian and Turkish;
/// the first word of a line is their meaning. `length` and `gauge` together are the gauge
/// length, `gauge-length` is alone; `plain` changes nothing, `other` names something else.
const WORDS: &str = include_str!("words.txt");
/// The ends of compounds, whose other part is looked up too.
const ENDS: &str =
    "kraft spannung dehnung weg verlangerung breite dicke starke lange width thickness length";

/// The words and units of a name.
#[derive(Debug, Default)]
pub(super) struct Name {
    /// The first words of lines of `WORDS`.
    meanings: Vec<&'static str>,
    /// Units, and what stands where a unit would and is none.
    units: Vec<String>,
    /// Other texts.
    unknown: Vec<String>,
}

impl Name {
    pub(crate) fn of(label: &str) -> Self {
        let label = label.replace(" / ", "/");
        let mut name = Self::default();
        for part in label.split_inclusive([')', ']', '}', '>']) {
            let (outside, inside) = part.split_once(['(', '[', '{', '<']).unwrap_or((part, ""));
            name.read(outside);
            let inside = inside.trim_end_matches([')', ']', '}', '>']);
            if is_unit(inside) {
                name.units.push(inside.to_owned());
            } else {
                let known = name.unknown.len();
                name.read(inside);
                if name.unknown.drain(known..).count() > 0 {
                    name.unknown.push(inside.to_owned());
                }
            }
        }
        name
    }

    /// Reads a text without brackets.
    fn read(&mut self, text: &str) {
        let sign = |c: char| !c.is_alphanumeric() && !"/%‰°^".contains(c);
        let mut chunks = text.split(sign).filter(|chunk| !chunk.is_empty()).peekable();
        while let Some(chunk) = chunks.next() {
            // `Force in N`, but `Extension in`.
            if chunk != "in" || chunks.peek().is_none() {
                self.chunk(chunk);
            }
        }
    }

    fn chunk(&mut self, chunk: &str) {
        let bare = chunk.trim_matches(['%', '‰']);
        let digit = |c: char| c.is_ascii_digit();
        // `x1000`, `Force/1000`.
        let before = chunk.split(digit).next().unwrap_or_default();
        let scaled = before != chunk && before.ends_with(['x', 'X', '/']);
        if chunk.chars().all(digit) {
            // The number of a specimen.
        } else if scaled || chunk.split('/').next().is_some_and(is_unit) {
            self.units.push(chunk.to_owned());
        } else if chunk.contains('/') {
            chunk.split('/').for_each(|part| self.chunk(part));
        } else if bare != chunk {
            self.chunk(bare);
            self.units.push(chunk.replace(bare, ""));
        } else if !self.word(&folded(chunk)) {
            let texts = if chunk.starts_with(digit) { &mut self.units } else { &mut self.unknown };
            texts.push(chunk.to_owned());
        }
    }

    /// Whether a word, or a compound, is known in all its parts.
    fn word(&mut self, word: &str) -> bool {
        let meaning = |word: &str| {
            let mut lines = WORDS.lines().filter_map(|line| line.split_once(' '));
            lines.find_map(|(first, words)| words.split(' ').any(|it| it == word).then_some(first))
        };
        let numbered = word.trim_matches(|c: char| c.is_ascii_digit());
        if let Some(meaning) = meaning(word).or_else(|| meaning(numbered)) {
            self.meanings.push(meaning);
            return true;
        }
        let compound = ENDS.split(' ').find_map(|end| Some((word.strip_suffix(end)?, end)));
        compound.is_some_and(|(start, end)| self.word(end) & self.word(start))
    }

    /// Whether a word has one of the meanings.
    fn has(&self, meanings: &str) -> bool {
        meanings.split(' ').any(|meaning| self.meanings.contains(&meaning))
    }

    /// Whether every word is known.
    pub(crate) fn is_known(&self) -> bool {
        self.unknown.is_empty()
    }

    /// Whether a word is the name of a quantity.
    pub(crate) fn is_near_quantity(&self) -> bool {
        self.has("force stress strain extension")
    }

    /// Whether a word is the name of a dimension.
    pub(crate) fn is_near_dimension(&self) -> bool {
        self.has("width thickness length gauge-length")
    }

    /// The quantity that the name of a column describes. `Tension` is a stress in Spanish and may be
    /// a force in English: the unit decides.
    pub(crate) fn quantity(&self) -> Option<Quantity> {
        let kinds = [
            ("stress", Stress, TrueStress, "force", Force),
            ("strain", Strain, TrueStrain, "extension", Extension),
        ];
        if self.has("other width thickness") {
            return None;
        }
        let (name, ratio, local, _, total) =
            (kinds.into_iter()).find(|(name, _, _, other, _)| self.has(name) || self.has(other))?;
        let measured_in =
            |quantity: Quantity| self.units.iter().any(|unit| quantity.factor(unit).is_some());
        Some(match self.has(name) {
            true if ratio == Strain && self.has("plastic") => PlasticStrain,
            true if self.has("true") => local,
            named if !measured_in(ratio) && (!named || measured_in(total)) => total,
            _ => ratio,
        })
    }

    /// The dimension of a specimen that the name describes in known words alone: the option of the
    /// command line without its dashes.
    pub(crate) fn dimension(&self) -> Option<&'static str> {
        let long = self.has("gauge-length");
        // `L0 - course standard`.
        let column = self.is_near_quantity() && !long;
        let fits = self.is_known() && !column && !self.has("other true plastic");
        let gauge = long || self.has("length") && self.has("gauge");
        let mut names = ["width", "thickness", "gauge-length"].into_iter();
        names.find(|name| fits && (self.has(name) || gauge && *name == "gauge-length"))
    }

    /// The unit of a quantity; the error is a text that may be another unit.
    pub(crate) fn unit(&self, quantity: Quantity) -> Result<Option<&str>, &str> {
        let Some(last) = self.units.last() else {
            return self.unknown.last().map_or(Ok(None), |text| Err(text));
        };
        let factor = quantity.factor(last);
        let other = |unit: &&String| factor.is_none() || quantity.factor(unit) != factor;
        self.units.iter().find(other).map_or(Ok(Some(last)), |unit| Err(unit))
    }
}

/// A text in lower case, without accents. Turkish in Windows-1254 that is read as Windows-1252 has
/// an Icelandic letter in place of three of its own.
fn folded(text: &str) -> String {
    let plain = |c| alike(c, "àáâäãa èéêëe ìíîïıýi òóôöo ùúûüu çc şþs ğðg");
    text.to_lowercase().chars().filter(|c| *c != '\u{307}').map(plain).collect()
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
            ("Displacement..mm.", Extension, Some("mm")),
            ("Force <kN>", Force, Some("kN")),
            ("Force {kN}", Force, Some("kN")),
            ("Force-kN", Force, Some("kN")),
            ("Force:kN", Force, Some("kN")),
            ("Force@kN", Force, Some("kN")),
            ("Force_kN_ch2", Force, Some("kN")),
            ("kN Force", Force, Some("kN")),
            ("Force kN filtered", Force, Some("kN")),
            ("Load pounds", Force, Some("pounds")),
            ("Load kilopounds", Force, Some("kilopounds")),
            ("Force (10^3 N)", Force, Some("10^3")),
            ("Force x1000 (N)", Force, Some("x1000")),
            ("Force (N/s)", Force, Some("N/s")),
            ("Strain%", Strain, Some("%")),
            ("Spannung (N mm⁻²)", Stress, Some("N mm⁻²")),
            ("Çekme gerilmesi (MPa)", Stress, Some("MPa")),
            ("Çekme gerinimi", Strain, None),
            ("Yükü (N)", Force, Some("N")),
        ] {
            let name = Name::of(label);
            assert_eq!(name.quantity(), Some(quantity), "{label}");
            assert_eq!(name.unit(quantity).unwrap_or_else(Some), unit, "{label}");
        }
        for label in [
            "Time (s)",
            "Strain rate (1/s)",
            "Temps (s)",
            "Width (mm)",
            "",
            "Cycle",
            "Transverse strain",
            "Strain (lateral) (%)",
            "Querdehnung (%)",
            "Déformation transversale",
            "Poisson strain",
            "Force limit (N)",
            "Load set point (N)",
            "Elongation at break (%)",
            "Preload (N)",
            "Force / 1000 N",
            "Bandstress",
        ] {
            assert_eq!(Name::of(label).quantity(), None, "{label}");
        }
    }
}
