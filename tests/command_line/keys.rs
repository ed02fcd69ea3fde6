//! docs/KEYS.md, the reference of every configuration file, is what the types say that read the
//! files. With `KIRIGAMI_WRITE=1` the test writes the page instead.

use crate::common::pages::root;
use clap::{Command, CommandFactory};
use fe_driver::Campaign;
use hinge::SheetMaterial;
use kirigami::cli::Cli;
use output::report::{Rule, rules};
use scene::SceneConfig;
use schemars::{Schema, schema_for};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use support::key_limits::Range;
use train::TrainingConfig;

const HEADING: &str = "# Keys of the configuration files

Written from the types that read the files (`KIRIGAMI_WRITE=1 cargo test --test command_line keys`). An unknown key is an error that names the nearest
known one. Ranges are checked when a file is read; the error states them.
";

fn page() -> String {
    let files: [(&str, &str, Schema); 4] = [
        ("Scene", "configs/scenes", schema_for!(SceneConfig)),
        ("Campaign", "configs/campaigns", schema_for!(Campaign)),
        ("Material", "configs/materials", schema_for!(SheetMaterial)),
        ("Training", "configs/training", schema_for!(TrainingConfig)),
    ];
    let (mut page, mut described) = (HEADING.to_owned(), Described::new());
    for (title, folder, schema) in files {
        writeln!(page, "\n## {title} ({folder})").unwrap();
        file(&mut page, &mut described, title, schema.as_value());
    }
    page
}

/// The titles under which the page describes types so far.
type Described = BTreeMap<String, String>;

/// The keys of a file, its sections, and the values of its enumerations.
fn file(page: &mut String, described: &mut Described, title: &str, schema: &Value) {
    let types = &schema["$defs"];
    let (sections, keys): (Vec<_>, Vec<_>) = properties(schema)
        .partition(|(_, property)| type_name(property).is_some_and(|name| has_keys(&types[name])));
    table(page, keys.into_iter(), schema);
    for (key, property) in sections {
        let name = type_name(property).unwrap_or_default();
        let section = match property["type"].as_str() {
            Some("array") => format!("`[[{key}]]` of a {title}"),
            _ => format!("`[{key}]` of a {title}"),
        }
        .to_lowercase();
        let need = if required(schema, key) { ", required" } else { "" };
        writeln!(page, "\n### {section}{need}\n").unwrap();
        let meaning = text(property);
        if !text(&types[name]).starts_with(meaning.trim_end_matches('.')) {
            writeln!(page, "{meaning}").unwrap();
        }
        if let Some(earlier) = described.get(name) {
            writeln!(page, "The same keys as {earlier}.").unwrap();
            continue;
        }
        describe(page, &types[name]);
        described.insert(name.to_owned(), section);
    }
    for (name, definition) in types.as_object().into_iter().flatten() {
        if !described.contains_key(name) {
            writeln!(page, "\n### {name}\n").unwrap();
            describe(page, definition);
            described.insert(name.clone(), name.clone());
        }
    }
}

/// What a type is, with its keys or values.
fn describe(page: &mut String, definition: &Value) {
    writeln!(page, "{}", text(definition)).unwrap();
    match definition.get("properties") {
        Some(_) => table(page, properties(definition), definition),
        None => choices(page, definition),
    }
}

fn properties(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    schema["properties"].as_object().into_iter().flatten()
}

fn required(schema: &Value, key: &str) -> bool {
    let required = schema["required"].as_array().into_iter().flatten();
    required.into_iter().any(|name| name == key)
}

/// The name of the type of a key, or of the items of its list, if that is not a number or text.
fn type_name(property: &Value) -> Option<&str> {
    let alternatives = property["anyOf"].as_array().into_iter().flatten();
    let mut places = [property, &property["items"]].into_iter().chain(alternatives);
    let name = places.find_map(|place| place["$ref"].as_str())?;
    name.rsplit('/').next()
}

/// Whether a type has keys of its own.
fn has_keys(definition: &Value) -> bool {
    let alternatives = definition["oneOf"].as_array().into_iter().flatten();
    std::iter::once(definition).chain(alternatives).any(|it| it.get("properties").is_some())
}

/// One row a key: its type, its range, its default or whether it must be given, its meaning.
fn table<'a>(
    page: &mut String,
    keys: impl Iterator<Item = (&'a String, &'a Value)>,
    schema: &Value,
) {
    writeln!(page, "\n| key | value | default | meaning |\n|---|---|---|---|").unwrap();
    for (key, property) in keys {
        let default = match property.get("default") {
            _ if required(schema, key) => "required".to_owned(),
            None | Some(Value::Null) => String::new(),
            Some(default) => format!("`{default}`"),
        };
        let (kind, range, meaning) = (kind(property), range(property), text(property));
        let comma = if range.is_empty() { "" } else { ", " };
        writeln!(page, "| `{key}` | {kind}{comma}{range} | {default} | {meaning} |").unwrap();
    }
}

