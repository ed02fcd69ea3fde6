//! `kirigami-studies keys`: docs/KEYS.md, the reference of every configuration file, from the types that read them.

use anyhow::{Context, Result};
use clap::Args;
use design::scene::SceneConfig;
use fe_driver::Campaign;
use hinge::SheetMaterial;
use schemars::{Schema, schema_for};
use serde_json::{Map, Value};
use std::fmt::Write;
use std::path::PathBuf;
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
    let mut page = HEADING.to_owned();
    for (title, folder, schema) in files {
        writeln!(page, "\n## {title} ({folder})")?;
        let schema = schema.as_value();
        let none = Map::new();
        let definitions = schema["$defs"].as_object().unwrap_or(&none);
        table(&mut page, title, schema)?;
        for (name, definition) in definitions {
            writeln!(page, "\n### {title}: {name}\n\n{}", text(definition))?;
            match definition.get("properties") {
                Some(_) => table(&mut page, title, definition)?,
                None => choices(&mut page, title, definition)?,
            }
        }
    }
    Ok(page)
}

/// One row a key: whether it must be given, its type, its meaning.
fn table(page: &mut String, title: &str, schema: &Value) -> Result<()> {
    let none = Map::new();
    let properties = schema["properties"].as_object().unwrap_or(&none);
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    writeln!(
        page,
        "\n| key | type | default | meaning |\n|---|---|---|---|"
    )?;
    for (key, property) in properties {
        let default = match (
            required.contains(&key.as_str().into()),
            property.get("default"),
        ) {
            (true, _) => "required".to_owned(),
            (false, None | Some(Value::Null)) => String::new(),
            (false, Some(default)) => format!("`{default}`"),
        };
        let meaning = text(property);
        writeln!(
            page,
            "| `{key}` | {} | {default} | {meaning} |",
            kind(title, property)
        )?;
    }
    Ok(())
}

/// The alternatives of an enumeration.
fn choices(page: &mut String, title: &str, schema: &Value) -> Result<()> {
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
        for (key, value) in alternative["properties"].as_object().into_iter().flatten() {
            writeln!(page, "- `{key}`: {}", text(alternative))?;
            if value.get("properties").is_some() {
                table(page, title, value)?;
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
fn kind(title: &str, schema: &Value) -> String {
    if let Some(name) = schema["$ref"].as_str() {
        let name = name.rsplit('/').next().unwrap_or(name);
        let anchor = format!("{title}-{name}").to_lowercase();
        return format!("[{name}](#{anchor})");
    }
    if let Some(all) = schema["anyOf"].as_array() {
        let not_null = all.iter().filter(|it| it["type"] != "null");
        return not_null
            .map(|it| kind(title, it))
            .collect::<Vec<_>>()
            .join(" or ");
    }
    let mut names = match &schema["type"] {
        Value::Array(names) => names.clone(),
        name => vec![name.clone()],
    };
    names.retain(|name| name != "null");
    let name = names.first().and_then(Value::as_str).unwrap_or("any");
    match name {
        "array" => {
            let many = match schema
                .get("minItems")
                .filter(|n| schema.get("maxItems") == Some(n))
            {
                Some(count) => format!("{count} of "),
                None => "list of ".to_owned(),
            };
            many + &kind(title, &schema["items"])
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
