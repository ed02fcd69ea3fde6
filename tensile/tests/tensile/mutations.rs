//! Files with random changes: never a panic, and never a number in the material file that is not
//! finite.

use super::{FILM, HEADER, OPTIONS, VOCE, csv, known, write};
use crate::synthetic::Noise;
use hinge::SheetMaterial;
use tensile::{MaterialFit, RecordOptions, material_file};

/// A text with one to three random changes of bytes and lines.
fn mutated(text: &str, random: &mut Noise) -> Vec<u8> {
    let mut below = |limit: usize| (random.integer() % limit.max(1) as u64) as usize;
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + below(3) {
        let at = below(bytes.len());
        let line = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |i| at + i);
        match below(9) {
            0 => bytes[at] = below(256) as u8,
            1 => bytes[at] = b"0123456789.,;-+eE\t\n\" "[below(21)],
            2 => drop(bytes.drain(at..line)),
            3 => bytes.truncate(at),
            4 => drop(bytes.splice(at..at, bytes[at..line].to_vec())),
            5 => drop(bytes.splice(at..at, b"1e308".iter().copied())),
            6 => drop(bytes.splice(at..at, b"\n0,0\n".iter().copied())),
            7 => drop(bytes.splice(0..0, bytes[at..line].to_vec())),
            _ => bytes[at..line].reverse(),
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

#[test]
fn mutated_files_are_refused_or_give_a_valid_material() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Noise(11);
    let (mut fitted, mut refused) = (0, 0);
    for (law, end, rows, files) in [(VOCE, 0.04, 600, 600), (FILM, 1.4, 2500, 100)] {
        let text = csv(HEADER, &law.record_to(end, rows));
        for _ in 0..files {
            let path = folder.path().join("test.csv");
            std::fs::write(&path, mutated(&text, &mut random)).unwrap();
            let records = [(path, RecordOptions::default())];
            let fit = match MaterialFit::new(&records, &OPTIONS) {
                Ok(fit) => fit,
                Err(error) => {
                    assert!(error.to_string().contains("test.csv"), "{error}");
                    refused += 1;
                    continue;
                }
            };
            fitted += 1;
            if let Ok(material) = fit.material(known()) {
                let text = material_file(&fit, &material, true);
                let path = write(folder.path(), "material.toml", &text);
                assert_eq!(SheetMaterial::load(&path).unwrap(), material, "{text}");
                assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            }
        }
    }
    assert!(fitted > 100 && refused > 100, "{fitted} fitted, {refused} refused");
}
