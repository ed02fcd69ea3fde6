//! The pages: every link leads to a file and to a heading in it, docs/SUMMARY.md lists every page,
//! and the README leads to every page by two links. Texts are free of some words.

use crate::common::pages::{pages, read, root, sources};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// A page without its blocks of code.
fn prose(page: &Path) -> String {
    let text = read(page);
    let blocks = text.split("```");
    blocks.step_by(2).collect()
}

/// The targets of the relative links and pictures of a page: a path from the root, and a heading.
fn links(page: &Path) -> Vec<(PathBuf, Option<String>)> {
    let text = prose(page);
    let after = |mark| text.split(mark).skip(1);
    let inline = after("](").filter_map(|rest| rest.split_once(')'));
    let pictures = after("src=\"").filter_map(|rest| rest.split_once('"'));
    let targets = inline.chain(pictures).map(|(target, _)| target);
    let own = targets.filter(|target| !target.contains("://") && !target.contains(' '));
    own.map(|target| {
        let (file, heading) = match target.split_once('#') {
            Some((file, heading)) => (file, Some(heading.to_owned())),
            None => (target, None),
        };
        let from = match file {
            "" => page.to_owned(),
            file => page.parent().unwrap().join(file),
        };
        (without_dots(&from), heading)
    })
    .collect()
}

fn without_dots(path: &Path) -> PathBuf {
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => assert!(parts.pop(), "{} leaves the root", path.display()),
            part => parts.push(part),
        }
    }
    parts
}

/// The headings of a page as links name them.
fn headings(page: &Path) -> Vec<String> {
    let text = prose(page);
    let titles = text.lines().filter(|line| line.starts_with('#'));
    let slug = |title: &str| {
        let letters = title.trim_start_matches('#').trim().chars();
        let kept = letters.filter(|c| c.is_alphanumeric() || matches!(c, '-' | '_' | ' '));
        kept.collect::<String>().to_lowercase().replace(' ', "-")
    };
    titles.map(slug).collect()
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut broken = Vec::new();
    for page in pages() {
        for (target, heading) in links(&page) {
            let leads = root().join(&target).exists()
                && heading.as_ref().is_none_or(|heading| headings(&target).contains(heading));
            if !leads {
                broken.push((page.clone(), target, heading));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

#[test]
fn the_summary_lists_every_page_once() {
    let summary = Path::new("docs/SUMMARY.md");
    let mut listed: Vec<PathBuf> = links(summary).into_iter().map(|(page, _)| page).collect();
    listed.sort();
    let mut all = pages();
    all.retain(|page| page != summary);
    all.sort();
    assert_eq!(listed, all);
}

#[test]
fn two_links_lead_from_the_readme_to_every_page() {
    let mut reached = BTreeSet::from([PathBuf::from("README.md")]);
    for _ in 0..2 {
        let next: Vec<PathBuf> = reached
            .iter()
            .filter(|page| page.extension().is_some_and(|kind| kind == "md"))
            .flat_map(|page| links(page))
            .map(|(target, _)| target)
            .collect();
        reached.extend(next);
    }
    let far: Vec<PathBuf> = pages()
        .into_iter()
        .filter(|page| !reached.contains(page) && !page.ends_with("SUMMARY.md"))
        .collect();
    assert!(far.is_empty(), "{far:?}");
}

/// Words of a private English, each of which has a plain one.
const HOUSE_WORDS: [&str; 10] = [
    "that of",
    "those of",
    "judge",
    "judged",
    "let go",
    "what stays",
    "anew",
    "nobody",
    "beside",
    "dear",
];

/// Comments and texts of Rust sources, line by line.
fn texts(source: &str) -> impl Iterator<Item = &str> {
    let mut continues = false;
    source.lines().filter_map(move |line| {
        let start = line.find(['"', '/']).filter(|_| !continues);
        let text = if continues { line } else { &line[start?..] };
        continues = line.ends_with('\\');
        Some(text)
    })
}

#[test]
fn comments_messages_and_pages_are_free_of_house_words() {
    let mut found = Vec::new();
    let mut search = |file: &Path, text: &str| {
        let text = text.to_lowercase();
        let is_letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
        for word in HOUSE_WORDS {
            let whole = |(at, _): (usize, &str)| {
                let (before, after) = (&text[..at], &text[at + word.len()..]);
                !is_letter(before.chars().next_back()) && !is_letter(after.chars().next())
            };
            if text.match_indices(word).any(whole) {
                found.push(format!("{}: {word}: {text}", file.display()));
            }
        }
    };
    for page in pages() {
        read(&page).lines().for_each(|line| search(&page, line));
    }
    for file in sources().into_iter().filter(|file| !file.ends_with("documents.rs")) {
        texts(&read(&file)).for_each(|text| search(&file, text));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// First words of a fragment that does not say what it is about.
const PREPOSITIONS: [&str; 10] = ["Of", "With", "For", "By", "In", "At", "To", "From", "On", "As"];

/// Crates whose comments do not yet keep to the rule.
const FRAGMENTS: [&str; 13] = [
    "analysis",
    "app",
    "design",
    "hinge",
    "output",
    "python",
    "scene",
    "src",
    "studio",
    "surrogate",
    "tensile",
    "train",
    "verification",
];

/// The beginning of each comment of a source: of each run of lines with one kind of slashes.
fn comments(source: &str) -> Vec<&str> {
    let mut kind = "";
    let lines = source.lines().map(str::trim_start).map(|line| {
        let before = std::mem::take(&mut kind);
        kind = ["///", "//!", "//"].into_iter().find(|it| line.starts_with(it)).unwrap_or("");
        (line, kind, before)
    });
    let begins = lines.filter(|(_, kind, before)| !kind.is_empty() && kind != before);
    begins.map(|(line, kind, _)| line[kind.len()..].trim_start()).collect()
}

#[test]
fn no_comment_begins_with_a_preposition() {
    let mut found = Vec::new();
    for file in sources() {
        let member = file.iter().next().unwrap();
        if FRAGMENTS.iter().any(|name| member == *name) {
            continue;
        }
        for text in comments(&read(&file)) {
            let first = text.split(|c: char| !c.is_alphabetic()).next().unwrap();
            if PREPOSITIONS.contains(&first) {
                found.push(format!("{}: {text}", file.display()));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}
