//! Tests the structure stated in docs/ARCHITECTURE.md against the `use` declarations of the
//! sources.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The modules of one crate by their path, with their source text up to the unit tests.
struct Crate {
    name: String,
    sources: BTreeMap<String, String>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn crates() -> Vec<Crate> {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let members = manifest.lines().find(|line| line.starts_with("members"));
    let members = members.unwrap().split('"').skip(1).step_by(2);
    // What tests share is counted with the tests of the root.
    let members = members.filter(|member| *member != "tests/kit");
    (members.chain(["."]))
        .map(|member| Crate::read(member, &root().join(member).join("src")))
        .collect()
}

impl Crate {
    fn read(name: &str, folder: &Path) -> Self {
        let mut sources = BTreeMap::new();
        for path in files(folder) {
            let text = std::fs::read_to_string(&path).unwrap();
            let text = text.split("#[cfg(test)]").next().unwrap().to_owned();
            let module = path.strip_prefix(folder).unwrap().with_extension("");
            sources.insert(module.to_str().unwrap().replace('/', "::"), text);
        }
        let name = name.to_owned();
        Self { name, sources }
    }

    /// The modules that each module imports from; re-exports of a module's own submodules do not
    /// count.
    fn imports(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let imports = |module: &str, text: &str| -> BTreeSet<&str> {
            uses(text)
                .into_iter()
                .flat_map(|(public, tree)| {
                    leaves(&tree).into_iter().map(move |leaf| (public, leaf))
                })
                .filter_map(|(public, leaf)| {
                    Some((public, self.defining(&absolute(module, &leaf)?)?))
                })
                .filter(|(public, other)| !(*public && is_part(module, other)))
                .map(|(_, other)| other)
                .filter(|other| *other != module)
                .collect()
        };
        let modules = self.sources.iter();
        modules.map(|(module, text)| (module.as_str(), imports(module, text))).collect()
    }

    /// The module that defines the item at a path below the crate's root; re-exports are followed.
    fn defining(&self, path: &str) -> Option<&str> {
        let segments: Vec<&str> = path.split("::").collect();
        for length in (0..=segments.len()).rev() {
            let prefix = match length {
                0 => "lib".to_owned(),
                _ => segments[..length].join("::"),
            };
            let Some((module, text)) = self.sources.get_key_value(&prefix) else {
                continue;
            };
            let item = segments.get(length).copied().unwrap_or_default();
            let exported = uses(text).into_iter().filter(|(public, _)| *public);
            let exported = exported.flat_map(|(_, tree)| leaves(&tree));
            let path = exported
                .filter(|leaf| leaf.rsplit("::").next() == Some(item))
                .find_map(|leaf| absolute(module, &leaf));
            return match path.filter(|path| path != &segments.join("::")) {
                Some(path) => self.defining(&path),
                None => Some(module),
            };
        }
        None
    }
}

/// Every Rust file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, others): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let rust = others.into_iter().filter(|path| path.extension().is_some_and(|it| it == "rs"));
    let below = folders.iter().flat_map(|folder| files(folder));
    rust.chain(below).collect()
}

/// The trees of the `use` declarations, and whether they are public.
fn uses(text: &str) -> Vec<(bool, String)> {
    let mut found = Vec::new();
    let mut declaration: Option<(bool, String)> = None;
    for line in text.lines().map(str::trim) {
        if declaration.is_none() {
            let public = line.starts_with("pub");
            let begins = line.strip_prefix("pub use ").or(line.strip_prefix("use "));
            let begins = begins.or_else(|| line.strip_prefix("pub(crate) use "));
            declaration = begins.map(|rest| (public, rest.to_owned()));
        } else if let Some((_, tree)) = &mut declaration {
            tree.push_str(line);
        }
        if let Some((public, tree)) = declaration.take_if(|(_, tree)| tree.ends_with(';')) {
            let tree = without_renames(tree.trim_end_matches(';'));
            found.push((public, tree.replace(' ', "")));
        }
    }
    found
}

/// A tree with the imported names, without their renames.
fn without_renames(tree: &str) -> String {
    let mut pieces = tree.split(" as ");
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces.fold(first, |text, piece| {
        text + piece.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_')
    })
}

/// The paths in a `use` tree.
fn leaves(tree: &str) -> Vec<String> {
    let Some((prefix, rest)) = tree.split_once('{') else {
        return vec![tree.to_owned()];
    };
    let inside = rest.strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in inside.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match (c, depth) {
            (',', 0) => parts.push(String::new()),
            _ => parts.last_mut().unwrap().push(c),
        }
    }
    let named = parts.iter().filter(|part| !part.is_empty());
    named
        .flat_map(|part| leaves(part))
        .map(|leaf| format!("{prefix}{leaf}").trim_end_matches("::self").to_owned())
        .collect()
}

