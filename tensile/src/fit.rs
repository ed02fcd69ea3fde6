//! The law of a material from its specimens: mean modulus, mean hardening curve, fracture strain,
//! and the table of the finite elements.

use crate::landmarks::{Draw, SpecimenEnd};
use crate::local_curve::{ColdDrawing, beyond_maximum_force};
use crate::record::{Record, RecordOptions};
use crate::regression::{interpolated, thinned};
use crate::specimen::SpecimenOptions;
use crate::{Exclusion, ReadColumn, Specimen};
use hinge::SheetMaterial;
use serde::Serialize;
use std::path::PathBuf;
use support::{Fault, Joined, Point, fault, refuse};

/// What is known about a material besides the records of its specimens.
#[derive(Clone, Copy, Debug)]
pub struct FitOptions {
    /// For the evaluation of each specimen.
    pub specimen: SpecimenOptions,
    /// Plastic strain at fracture, ln(A0 / A) from the section A of the broken specimen, if it was
    /// measured.
    pub fracture_strain: Option<f64>,
    /// Maximum number of rows of the table, 2 to 200: CalculiX interpolates between at most 200
    /// rows.
    pub rows: usize,
}

/// Mean and standard deviation of a quantity over the specimens.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Statistic {
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation of the sample; `None` for one specimen.
    pub deviation: Option<f64>,
}

/// How a row of the table was obtained.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// From rows at which the strain is uniform.
    Measured,
    /// In the running neck, from the work of the machine; see `local_curve`.
    Drawn,
    /// Beyond the maximum force, by Considere's condition; see `local_curve`.
    Extrapolated,
}

/// A row of the hardening curve.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct HardeningRow {
    /// True stress (MPa).
    pub stress: f64,
    /// True plastic strain.
    pub strain: f64,
    /// How the row was obtained.
    pub origin: Origin,
}

/// The source of the fracture strain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FractureSource {
    /// Given.
    Given,
    /// Plastic strain at the end of records whose specimens deform uniformly to their break.
    Break,
    /// The same, but a record ends without a break: a lower bound, because the specimen strains
    /// further.
    RecordEnd,
    /// Plastic strain at the maximum force: a lower bound, because the neck strains further.
    MaximumForce,
    /// Plastic strain at the natural draw ratio: a lower bound, because the drawn material strains
    /// further.
    DrawRatio,
}

impl FractureSource {
    /// The source in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Break => "where the specimens broke, at uniform strain",
            Self::RecordEnd => {
                "the record ends here without a break: a lower bound; measure ln(A0 / A)"
            }
            Self::MaximumForce => "at the maximum force: a lower bound, the neck strains further",
            Self::DrawRatio => "at the natural draw ratio: a lower bound",
        }
    }
}

/// The law fitted to the records of one material. Stresses are in MPa.
#[derive(Debug, Serialize)]
pub struct MaterialFit {
    /// The specimens.
    pub specimens: Vec<Specimen>,
    /// Young's modulus of the law.
    pub young: Statistic,
    /// Whether Young's modulus was given.
    pub young_given: bool,
    /// Nominal stress at a plastic strain of 0.2 %.
    pub offset_yield: Statistic,
    /// Nominal stress at the upper yield, of specimens that draw.
    pub upper_yield: Option<Statistic>,
    /// Nominal stress of the draw plateau.
    pub plateau: Option<Statistic>,
    /// Stretch of the drawn material.
    pub draw_ratio: Option<Statistic>,
    /// True stress at which the law yields, if the upper yield was cut to the mean stress of the
    /// draw.
    pub cut_yield: Option<f64>,
    /// The hardening curve before it is thinned.
    #[serde(skip)]
    pub curve: Vec<HardeningRow>,
    /// The rows of `plastic`: the curve thinned and rounded.
    pub table: Vec<HardeningRow>,
    /// Maximum deviation of the table from the curve, over the stress.
    pub table_deviation: f64,
    /// Plastic strain at fracture.
    pub fracture_strain: f64,
    /// Scatter of the fracture strain, if the fracture strain comes from the specimens.
    pub fracture_scatter: Option<f64>,
    /// Source of the fracture strain.
    pub fracture_source: FractureSource,
}

/// Number of points of the curve in the neck.
const NECK_POINTS: usize = 100;
/// Number of intervals of the mean curve; they grow linearly, because a curve bends most after
/// yield.
const INTERVALS: usize = 400;
/// Digits after the point of stresses (MPa) and strains in the table.
const DIGITS: [i32; 2] = [3, 5];

