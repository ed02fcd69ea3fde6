//! Position, size, data and transform that the styles of an SVG file give to its elements, written
//! as attributes and as SVG has transforms, because usvg reads them only so. What cannot be written
//! so is refused by its name.

use simplecss::{AttributeOperator, DeclarationTokenizer, PseudoClass, StyleSheet};
use std::{collections::HashMap, ops::Range, str::FromStr};
use support::Fault;
use svgtypes::{Angle, Length, LengthUnit};
use usvg::roxmltree::{Attribute, Document, Node};

/// The namespace of SVG.
const SVG: &str = "http://www.w3.org/2000/svg";
/// Properties of CSS that are lengths in attributes.
const LENGTHS: [&str; 9] = ["x", "y", "cx", "cy", "r", "rx", "ry", "width", "height"];
/// Properties that are applied before `transform`, in this order.
const TRANSFORMS: [&str; 3] = ["translate", "rotate", "scale"];
/// Properties that change what is drawn, with the starts of the values that are read.
const OTHERS: [(&str, [&str; 2]); 5] = [
    ("clip-path", ["none", "url"]),
    ("mask", ["none", "url"]),
    ("offset-path", ["none", "none"]),
    ("transform-box", ["view-box", "view-box"]),
    ("zoom", ["1", "normal"]),
];

/// A part of a text, and what replaces it.
pub(super) type Edit = (Range<usize>, String);

/// A text after edits that do not overlap.
pub(super) fn edited(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|(range, _)| range.start);
    // An element of an entity of the document occurs several times.
    edits.dedup();
    let mut result = String::new();
    let mut copied = 0;
    for (range, new) in edits {
        result += &text[copied..range.start];
        result += &new;
        copied = range.end;
    }
    result + &text[copied..]
}

/// The edits of the text of a document.
pub(super) fn edits(document: &Document) -> Result<Vec<Edit>, Fault> {
    let mut sheet = StyleSheet::new();
    let styles = document.descendants().filter(|node| node.has_tag_name("style"));
    styles.filter_map(|node| node.text()).for_each(|text| sheet.parse_more(text));
    let mut edits = Vec::new();
    let drawn = |node: &Node| node.tag_name().namespace() == Some(SVG);
    for node in document.descendants().filter(drawn) {
        let styled = Styled::of(node, &sheet);
        let geometry = LENGTHS.iter().chain(&["d"]).filter(|_| node != document.root_element());
        for name in geometry {
            if let Some(value) = styled.geometry(name)? {
                edits.push(styled.attribute(name, &value, false));
            }
        }
        if let Some(list) = styled.transform()? {
            edits.push(styled.attribute("style", &format!("transform:{list}"), true));
        }
    }
    Ok(edits)
}

/// An element with the styles that win there.
struct Styled<'a> {
    node: Node<'a, 'a>,
    /// Values by the names of their properties, and whether they are important.
    styles: HashMap<&'a str, (&'a str, bool)>,
}

impl<'a> Styled<'a> {
    fn of(node: Node<'a, 'a>, sheet: &StyleSheet<'a>) -> Self {
        let rules = sheet.rules.iter().filter(|rule| rule.selector.matches(&Element(node)));
        let own = DeclarationTokenizer::from(node.attribute("style").unwrap_or_default());
        let mut styles = HashMap::new();
        for style in rules.flat_map(|rule| rule.declarations.iter().copied()).chain(own) {
            let known = styles.get(style.name).is_some_and(|(_, important)| *important);
            if !known || style.important {
                styles.insert(style.name, (style.value.trim(), style.important));
            }
        }
        Self { node, styles }
    }

    /// An attribute of SVG: drawing programs have others of the same name in their own namespaces,
    /// such as `inkscape:zoom`.
    fn own(&self, name: &str) -> Option<Attribute<'a, 'a>> {
        self.node.attributes().find(|own| own.name() == name && own.namespace().is_none())
    }

    /// The value of an attribute, if a style gives one.
    fn geometry(&self, name: &str) -> Result<Option<String>, Fault> {
        let Some((value, _)) = self.styles.get(name).filter(|(value, _)| *value != "auto") else {
            return Ok(None);
        };
        let read = if name == "d" {
            let data = value.strip_prefix("path(").and_then(|it| it.strip_suffix(')'));
            data.map(|data| data.trim_matches(['"', '\'', ' ']))
        } else {
            let length = Length::from_str(value).ok();
            length.filter(|it| it.unit != LengthUnit::None || it.number == 0.0).map(|_| *value)
        };
        read.map(|read| Some(read.into())).ok_or_else(|| refused(name, value))
    }

