//! The material file of a fit, with its provenance as comments.

use crate::{Cause, MaterialFit, Origin, ReadColumn, Specimen, Statistic};
use hinge::SheetMaterial;
use support::fault::Fault;

impl MaterialFit {
    /// The material of the fit, with name, thickness, Poisson's ratio and density of `known`, which
    /// a tensile test does not measure. The error names a value that no sheet has.
    pub fn material(&self, known: SheetMaterial) -> Result<SheetMaterial, Fault> {
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
    let SheetMaterial { thickness, young, poisson, density_kg_m3, fracture_strain, .. } = material;
    let name = printable(&material.name);
    let rows = fit.table.iter().map(|row| {
        let origin = match row.origin {
            Origin::Measured => "",
            Origin::Drawn => "  # in the neck: equal work",
            Origin::Extrapolated => "  # beyond the maximum force: Considere",
        };
        format!("    [{:?}, {:?}],{origin}\n", row.stress, row.strain)
    });
    let deviation = material.stress_deviation.map(|deviation| {
        format!("\nstress_deviation = {deviation:?}  # relative standard deviation of the stress over the specimens\n")
    });
    format!(
        "# {name}: the law of tensile tests, by `kirigami material fit`.\n{}{}\
         name = \"{}\"\n\n\
         thickness = {thickness:?}  # mm\n\
         young = {young:?}  # MPa; {}{}\n\
         poisson = {poisson:?}{}\n\
         density_kg_m3 = {density_kg_m3:?}  # kg/m^3\n\
         fracture_strain = {fracture_strain:?}  # true plastic strain; {}\n\n\
         # Rows [true stress (MPa), true plastic strain]; constant stress after the last row. They deviate by at most\n\
         # {:.2} % from the mean curve.\nplastic = [\n{}]\n{}",
        fit.specimens.iter().map(provenance).collect::<String>(),
        landmarks(fit),
        name.replace('\\', "\\\\").replace('"', "\\\""),
        if fit.young_given { "given" } else { "measured" },
        scatter(&fit.young, 0),
        if poisson_assumed { "  # assumed" } else { "" },
        fit.fracture_source.words(),
        100.0 * fit.table_deviation,
        rows.collect::<String>(),
        deviation.unwrap_or_default()
    )
}

/// The file of a specimen, what was read from it and what was dropped.
fn provenance(specimen: &Specimen) -> String {
    let name = specimen.path.file_name().unwrap_or_default().to_string_lossy();
    let [toe, unloading, broken] =
        [Cause::Toe, Cause::Unloading, Cause::Broken].map(|cause| specimen.dropped_for(cause));
    let [from, to] = specimen.linear.strain.map(|strain| 100.0 * strain);
    format!(
        "# {} (blake3 {}): {}.\n#   {} rows, not used: {toe} in the toe, {unloading} of unloading, {broken} after the break.\n\
         #   Toe {:.3} %, linear from {from:.3} to {to:.3} % with {:.0} MPa.\n",
        printable(&name),
        specimen.hash,
        printable(&specimen.read_as.each_ref().map(ReadColumn::to_string).join(", ")),
        specimen.rows,
        100.0 * specimen.toe,
        specimen.linear.young
    )
}

/// Yield and draw with their scatter.
fn landmarks(fit: &MaterialFit) -> String {
    let all = [
        ("# Rp0.2", Some(&fit.offset_yield), " MPa", 2),
        (", upper yield", fit.upper_yield.as_ref(), " MPa", 2),
        (", draw plateau", fit.plateau.as_ref(), " MPa", 2),
        (", natural draw ratio", fit.draw_ratio.as_ref(), "", 3),
    ];
    let known = all.into_iter().filter_map(|(name, value, unit, digits)| {
        let value = value?;
        Some(format!("{name} {:.digits$}{unit}{}", value.mean, scatter(value, digits)))
    });
    known.collect::<String>() + "; +- is the standard deviation.\n"
}

/// " +- 1.2", or nothing for one specimen.
fn scatter(of: &Statistic, digits: usize) -> String {
    of.deviation.map_or(String::new(), |deviation| format!(" +- {deviation:.digits$}"))
}

/// A text without the characters that would end a comment.
fn printable(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}
