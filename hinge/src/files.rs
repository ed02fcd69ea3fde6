//! Files that are either whole or absent.

use std::io;
use std::path::Path;

/// Writes beside `path`, whose folder must exist, and renames: the path holds the old bytes or
/// the new ones, never a part.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let beside = path.with_added_extension("partial");
    std::fs::write(&beside, bytes)?;
    std::fs::rename(&beside, path)
}
