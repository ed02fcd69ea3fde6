//! Reading TOML configuration files. An unknown key is an error that names the most similar known
//! key; an array with more elements than its type has is an error.

use crate::nearest::nearest;
use crate::text_file;
use crate::{Fault, unread};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Value};

/// A hint at decimal commas.
const DECIMAL_POINT: &str = "the decimal sign is a point (40.5, not 40,5)";

/// Reads a TOML file into `T`, which should deny unknown fields. An error names the file, the line
/// and the key.
pub fn read<T: DeserializeOwned + Serialize>(path: &Path) -> Result<T, Fault> {
    let text = text_file::read(path).map_err(unread(path))?;
    parse(&text, path)
}

/// Parses TOML text; errors name `path`.
pub fn parse<T: DeserializeOwned + Serialize>(text: &str, path: &Path) -> Result<T, Fault> {
    let located = |message: &str, start: usize| {
        let line = 1 + text[..start].matches('\n').count();
        let what = match unknown_field(message) {
            Some((key, known)) => {
                let near = nearest(&key, known.iter().map(String::as_str));
                let near = near.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
                format!("unknown key `{key}`{near}")
            }
            None => plain(message, text.lines().nth(line - 1).unwrap_or_default()),
        };
        fault!("{}:{line}: {what}", path.display())
    };
    let refused = |error: toml::de::Error| {
        let start = error.span().map_or(0, |span| span.start);
        located(error.message(), start)
    };
    let config: T = toml::from_str(text).map_err(refused)?;
    let given = DeTable::parse(text).map_err(refused)?;
    // What was read from TOML can be written as TOML.
    let read = Value::try_from(&config).ok();
    match read.and_then(|read| longer_table(given.get_ref(), &read)) {
        None => Ok(config),
        Some((start, [expected, found])) => Err(located(
            &format!(
                "an array of {expected} has {found} elements: remove those too many; {DECIMAL_POINT}"
            ),
            start,
        )),
    }
}

/// The place of the first array in a file that has more elements than were read, and both numbers.
/// A type with N elements reads the first N of them: decimal commas, `force = [40,5, 0,0]`, would
/// be read as `[40, 5]`.
fn longer_array(given: &Spanned<DeValue>, read: &Value) -> Option<(usize, [usize; 2])> {
    match (given.get_ref(), read) {
        (DeValue::Table(given), read) => longer_table(given, read),
        (DeValue::Array(all), Value::Array(read)) if all.len() > read.len() => {
            Some((given.span().start, [read.len(), all.len()]))
        }
        (DeValue::Array(given), Value::Array(read)) => {
            let mut pairs = given.iter().zip(read);
            pairs.find_map(|(given, read)| longer_array(given, read))
        }
        _ => None,
    }
}

fn longer_table(given: &DeTable, read: &Value) -> Option<(usize, [usize; 2])> {
    given.iter().find_map(|(key, given)| longer_array(given, read.get(key.get_ref().as_ref())?))
}

/// The message of the parser about a line, without the terms of Rust, with the key and a hint at
/// decimal commas.
fn plain(message: &str, line: &str) -> String {
    let mut words: Vec<&str> = message.split(' ').collect();
    for word in &mut words {
        *word = match *word {
            "f64" | "f32" => "a number",
            "usize" | "u64" | "u32" | "u16" | "u8" => "a whole number that is not negative",
            "i64" | "i32" => "a whole number",
            "bool" => "true or false",
            word => word,
        };
    }
    let (key, value) = line.split_once('=').unwrap_or_default();
    // The span of a missing key is another line.
    let key = match key.trim() {
        key if key.is_empty() || message.starts_with("missing") => String::new(),
        key => format!("`{key}`: "),
    };
    // One number: in an array the comma separates two numbers.
    let value = value.split('#').next().unwrap_or_default().trim();
    let number = value.split_once(',').is_some_and(|(whole, rest)| {
        let digits =
            |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        digits(whole.trim_start_matches(['-', '+'])) && digits(rest)
    });
    let mut plain = format!("{key}{}", words.join(" "));
    if number {
        plain += &format!("; {DECIMAL_POINT}");
    }
    if let Some(character) = text_file::unlike_its_looks(line) {
        plain += &format!(
            "; the line contains {character}, which is not what it looks like: type it again"
        );
    }
    plain
}

