//! CSV files that people write: cells may stand between spaces, and lines that start with `#` are comments.

use crate::regular_file;
use std::io::{self, Cursor};
use std::path::Path;

/// A reader of the file's rows.
pub fn open(path: &Path) -> io::Result<csv::Reader<Cursor<Vec<u8>>>> {
    let mut bytes = regular_file::read(path)?;
    // A comment at the end of the file without a line break would be read as a row.
    bytes.push(b'\n');
    Ok(csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(Cursor::new(bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_no_rows_also_without_a_last_line_break() {
        let file = tempfile::NamedTempFile::new().unwrap();
        for last in ["", "\n", "# end", "# end\n"] {
            std::fs::write(file.path(), format!("# begin\na, b\n1, 2\n{last}")).unwrap();
            let rows = open(file.path()).unwrap().into_records();
            let rows: Vec<_> = rows.map(Result::unwrap).collect();
            assert_eq!(rows, [vec!["1", "2"]], "{last}");
        }
    }
}
