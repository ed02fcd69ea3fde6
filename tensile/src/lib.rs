//! Tensile tests: from the files of a testing machine to the hardening table of a material; section
//! 4.1.
//!
//! | step | file |
//! |---|---|
//! | text, specimens, columns, units, dimensions | `number_table`, `name`, `quantity`, `preamble`, `record` |
//! | unloading, break, shaking strains | `cleaning`, `isotonic` |
//! | Young's modulus and toe (ISO 527-1, ASTM D638) | `linear_part` |
//! | yield, plateau, natural draw ratio, necking | `landmarks` |
//! | one specimen, its local curve | `specimen`, `local_curve` |
//! | local curve in the neck | `drawing` |
//! | mean over the specimens, table, fracture strain | `mean_curve`, `thinning`, `fit` |
//!
//! A material file may name a clean curve as `tensile_csv`. It is read without corrections: a curve
//! that needs one is rejected, with the advice to use `kirigami material fit`, which reports them.
//!
//! ```
//! use tensile::{FitOptions, MaterialFit, RecordOptions, SpecimenOptions};
//!
//! # let records = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/tensile");
//! let dimensions = RecordOptions {
//!     width: Some(10.0),
//!     thickness: Some(0.5),
//!     gauge_length: Some(50.0),
//!     ..RecordOptions::default()
//! };
//! let options =
//!     FitOptions { specimen: SpecimenOptions::default(), fracture_strain: None, rows: 30 };
//! let fit = MaterialFit::new(&[(records.join("strip-1.csv"), dimensions)], &options)?;
//! assert!((fit.young.mean - 3000.0).abs() < 10.0); // MPa
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

mod cleaning;
mod drawing;
mod error;
mod fit;
mod isotonic;
mod landmarks;
mod linear_part;
mod local_curve;
mod mean_curve;
mod name;
mod number_table;
mod preamble;
mod quantity;
mod record;
mod regression;
mod specimen;
mod thinning;

pub use cleaning::{Cause, DroppedRow};
pub use error::TensileError;
pub use fit::{FitOptions, FractureSource, HardeningRow, MaterialFit, Origin, Statistic};
pub use landmarks::Draw;
pub use linear_part::LinearPart;
pub use preamble::StatedDimension;
pub use quantity::Quantity;
pub use record::{ReadColumn, RecordOptions};
pub use specimen::{End, Softening, Specimen, SpecimenOptions};

use quantity::Quantity::PlasticStrain;
use record::Record;
use std::path::Path;

/// Maximum number of rows of a converted table; a testing machine records thousands.
const MOST_ROWS: usize = 40;
/// Maximum factor between the initial slope and Young's modulus; wrong units give factors of 100
/// and more.
const SLOPE_FACTOR: f64 = 2.0;
/// Maximum toe: a quarter of the offset strain at which the yield stress is defined.
const MAX_TOE: f64 = 5e-4;

