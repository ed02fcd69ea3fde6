//! Generates the gmsh script of the window.

mod structured;
mod unstructured;

use crate::msh::Boundary;
use crate::tier::PlaneRecipe;
use crate::window::Window;
use std::fmt::Write;

/// The script that meshes `window` according to `recipe`.
pub(crate) fn script(window: &Window, recipe: &PlaneRecipe) -> String {
    let mut geo = Script::default();
    match recipe {
        PlaneRecipe::Structured(recipe) => structured::add(&mut geo, window, recipe),
        PlaneRecipe::Unstructured(recipe) => unstructured::add(&mut geo, window, recipe),
    }
    geo.finish()
}

/// A .geo script under construction. The sign of a curve's number gives its direction.
#[derive(Default)]
struct Script {
    text: String,
    points: i32,
    curves: i32,
    patches: i32,
}

impl Script {
    fn point(&mut self, [x, y]: [f64; 2]) -> i32 {
        self.points += 1;
        let id = self.points;
        self.add(format_args!("Point({id}) = {{{x:?}, {y:?}, 0}};"));
        id
    }

    /// A straight line.
    fn line(&mut self, from: i32, to: i32) -> i32 {
        self.curves += 1;
        let id = self.curves;
        self.add(format_args!("Line({id}) = {{{from}, {to}}};"));
        id
    }

    /// A circular arc, shorter than a half circle.
    fn arc(&mut self, from: i32, centre: i32, to: i32) -> i32 {
        self.curves += 1;
        let id = self.curves;
        self.add(format_args!("Circle({id}) = {{{from}, {centre}, {to}}};"));
        id
    }

    /// Divides a curve into `elements` segments, each `growth` times as long as the one before.
    fn divide(&mut self, curve: i32, elements: usize, growth: f64) -> i32 {
        let points = elements + 1;
        self.add(format_args!(
            "Transfinite Curve {{{curve}}} = {points} Using Progression {growth:?};"
        ));
        curve
    }

    /// The plane surface inside a closed loop of curves, counter-clockwise.
    fn surface(&mut self, curves: &[i32]) -> i32 {
        self.patches += 1;
        let id = self.patches;
        let list = joined(curves);
        self.add(format_args!("Curve Loop({id}) = {{{list}}};"));
        self.add(format_args!("Plane Surface({id}) = {{{id}}};"));
        id
    }

    /// The plane surface inside four divided curves, meshed with quadrilaterals in rows and columns.
    fn patch(&mut self, curves: [i32; 4]) {
        let id = self.surface(&curves);
        self.add(format_args!("Transfinite Surface {{{id}}};"));
        self.add(format_args!("Recombine Surface {{{id}}};"));
    }

    fn boundary(&mut self, boundary: Boundary, curves: &[i32]) {
        let (tag, list) = (boundary.tag(), joined(curves));
        self.add(format_args!("Physical Curve({tag}) = {{{list}}};"));
    }

    /// The finished script. gmsh ignores a last statement without a newline, so every statement ends with one.
    fn finish(mut self) -> String {
        let patches = self.patches;
        self.add(format_args!("Physical Surface(100) = {{1:{patches}}};"));
        self.text
    }

    fn add(&mut self, statement: std::fmt::Arguments) {
        writeln!(self.text, "{statement}").expect("writing to a string cannot fail");
    }
}

/// Curve numbers as a comma-separated list.
fn joined(curves: &[i32]) -> String {
    curves
        .iter()
        .map(i32::to_string)
        .collect::<Vec<_>>()
        .join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tier::Tier;
    use crate::window::tests::design;

    #[test]
    fn every_statement_ends_its_line() {
        let design = design(18.0, 90.0);
        for tier in Tier::ALL {
            let text = script(&Window(&design), &tier.recipe().plane);
            assert!(text.ends_with(";\n"));
            assert!(text.lines().all(|line| line.ends_with(';')));
        }
    }
}
