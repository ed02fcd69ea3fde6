//! What the keys of a scene mean and which numbers they may have, for the fields of a page: from
//! the types that read the scene.

use scene::SceneConfig;
use schemars::schema_for;
use serde_json::Value;
use std::collections::BTreeMap;
use support::key_limits::Range;

/// The meaning and the range of every key, by its path without the numbers of lists, as in
/// `loads.force`.
pub(crate) fn meanings() -> BTreeMap<String, String> {
    let schema = schema_for!(SceneConfig);
    let mut found = BTreeMap::new();
    explain(schema.as_value(), schema.as_value(), "", "", &mut found);
    found
}

/// Adds the keys of a part of a schema; `meaning` is said of the key itself.
fn explain(
    all: &Value,
    part: &Value,
    key: &str,
    meaning: &str,
    found: &mut BTreeMap<String, String>,
) {
    let own = part["description"].as_str().unwrap_or_default();
    let own = own.split("\n\n").next().unwrap_or_default();
    let meaning = if meaning.is_empty() { own } else { meaning };
    if !key.is_empty() && !meaning.is_empty() {
        let said = found.entry(key.to_owned());
        let said = said.or_insert_with(|| meaning.replace('\n', " "));
        let range = Range::of_schema(part).to_string();
        if !range.is_empty() {
            *said = format!("{said} Range: {range}.");
        }
    }
    if let Some(name) = part["$ref"].as_str() {
        let name = name.rsplit('/').next().unwrap_or_default();
        explain(all, &all["$defs"][name], key, meaning, found);
    }
    let alternatives = ["anyOf", "oneOf"].iter();
    let alternatives = alternatives.flat_map(|name| part[name].as_array().into_iter().flatten());
    for inner in alternatives.chain(part.get("items")) {
        explain(all, inner, key, meaning, found);
    }
    for (name, property) in part["properties"].as_object().into_iter().flatten() {
        let name = match key {
            "" => name.clone(),
            key => format!("{key}.{name}"),
        };
        explain(all, property, &name, "", found);
    }
}

#[cfg(test)]
mod tests {
    use super::meanings;

    #[test]
    fn a_key_has_its_meaning_its_unit_and_its_range() {
        let all = meanings();
        for (key, words) in [
            ("thickness", ["(mm)", "Range: 0.02 to 10."]),
            ("sheet.panels", ["olumns", "Range: "]),
            ("drive.stroke", ["(mm", "."]),
            ("target.svg.height", ["(mm)", "Range: "]),
            ("loads.force", ["(N", "."]),
            ("optimiser.steps", ["teps", "Range: "]),
        ] {
            let said = all.get(key).map_or("", |said| said);
            assert!(words.iter().all(|word| said.contains(word)), "{key}: {said}");
            assert!(said.matches("Range:").count() < 2, "{key}: {said}");
        }
    }
}
