//! Styles of an SVG file that move or change its elements, which usvg does not read: they are
//! refused by their name.

use simplecss::{AttributeOperator, DeclarationTokenizer, PseudoClass, StyleSheet};
use std::collections::HashMap;
use support::{Fault, refuse};
use usvg::roxmltree::{Document, Node};

/// The namespace of SVG.
const SVG: &str = "http://www.w3.org/2000/svg";
/// Properties of CSS that usvg reads as attributes alone, and values that change nothing.
const ATTRIBUTES: [&str; 14] = [
    "d",
    "x",
    "y",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "width",
    "height",
    "transform",
    "translate",
    "rotate",
    "scale",
];
const UNCHANGED: [&str; 2] = ["none", "auto"];
/// Properties that it does not read as attributes either, with the starts of the values that it
/// reads.
const OTHERS: [(&str, [&str; 2]); 5] = [
    ("clip-path", ["none", "url"]),
    ("mask", ["none", "url"]),
    ("offset-path", ["none", "none"]),
    ("transform-box", ["view-box", "view-box"]),
    ("zoom", ["1", "normal"]),
];

/// An error with the first style of a document that is not read.
pub(super) fn refuse_unread(document: &Document) -> Result<(), Fault> {
    let mut sheet = StyleSheet::new();
    let styles = document.descendants().filter(|node| node.has_tag_name("style"));
    styles.filter_map(|node| node.text()).for_each(|text| sheet.parse_more(text));
    let drawn = |node: &Node| node.tag_name().namespace() == Some(SVG);
    // The page is as large as its program shows it.
    let root = document.root_element();
    for node in document.descendants().filter(drawn).filter(|node| *node != root) {
        let styles = styles_of(node, &sheet);
        let unread = ATTRIBUTES.iter().find_map(|name| {
            let value = styles.get(name).filter(|value| !UNCHANGED.contains(value))?;
            Some((*name, *value))
        });
        // Drawing programs have attributes of the same name in their own namespaces, such as
        // `inkscape:zoom`.
        let own = |name: &str| {
            let own = node.attributes().find(|own| own.name() == name && own.namespace().is_none());
            own.map(|own| own.value())
        };
        let other = || {
            OTHERS.iter().find_map(|(name, read)| {
                let value = styles.get(name).copied().or_else(|| own(name))?;
                let is_read = read.iter().any(|start| value.starts_with(start));
                (!is_read).then_some((*name, value))
            })
        };
        if let Some((name, value)) = unread.or_else(other) {
            refuse!(
                "the style `{name}: {value}` is not read; apply it in the drawing program, or write it as an attribute"
            );
        }
    }
    Ok(())
}

/// The values of the properties of an element, by their names.
fn styles_of<'a>(node: Node<'a, 'a>, sheet: &StyleSheet<'a>) -> HashMap<&'a str, &'a str> {
    let rules = sheet.rules.iter().filter(|rule| rule.selector.matches(&Element(node)));
    let own = DeclarationTokenizer::from(node.attribute("style").unwrap_or_default());
    let all = rules.flat_map(|rule| rule.declarations.iter().copied()).chain(own);
    all.map(|style| (style.name, style.value.trim())).collect()
}

/// An element for the selectors of a style sheet.
struct Element<'a>(Node<'a, 'a>);

impl simplecss::Element for Element<'_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Element)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Element)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass) -> bool {
        class == PseudoClass::FirstChild && self.prev_sibling_element().is_none()
    }
}