/// The range of a number, or of the numbers of a list, also as one of several types.
fn range(property: &Value) -> String {
    let range = Range::of_schema(property).to_string();
    if range.is_empty() && property.get("items").is_some() {
        return self::range(&property["items"]);
    }
    let mut alternatives = property["anyOf"].as_array().into_iter().flatten().map(self::range);
    let stated = alternatives.find(|range| !range.is_empty());
    stated.unwrap_or(range)
}

/// The alternatives of an enumeration.
fn choices(page: &mut String, schema: &Value) {
    let alternatives = ["oneOf", "anyOf"].iter().find_map(|key| schema[key].as_array());
    if let Some(names) = schema["enum"].as_array() {
        writeln!(page, "\nOne of {}.", quoted(names)).unwrap();
    }
    for alternative in alternatives.into_iter().flatten() {
        if let Some(name) = alternative.get("const") {
            writeln!(page, "- `{name}`: {}", text(alternative)).unwrap();
        } else if let Some(names) = alternative["enum"].as_array() {
            writeln!(page, "- one of {}", quoted(names)).unwrap();
        }
        for (key, value) in properties(alternative) {
            writeln!(page, "- `{key}`: {}", text(alternative)).unwrap();
            if value.get("properties").is_some() {
                table(page, properties(value), value);
                writeln!(page).unwrap();
            }
        }
    }
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
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|")
}

/// The type of a value in words.
fn kind(schema: &Value) -> String {
    if schema.get("$ref").is_some() {
        let name = type_name(schema).unwrap_or_default();
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(all) = schema["anyOf"].as_array() {
        let not_null = all.iter().filter(|schema| schema["type"] != "null");
        let kinds: Vec<String> = not_null.map(kind).collect();
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
            many + &kind(&schema["items"])
        }
        name => name.to_owned(),
    }
}

#[test]
fn the_page_of_keys_is_what_the_types_say() {
    let path = root().join("docs/KEYS.md");
    let page = page();
    if std::env::var_os("KIRIGAMI_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let shipped = std::fs::read_to_string(path).unwrap();
    assert!(shipped == page, "run `KIRIGAMI_WRITE=1 cargo test --test command_line keys`");
}

/// The commands of docs/COMMANDS.md, as their help has them.
fn command_table() -> String {
    let mut table = "| command | what it does |\n|---|---|\n".to_owned();
    let program = Cli::command();
    program.get_subcommands().for_each(|command| commands(&mut table, "", command));
    table
}

/// A row for a command, or for each of its subcommands.
fn commands(table: &mut String, parent: &str, command: &Command) {
    let name = format!("{parent}{}", command.get_name());
    if command.has_subcommands() {
        let parent = format!("{name} ");
        command.get_subcommands().for_each(|command| commands(table, &parent, command));
    } else {
        writeln!(table, "| `{name}` | {} |", command.get_about().unwrap()).unwrap();
    }
}

/// Asserts that a page has a table, which begins with the same heading.
fn assert_table(page: &str, table: &str) {
    let path = root().join(page);
    let text = std::fs::read_to_string(&path).unwrap();
    let begin = text.find(table.lines().next().unwrap()).unwrap();
    let length = text[begin..].find("\n\n").unwrap() + 1;
    if std::env::var_os("KIRIGAMI_WRITE").is_some() {
        let mut text = text.clone();
        text.replace_range(begin..begin + length, table);
        std::fs::write(path, text).unwrap();
    } else {
        let run = "run `KIRIGAMI_WRITE=1 cargo test --test command_line keys`";
        assert!(&text[begin..begin + length] == table, "{page}: {run}");
    }
}

/// The table of docs/WARNINGS.md.
fn rule_table() -> String {
    let mut table = "| finding | meaning | remedy |\n|---|---|---|\n".to_owned();
    for Rule { subject, severity, meaning, remedy, .. } in rules() {
        writeln!(table, "| {severity}: {subject} | {meaning} | {remedy} |").unwrap();
    }
    table
}

#[test]
fn the_page_of_warnings_has_every_rule() {
    assert_table("docs/WARNINGS.md", &rule_table());
}

#[test]
fn the_page_of_commands_has_every_command() {
    assert_table("docs/COMMANDS.md", &command_table());
}
