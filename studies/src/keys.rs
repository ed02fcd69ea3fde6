//! `kirigami-studies keys`: docs/KEYS.md, the reference of every configuration file, from the types that read them.

use anyhow::{Context, Result};
use clap::Args;
use design::scene::SceneConfig;
use fe_driver::Campaign;
use hinge::SheetMaterial;
use schemars::{Schema, schema_for};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use support::key_limits::Range;
use train::TrainingConfig;

/// Write the reference of all keys of scenes, campaigns, materials and trainings
#[derive(Args)]
pub struct KeysCommand {
    /// The page to write
    #[arg(long, value_name = "FILE", default_value = "docs/KEYS.md")]
    out: PathBuf,
}

impl KeysCommand {
    pub fn run(&self) -> Result<()> {
        support::whole_file::write(&self.out, page()?.as_bytes())
            .with_context(|| format!("cannot write {}", self.out.display()))
    }
}

const HEADING: &str = "# Keys of the configuration files

Written by `kirigami-studies keys` from the types that read the files. An unknown key is an error that names the nearest
known one. Ranges are checked when a file is read; the error states them.
";

fn page() -> Result<String> {
    let files: [(&str, &str, Schema); 4] = [
        ("Scene", "configs/scenes", schema_for!(SceneConfig)),
        ("Campaign", "configs/campaigns", Campaign::file_schema()),
        (
            "Material",
            "configs/materials",
            SheetMaterial::file_schema(),
        ),
        ("Training", "configs/training", schema_for!(TrainingConfig)),
    ];
    let mut page = Page {
        text: HEADING.to_owned(),
        described: BTreeMap::new(),
    };
    for (title, folder, schema) in files {
        writeln!(page.text, "\n## {title} ({folder})")?;
        let none = Map::new();
        let schema = schema.as_value();
        let definitions = schema["$defs"].as_object().unwrap_or(&none);
        page.file(title, schema, definitions)?;
    }
    Ok(page.text)
}

/// The page, and the types that it describes so far with the titles of their descriptions.
struct Page {
    text: String,
    described: BTreeMap<String, (Value, String)>,
}

impl Page {
    /// The keys of a file, its sections, and the values of its enumerations.
    fn file(&mut self, title: &str, schema: &Value, types: &Map<String, Value>) -> Result<()> {
        let mut titles = BTreeMap::new();
        let mut described = Vec::new();
        for (name, definition) in types {
            let heading = match self.described.get(name) {
                Some((known, heading)) if known == definition => heading.clone(),
                Some(_) => format!("{title} {name}"),
                None => name.clone(),
            };
            titles.insert(name.as_str(), heading);
        }
        let (sections, keys): (Vec<_>, Vec<_>) = properties(schema).partition(|(_, property)| {
            section(property).is_some_and(|name| is_section(&types[name]))
        });
        table(&mut self.text, &titles, keys.into_iter(), schema)?;
        for (key, property) in sections {
            let name = section(property).unwrap_or_default();
            let heading = match property["type"] == "array" {
                true => format!("`[[{key}]]`"),
                false => format!("`[{key}]`"),
            };
            let need = if required(schema, key) {
                ", required"
            } else {
                ""
            };
            writeln!(self.text, "\n### {title}: {heading}{need}\n")?;
            let (meaning, definition) = (text(property), &types[name]);
            let of_type = text(definition);
            if !of_type.starts_with(meaning.trim_end_matches('.')) {
                writeln!(self.text, "{meaning}")?;
            }
            if let Some((known, heading)) = self.described.get(name)
                && known == definition
            {
                writeln!(self.text, "The keys are those of {heading}.")?;
                continue;
            }
            described.push((name, format!("{title}: {heading}")));
            writeln!(self.text, "{of_type}")?;
            match definition.get("properties") {
                Some(_) => table(&mut self.text, &titles, properties(definition), definition)?,
                None => choices(&mut self.text, &titles, definition)?,
            }
        }
        for (name, definition) in types
            .iter()
            .filter(|(_, definition)| !is_section(definition))
        {
            if self
                .described
                .get(name)
                .is_none_or(|(known, _)| known != definition)
            {
                let heading = &titles[name.as_str()];
                writeln!(self.text, "\n### {heading}\n\n{}", text(definition))?;
                choices(&mut self.text, &titles, definition)?;
                described.push((name, heading.clone()));
            }
        }
        for (name, heading) in described {
            let described = (types[name].clone(), heading);
            self.described.insert(name.to_owned(), described);
        }
        Ok(())
    }
}

/// The title of the description of each type.
type Titles<'a> = BTreeMap<&'a str, String>;

fn properties(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    schema["properties"].as_object().into_iter().flatten()
}

