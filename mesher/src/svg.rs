//! A picture of the plane mesh.

use crate::{Boundary, WindowMesh, sides};
use std::fmt::Write;

/// Picture width (px); the window's diameter fills it.
const WIDTH: f64 = 1000.0;
const MARGIN: f64 = 10.0;

/// The plane mesh as SVG: elements grey, arc A blue, arc B red, hole green. Edges are drawn as
/// quadratic curves, like the edges of the elements.
pub fn plane_mesh_svg(mesh: &WindowMesh) -> String {
    let scale = (WIDTH - 2.0 * MARGIN) / (2.0 * mesh.design.r_win);
    let height = WIDTH / 2.0 + MARGIN;
    let at = |node: usize| {
        let [x, y] = mesh.plane.nodes[node];
        [WIDTH / 2.0 + scale * x, MARGIN - scale * y]
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut path = |edges: &mut dyn Iterator<Item = [usize; 3]>, colour: &str, width: f64| {
        let mut d = String::new();
        for [from, to, middle] in edges {
            let ([x0, y0], [x1, y1], [xm, ym]) = (at(from), at(to), at(middle));
            // The Bezier control point whose curve passes through the mid-side node.
            let (xc, yc) = (2.0 * xm - 0.5 * (x0 + x1), 2.0 * ym - 0.5 * (y0 + y1));
            write!(d, "M{x0:.2} {y0:.2}Q{xc:.2} {yc:.2} {x1:.2} {y1:.2}")
                .expect("writing to a string cannot fail");
        }
        writeln!(
            svg,
            "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
        )
        .expect("writing to a string cannot fail");
    };
    path(&mut mesh.plane.faces.iter().flat_map(|face| sides(face)), "#888", 0.8);
    for (boundary, colour) in
        [(Boundary::ArcA, "#1f5fbf"), (Boundary::ArcB, "#c0392b"), (Boundary::Hole, "#2e8b57")]
    {
        let edges = &mesh.plane.edges;
        let mut own = edges.iter().filter(|(of, _)| *of == boundary).map(|(_, edge)| *edge);
        path(&mut own, colour, 2.5);
    }
    svg.push_str("</svg>\n");
    svg
}
