//! A measured tensile curve (CSV) as the hardening table of a material.
//!
//! One of two pairs of columns is read; other columns are ignored. Lines that start with `#` are
//! comments.
//!
//! | columns | meaning |
//! |---|---|
//! | `true_stress_mpa`, `plastic_strain` | the hardening table itself |
//! | `engineering_stress_mpa`, `engineering_strain` | force over initial section, elongation over initial length |
//!
//! Engineering values are converted up to the maximum stress, where necking begins (Considere):
//! sigma = s (1 + e), eps_p = ln(1 + e) - sigma / E. The yield stress is the stress at a plastic strain of 0.2 %
//! (Rp0.2, ISO 6892-1); plastic strain is counted from there. Data beyond necking must be measured on the neck
//! and given as true stress. A curve whose initial slope is not Young's modulus is rejected: it is in other
//! units, or it contains a toe region or the compliance of the testing machine.

use std::path::{Path, PathBuf};

/// Plastic strain at the yield stress Rp0.2.
const OFFSET: f64 = 0.002;
/// Maximum number of rows of a converted table; a testing machine records thousands.
const MOST_ROWS: usize = 40;
/// Fraction of the maximum stress up to which the initial slope is measured.
const FIRST_SHARE: f64 = 0.2;
/// Maximum factor between the initial slope and Young's modulus; wrong units give factors of 100 and more.
const SLOPE_FACTOR: f64 = 2.0;
/// Maximum decrease of the strain from one row to the next: the noise of an extensometer.
const NOISE: f64 = 1e-3;
/// Maximum strain accepted (dimensionless, not per cent).
const GREATEST_STRAIN: f64 = 10.0;

/// A file that is not a valid tensile curve.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum TensileError {
    #[error("{path}: {source}", path = .path.display())]
    Read { path: PathBuf, source: csv::Error },
    #[error(
        "{path} has the columns {found}: name either true_stress_mpa and plastic_strain, or \
         engineering_stress_mpa and engineering_strain, in the first line, separated by commas",
        path = .path.display()
    )]
    Columns { path: PathBuf, found: String },
    #[error("{path}:{line}: {what}", path = .path.display())]
    Row {
        path: PathBuf,
        line: u64,
        what: String,
    },
    #[error("{path} has no rows", path = .path.display())]
    Empty { path: PathBuf },
    #[error(
        "{path}: the initial slope is {slope:.3e} MPa, but young = {young:.3e} MPa: is the strain in \
         per cent, is the stress not in MPa, or does the curve contain a toe region or the machine's compliance?",
        path = .path.display()
    )]
    Slope {
        path: PathBuf,
        slope: f64,
        young: f64,
    },
    #[error(
        "{path} ends before a plastic strain of 0.2 %: it contains no hardening data",
        path = .path.display()
    )]
    NoYield { path: PathBuf },
}

/// Reads the hardening table of a material of Young's modulus `young` (MPa): rows [true stress
/// (MPa), true plastic strain].
pub(crate) fn read_tensile(path: &Path, young: f64) -> Result<Vec<[f64; 2]>, TensileError> {
    let (rows, is_engineering) = read_rows(path)?;
    if rows.is_empty() {
        let path = path.to_owned();
        return Err(TensileError::Empty { path });
    }
    if !is_engineering {
        return Ok(rows);
    }
    let slope = first_slope(&rows);
    if !(young / SLOPE_FACTOR..=young * SLOPE_FACTOR).contains(&slope) {
        return Err(TensileError::Slope {
            path: path.to_owned(),
            slope,
            young,
        });
    }
    converted(&rows, young).ok_or_else(|| TensileError::NoYield {
        path: path.to_owned(),
    })
}

