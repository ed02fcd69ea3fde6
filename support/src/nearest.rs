//! The known name that a misspelt one probably means.

use crate::Extremes;

/// The name of `known` that is most similar to `name`, if any is similar enough.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.8)
        .largest_by(|(likeness, _)| *likeness)
        .map(|(_, candidate)| candidate)
}

/// What is wrong with the name of a thing, such as a machine, that is none of `known`.
pub fn unknown<'a>(what: &str, name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    let near = nearest(name, known.iter().copied());
    let near = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
    format!("unknown {what} {name}: use {}{near}", known.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_a_letter_is_recognised_and_another_word_is_not() {
        let known = ["panel", "corner", "unit"];
        assert_eq!(nearest("pannel", known), Some("panel"));
        assert_eq!(nearest("cornr", known), Some("corner"));
        assert_eq!(nearest("thickness", known), None);
    }
}