impl Statistic {
    /// The statistic of at least one value.
    pub fn new(values: impl Iterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt());
        Self { mean, deviation }
    }
}

impl MaterialFit {
    /// Relative standard deviation of the stress over the specimens: the largest of modulus, yield
    /// and plateau, to two digits.
    pub fn stress_deviation(&self) -> Option<f64> {
        let stresses = [self.young, self.offset_yield].into_iter();
        let drawn = [self.upper_yield, self.plateau].into_iter().flatten();
        let relative = |of: Statistic| Some(of.deviation? / of.mean);
        let largest = stresses.chain(drawn).filter_map(relative).reduce(f64::max)?;
        Some(rounded(largest, 4))
    }

    /// Reads and evaluates the record of each specimen with its own options, and fits one law to
    /// all.
    pub fn new(records: &[(PathBuf, RecordOptions)], options: &FitOptions) -> Result<Self, Fault> {
        let mut specimens = Vec::new();
        for (path, record) in records {
            for record in Record::read_all(path, record)? {
                specimens.push(Specimen::new(record, &options.specimen)?);
            }
        }
        let draws = draws(&specimens)?;
        let over = |value: fn(&Specimen) -> f64| Statistic::new(specimens.iter().map(value));
        let drawn = |value: fn(&Draw) -> f64| {
            (!draws.is_empty()).then(|| Statistic::new(draws.iter().map(value)))
        };
        let young = over(|specimen| specimen.young);
        let (plateau, draw_ratio) = (drawn(|draw| draw.plateau), drawn(|draw| draw.draw_ratio));
        let (mut curve, cut_yield) = hardening(&specimens, young.mean, plateau.zip(draw_ratio))?;
        let end = curve[curve.len() - 1];
        let (fracture_strain, fracture_scatter, fracture_source) =
            fracture(&specimens, options.fracture_strain, end.strain)?;
        let necks = specimens.iter().all(|specimen| specimen.end == SpecimenEnd::Neck);
        if necks && fracture_strain > end.strain {
            let stress =
                beyond_maximum_force([end.stress, end.strain], fracture_strain, young.mean);
            curve.extend(marked(&[[stress, fracture_strain]], Origin::Extrapolated));
        }
        let rows: Vec<Point> = curve.iter().map(|row| [row.stress, row.strain]).collect();
        let (kept, table_deviation) = thinned(&rows, options.rows);
        let mut table: Vec<HardeningRow> = kept.into_iter().map(|row| curve[row]).collect();
        for row in &mut table {
            row.stress = rounded(row.stress, DIGITS[0]);
            row.strain = rounded(row.strain, DIGITS[1]);
        }
        table.dedup_by(|row, before| row.strain <= before.strain);
        Ok(Self {
            young: Statistic { mean: rounded(young.mean, 1), ..young },
            young_given: options.specimen.young.is_some(),
            offset_yield: over(|specimen| specimen.offset_yield),
            upper_yield: drawn(|draw| draw.upper_yield),
            plateau,
            draw_ratio,
            cut_yield,
            table,
            curve,
            table_deviation,
            fracture_strain: rounded(fracture_strain, 4),
            fracture_scatter,
            fracture_source,
            specimens,
        })
    }
}

/// The draws of the specimens, none or one each: specimens that draw and specimens that do not have
/// no common curve.
fn draws(specimens: &[Specimen]) -> Result<Vec<Draw>, Fault> {
    let draws: Vec<Draw> = specimens.iter().filter_map(|specimen| specimen.draw).collect();
    if draws.is_empty() || draws.len() == specimens.len() {
        return Ok(draws);
    }
    let names = |draw: bool| {
        let these = specimens.iter().filter(|specimen| specimen.draw.is_some() == draw);
        these.map(|specimen| specimen.path.display().to_string()).joined(", ")
    };
    Err(fault!(
        "{} have a draw plateau, {} have none: fit them apart, or leave out specimens that broke early",
        names(true),
        names(false)
    ))
}

