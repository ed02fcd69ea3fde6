//! A CalculiX that is a script.

use std::io::ErrorKind;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

/// An executable script in `folder` that prints the version 2.20 on request and otherwise runs
/// `body`.
pub fn fake_ccx(folder: &Path, body: &str) -> PathBuf {
    script(folder, "echo 'This is Version 2.20'", body)
}

/// A ccx with the version of the installed one that runs `body` and refuses its input.
pub fn failing_ccx(folder: &Path, body: &str) -> PathBuf {
    script(folder, "ccx -v", &format!("{body}; echo ' *ERROR'; exit 201"))
}

fn script(folder: &Path, version: &str, body: &str) -> PathBuf {
    let path = folder.join("fake-ccx");
    let script = format!("#!/bin/sh\nif [ \"$1\" = -v ]; then {version}; exit; fi\n{body}\n");
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    // A child process that another test has just forked may still have the script open for writing.
    while let Err(error) = Command::new(&path).arg("-v").output() {
        assert_eq!(error.kind(), ErrorKind::ExecutableFileBusy, "{error}");
    }
    path
}