fn required(schema: &Value, key: &str) -> bool {
    let required = schema["required"].as_array().into_iter().flatten();
    required.into_iter().any(|name| name == key)
}

/// The type that a key refers to, alone or in a list.
fn section(property: &Value) -> Option<&str> {
    let alternatives = property["anyOf"].as_array().into_iter().flatten();
    let mut places = [property, &property["items"]]
        .into_iter()
        .chain(alternatives);
    let name = places.find_map(|place| place["$ref"].as_str())?;
    name.rsplit('/').next()
}

/// Whether a type has keys of its own.
fn is_section(definition: &Value) -> bool {
    let alternatives = definition["oneOf"].as_array().into_iter().flatten();
    let mut all = std::iter::once(definition).chain(alternatives);
    all.any(|schema| schema.get("properties").is_some())
}

/// One row a key: its type, its range, its default or whether it must be given, its meaning.
fn table<'a>(
    page: &mut String,
    titles: &Titles,
    keys: impl Iterator<Item = (&'a String, &'a Value)>,
    schema: &Value,
) -> Result<()> {
    writeln!(
        page,
        "\n| key | type | range | default | meaning |\n|---|---|---|---|---|"
    )?;
    for (key, property) in keys {
        let default = match property.get("default") {
            _ if required(schema, key) => "required".to_owned(),
            None | Some(Value::Null) => String::new(),
            Some(default) => format!("`{default}`"),
        };
        let (kind, range, meaning) = (kind(titles, property), range(property), text(property));
        writeln!(
            page,
            "| `{key}` | {kind} | {range} | {default} | {meaning} |"
        )?;
    }
    Ok(())
}

/// The range of a number, or of the numbers of a list.
fn range(property: &Value) -> String {
    let range = Range::of_schema(property).to_string();
    if range.is_empty() && property.get("items").is_some() {
        return self::range(&property["items"]);
    }
    // Every integer that is no count of something may be zero.
    if range == "at least 0"
        && property["format"]
            .as_str()
            .is_some_and(|f| f.starts_with("uint"))
    {
        return String::new();
    }
    range
}

/// The alternatives of an enumeration.
fn choices(page: &mut String, titles: &Titles, schema: &Value) -> Result<()> {
    let alternatives = ["oneOf", "anyOf"]
        .iter()
        .find_map(|key| schema[key].as_array());
    if let Some(names) = schema["enum"].as_array() {
        writeln!(page, "\nOne of {}.", quoted(names))?;
    }
    for alternative in alternatives.into_iter().flatten() {
        if let Some(name) = alternative.get("const") {
            writeln!(page, "- `{name}`: {}", text(alternative))?;
        } else if let Some(names) = alternative["enum"].as_array() {
            writeln!(page, "- one of {}", quoted(names))?;
        }
        for (key, value) in properties(alternative) {
            writeln!(page, "- `{key}`: {}", text(alternative))?;
            if value.get("properties").is_some() {
                table(page, titles, properties(value), value)?;
                writeln!(page)?;
            }
        }
    }
    Ok(())
}

fn quoted(names: &[Value]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

/// The documentation of a type or a key on one line.
fn text(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    // The first paragraph: tables and notes of the sources do not fit into a cell.
    let text = text.split("\n\n").next().unwrap_or_default();
    text.split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .replace('|', "\\|")
}

/// The type of a value in words.
fn kind(titles: &Titles, schema: &Value) -> String {
    if let Some(name) = schema["$ref"].as_str() {
        let name = name.rsplit('/').next().unwrap_or(name);
        let anchor = titles[name].to_lowercase().replace(' ', "-");
        return format!("[{name}](#{anchor})");
    }
    if let Some(all) = schema["anyOf"].as_array() {
        let not_null = all.iter().filter(|schema| schema["type"] != "null");
        let kinds: Vec<String> = not_null.map(|schema| kind(titles, schema)).collect();
        return kinds.join(" or ");
    }
    let mut names = match &schema["type"] {
        Value::Array(names) => names.clone(),
        name => vec![name.clone()],
    };
    names.retain(|name| name != "null");
    match names.first().and_then(Value::as_str).unwrap_or("any") {
        "array" => {
            let count = schema.get("minItems");
            let many = match count.filter(|n| schema.get("maxItems") == Some(n)) {
                Some(count) => format!("{count} of "),
                None => "list of ".to_owned(),
            };
            many + &kind(titles, &schema["items"])
        }
        name => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_page_is_current() {
        let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/KEYS.md");
        let shipped = std::fs::read_to_string(shipped).unwrap();
        assert!(shipped == page().unwrap(), "run `kirigami-studies keys`");
    }
}