/// Reads the hardening table of a material of Young's modulus `young` (MPa): rows [true stress
/// (MPa), true plastic strain].
pub fn read_tensile(path: &Path, young: f64) -> Result<Vec<[f64; 2]>, TensileError> {
    let refuse = |what| TensileError::File { path: path.to_owned(), what };
    let records = Record::read_all(path, &RecordOptions::default())?;
    let [record] = &records[..] else {
        let what =
            format!("has {} specimens: `kirigami material fit` evaluates them", records.len());
        return Err(refuse(what));
    };
    if record.deformation == PlasticStrain {
        return Ok(record.rows.iter().map(|row| [row.stress, row.strain]).collect());
    }
    let young_known = SpecimenOptions { young: Some(young), ..SpecimenOptions::default() };
    let specimen = Specimen::new(record, &young_known)?;
    let fit = "`kirigami material fit` corrects and reports it, and writes the table `plastic`";
    let slope = specimen.linear.young;
    if !(young / SLOPE_FACTOR..=young * SLOPE_FACTOR).contains(&slope) {
        return Err(refuse(format!(
            "has the initial slope {slope:.3e} MPa, but young = {young:.3e} MPa: is the strain in per cent, is the stress \
             not in MPa, or does the curve contain the machine's compliance? {fit}"
        )));
    }
    if specimen.toe.abs() > MAX_TOE {
        return Err(refuse(format!(
            "has a toe: its linear part starts at a strain of {:.2} %, not at zero; {fit}",
            100.0 * specimen.toe
        )));
    }
    if let Some(draw) = &specimen.draw {
        return Err(refuse(format!(
            "has a yield peak of {:.1} MPa and a draw plateau of {:.1} MPa, along which its strain is not the strain of the \
             material; {fit}",
            draw.upper_yield, draw.plateau
        )));
    }
    let (kept, _) = thinning::thinned(&specimen.before, MOST_ROWS);
    Ok(kept.into_iter().map(|row| specimen.before[row]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes `text` to a temporary file and reads it as a tensile curve.
    fn read(text: &str, young: f64) -> Result<Vec<[f64; 2]>, TensileError> {
        let digest = blake3::hash(text.as_bytes()).to_hex();
        let path = std::env::temp_dir().join(format!("kirigami-tensile-{}.csv", &digest[..16]));
        std::fs::write(&path, text).unwrap();
        let table = read_tensile(&path, young);
        std::fs::remove_file(path).unwrap();
        table
    }

    const YOUNG: f64 = 70e3;

    /// The law sigma = 200 + 1000 eps_p with a modulus of 70 GPa as a testing machine records it,
    /// in units of `stress_unit` MPa and `strain_unit`.
    fn recorded(stress_unit: f64, strain_unit: f64) -> Vec<String> {
        let mut rows =
            vec!["0,0".to_owned(), format!("{},{}", 0.001 / strain_unit, 70.0 / stress_unit)];
        for i in 0..=2000 {
            let plastic = 1e-4 * f64::from(i);
            let stress = 200.0 + 1000.0 * plastic;
            let stretch = (plastic + stress / YOUNG).exp();
            let strain = (stretch - 1.0) / strain_unit;
            rows.push(format!("{strain},{}", stress / stretch / stress_unit));
        }
        // The specimen necks and breaks.
        rows.push(format!("{},{}", 0.24 / strain_unit, 300.0 / stress_unit));
        rows.push(format!("{},{}", 0.26 / strain_unit, 100.0 / stress_unit));
        rows
    }

    fn with_header(rows: &[String]) -> String {
        format!("engineering_strain,engineering_stress_mpa\n{}\n", rows.join("\n"))
    }

    #[test]
    fn a_hardening_table_is_read_unchanged_and_other_columns_are_ignored() {
        let text = "# comment\ntime_s, true_stress_mpa, plastic_strain\n0,44.0, 0\n1,33.6, 0.05\n";
        assert_eq!(read(text, 3000.0).unwrap(), [[44.0, 0.0], [33.6, 0.05]]);
    }

    #[test]
    fn an_engineering_curve_is_converted_to_the_law_that_generated_it() {
        let table = read(&with_header(&recorded(1.0, 1.0)), YOUNG).unwrap();
        assert!(table.len() <= MOST_ROWS, "{}", table.len());
        assert_eq!(table[0][1], 0.0);
        for [stress, strain] in table {
            let law = 200.0 + 1000.0 * strain;
            assert!((stress - law).abs() < 0.5, "{stress} {strain}");
            assert!(strain < 0.201);
        }
    }

    /// A toe of 0.3 % moved the yield stress of the law above from 200 to 17 MPa without a message.
    #[test]
    fn a_toe_is_refused_with_the_command_that_corrects_it() {
        // Slack of 0.25 %, a parabola over 0.1 % whose tangent has the slope E, then the elastic
        // line.
        let stress = |strain: f64| match strain - 0.0025 {
            x if x < 0.0 => 0.0,
            x if x < 0.001 => 0.5 * YOUNG * x * x / 0.001,
            x => YOUNG * (x - 0.0005),
        };
        let mut rows: Vec<String> = (0..58)
            .map(|i| 1e-4 * f64::from(i))
            .map(|strain| format!("{strain},{}", stress(strain)))
            .collect();
        rows.extend(recorded(1.0, 1.0).iter().skip(2).map(|row| {
            let (strain, stress) = row.split_once(',').unwrap();
            format!("{},{stress}", strain.parse::<f64>().unwrap() + 0.003)
        }));
        let message = read(&with_header(&rows), YOUNG).unwrap_err().to_string();
        assert!(
            message.contains("has a toe: its linear part starts at a strain of 0.30 %"),
            "{message}"
        );
        assert!(message.contains("kirigami material fit"), "{message}");
    }

    /// The curve of a film that draws was cut at its yield peak without a message.
    #[test]
    fn a_draw_is_refused_with_the_command_that_evaluates_it() {
        let stress = |strain: f64| match strain {
            x if x < 0.016 => 3000.0 * x,
            x if x < 0.1 => (48.0 + 20.0 * (x - 0.016)).min(48.2) - 170.0 * (x - 0.026f64).max(0.0),
            x => 35.62 + 6.0 * (x - 2.0f64).max(0.0),
        };
        let rows = (0..4000).map(|i| 1e-3 * f64::from(i)).map(|e| format!("{e},{}", stress(e)));
        let text = with_header(&rows.collect::<Vec<_>>()).replace("strain,", "strain (1),");
        let message = read(&text, 3000.0).unwrap_err().to_string();
        assert!(message.contains("draw plateau of 35.6 MPa"), "{message}");
        assert!(message.contains("kirigami material fit"), "{message}");
    }

    #[test]
    fn other_units_and_unsorted_rows_are_rejected() {
        for (stress, strain, expected) in [
            (1.0, 0.01, "per cent"),
            (1.0, 0.001, "--units strain=%"),
            (1000.0, 1.0, "in another unit"),
            (1e-6, 1.0, "in Pa"),
        ] {
            let text = with_header(&recorded(stress, strain));
            let message = read(&text, YOUNG).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let mut rows = recorded(1.0, 1.0);
        rows.reverse();
        let message = read(&with_header(&rows), YOUNG).unwrap_err().to_string();
        assert!(message.contains("strain falls"), "{message}");
        // The machine's compliance adds half a per cent of strain before yield.
        let soft = ["0,0", "0.004,100", "0.008,200", "0.1,250", "0.2,260"].map(str::to_owned);
        let message = read(&with_header(&soft), YOUNG).unwrap_err().to_string();
        assert!(message.contains("compliance"), "{message}");
    }

    #[test]
    fn an_invalid_curve_is_rejected_with_the_reason() {
        for (text, expected) in [
            ("wear,tear\n1,2\n", "has the columns 1 `wear`, 2 `tear`"),
            ("true_stress_mpa,engineering_strain\n1,2\n", "no pair of stress"),
            (
                "engineering_stress_mpa,engineering_strain,true_stress_mpa,plastic_strain\n1,2,3,4\n",
                "both engineering and true values",
            ),
            ("true_stress_mpa,plastic_strain\n44,0\n50,60\n", "per cent"),
            ("engineering_stress_mpa,engineering_strain\n0,0\n30,-2\n", "violates"),
        ] {
            let message = read(text, 3000.0).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let missing = read_tensile(Path::new("/no/such/curve.csv"), 3000.0).unwrap_err();
        assert!(missing.to_string().contains("/no/such/curve.csv"));
    }
}
