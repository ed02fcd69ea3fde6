//! The structure that docs/ARCHITECTURE.md states, against the sources.

use crate::common::pages::{files_below, members, pages, read, sources};
use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// The modules of one crate by their path, with their source text up to the unit tests.
struct Crate {
    name: String,
    sources: BTreeMap<String, String>,
}

fn crates() -> Vec<Crate> {
    // What tests share is counted with the tests of the root.
    let members = members().into_iter().filter(|member| member != "tests/kit");
    members.map(|name| Crate::read(&name)).collect()
}

impl Crate {
    fn read(name: &str) -> Self {
        let folder = Path::new(name).join("src");
        let module = |path: PathBuf| {
            let text = read(&path).split("#[cfg(test)]").next().unwrap().to_owned();
            let module = path.strip_prefix(&folder).unwrap().with_extension("");
            (module.to_str().unwrap().replace('/', "::"), text)
        };
        let sources = files_below(folder.to_str().unwrap(), "rs").into_iter().map(module);
        Self { name: name.to_owned(), sources: sources.collect() }
    }

    /// The modules that each module imports from; re-exports of a module's own submodules do not
    /// count.
    fn imports(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let imports = |module: &str, text: &str| -> BTreeSet<&str> {
            let used = uses(module, text).into_iter();
            let is_root = matches!(module, "lib" | "main");
            let is_part = |of: &str| is_root || of.starts_with(&format!("{module}::"));
            used.map(|(public, path)| (public, self.defining(&path)))
                .filter(|(public, other)| !(*public && is_part(other)))
                .map(|(_, other)| other)
                .filter(|other| *other != module)
                .collect()
        };
        let modules = self.sources.iter();
        modules.map(|(module, text)| (module.as_str(), imports(module, text))).collect()
    }

    /// The module that defines the item at a path below the crate's root; re-exports are followed.
    fn defining(&self, path: &str) -> &str {
        let ends = (0..=path.len()).rev();
        let mut ends = ends.filter(|&end| end == path.len() || path[end..].starts_with("::"));
        let longest = ends.find_map(|end| self.sources.get_key_value(&path[..end]));
        let (module, text) = longest.or_else(|| self.sources.get_key_value("lib")).unwrap();
        let item = path.strip_prefix(&format!("{module}::")).unwrap_or(path);
        let item = item.split("::").next().unwrap();
        let mut exported = uses(module, text).into_iter().filter(|(public, _)| *public);
        let named = |leaf: &str| leaf.rsplit("::").next() == Some(item) && leaf != path;
        exported.find(|(_, leaf)| named(leaf)).map_or(module, |(_, leaf)| self.defining(&leaf))
    }
}

static DECLARATION: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"(?m)^\s*(pub(?:\(crate\))? )?use ([^;]+);").unwrap());
static RENAME: LazyLock<Regex> = LazyLock::new(|| Regex::new(r" as \w+|\s").unwrap());

/// The paths that a module imports, relative to the root of its crate, and whether it exports them.
/// The path of an item of another crate begins with the module.
fn uses(module: &str, text: &str) -> Vec<(bool, String)> {
    let declarations = DECLARATION.captures_iter(text).flat_map(|found| {
        let public = found.get(1).is_some();
        let tree = RENAME.replace_all(&found[2], "").into_owned();
        leaves(&tree).into_iter().map(move |leaf| (public, leaf))
    });
    declarations.map(|(public, leaf)| (public, absolute(module, &leaf))).collect()
}

/// The paths in a `use` tree.
fn leaves(tree: &str) -> Vec<String> {
    let Some((prefix, rest)) = tree.split_once('{') else {
        return vec![tree.to_owned()];
    };
    let mut depth = 0;
    let parts = rest.strip_suffix('}').unwrap().split(|c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0
    });
    let leaves = parts.filter(|part| !part.is_empty()).flat_map(leaves);
    leaves.map(|leaf| format!("{prefix}{leaf}").trim_end_matches("::self").to_owned()).collect()
}

