//! The material file of a fit, with its provenance as comments.

use crate::material::{InvalidMaterial, SheetMaterial};
use std::fmt::Write;
use tensile::{Cause, MaterialFit, Origin, ReadColumn, Specimen, Statistic};

/// What a tensile test does not measure.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetFacts {
    /// Name of the material.
    pub name: String,
    /// Thickness of the sheet (mm).
    pub thickness: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Whether Poisson's ratio is assumed.
    pub poisson_assumed: bool,
    /// Density (kg/m^3).
    pub density_kg_m3: f64,
}

impl SheetMaterial {
    /// The material of a fit; the error names a value that no sheet has.
    pub fn fitted(fit: &MaterialFit, facts: &SheetFacts) -> Result<Self, InvalidMaterial> {
        let material = Self {
            name: facts.name.clone(),
            thickness: facts.thickness,
            young: fit.young.mean,
            poisson: facts.poisson,
            density_kg_m3: facts.density_kg_m3,
            fracture_strain: fit.fracture_strain,
            plastic: fit.table.iter().map(|row| [row.stress, row.strain]).collect(),
            stress_deviation: fit.stress_deviation(),
            ..Self::default()
        };
        material.validate()?;
        Ok(material)
    }
}

/// The TOML text of a fitted material.
pub fn material_file(fit: &MaterialFit, facts: &SheetFacts) -> String {
    let mut text = String::new();
    write(&mut text, fit, facts).expect("writing to a string cannot fail");
    text
}

fn write(t: &mut String, fit: &MaterialFit, facts: &SheetFacts) -> std::fmt::Result {
    let name = printable(&facts.name);
    writeln!(t, "# {name}: the law of tensile tests, by `kirigami material fit`.")?;
    for specimen in &fit.specimens {
        provenance(t, specimen)?;
    }
    landmarks(t, fit)?;
    let quoted = name.replace('\\', "\\\\").replace('"', "\\\"");
    writeln!(t, "name = \"{quoted}\"\n")?;
    let source = if fit.young_given { "given" } else { "measured" };
    let assumed = if facts.poisson_assumed { "  # assumed" } else { "" };
    writeln!(t, "thickness = {:?}  # mm", facts.thickness)?;
    writeln!(t, "young = {:?}  # MPa; {source}{}", fit.young.mean, scatter(&fit.young, 0))?;
    writeln!(t, "poisson = {:?}{assumed}", facts.poisson)?;
    writeln!(t, "density_kg_m3 = {:?}  # kg/m^3", facts.density_kg_m3)?;
    let source = fit.fracture_source.words();
    writeln!(t, "fracture_strain = {:?}  # true plastic strain; {source}", fit.fracture_strain)?;
    writeln!(
        t,
        "\n# Rows [true stress (MPa), true plastic strain]; constant stress after the last row. They deviate by at most\n\
         # {:.2} % from the mean curve.\nplastic = [",
        100.0 * fit.table_deviation
    )?;
    for row in &fit.table {
        let origin = match row.origin {
            Origin::Measured => "",
            Origin::Drawn => "  # in the neck: equal work",
            Origin::Extrapolated => "  # beyond the maximum force: Considere",
        };
        writeln!(t, "    [{:?}, {:?}],{origin}", row.stress, row.strain)?;
    }
    writeln!(t, "]")?;
    match fit.stress_deviation() {
        Some(deviation) => writeln!(
            t,
            "\nstress_deviation = {deviation:?}  # relative standard deviation of the stress over the specimens"
        ),
        None => Ok(()),
    }
}

/// The file of a specimen, what was read from it and what was dropped.
fn provenance(t: &mut String, specimen: &Specimen) -> std::fmt::Result {
    let name = specimen.path.file_name().unwrap_or_default().to_string_lossy();
    let [toe, unloading, broken] =
        [Cause::Toe, Cause::Unloading, Cause::Broken].map(|cause| specimen.dropped_for(cause));
    let [from, to] = specimen.linear.strain.map(|strain| 100.0 * strain);
    writeln!(
        t,
        "# {} (blake3 {}): {}.\n#   {} rows, not used: {toe} in the toe, {unloading} of unloading, {broken} after the break.\n\
         #   Toe {:.3} %, linear from {from:.3} to {to:.3} % with {:.0} MPa.",
        printable(&name),
        specimen.hash,
        printable(&specimen.read_as.each_ref().map(ReadColumn::to_string).join(", ")),
        specimen.rows,
        100.0 * specimen.toe,
        specimen.linear.young
    )
}

/// Yield and draw with their scatter.
fn landmarks(t: &mut String, fit: &MaterialFit) -> std::fmt::Result {
    write!(t, "# Rp0.2 {:.2} MPa{}", fit.offset_yield.mean, scatter(&fit.offset_yield, 2))?;
    for (name, value, unit, digits) in [
        ("upper yield", &fit.upper_yield, " MPa", 2),
        ("draw plateau", &fit.plateau, " MPa", 2),
        ("natural draw ratio", &fit.draw_ratio, "", 3),
    ] {
        if let Some(value) = value {
            write!(t, ", {name} {:.digits$}{unit}{}", value.mean, scatter(value, digits))?;
        }
    }
    writeln!(t, "; +- is the standard deviation.")
}

/// " +- 1.2", or nothing for one specimen.
fn scatter(of: &Statistic, digits: usize) -> String {
    of.deviation.map_or(String::new(), |deviation| format!(" +- {deviation:.digits$}"))
}

/// A text without the characters that would end a comment.
fn printable(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}
