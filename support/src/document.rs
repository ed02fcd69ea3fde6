//! Reports for people: parts in the order of reading.

use crate::Joined;
use crate::table::Table;
use std::fmt::{self, Display};

/// A report. `Display` is for a screen, with aligned columns; [`markdown`](Self::markdown) is for a
/// page.
#[derive(Debug, Default)]
pub struct Document {
    parts: Vec<DocumentBlock>,
}

#[derive(Debug)]
enum DocumentBlock {
    /// A title, with its depth from 1.
    Heading(usize, String),
    Text(String),
    Table(Table),
    List(Vec<String>),
}

impl Document {
    /// Adds the title of the report, or of one of its sections.
    pub fn heading(&mut self, depth: usize, title: impl Into<String>) {
        self.parts.push(DocumentBlock::Heading(depth, title.into()));
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: impl Into<String>) {
        self.parts.push(DocumentBlock::Text(text.into()));
    }

    /// Adds a table.
    pub fn table(&mut self, table: Table) {
        self.parts.push(DocumentBlock::Table(table));
    }

    /// Adds a list, unless it has no items.
    pub fn list(&mut self, items: impl IntoIterator<Item = impl Display>) {
        let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
        if !items.is_empty() {
            self.parts.push(DocumentBlock::List(items));
        }
    }

    /// Adds the parts of another report.
    pub fn append(&mut self, other: Self) {
        self.parts.extend(other.parts);
    }

    /// The report as a page in Markdown.
    pub fn markdown(&self) -> String {
        self.written(|part| match part {
            DocumentBlock::Heading(depth, title) => format!("{} {title}", "#".repeat(*depth)),
            DocumentBlock::Text(text) => text.clone(),
            DocumentBlock::Table(table) => table.markdown().trim_end().to_owned(),
            DocumentBlock::List(items) => list("*", items),
        })
    }

    fn written(&self, part: impl Fn(&DocumentBlock) -> String) -> String {
        self.parts.iter().map(part).joined("\n\n") + "\n"
    }
}

/// A report that is a table alone.
impl From<Table> for Document {
    fn from(table: Table) -> Self {
        Self { parts: vec![DocumentBlock::Table(table)] }
    }
}

fn list(mark: &str, items: &[String]) -> String {
    let lines = items.iter().map(|item| format!("{mark} {item}"));
    lines.joined("\n")
}

impl Display for Document {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.written(|part| match part {
            DocumentBlock::Heading(_, text) | DocumentBlock::Text(text) => text.clone(),
            DocumentBlock::Table(table) => table.to_string(),
            DocumentBlock::List(items) => list("-", items),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screen_has_columns_and_a_page_has_markdown() {
        let mut table = Table::new(["hinge", "W\nN mm"]);
        table.row(["0", "12.5"]);
        let mut document = Document::default();
        document.heading(1, "Two hinges");
        document.text("The second one tore.");
        document.table(table);
        document.list(["error: hinge 1 tears"]);
        document.list(Vec::<String>::new());
        let screen = "Two hinges\n\nThe second one tore.\n\n hinge      W\n         N mm\n──────────────\n 0       12.5\n\n\
            - error: hinge 1 tears\n";
        assert_eq!(document.to_string(), screen);
        let page = "# Two hinges\n\nThe second one tore.\n\n| hinge | W, N mm |\n|---|---|\n| 0 | 12.5 |\n\n\
            * error: hinge 1 tears\n";
        assert_eq!(document.markdown(), page);
    }
}