/// A path of this crate relative to its root; `None` for paths of other crates.
fn absolute(module: &str, path: &str) -> Option<String> {
    let inside = |module: &str| match module {
        "lib" | "main" => Vec::new(),
        _ => module.split("::").map(str::to_owned).collect(),
    };
    let mut at: Vec<String> = inside(module);
    let mut segments = path.split("::").peekable();
    match *segments.peek()? {
        "crate" => at.clear(),
        "super" => _ = at.pop(),
        "self" => {}
        first => {
            // A submodule of this module, by its relative path.
            let part = |rest: &str| [at.join("::"), rest.to_owned()].join("::");
            let relative = part(first).trim_start_matches("::").to_owned();
            return Some(relative + path.strip_prefix(first)?).filter(|_| first != "std");
        }
    }
    segments.next();
    at.extend(segments.map(str::to_owned));
    Some(at.join("::"))
}

fn is_part(module: &str, of: &str) -> bool {
    matches!(module, "lib" | "main") || of.starts_with(&format!("{module}::"))
}

/// The modules on circular imports: what remains after repeatedly removing modules without
/// remaining imports.
fn circle<'a>(imports: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> Vec<&'a str> {
    let mut left: BTreeSet<&str> = imports.keys().copied().collect();
    loop {
        let before = left.len();
        let rest = left.clone();
        left.retain(|module| imports[module].iter().any(|other| rest.contains(other)));
        if left.len() == before {
            return left.into_iter().collect();
        }
    }
}

#[test]
fn no_crate_has_circular_imports() {
    for member in crates() {
        let left = circle(&member.imports());
        assert!(left.is_empty(), "{}: circular imports among {left:?}", member.name);
    }
}

/// Each room of a crate imports only from itself and the rooms that the page lists before it.
/// Modules outside the listed rooms are the room with the name of the crate.
#[test]
fn rooms_follow_the_order_of_the_page() {
    let page = std::fs::read_to_string(root().join("docs/ARCHITECTURE.md")).unwrap();
    for name in ["design", "scene"] {
        let beginning = format!("Rooms of `{name}`: ");
        let order = page.lines().find_map(|line| line.strip_prefix(&beginning));
        let order: Vec<&str> = order.unwrap().split('`').skip(1).step_by(2).collect();
        let named = |room: &str| order.iter().position(|other| *other == room);
        let place = |module: &str| named(module.split("::").next()?).or(named(name));
        let member = Crate::read(name, &root().join(name).join("src"));
        for (module, others) in member.imports() {
            let own = place(module);
            assert!(own.is_some() || module == "lib", "{module} is in no room");
            for other in others.into_iter().filter(|_| module != "lib") {
                assert!(
                    place(other).is_some_and(|at| Some(at) <= own),
                    "{module} imports from {other}, which is not listed before it"
                );
            }
        }
    }
}

#[test]
fn no_file_name_occurs_four_times() {
    let mut names: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for member in crates() {
        for module in member.sources.keys().filter(|module| *module != "lib" && *module != "main") {
            let name = module.rsplit("::").next().unwrap().to_owned();
            names.entry(name).or_default().push(format!("{}::{module}", member.name));
        }
    }
    for (name, places) in names {
        assert!(places.len() < 4, "{name}: {places:?}");
    }
}

/// Every test that docs/FAULTS.md names as a proof is a test of the workspace.
#[test]
fn the_tests_that_the_page_of_faults_names_exist() {
    let page = std::fs::read_to_string(root().join("docs/FAULTS.md")).unwrap();
    let mut sources = String::new();
    for folder in std::fs::read_dir(root()).unwrap() {
        for part in ["src", "tests"] {
            let folder = folder.as_ref().unwrap().path().join(part);
            if folder.is_dir() {
                let texts =
                    files(&folder).into_iter().map(|path| std::fs::read_to_string(path).unwrap());
                sources.extend(texts);
            }
        }
    }
    for path in ["src", "tests"].iter().flat_map(|part| files(&root().join(part))) {
        sources.push_str(&std::fs::read_to_string(path).unwrap());
    }
    let cells = page.lines().filter_map(|line| line.strip_prefix("| ")?.rsplit(" | ").next());
    let tests: Vec<&str> = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    assert!(tests.len() > 20);
    for test in tests {
        assert!(sources.contains(&format!("fn {test}(")), "there is no test {test}");
    }
}

/// What the section "Size" of the page allows at most of a thing; its row begins with the name.
fn allowed(page: &str, name: &str) -> usize {
    let (_, section) = page.split_once("\n## Size\n").unwrap();
    let row = (section.lines()).find_map(|line| line.strip_prefix(&format!("| {name} | ")));
    let row = row.unwrap_or_else(|| panic!("docs/ARCHITECTURE.md has no row for {name}"));
    let number = row.trim_end_matches(" |").replace(' ', "");
    number.parse().unwrap_or_else(|_| panic!("{name}: {row}"))
}

