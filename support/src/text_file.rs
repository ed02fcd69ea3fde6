//! Texts that people hand in, in the encodings and with the line ends of their programs: UTF-8,
//! UTF-16 with and without a byte order mark, and else Windows-1252, which contains Latin-1.

use crate::regular_file;
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use std::io::{self, ErrorKind};
use std::path::Path;

/// First bytes of files that are no texts, with what they are and the remedy.
const OTHERS: [(&[u8], &str); 12] = [
    (b"PK\x03\x04", "a workbook (xlsx) or another ZIP archive: save its sheet as CSV"),
    (b"\xD0\xCF\x11\xE0", "a workbook (xls): save its sheet as CSV"),
    (b"\x1F\x8B", "compressed by gzip: unpack it with `gunzip`"),
    (b"PAR1", "a Parquet table: write it as CSV"),
    (b"AC10", "a DWG drawing: save it as DXF"),
    (b"AutoCAD Binary DXF", "a binary DXF file: save it as text"),
    (b"%PDF", "a PDF document: export its contents as text, and a drawing as SVG"),
    (b"%!PS", "PostScript (EPS): open it in Inkscape or Illustrator, and save it as SVG"),
    (b"\x89PNG", "a picture (PNG): `init --target` traces it, or trace it and save it as SVG"),
    (
        b"\xFF\xD8\xFF",
        "a picture (JPEG): `init --target` traces it, or trace it and save it as SVG",
    ),
    (
        b"GIF8",
        "a picture (GIF): save it as PNG for `init --target`, or trace it and save it as SVG",
    ),
    (
        b"RIFF",
        "a picture (WebP): save it as PNG for `init --target`; or a drawing of CorelDRAW: save it as SVG",
    ),
];

/// The text of a file, with `\n` at the ends of its lines; an error if it is not a regular file, or
/// no text.
pub fn read(path: &Path) -> io::Result<String> {
    decoded(&regular_file::read(path)?)
}

/// The text in the bytes of a file, with `\n` at the ends of its lines; the error says what else
/// they are.
pub fn decoded(bytes: &[u8]) -> io::Result<String> {
    let refused = |what: &str| Err(io::Error::new(ErrorKind::InvalidData, what));
    if let Some((_, what)) = OTHERS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return refused(&format!("it is {what}"));
    }
    // A mark decides, whatever the encoding is said to be.
    let (text, ..) = encoding(bytes).decode(bytes);
    if text.contains('\0') {
        return refused("it has NUL bytes and is no text: export its contents as text");
    }
    Ok(text.replace("\r\n", "\n").replace('\r', "\n"))
}

/// The encoding of bytes without a byte order mark. In UTF-16 one byte of most letters is zero.
fn encoding(bytes: &[u8]) -> &'static Encoding {
    let zeros = |from: usize| {
        let half = bytes.iter().skip(from).step_by(2);
        4 * half.filter(|byte| **byte == 0).count() > bytes.len()
    };
    match (zeros(0), zeros(1)) {
        (false, true) => UTF_16LE,
        (true, false) => UTF_16BE,
        _ if std::str::from_utf8(bytes).is_ok() => encoding_rs::UTF_8,
        _ => WINDOWS_1252,
    }
}

/// A character that looks like another one or like nothing, with its number, as in `” (U+201D)`: a
/// quotation mark of a web page, a no-break space.
pub fn unlike_its_looks(text: &str) -> Option<String> {
    let looks = |c: &char| {
        let shown = c.escape_debug().count() == 1;
        matches!(c, '\u{2018}'..='\u{201F}' | '\u{2212}') || (!c.is_ascii() && !shown)
    };
    let found = text.chars().find(looks)?;
    Some(format!("`{found}` (U+{:04X})", u32::from(found)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_text_is_read_from_every_encoding_and_line_end() {
        let text = "Größe (mm²)\n1\n2\n";
        let wide = |bytes: fn(u16) -> [u8; 2], mark: &str| {
            let units: Vec<u16> = mark.encode_utf16().chain(text.encode_utf16()).collect();
            units.into_iter().flat_map(bytes).collect::<Vec<u8>>()
        };
        let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
        for bytes in [
            text.as_bytes().to_vec(),
            format!("\u{feff}{text}").into_bytes(),
            text.replace('\n', "\r\n").into_bytes(),
            text.replace('\n', "\r").into_bytes(),
            latin,
            wide(u16::to_le_bytes, ""),
            wide(u16::to_be_bytes, ""),
            wide(u16::to_le_bytes, "\u{feff}"),
            wide(u16::to_be_bytes, "\u{feff}"),
        ] {
            assert_eq!(decoded(&bytes).unwrap(), text, "{bytes:?}");
        }
    }

    #[test]
    fn what_is_no_text_is_named_with_the_way_out() {
        for (bytes, part) in [
            (&b"PK\x03\x04\x14\0"[..], "workbook"),
            (b"\x1F\x8B\x08\0", "gunzip"),
            (b"PAR1\x15\0", "Parquet"),
            (b"1,2\n\0\0\0\x03,4\n", "NUL"),
        ] {
            let message = decoded(bytes).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn characters_that_look_like_others_are_named() {
        let found =
            ["title = “a”", "a\u{a0}= 1", "a = \u{2212}1", "Größe — µ"].map(unlike_its_looks);
        let expected = ["`“` (U+201C)", "`\u{a0}` (U+00A0)", "`\u{2212}` (U+2212)"];
        assert_eq!(found[..3], expected.map(|it| Some(it.to_owned())));
        assert_eq!(found[3], None);
    }
}
