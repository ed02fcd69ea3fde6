//! The material file of a fit, with its provenance as comments.

use crate::{Cause, MaterialFit, Origin, ReadColumn, Specimen, Statistic};
use hinge::{InvalidMaterial, SheetMaterial};
use std::fmt::Write;

impl MaterialFit {
    /// The material of the fit, with name, thickness, Poisson's ratio and density of `known`, which
    /// a tensile test does not measure. The error names a value that no sheet has.
    pub fn material(&self, known: SheetMaterial) -> Result<SheetMaterial, InvalidMaterial> {
        let material = SheetMaterial {
            young: self.young.mean,
            fracture_strain: self.fracture_strain,
            plastic: self.table.iter().map(|row| [row.stress, row.strain]).collect(),
            stress_deviation: self.stress_deviation(),
            ..known
        };
        material.validate()?;
        Ok(material)
    }
}

/// TOML text of the fitted material, with its provenance as comments.
pub fn material_file(fit: &MaterialFit, material: &SheetMaterial, poisson_assumed: bool) -> String {
    let mut text = String::new();
    write(&mut text, fit, material, poisson_assumed).expect("writing to a string cannot fail");
    text
}

fn write(
    t: &mut String,
    fit: &MaterialFit,
    material: &SheetMaterial,
    poisson_assumed: bool,
) -> std::fmt::Result {
    let name = printable(&material.name);
    writeln!(t, "# {name}: the law of tensile tests, by `kirigami material fit`.")?;
    for specimen in &fit.specimens {
        provenance(t, specimen)?;
    }
    landmarks(t, fit)?;
    let quoted = name.replace('\\', "\\\\").replace('"', "\\\"");
    writeln!(t, "name = \"{quoted}\"\n")?;
    let source = if fit.young_given { "given" } else { "measured" };
    let assumed = if poisson_assumed { "  # assumed" } else { "" };
    writeln!(t, "thickness = {:?}  # mm", material.thickness)?;
    writeln!(t, "young = {:?}  # MPa; {source}{}", material.young, scatter(&fit.young, 0))?;
    writeln!(t, "poisson = {:?}{assumed}", material.poisson)?;
    writeln!(t, "density_kg_m3 = {:?}  # kg/m^3", material.density_kg_m3)?;
    let source = fit.fracture_source.words();
    writeln!(
        t,
        "fracture_strain = {:?}  # true plastic strain; {source}",
        material.fracture_strain
    )?;
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
    match material.stress_deviation {
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