/// Whether a file has tests alone.
fn is_test(path: &Path) -> bool {
    let mut parts = path.strip_prefix(root()).unwrap().iter();
    parts.any(|part| part == "tests" || part == "benches" || part == "tests.rs")
}

/// Tokens of a text without its comments: names, numbers, texts, signs other than commas. No format
/// changes their number.
fn tokens(text: &str) -> usize {
    let token =
        r##"(?s)//[^\n]*|/\*.*?\*/|r#*".*?"#*|"(?:\\.|[^"\\])*"|[A-Za-z_]\w*|\d[\w.]*|[^\s\w,]"##;
    let found = regex::Regex::new(token).unwrap();
    let found = found.find_iter(text).map(|token| token.as_str());
    found.filter(|token| !token.starts_with("//") && !token.starts_with("/*")).count()
}

/// Lines of tests of a file, neither blank nor comments.
fn test_lines(path: &Path) -> usize {
    let text = std::fs::read_to_string(path).unwrap();
    let begin = if is_test(path) { 0 } else { text.find("#[cfg(test)]").unwrap_or(text.len()) };
    let lines = text[begin..].lines().map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with("//")).count()
}

/// Whoever needs more raises the table in the same commit and says why in its message.
#[test]
fn the_code_fits_into_the_table_of_the_page() {
    let page = std::fs::read_to_string(root().join("docs/ARCHITECTURE.md")).unwrap();
    let (mut all, mut tests) = (0, 0);
    for member in crates() {
        let folders = ["src", "tests", "benches"].map(|part| root().join(&member.name).join(part));
        let folders = folders.iter().filter(|folder| folder.is_dir());
        tests +=
            folders.flat_map(|folder| files(folder)).map(|file| test_lines(&file)).sum::<usize>();
        let code = member.sources.iter().filter(|(module, _)| !module.ends_with("tests"));
        let code = code.map(|(_, text)| tokens(text)).sum::<usize>();
        let name = if member.name == "." { "kirigami" } else { &member.name };
        let most = allowed(&page, &format!("`{name}`"));
        assert!(code <= most, "{name} has {code} tokens, {most} are allowed");
        all += code;
    }
    for (name, found) in [("all crates", all), ("lines of tests", tests)] {
        let most = allowed(&page, name);
        assert!(found <= most, "{name}: {found}, {most} are allowed");
    }
}

/// The number of long options of a subcommand and of those below it.
fn long_options(command: &[&str]) -> usize {
    let help = std::process::Command::new(env!("CARGO_BIN_EXE_kirigami"))
        .args(command)
        .arg("--help")
        .output()
        .unwrap();
    assert!(help.status.success(), "{command:?}");
    let help = String::from_utf8(help.stdout).unwrap();
    let of_all = ["--help", "--version", "--quiet", "--verbose"];
    let option = |line: &str| {
        let words = line.split([' ', ',']).filter(|word| !word.is_empty());
        let long = words.take(2).find(|word| word.starts_with("--"))?;
        (!of_all.contains(&long)).then(|| long.to_owned())
    };
    let lines = help.lines().filter(|line| line.trim_start().starts_with('-'));
    // The text of an option may begin a line with its name.
    let own: BTreeSet<String> = lines.filter_map(option).collect();
    let below = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let below = below.take_while(|line| !line.is_empty());
    let names = below.filter_map(|line| {
        let name = line.strip_prefix("  ")?;
        name.split(' ').next().filter(|name| !name.is_empty() && *name != "help")
    });
    let of_subcommands = names.map(|name| long_options(&[command, &[name]].concat()));
    own.len() + of_subcommands.sum::<usize>()
}

#[test]
fn keys_options_and_words_fit_into_the_table_of_the_page() {
    let page = std::fs::read_to_string(root().join("docs/ARCHITECTURE.md")).unwrap();
    let read = |path: PathBuf| std::fs::read_to_string(path).unwrap();
    let keys = read(root().join("docs/KEYS.md"));
    let keys = keys.lines().filter(|line| line.starts_with("| `")).count();
    let mut pages = vec![root().join("README.md")];
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.extension() {
                _ if path.is_dir() => folders.push(path),
                Some(kind) if kind == "md" => pages.push(path),
                _ => {}
            }
        }
    }
    let words = pages.into_iter().map(|page| read(page).split_whitespace().count());
    for (name, found) in [
        ("keys of the configuration files", keys),
        ("long options", long_options(&[])),
        ("words of README and docs", words.sum()),
    ] {
        let most = allowed(&page, name);
        assert!(found <= most, "{name}: {found}, {most} are allowed");
    }
}
