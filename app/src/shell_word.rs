//! Paths in the commands that are printed to be copied.

use std::path::Path;

/// A path as one word of a POSIX shell: quoted unless all its characters stand for themselves.
pub fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+,:@%".contains(c);
    if !path.is_empty() && path.chars().all(plain) {
        path
    } else {
        format!("'{}'", path.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn a_shell_reads_the_path_back() {
        assert_eq!(shell_word(Path::new("runs/a-4.toml")), "runs/a-4.toml");
        for path in ["my sheet/a.toml", "it's", "a$HOME;b", "*", "~", ""] {
            let command = format!("printf %s {}", shell_word(Path::new(path)));
            let output = Command::new("sh").args(["-c", &command]).output().unwrap();
            assert_eq!(String::from_utf8(output.stdout).unwrap(), path, "{command}");
        }
    }
}