/// The mean hardening curve, and the true stress to which the upper yield is cut, if it is. `draw`
/// has the plateau and the natural draw ratio.
fn hardening(
    specimens: &[Specimen],
    young: f64,
    draw: Option<(Statistic, Statistic)>,
) -> Result<(Vec<HardeningRow>, Option<f64>), Fault> {
    let mean = |part: fn(&Specimen) -> &[Point]| {
        mean_curve(&specimens.iter().map(part).collect::<Vec<_>>())
    };
    let mut uniform = mean(|specimen| &specimen.before);
    let Some((plateau, ratio)) = draw else {
        return Ok((marked(&uniform, Origin::Measured), None));
    };
    let top = uniform[uniform.len() - 1];
    let drawing = ColdDrawing::new(top, plateau.mean, ratio.mean, young).ok_or_else(|| {
        fault!("the natural draw ratio {:.3} is not beyond the upper yield at the plastic strain {:.3}: check --draw-ratio, \
             the initial section over the section of the drawn neck",
            ratio.mean, top[1])
    })?;
    let yields = drawing.yields_at();
    uniform.iter_mut().for_each(|row| row[0] = row[0].min(yields));
    let mut curve = marked(&uniform, Origin::Measured);
    curve.extend(marked(&drawing.points(NECK_POINTS), Origin::Drawn));
    let drawn = mean(|specimen| &specimen.after);
    let [stress, strain] = drawing.to;
    let continued = drawn[1..].iter().map(|row| [row[0] - drawn[0][0] + stress, row[1] + strain]);
    curve.extend(marked(&continued.collect::<Vec<_>>(), Origin::Measured));
    Ok((curve, (yields < top[0]).then_some(yields)))
}

/// The mean of curves [stress, strain] with increasing strain, over the strain from their starts up
/// to their mean end.
///
/// The stress at zero is the mean. From there the mean increment of the curves that reach an
/// interval is added, so that a specimen that breaks early leaves no jump.
fn mean_curve(curves: &[&[Point]]) -> Vec<Point> {
    let length = |curve: &[Point]| curve[curve.len() - 1][1] - curve[0][1];
    let end = Statistic::new(curves.iter().map(|curve| length(curve))).mean;
    let mut stress = Statistic::new(curves.iter().map(|curve| curve[0][0])).mean;
    let mut rows = vec![[stress, 0.0]];
    for interval in 1..=INTERVALS {
        let [before, strain] =
            [interval - 1, interval].map(|index| end * (index as f64 / INTERVALS as f64).powi(2));
        if strain > before {
            let at = |curve: &[Point], strain| interpolated(curve, 0, curve[0][1] + strain);
            let reached = curves.iter().filter(|curve| length(curve) >= before);
            let increments = reached.map(|curve| at(curve, strain) - at(curve, before));
            stress += Statistic::new(increments).mean;
            rows.push([stress, strain]);
        }
    }
    rows
}

/// The plastic strain at fracture, its scatter and its source, for a curve that ends at `end`.
fn fracture(
    specimens: &[Specimen],
    given: Option<f64>,
    end: f64,
) -> Result<(f64, Option<f64>, FractureSource), Fault> {
    if let Some(strain) = given {
        if strain < end {
            refuse!(
                "--fracture-strain {strain} is less than the plastic strain {end:.4} that the specimens reach on \
                 average: it is ln(A0 / A), from the section A of the broken specimen"
            );
        }
        return Ok((strain, None, FractureSource::Given));
    }
    let any = |of| specimens.iter().any(|specimen| specimen.end == of);
    let source = if any(SpecimenEnd::Drawing) {
        FractureSource::DrawRatio
    } else if any(SpecimenEnd::Neck) {
        FractureSource::MaximumForce
    } else if specimens.iter().all(|specimen| specimen.dropped_for(Exclusion::Broken) > 0) {
        FractureSource::Break
    } else {
        FractureSource::RecordEnd
    };
    let reached = |it: &Specimen| it.after.last().or(it.before.last()).map(|row| row[1]);
    let scatter = Statistic::new(specimens.iter().filter_map(reached)).deviation;
    if let Some(scatter) = scatter.filter(|scatter| *scatter > end) {
        refuse!(
            "the specimens have a fracture strain of {end:.4} ± {scatter:.4}, which is none: give --fracture-strain, or \
             leave out specimens that broke early"
        );
    }
    Ok((end, scatter, source))
}

fn rounded(value: f64, digits: i32) -> f64 {
    let unit = 10f64.powi(digits);
    (value * unit).round() / unit
}

fn marked(rows: &[Point], origin: Origin) -> Vec<HardeningRow> {
    let row = |&[stress, strain]: &Point| HardeningRow { stress, strain, origin };
    rows.iter().map(row).collect()
}

// The material file of a fit, with its provenance as comments.

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
    let [toe, unloading, broken] = [Exclusion::Toe, Exclusion::Unloading, Exclusion::Broken]
        .map(|cause| specimen.dropped_for(cause));
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
