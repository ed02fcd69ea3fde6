//! Reading TOML configuration files. An unknown key is an error that names the most similar known key.

use crate::nearest::nearest;
use crate::regular_file;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// Why a configuration file cannot be read; the message names the file, the line and the key.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum ConfigError {
    #[error("cannot read {path}: {source}", path = .path.display())]
    Read {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error(
        "{path}:{line}: unknown key `{key}`{nearest}",
        path = .path.display(),
        nearest = nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default()
    )]
    UnknownKey {
        path: PathBuf,
        line: usize,
        key: String,
        nearest: Option<String>,
    },
    #[error("{path}:{line}: {message}", path = .path.display())]
    Syntax {
        path: PathBuf,
        line: usize,
        message: String,
    },
}

/// Reads a TOML file into `T`, which should deny unknown fields.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, ConfigError> {
    let text = regular_file::read_to_string(path).map_err(|source| ConfigError::Read {
        path: path.to_owned(),
        source,
    })?;
    parse(&text, path)
}

/// Parses TOML text; errors name `path`.
pub fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|error| {
        let path = path.to_owned();
        let line = error
            .span()
            .map_or(1, |span| 1 + text[..span.start].matches('\n').count());
        match unknown_field(error.message()) {
            Some((key, known)) => ConfigError::UnknownKey {
                path,
                line,
                nearest: nearest(&key, known.iter().map(String::as_str)).map(str::to_owned),
                key,
            },
            None => ConfigError::Syntax {
                path,
                line,
                message: error.message().to_owned(),
            },
        }
    })
}

/// The unknown key and the known keys from serde's message "unknown field `x`, expected one of `a`, `b`".
fn unknown_field(message: &str) -> Option<(String, Vec<String>)> {
    let mut quoted = message
        .strip_prefix("unknown field ")?
        .split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned);
    Some((quoted.next()?, quoted.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Film {
        #[allow(dead_code, reason = "a key that a file may contain")]
        name: String,
        #[allow(dead_code, reason = "a key that a file may contain")]
        thickness: f64,
        poisson: f64,
    }

    const FILM: &str = "name = \"film\"\nthickness = 0.5\npoisson = 0.4\n";

    fn message(text: &str) -> String {
        parse::<Film>(text, Path::new("film.toml"))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn a_file_is_read() {
        let film: Film = parse(FILM, Path::new("film.toml")).unwrap();
        assert_eq!(film.poisson, 0.4);
    }

    #[test]
    fn the_error_for_an_unknown_key_names_its_line_and_the_nearest_key() {
        let message = message(&FILM.replace("thickness", "thicknes"));
        assert_eq!(
            message,
            "film.toml:2: unknown key `thicknes`; did you mean `thickness`?"
        );
    }

    #[test]
    fn errors_for_a_wrong_type_and_a_missing_key_name_the_file() {
        assert!(message(&FILM.replace("0.5", "\"thin\"")).starts_with("film.toml:2: "));
        assert!(message(&FILM.replace("poisson = 0.4\n", "")).contains("missing field `poisson`"));
    }
}