fn absolute(module: &str, path: &str) -> String {
    let mut at: Vec<&str> = module.split("::").filter(|part| *part != "lib").collect();
    let mut rest = path;
    while let Some((first, below)) = rest.split_once("::") {
        match first {
            "crate" => at.clear(),
            "super" => _ = at.pop(),
            "self" => {}
            _ => break,
        }
        rest = below;
    }
    at.push(rest);
    at.join("::")
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
    let page = read(Path::new("docs/ARCHITECTURE.md"));
    for name in ["design", "scene"] {
        let beginning = format!("Rooms of `{name}`: ");
        let order = page.lines().find_map(|line| line.strip_prefix(&beginning));
        let order: Vec<&str> = order.unwrap().split('`').skip(1).step_by(2).collect();
        let named = |room: &str| order.iter().position(|other| *other == room);
        let place = |module: &str| named(module.split("::").next()?).or(named(name));
        let member = Crate::read(name);
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

/// Every test that docs/FAULTS.md names as a proof is a test of the workspace.
#[test]
fn the_tests_that_the_page_of_faults_names_exist() {
    let page = read(Path::new("docs/FAULTS.md"));
    let sources: String = sources().iter().map(|file| read(file)).collect();
    let cells = page.lines().filter_map(|line| line.strip_prefix("| ")?.rsplit(" | ").next());
    let tests: Vec<&str> = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    assert!(tests.len() > 20);
    for test in tests {
        assert!(sources.contains(&format!("fn {test}(")), "there is no test {test}");
    }
}

/// Asserts that there is no more of a thing than its row in the section "Size" of the page allows;
/// whoever needs more raises the table in the same commit and says why in its message.
#[track_caller]
fn assert_allowed(name: &str, found: usize) {
    let page = read(Path::new("docs/ARCHITECTURE.md"));
    let (_, section) = page.split_once("\n## Size\n").unwrap();
    let row = (section.lines()).find_map(|line| line.strip_prefix(&format!("| {name} | ")));
    let row = row.unwrap_or_else(|| panic!("docs/ARCHITECTURE.md has no row for {name}"));
    let most: usize = row.trim_end_matches(" |").replace(' ', "").parse().unwrap();
    assert!(found <= most, "{name}: {found}, {most} are allowed");
}

/// Tokens of a text without its comments: names, numbers, texts, signs other than commas. No format
/// changes their number.
fn tokens(text: &str) -> usize {
    let token =
        r##"(?s)//[^\n]*|/\*.*?\*/|r#*".*?"#*|"(?:\\.|[^"\\])*"|[A-Za-z_]\w*|\d[\w.]*|[^\s\w,]"##;
    let found = Regex::new(token).unwrap();
    let found = found.find_iter(text).map(|token| token.as_str());
    found.filter(|token| !token.starts_with("//") && !token.starts_with("/*")).count()
}

/// Lines of tests of a file, neither blank nor comments.
fn test_lines(path: &Path) -> usize {
    let is_test = |part| part == "tests" || part == "benches" || part == "tests.rs";
    let text = read(path);
    let whole = path.iter().any(is_test);
    let begin = if whole { 0 } else { text.find("#[cfg(test)]").unwrap_or(text.len()) };
    let lines = text[begin..].lines().map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with("//")).count()
}

/// The names of types that production code defines more than once.
fn repeated_type_names(crates: &[Crate]) -> Vec<String> {
    let definition =
        Regex::new(r"(?m)^(?:pub(?:\(\w+\))? )?(?:struct|enum|trait|type|union) (\w+)").unwrap();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for text in crates.iter().flat_map(|member| member.sources.values()) {
        for found in definition.captures_iter(text) {
            *counts.entry(found[1].to_owned()).or_default() += 1;
        }
    }
    counts.into_iter().filter(|(_, count)| *count > 1).map(|(name, _)| name).collect()
}

#[test]
fn the_code_fits_into_the_table_of_the_page() {
    let crates = crates();
    let mut all = 0;
    for member in &crates {
        let code = member.sources.iter().filter(|(module, _)| !module.ends_with("tests"));
        let code = code.map(|(_, text)| tokens(text)).sum::<usize>();
        let name = if member.name == "." { "kirigami" } else { &member.name };
        assert_allowed(&format!("`{name}`"), code);
        all += code;
    }
    assert_allowed("all crates", all);
    let files = sources();
    assert_allowed("lines of tests", files.iter().map(|file| test_lines(file)).sum());
    let longest = files.iter().max_by_key(|file| read(file).lines().count()).unwrap();
    println!("{}", longest.display());
    assert_allowed("lines of the longest file", read(longest).lines().count());
    let repeated = repeated_type_names(&crates);
    println!("{repeated:?}");
    assert_allowed("type names defined more than once", repeated.len());
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
    let keys = read(Path::new("docs/KEYS.md"));
    let keys = keys.lines().filter(|line| line.starts_with("| `")).count();
    assert_allowed("keys of the configuration files", keys);
    assert_allowed("long options", long_options(&[]));
    // All but CHANGELOG and CONTRIBUTING.
    let pages = pages().into_iter().filter(|page| !page.to_string_lossy().starts_with('C'));
    let texts = pages.map(|page| read(&page)).filter(|text| !text.contains("\nWritten from the "));
    let words = texts.map(|text| text.split_whitespace().count()).sum();
    assert_allowed("words of README, docs and data but of generated pages", words);
}
