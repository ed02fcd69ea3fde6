//! Hosts that share the folder of a campaign: the name of this one, and locks where the file system has them.

use nix::errno::Errno;
use std::fs::File;
use std::io;

/// Locks a file by `how`, unless its file system has no locks: they save work, and no result depends on them.
pub(crate) fn lock(file: &File, how: impl Fn(&File) -> io::Result<()>) -> io::Result<()> {
    match how(file) {
        Err(error)
            if error.kind() == io::ErrorKind::Unsupported
                || error.raw_os_error() == Some(Errno::ENOLCK as i32) =>
        {
            Ok(())
        }
        other => other,
    }
}

/// The name of this host, by which the runs that share a folder are distinguished. `KIRIGAMI_HOST` replaces it where
/// host names are not unique.
pub(crate) fn host() -> String {
    let name = std::env::var_os("KIRIGAMI_HOST").or_else(|| nix::unistd::gethostname().ok());
    let name = name.unwrap_or_else(|| "localhost".into());
    name.to_string_lossy().replace('/', "_")
}
