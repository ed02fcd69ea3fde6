//! Generates the gmsh scripts of a window and of a sheet.

mod sheet_script;
mod structured;
mod unstructured;

pub(crate) use sheet_script::sheet_script;

use crate::{Boundary, Frame, PlaneRecipe, Window};
use std::ops::RangeInclusive;
use support::{Joined, add_line};

/// Physical tag of the faces of a window.
const WINDOW: usize = 100;

/// The script that meshes `window` according to `recipe`.
pub(crate) fn script(window: &Window, recipe: &PlaneRecipe) -> String {
    let mut geo = Script::default();
    match recipe {
        PlaneRecipe::Structured(recipe) => {
            let curves = structured::add(&mut geo, window, recipe);
            geo.boundary(Boundary::Hole, &curves.hole);
            geo.boundary(Boundary::ArcA, &curves.rim_a.arcs);
            geo.boundary(Boundary::ArcB, &curves.rim_b.arcs);
        }
        PlaneRecipe::Unstructured(recipe) => unstructured::add(&mut geo, window, recipe),
    }
    geo.faces(WINDOW, 1..=geo.patches);
    geo.text
}

/// A .geo script under construction. The sign of a curve's number gives its direction.
#[derive(Default)]
struct Script {
    /// gmsh ignores a last statement without a newline, so every statement ends with one.
    text: String,
    /// The frame in which points are given.
    frame: Frame,
    points: i32,
    curves: i32,
    patches: i32,
}

impl Script {
    fn point(&mut self, local: [f64; 2]) -> i32 {
        let [x, y] = self.frame.point(local);
        self.points += 1;
        let id = self.points;
        add_line!(self.text, "Point({id}) = {{{x:?}, {y:?}, 0}};");
        id
    }

    /// A straight line.
    fn line(&mut self, from: i32, to: i32) -> i32 {
        self.curves += 1;
        let id = self.curves;
        add_line!(self.text, "Line({id}) = {{{from}, {to}}};");
        id
    }

    /// A circular arc, shorter than a half circle.
    fn arc(&mut self, from: i32, centre: i32, to: i32) -> i32 {
        self.curves += 1;
        let id = self.curves;
        add_line!(self.text, "Circle({id}) = {{{from}, {centre}, {to}}};");
        id
    }

    /// Divides a curve into `elements` segments, each `growth` times as long as the one before.
    fn divide(&mut self, curve: i32, elements: usize, growth: f64) -> i32 {
        let points = elements + 1;
        add_line!(
            self.text,
            "Transfinite Curve {{{curve}}} = {points} Using Progression {growth:?};"
        );
        curve
    }

    /// The plane surface inside a closed loop of curves, counter-clockwise.
    fn surface(&mut self, curves: &[i32]) -> i32 {
        self.patches += 1;
        let id = self.patches;
        let list = joined(curves);
        add_line!(self.text, "Curve Loop({id}) = {{{list}}};");
        add_line!(self.text, "Plane Surface({id}) = {{{id}}};");
        id
    }

    /// The plane surface inside four divided curves, meshed with quadrilaterals in rows and
    /// columns.
    fn patch(&mut self, curves: [i32; 4]) {
        let id = self.surface(&curves);
        add_line!(self.text, "Transfinite Surface {{{id}}};");
        self.recombine(id);
    }

    /// Joins the triangles of a surface to quadrilaterals.
    fn recombine(&mut self, surface: i32) {
        add_line!(self.text, "Recombine Surface {{{surface}}};");
    }

    fn boundary(&mut self, boundary: Boundary, curves: &[i32]) {
        let (tag, list) = (boundary.tag(), joined(curves));
        add_line!(self.text, "Physical Curve({tag}) = {{{list}}};");
    }

    /// Names the faces of surfaces.
    fn faces(&mut self, tag: usize, surfaces: RangeInclusive<i32>) {
        let (first, last) = surfaces.into_inner();
        add_line!(self.text, "Physical Surface({tag}) = {{{first}:{last}}};");
    }
}

/// Curve numbers as a comma-separated list.
fn joined(curves: &[i32]) -> String {
    curves.iter().map(i32::to_string).joined(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tier::Tier;
    use crate::window::tests::design;

    #[test]
    fn every_statement_ends_its_line() {
        let design = design(18.0, 90.0);
        for tier in Tier::all() {
            let text = script(&Window(&design), &tier.recipe().plane);
            assert!(text.ends_with(";\n"));
            assert!(text.lines().all(|line| line.ends_with(';')));
        }
    }
}
