//! Cards of CalculiX input decks that windows and sheets have in common. Nodes and elements count
//! from 0 here and from 1 in a deck.

use crate::StepControl;
use hinge::SheetMaterial;
use support::add_line;

/// A number in a format that ccx reads: a field has 20 characters, and this format uses at most 19.
pub(crate) fn real(x: f64) -> String {
    format!("{x:.11e}")
}

/// All nodes, as the set NALL.
pub(crate) fn write_nodes(d: &mut String, nodes: &[[f64; 3]]) {
    add_line!(d, "*NODE,NSET=NALL");
    nodes.iter().enumerate().for_each(|(node, [x, y, z])| {
        add_line!(d, "{},{},{},{}", node + 1, real(*x), real(*y), real(*z))
    })
}

/// The line of an element.
pub(crate) fn write_element(d: &mut String, element: usize, nodes: &[usize]) {
    let numbers = [element].into_iter().chain(nodes.iter().copied());
    let numbers: Vec<String> = numbers.map(|number| (number + 1).to_string()).collect();
    // A line has at most 16 entries.
    let lines: Vec<String> = numbers.chunks(16).map(|line| line.join(",")).collect();
    add_line!(d, "{}", lines.join(",\n"));
}

/// A set of nodes (NSET) or elements (ELSET), unless it is empty.
pub(crate) fn write_set(d: &mut String, kind: &str, name: &str, members: &[usize]) {
    if !members.is_empty() {
        add_line!(d, "*{kind},{kind}={name}");
        members.iter().for_each(|member| add_line!(d, "{},", member + 1));
    }
}

/// The material SHEET with its elastic and plastic law.
pub(crate) fn write_material(d: &mut String, material: &SheetMaterial) {
    let (young, poisson) = (real(material.young), real(material.poisson));
    add_line!(d, "*MATERIAL,NAME=SHEET\n*ELASTIC\n{young},{poisson}\n*PLASTIC");
    material
        .plastic
        .iter()
        .for_each(|[stress, strain]| add_line!(d, "{},{}", real(*stress), real(*strain)))
}

/// A table of (time since the beginning of the first step, value).
pub(crate) fn write_amplitude(
    d: &mut String,
    name: &str,
    pairs: impl IntoIterator<Item = [f64; 2]>,
) {
    add_line!(d, "*AMPLITUDE,NAME={name},TIME=TOTAL TIME");
    let pairs: Vec<String> = (pairs.into_iter())
        .map(|[time, value]| format!("{},{}", real(time), real(value)))
        .collect();
    // A line has at most 4 pairs.
    pairs.chunks(4).for_each(|line| add_line!(d, "{}", line.join(",")))
}

/// The increments of a step of the given duration, and its tolerances.
pub(crate) fn write_increments(d: &mut String, step: &StepControl, duration: f64) {
    let [initial, least, greatest] =
        [step.initial, step.least, step.greatest].map(|part| real(duration * part));
    let (residual, correction) = (real(step.residual), real(step.correction));
    add_line!(d, "{initial},{},{least},{greatest}", real(duration));
    add_line!(d, "*CONTROLS,PARAMETERS=FIELD\n{residual},{correction},,,0.04")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_the_fields_of_a_deck() {
        for x in [-1.0 / 3.0, -1.0 / 3.0 * 1e-200, 1e300 / 7.0, 0.0] {
            let text = real(x);
            assert!(text.len() <= 20, "{text}");
            assert!((text.parse::<f64>().unwrap() - x).abs() <= 1e-11 * x.abs());
        }
    }
}
