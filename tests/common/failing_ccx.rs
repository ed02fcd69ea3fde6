//! A CalculiX that fails.

use std::path::{Path, PathBuf};

/// A ccx that prints its version if asked for it, and otherwise runs `body` and refuses its input.
pub fn failing_ccx(folder: &Path, body: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("ccx");
    let script = format!(
        "#!/bin/sh\n[ \"$1\" = -v ] && {{ ccx -v; exit 0; }}\n{body}; echo ' *ERROR'; exit 201\n"
    );
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path
}
