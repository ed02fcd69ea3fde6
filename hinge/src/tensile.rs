//! A measured tensile curve (CSV) as the hardening table of a material.
//!
//! Two kinds of columns are understood; lines that start with `#` are comments:
//!
//! | columns | meaning |
//! |---|---|
//! | `true_stress_mpa`, `plastic_strain` | the table itself |
//! | `engineering_stress_mpa`, `engineering_strain` | force over first section, elongation over first length |
//!
//! Engineering values are converted while the specimen is uniform, that is up to the greatest
//! stress (Considere): sigma = s (1 + e), eps_p = ln(1 + e) - sigma / E. The yield stress is that
//! at a plastic strain of 0.2 % (Rp0.2, ISO 6892-1), from where plastic strain is counted. What
//! follows the neck must be measured on it, and given as true stress.

use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Plastic strain at the yield stress Rp0.2.
const OFFSET: f64 = 0.002;
/// Most rows of a converted table; a testing machine records thousands.
const MOST_ROWS: usize = 40;

/// A file that is no tensile curve.
#[derive(Debug, thiserror::Error)]
pub enum TensileError {
    #[error("{path}: {source}", path = .path.display())]
    Read { path: PathBuf, source: csv::Error },
    #[error(
        "{path}: its columns must be true_stress_mpa and plastic_strain, or \
         engineering_stress_mpa and engineering_strain",
        path = .path.display()
    )]
    Columns { path: PathBuf },
    #[error("{path}, line {line}: {what}", path = .path.display())]
    Row {
        path: PathBuf,
        line: u64,
        what: &'static str,
    },
    #[error(
        "{path}: the curve ends before a plastic strain of 0.2 %: is the strain in per cent, or \
         Young's modulus ({young} MPa) too low?",
        path = .path.display()
    )]
    NoYield { path: PathBuf, young: f64 },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    true_stress_mpa: Option<f64>,
    plastic_strain: Option<f64>,
    engineering_stress_mpa: Option<f64>,
    engineering_strain: Option<f64>,
}

/// Reads the hardening table of a material of Young's modulus `young` (MPa): rows [true stress
/// (MPa), true plastic strain].
pub(crate) fn read_tensile(path: &Path, young: f64) -> Result<Vec<[f64; 2]>, TensileError> {
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
    let (mut table, mut engineering) = (Vec::new(), Vec::new());
    for record in reader.into_records() {
        let record = record.map_err(unreadable)?;
        let line = record.position().map_or(0, csv::Position::line);
        let row: Row = record.deserialize(Some(&headers)).map_err(unreadable)?;
        let (rows, pair) = match (
            row.true_stress_mpa.zip(row.plastic_strain),
            row.engineering_stress_mpa.zip(row.engineering_strain),
        ) {
            (Some((stress, strain)), None) => (&mut table, [stress, strain]),
            (None, Some((stress, strain))) => (&mut engineering, [stress, strain]),
            _ => {
                let path = path.to_owned();
                return Err(TensileError::Columns { path });
            }
        };
        if !pair.iter().all(|number| number.is_finite()) {
            return Err(TensileError::Row {
                path: path.to_owned(),
                line,
                what: "a number is not finite",
            });
        }
        rows.push(pair);
    }
    if engineering.is_empty() {
        return Ok(table);
    }
    converted(&engineering, young).ok_or_else(|| TensileError::NoYield {
        path: path.to_owned(),
        young,
    })
}

/// The hardening table of an engineering curve; `None` if it never yields.
fn converted(curve: &[[f64; 2]], young: f64) -> Option<Vec<[f64; 2]>> {
    let greatest = curve.iter().map(|row| row[0]).fold(0.0, f64::max);
    let uniform = curve.iter().position(|row| row[0] >= greatest)?;
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

    fn read(text: &str, young: f64) -> Result<Vec<[f64; 2]>, TensileError> {
        let name = format!("kirigami-tensile-{}", text.len());
        let path = std::env::temp_dir().join(name);
        std::fs::write(&path, text).unwrap();
        read_tensile(&path, young)
    }

    #[test]
    fn a_true_curve_is_the_table() {
        let text = "# comment\ntrue_stress_mpa, plastic_strain\n44.0, 0\n33.6, 0.05\n";
        assert_eq!(read(text, 3000.0).unwrap(), [[44.0, 0.0], [33.6, 0.05]]);
    }

    /// sigma = 200 + 1000 eps_p on a modulus of 70 GPa, recorded as a machine would.
    #[test]
    fn an_engineering_curve_gives_back_the_law_it_was_made_of() {
        let young = 70e3;
        let mut text = "engineering_strain,engineering_stress_mpa\n0,0\n0.001,70\n".to_owned();
        for i in 0..=2000 {
            let plastic = 1e-4 * f64::from(i);
            let stress = 200.0 + 1000.0 * plastic;
            let stretch = (plastic + stress / young).exp();
            text += &format!("{},{}\n", stretch - 1.0, stress / stretch);
        }
        // The specimen necks and breaks.
        text += "0.24,300\n0.26,100\n";
        let table = read(&text, young).unwrap();
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
    fn what_is_no_curve_is_refused_with_the_reason() {
        let cases = [
            ("stress,strain\n1,2\n", "unknown field"),
            (
                "true_stress_mpa,engineering_strain\n1,2\n",
                "its columns must be",
            ),
            (
                "true_stress_mpa,plastic_strain\n44,nan\n",
                "line 2: a number is not finite",
            ),
            ("true_stress_mpa,plastic_strain\n44,x\n", "line: 2"),
            (
                "engineering_stress_mpa,engineering_strain\n0,0\n30,0.01\n",
                "ends before a plastic strain",
            ),
        ];
        for (text, expected) in cases {
            let message = read(text, 3000.0).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let missing = read_tensile(Path::new("/no/such/curve.csv"), 3000.0).unwrap_err();
        assert!(missing.to_string().contains("/no/such/curve.csv"));
    }
}