/// Rows [stress, strain], and whether they are engineering values.
fn read_rows(path: &Path) -> Result<(Vec<[f64; 2]>, bool), TensileError> {
    let unreadable = |source| TensileError::Read {
        path: path.to_owned(),
        source,
    };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_path(path)
        .map_err(unreadable)?;
    let headers = reader.headers().map_err(unreadable)?.clone();
    let place = |name| headers.iter().position(|header| header == name);
    let table = place("true_stress_mpa").zip(place("plastic_strain"));
    let engineering = place("engineering_stress_mpa").zip(place("engineering_strain"));
    let ((stress, strain), is_engineering) = match (table, engineering) {
        (Some(columns), None) => (columns, false),
        (None, Some(columns)) => (columns, true),
        _ => {
            return Err(TensileError::Columns {
                path: path.to_owned(),
                found: headers.iter().collect::<Vec<_>>().join(", "),
            });
        }
    };
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for record in reader.into_records() {
        let record = record.map_err(unreadable)?;
        let refuse = |what| TensileError::Row {
            path: path.to_owned(),
            line: record.position().map_or(0, csv::Position::line),
            what,
        };
        let number = |column| {
            let text = record.get(column).unwrap_or_default();
            let number = text.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| refuse(format!("`{text}` is not a number")))
        };
        let row = [number(stress)?, number(strain)?];
        if !(-0.1..=GREATEST_STRAIN).contains(&row[1]) {
            return Err(refuse(format!(
                "strain = {} violates -0.1 <= strain <= {GREATEST_STRAIN}: is it in per cent?",
                row[1]
            )));
        }
        if rows.last().is_some_and(|before| row[1] < before[1] - NOISE) {
            return Err(refuse(
                "the strain decreases from the row before: sort the rows by strain".into(),
            ));
        }
        rows.push(row);
    }
    Ok((rows, is_engineering))
}

/// Slope (MPa) from the first row to the first row whose stress is higher by a fifth of the maximum stress; NaN for
/// a curve without slope.
fn first_slope(curve: &[[f64; 2]]) -> f64 {
    let maximum = curve.iter().map(|row| row[0]).fold(0.0, f64::max);
    let start = curve[0];
    let risen = curve
        .iter()
        .find(|row| row[0] >= start[0] + FIRST_SHARE * maximum);
    risen.map_or(f64::NAN, |row| (row[0] - start[0]) / (row[1] - start[1]))
}

