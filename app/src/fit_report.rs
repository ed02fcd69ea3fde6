//! What is said of a material that was fitted to tensile tests.

use support::table::{Cell, Table};
use tensile::{
    Exclusion, FractureSource, MaterialFit, Origin, Quantity, Softening, Specimen, Statistic,
};

/// The columns that were read, the specimens, and the numbers of the law with their scatter.
pub fn tables(fit: &MaterialFit) -> [Table; 3] {
    [column_table(&fit.specimens), specimen_table(&fit.specimens), law_table(fit)]
}

/// The columns that were read, one a row.
fn column_table(specimens: &[Specimen]) -> Table {
    let mut table = Table::new(["specimen", "read as", "column", "name", "unit", "factor"]);
    for specimen in specimens {
        for column in &specimen.read_as {
            table.row([
                file_name(specimen),
                column.quantity.to_string(),
                column.number.to_string(),
                column.name.clone(),
                column.unit.clone().unwrap_or("not stated".into()),
                match &*column.quantity.own_unit() {
                    "1" => column.factor.to_string(),
                    unit => format!("{} {unit}", column.factor),
                },
            ]);
        }
    }
    table
}

fn file_name(specimen: &Specimen) -> String {
    let name = specimen.path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// The specimens, one a row.
fn specimen_table(specimens: &[Specimen]) -> Table {
    let mut table = Table::new([
        "specimen",
        "rows",
        "toe",
        "unloading",
        "broken",
        "averaged",
        "toe, %",
        "linear, %",
        "E, MPa",
        "Rp0.2, MPa",
        "Rm, MPa",
        "upper, MPa",
        "plateau, MPa",
        "draw ratio",
    ]);
    for it in specimens {
        let draw = |value: fn(&tensile::Draw) -> f64, digits: usize| {
            Cell::fixed(it.draw.as_ref().map(value), digits)
        };
        let [from, to] = it.linear.strain.map(|strain| 100.0 * strain);
        table.row([
            Cell::text(file_name(it)),
            Cell::text(it.rows),
            Cell::text(it.dropped_for(Exclusion::Toe)),
            Cell::text(it.dropped_for(Exclusion::Unloading)),
            Cell::text(it.dropped_for(Exclusion::Broken)),
            Cell::text(it.averaged),
            Cell::fixed(100.0 * it.toe, 3),
            Cell::text(format!("{from:.3} to {to:.3}")),
            Cell::text(format!("{:.0} ± {:.0}", it.linear.young, it.linear.error)),
            Cell::fixed(it.offset_yield, 2),
            Cell::fixed(it.strength, 2),
            draw(|draw| draw.upper_yield, 2),
            draw(|draw| draw.plateau, 2),
            draw(|draw| draw.draw_ratio, 3),
        ]);
    }
    table
}

/// The numbers of the law with their scatter.
fn law_table(fit: &MaterialFit) -> Table {
    let mut table = Table::new(["law", "mean", "standard deviation"]);
    let mut row = |name: &str, of: &Statistic, digits: usize| {
        let [mean, deviation] = [Some(of.mean), of.deviation];
        table.row([Cell::text(name), Cell::fixed(mean, digits), Cell::fixed(deviation, digits)]);
    };
    row("Young's modulus, MPa", &fit.young, 0);
    row("offset yield Rp0.2, MPa", &fit.offset_yield, 2);
    for (name, of, digits) in [
        ("upper yield, MPa", &fit.upper_yield, 2),
        ("draw plateau, MPa", &fit.plateau, 2),
        ("natural draw ratio", &fit.draw_ratio, 3),
    ] {
        if let Some(of) = of {
            row(name, of, digits);
        }
    }
    let fracture = Statistic { mean: fit.fracture_strain, deviation: fit.fracture_scatter };
    row("fracture strain (true, plastic)", &fracture, 4);
    table
}

/// What a user must know about the law, one sentence each.
pub fn notes(fit: &MaterialFit) -> Vec<String> {
    let mut notes = units_taken(&fit.specimens);
    notes.extend(fit.specimens.iter().flat_map(stated));
    notes.extend(fit.specimens.iter().filter_map(softens));
    notes.push(format!(
        "the table has {} rows and deviates from the mean curve by at most {:.2} %",
        fit.table.len(),
        100.0 * fit.table_deviation
    ));
    let ends = |origin| {
        let mut rows = fit.curve.iter().filter(|row| row.origin == origin);
        rows.clone().next().zip(rows.next_back()).map(|(first, last)| [first.strain, last.strain])
    };
    if let Some([from, to]) = ends(Origin::Drawn) {
        notes.push(format!(
            "between the plastic strains {from:.3} and {to:.3} a neck runs along the specimen and the record is not \
             local: the curve there is constructed, such that its work equals the work of the machine"
        ));
    }
    if let Some(yields) = fit.cut_yield {
        notes.push(format!(
            "the upper yield is cut to the mean true stress of the draw, {yields:.2} MPa: a hardening table does not soften"
        ));
    }
    if let Some([_, to]) = ends(Origin::Extrapolated) {
        notes.push(format!(
            "beyond the maximum force the curve is extrapolated to {to:.3} by Considere's tangent, an upper bound"
        ));
    }
    if fit.young_given {
        let measured = Statistic::new(fit.specimens.iter().map(|specimen| specimen.linear.young));
        let removed = fit.specimens.iter().any(|specimen| specimen.compliance != 0.0);
        notes.push(format!(
            "the records have a mean slope of {:.0} MPa; {}",
            measured.mean,
            if removed {
                "the difference to the given modulus is removed as the compliance of the machine"
            } else {
                "it is not corrected (an extensometer, or too few rows), and the given modulus is the slope to Rp0.2"
            }
        ));
    }
    notes.push(match fit.fracture_source {
        FractureSource::MaximumForce => {
            "the fracture strain is that at the maximum force, a lower bound: measure the \
             broken section and give --fracture-strain, ln(A0 / A)"
                .into()
        }
        source => format!("fracture strain: {}", source.words()),
    });
    notes
}

/// The dimensions that the file of a specimen states, and what is not used, one note each.
fn stated(specimen: &Specimen) -> Vec<String> {
    let sizes: Vec<String> = specimen.stated.iter().map(ToString::to_string).collect();
    let note = |says: &str, what: &[String]| {
        let name = file_name(specimen);
        (!what.is_empty()).then(|| format!("{name}{says}: {}", what.join("; ")))
    };
    let notes = [note(" states the dimensions used", &sizes), note(", not used", &specimen.unused)];
    notes.into_iter().flatten().collect()
}

/// What softening means for the hinge, which the law cannot have.
fn softens(specimen: &Specimen) -> Option<String> {
    let Softening { rows, ends: [top, end] } = specimen.softening?;
    Some(format!(
        "{} softens from {:.2} MPa at a strain of {:.2} % to {:.2} MPa at {:.2} %: these {rows} rows are not used, because a \
         hardening table does not soften. A hinge of this law is too stiff there, and without --fracture-strain it is said to \
         tear where the specimen begins to neck",
        file_name(specimen),
        top[1],
        100.0 * top[0],
        end[1],
        100.0 * end[0]
    ))
}

/// Fewest rows from which a modulus is taken without a word.
const FEW_ROWS: usize = 5;
/// Largest standard error of a modulus, and largest distance to the median of the specimens, over
/// the modulus.
const DOUBTFUL: f64 = 0.1;

/// Measured moduli from few rows, with a large error, or far from the moduli of the other
/// specimens; one sentence each.
pub fn doubtful_moduli(fit: &MaterialFit) -> Vec<String> {
    let mut moduli: Vec<f64> = fit.specimens.iter().map(|it| it.linear.young).collect();
    moduli.sort_by(f64::total_cmp);
    let median = moduli[moduli.len() / 2];
    let doubt = |it: &Specimen| {
        let (linear, name) = (&it.linear, file_name(it));
        let reason = if (linear.young / median - 1.0).abs() > DOUBTFUL {
            format!("the median of the specimens is {median:.0} MPa")
        } else if linear.rows < FEW_ROWS || linear.error > DOUBTFUL * linear.young {
            format!("it is from {} rows", linear.rows)
        } else {
            return None;
        };
        Some(format!(
            "the modulus of {name} is {:.0} ± {:.0} MPa (standard error), and {reason}: state it with --young, export \
             the record without thinning, or leave it out",
            linear.young, linear.error
        ))
    };
    let of_records = fit.specimens.iter().filter(|_| !fit.young_given);
    of_records.filter_map(doubt).collect()
}

/// The units that no file and no option states, one note a quantity.
fn units_taken(specimens: &[Specimen]) -> Vec<String> {
    let mut taken: Vec<(Quantity, Vec<String>)> = Vec::new();
    for specimen in specimens {
        for column in specimen.read_as.iter().filter(|it| it.unit.is_none()) {
            match taken.iter_mut().find(|(of, _)| *of == column.quantity) {
                Some((_, files)) => files.push(file_name(specimen)),
                None => taken.push((column.quantity, vec![file_name(specimen)])),
            }
        }
    }
    let note = |(quantity, files): &(Quantity, Vec<String>)| {
        format!(
            "no unit of the {quantity} is stated in {}: taken as {}; --units {quantity}=UNIT states another",
            files.join(", "),
            quantity.own_unit()
        )
    };
    taken.iter().map(note).collect()
}