    /// The transform as SVG writes it, if a style gives one.
    fn transform(&self) -> Result<Option<String>, Fault> {
        for (name, read) in OTHERS {
            let style = self.styles.get(name).map(|(value, _)| *value);
            if let Some(value) = style.or_else(|| self.own(name).map(|own| own.value()))
                && !read.iter().any(|start| value.starts_with(start))
            {
                return Err(refused(name, value));
            }
        }
        let mut list = String::new();
        let mut styled = false;
        for name in TRANSFORMS.into_iter().chain(["transform"]) {
            let Some(&(value, important)) = self.styles.get(name) else {
                continue;
            };
            styled = true;
            let functions = match name {
                _ if value == "none" => String::new(),
                "transform" => value.to_owned(),
                _ => format!("{name}({value})"),
            };
            let matrices = matrices(&functions).filter(|_| !important);
            list += &matrices.ok_or_else(|| refused(name, value))?;
        }
        if !self.styles.contains_key("transform") {
            list += self.own("transform").map_or("", |own| own.value());
        }
        Ok(styled.then(|| format!("{list} scale(1)")))
    }

    /// Writes an attribute, or behind the one that is there.
    fn attribute(&self, name: &str, value: &str, behind: bool) -> Edit {
        if let Some(present) = self.own(name) {
            let Range { start, end } = present.range_value();
            return match behind && !present.value().is_empty() {
                true => (end..end, format!(";{value}")),
                false => (start..end, value.to_owned()),
            };
        }
        let start = self.node.range().start;
        let tag = &self.node.document().input_text()[start..];
        let length = tag.find(|c: char| c.is_whitespace() || "/>".contains(c));
        let end = start + length.unwrap_or(tag.len());
        (end..end, format!(" {name}='{value}'"))
    }
}

/// The error of a style that is not read.
fn refused(name: &str, value: &str) -> Fault {
    format!(
        "the style `{name}: {value}` is not read; apply it in the drawing program, or write it as an attribute"
    )
    .into()
}

/// Functions of CSS as matrices of SVG; `None` if one is not of the plane or has no unit.
fn matrices(functions: &str) -> Option<String> {
    let parts = functions.split_inclusive(')').filter(|part| !part.trim().is_empty());
    let matrix = |part: &str| {
        let (name, values) = part.trim().strip_suffix(')')?.split_once('(')?;
        let name = name.trim();
        let values = values.split([',', ' ']).filter(|value| !value.is_empty());
        let values: Vec<f64> = values.map(|value| number(name, value)).collect::<Option<_>>()?;
        let [a, b, c, d, e, f] = match (name, &values[..]) {
            ("matrix", &[a, b, c, d, e, f]) => [a, b, c, d, e, f],
            ("translate" | "translateX", &[x]) => [1.0, 0.0, 0.0, 1.0, x, 0.0],
            ("translate", &[x, y]) => [1.0, 0.0, 0.0, 1.0, x, y],
            ("translateY", &[y]) => [1.0, 0.0, 0.0, 1.0, 0.0, y],
            ("scale", &[s]) => [s, 0.0, 0.0, s, 0.0, 0.0],
            ("scale", &[x, y]) => [x, 0.0, 0.0, y, 0.0, 0.0],
            ("scaleX", &[x]) => [x, 0.0, 0.0, 1.0, 0.0, 0.0],
            ("scaleY", &[y]) => [1.0, 0.0, 0.0, y, 0.0, 0.0],
            ("rotate" | "rotateZ", &[angle]) => {
                let (sin, cos) = angle.sin_cos();
                [cos, sin, -sin, cos, 0.0, 0.0]
            }
            ("skew" | "skewX", &[x]) => [1.0, 0.0, x.tan(), 1.0, 0.0, 0.0],
            ("skew", &[x, y]) => [1.0, y.tan(), x.tan(), 1.0, 0.0, 0.0],
            ("skewY", &[y]) => [1.0, y.tan(), 0.0, 1.0, 0.0, 0.0],
            _ => return None,
        };
        Some(format!("matrix({a} {b} {c} {d} {e} {f})"))
    };
    parts.map(matrix).collect()
}

/// A value of a function: a length in px, an angle in rad, or a number. Browsers drop a length or
/// an angle without a unit.
fn number(name: &str, value: &str) -> Option<f64> {
    let plain = value.parse().ok();
    if name.starts_with("translate") {
        let length = Length::from_str(value).ok()?;
        let unit = match length.unit {
            LengthUnit::None if length.number == 0.0 => 1.0,
            LengthUnit::Px => 1.0,
            LengthUnit::In => 96.0,
            LengthUnit::Cm => 96.0 / 2.54,
            LengthUnit::Mm => 96.0 / 25.4,
            LengthUnit::Pt => 96.0 / 72.0,
            LengthUnit::Pc => 16.0,
            LengthUnit::None | LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => {
                return None;
            }
        };
        return Some(unit * length.number);
    }
    if name.starts_with("rotate") || name.starts_with("skew") {
        let angle = Angle::from_str(value).ok()?;
        return plain
            .is_none_or(|angle: f64| angle == 0.0)
            .then(|| angle.to_degrees().to_radians());
    }
    let percent = || Some(0.01 * value.strip_suffix('%')?.parse::<f64>().ok()?);
    plain.or_else(percent)
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