/// The hardening table of an engineering curve; `None` if the curve does not reach the yield stress.
fn converted(curve: &[[f64; 2]], young: f64) -> Option<Vec<[f64; 2]>> {
    let maximum = curve.iter().map(|row| row[0]).fold(0.0, f64::max);
    let uniform = curve.iter().position(|row| row[0] >= maximum)?;
    let true_curve: Vec<_> = curve[..=uniform]
        .iter()
        .map(|[stress, strain]| {
            let stress = stress * (1.0 + strain);
            [stress, strain.ln_1p() - stress / young]
        })
        .collect();
    let yields = true_curve.iter().position(|row| row[1] >= OFFSET)?;
    let onset = match yields.checked_sub(1) {
        Some(before) => {
            let ([s0, e0], [s1, e1]) = (true_curve[before], true_curve[yields]);
            s0 + (s1 - s0) * (OFFSET - e0) / (e1 - e0)
        }
        None => true_curve[yields][0],
    };
    let last = true_curve[uniform][1] - OFFSET;
    let step = last / MOST_ROWS as f64;
    let mut table = vec![[onset, 0.0]];
    for [stress, strain] in &true_curve[yields..] {
        let strain = strain - OFFSET;
        if strain >= table[table.len() - 1][1] + step.max(1e-9) {
            table.push([*stress, strain]);
        }
    }
    Some(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes `text` to a temporary file and reads it as a tensile curve.
    fn read(text: &str, young: f64) -> Result<Vec<[f64; 2]>, TensileError> {
        let digest: u64 = text
            .bytes()
            .fold(7, |sum, b| sum.wrapping_mul(31) + u64::from(b));
        let path = std::env::temp_dir().join(format!("kirigami-tensile-{digest:x}.csv"));
        std::fs::write(&path, text).unwrap();
        let table = read_tensile(&path, young);
        std::fs::remove_file(path).unwrap();
        table
    }

    const YOUNG: f64 = 70e3;

    /// The law sigma = 200 + 1000 eps_p with a modulus of 70 GPa as a testing machine records it, in units of
    /// `stress_unit` MPa and `strain_unit`.
    fn recorded(stress_unit: f64, strain_unit: f64) -> Vec<String> {
        let mut rows = vec![
            "0,0".to_owned(),
            format!("{},{}", 0.001 / strain_unit, 70.0 / stress_unit),
        ];
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
        format!(
            "engineering_strain,engineering_stress_mpa\n{}\n",
            rows.join("\n")
        )
    }

    #[test]
    fn a_true_curve_is_read_unchanged_and_other_columns_are_ignored() {
        let text = "# comment\ntime_s, true_stress_mpa, plastic_strain\n0,44.0, 0\n1,33.6, 0.05\n";
        assert_eq!(read(text, 3000.0).unwrap(), [[44.0, 0.0], [33.6, 0.05]]);
    }

    #[test]
    fn an_engineering_curve_is_converted_to_the_law_that_generated_it() {
        let table = read(&with_header(&recorded(1.0, 1.0)), YOUNG).unwrap();
        assert!(
            (10..=MOST_ROWS + 1).contains(&table.len()),
            "{}",
            table.len()
        );
        assert_eq!(table[0][1], 0.0);
        for [stress, strain] in table {
            let law = 200.0 + 1000.0 * (strain + OFFSET);
            assert!((stress - law).abs() < 0.1, "{stress} {strain}");
            assert!(strain < 0.2);
        }
    }

    #[test]
    fn other_units_and_unsorted_rows_are_rejected() {
        for (stress, strain, expected) in [
            (1.0, 0.01, "per cent"),
            (1.0, 0.001, "per cent"),
            (1000.0, 1.0, "not in MPa"),
            (1e-6, 1.0, "not in MPa"),
        ] {
            let text = with_header(&recorded(stress, strain));
            let message = read(&text, YOUNG).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let mut rows = recorded(1.0, 1.0);
        rows.reverse();
        let message = read(&with_header(&rows), YOUNG).unwrap_err().to_string();
        assert!(message.contains(":3: the strain decreases"), "{message}");
        // The machine's compliance adds half a per cent of strain before yield.
        let soft = ["0,0", "0.004,100", "0.008,200", "0.1,250", "0.2,260"].map(str::to_owned);
        let message = read(&with_header(&soft), YOUNG).unwrap_err().to_string();
        assert!(message.contains("compliance"), "{message}");
    }

    #[test]
    fn an_invalid_curve_is_rejected_with_the_reason() {
        let engineering = "engineering_stress_mpa,engineering_strain";
        for (text, expected) in [
            (
                "stress,strain\n1,2\n".to_owned(),
                "has the columns stress, strain",
            ),
            (
                "true_stress_mpa,engineering_strain\n1,2\n".to_owned(),
                "name either",
            ),
            (
                format!("{engineering},true_stress_mpa,plastic_strain\n1,2,3,4\n"),
                "name either",
            ),
            (
                "true_stress_mpa,plastic_strain\n44,nan\n".to_owned(),
                ":2: `nan` is not",
            ),
            (
                "true_stress_mpa,plastic_strain\n44,\n".to_owned(),
                ":2: `` is not",
            ),
            (
                "true_stress_mpa,plastic_strain\n44,0\n50,60\n".to_owned(),
                "per cent",
            ),
            (format!("{engineering}\n0,0\n30,-2\n"), "violates"),
            (format!("{engineering}\n"), "no rows"),
            (
                format!("{engineering}\n0,0\n30,0.01\n"),
                "ends before a plastic strain",
            ),
        ] {
            let message = read(&text, 3000.0).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let missing = read_tensile(Path::new("/no/such/curve.csv"), 3000.0).unwrap_err();
        assert!(missing.to_string().contains("/no/such/curve.csv"));
    }
}
