//! CSV files that people write: cells may stand between spaces, and lines that start with `#` are comments. The first other
//! line decides whether cells are separated by commas, semicolons or tabs.

use crate::file_error::FileError;
use crate::regular_file;
use csv::StringRecord;
use serde::de::DeserializeOwned;
use std::io::{self, Cursor};
use std::path::Path;

/// A reader of the file's rows, and what separates their cells.
pub fn open(path: &Path) -> io::Result<(csv::Reader<Cursor<Vec<u8>>>, u8)> {
    let mut bytes = regular_file::read(path)?;
    // A comment at the end of the file without a line break would be read as a row.
    bytes.push(b'\n');
    let separator = separator(&bytes);
    let reader = csv::ReaderBuilder::new()
        .delimiter(separator)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(Cursor::new(bytes));
    Ok((reader, separator))
}

/// The separator that the first line which is no comment has most of; a comma if it has none.
fn separator(bytes: &[u8]) -> u8 {
    let mut lines = bytes.split(|byte| *byte == b'\n');
    let header = lines.find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"));
    let count = |separator: &u8| {
        let header = header.unwrap_or_default().iter();
        header.filter(|byte| *byte == separator).count()
    };
    // The last of equal counts.
    let [tab, semicolon, comma] = *b"\t;,";
    [tab, semicolon, comma]
        .into_iter()
        .max_by_key(count)
        .unwrap_or(comma)
}

/// The header of the file, and its rows, each with the number of its line.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<(StringRecord, Vec<(u64, T)>), FileError> {
    let rows = || -> Result<_, csv::Error> {
        let (mut reader, _) = open(path)?;
        let header = reader.headers()?.clone();
        let rows = reader.into_records().map(|record| {
            let record = record?;
            let line = record.position().map_or(0, csv::Position::line);
            Ok((line, record.deserialize(Some(&header))?))
        });
        let rows = rows.collect::<Result<_, csv::Error>>()?;
        Ok((header, rows))
    };
    rows().map_err(FileError::at(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_tells_the_separator() {
        let file = tempfile::NamedTempFile::new().unwrap();
        for (text, cells) in [
            ("a,b\n1,2\n", ["1", "2"]),
            ("# a,b,c\n\na;b\n1,5;2\n", ["1,5", "2"]),
            ("a\tb\r\n1,5\t2\r\n", ["1,5", "2"]),
        ] {
            std::fs::write(file.path(), text).unwrap();
            let mut rows = open(file.path()).unwrap().0.into_records();
            assert_eq!(rows.next().unwrap().unwrap(), cells.to_vec(), "{text}");
        }
    }

    #[test]
    fn comments_are_no_rows_also_without_a_last_line_break() {
        let file = tempfile::NamedTempFile::new().unwrap();
        for last in ["", "\n", "# end", "# end\n"] {
            std::fs::write(file.path(), format!("# begin\na, b\n1, 2\n{last}")).unwrap();
            let rows = open(file.path()).unwrap().0.into_records();
            let rows: Vec<_> = rows.map(Result::unwrap).collect();
            assert_eq!(rows, [vec!["1", "2"]], "{last}");
        }
    }
}
