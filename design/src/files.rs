//! Files that are either whole or absent: written beside their place, then renamed into it.

use std::io;
use std::path::Path;

/// Replaces the file at `path`, whose folder must exist.
pub fn write(path: &Path, contents: &[u8]) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    let beside = path.with_file_name(name);
    std::fs::write(&beside, contents)?;
    std::fs::rename(&beside, path)
}