/// The unknown key and the known keys from serde's message "unknown field `x`, expected one of `a`,
/// `b`".
fn unknown_field(message: &str) -> Option<(String, Vec<String>)> {
    let mut quoted =
        message.strip_prefix("unknown field ")?.split('`').skip(1).step_by(2).map(str::to_owned);
    Some((quoted.next()?, quoted.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::{Deserialize, Serialize};

    #[derive(Debug, Serialize, Deserialize)]
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
        let refused = parse::<Film>(text, Path::new("film.toml"));
        refused.unwrap_err().to_string()
    }

    #[test]
    fn a_file_is_read() {
        let film: Film = parse(FILM, Path::new("film.toml")).unwrap();
        assert_eq!(film.poisson, 0.4);
    }

    #[test]
    fn the_error_for_an_unknown_key_names_its_line_and_the_nearest_key() {
        let unknown = "film.toml:2: unknown key `thicknes`; did you mean `thickness`?";
        assert_eq!(message(&FILM.replace("thickness", "thicknes")), unknown);
    }

    #[test]
    fn an_array_with_decimal_commas_is_refused_wherever_it_stands() {
        #[derive(Debug, PartialEq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        enum Shape {
            Circle { centre: [f64; 2] },
            Line([f64; 1]),
        }
        #[derive(Debug, Serialize, Deserialize)]
        struct Scene {
            size: [f64; 2],
            range: Option<[f64; 2]>,
            shape: Option<Shape>,
            #[serde(default)]
            rows: Vec<[f64; 2]>,
        }
        let read = |text: &str| parse::<Scene>(text, Path::new("scene.toml"));
        let whole = "size = [1, 2]\nrange = [0.5, 1.0]\nrows = [[1, 2], [3, 4], [5, 6]]\n[shape.circle]\ncentre = [1, 2]\n";
        let scene = read(whole).unwrap();
        assert_eq!((scene.size, scene.rows.len()), ([1.0, 2.0], 3));
        assert_eq!(scene.range, Some([0.5, 1.0]));
        let centre = [1.0, 2.0];
        assert_eq!(scene.shape, Some(Shape::Circle { centre }));
        let line = read("size = [1, 2]\nshape.line = [3]\n").unwrap();
        assert_eq!(line.shape, Some(Shape::Line([3.0])));
        let circle = "[shape.circle]\ncentre = [1, 2]";
        for (from, to, line, counts) in [
            ("size = [1, 2]", "size = [1,5, 2,5]", 1, "of 2 has 4"),
            ("range = [0.5, 1.0]", "range = [0,5, 1]", 2, "of 2 has 3"),
            ("[3, 4], ", "[3, 4, 4], ", 3, "of 2 has 3"),
            ("centre = [1, 2]", "centre = [1, 2, 3]", 5, "of 2 has 3"),
            (circle, "shape.line = [1, 2]", 4, "of 1 has 2"),
        ] {
            let message = read(&whole.replace(from, to)).unwrap_err().to_string();
            let place = format!("scene.toml:{line}: ");
            assert!(message.starts_with(&place), "{message}");
            let numbers = message.contains(counts) && message.contains("40.5");
            assert!(numbers, "{message}");
        }
        let short = read("size = [1]").unwrap_err().to_string();
        assert!(short.contains("length 1"), "{short}");
    }

    /// Text that is copied from a page has them.
    #[test]
    fn characters_that_look_like_others_are_shown() {
        for (from, to, shown) in
            [("\"film\"", "“film”", "`“` (U+201C)"), ("poisson = ", "poisson\u{a0}= ", "(U+00A0)")]
        {
            let message = message(&FILM.replace(from, to));
            assert!(message.contains(shown), "{message}");
        }
    }

    #[test]
    fn errors_for_a_wrong_type_and_a_missing_key_name_the_file() {
        let thin = message(&FILM.replace("0.5", "\"thin\""));
        let text = "film.toml:2: `thickness`: invalid type: string \"thin\", expected a number";
        assert_eq!(thin, text);
        let comma = message(&FILM.replace("0.5", "0,5"));
        assert!(comma.starts_with("film.toml:2: `thickness`: "), "{comma}");
        assert!(comma.ends_with("(40.5, not 40,5)"), "{comma}");
        let missing = message(&FILM.replace("poisson = 0.4\n", ""));
        assert_eq!(missing, "film.toml:1: missing field `poisson`");
    }
}
