//! The unstructured mesh: free triangles that grow with the distance d from O.
//!
//! Their size is tip_size w_lig (1 + (d / (1.5 w_lig))^2), at most rim_size r_win. It is nearly
//! uniform across the ligament, which folds along its whole width, and coarse in the panels, which
//! only bend.

use super::Script;
use crate::{Boundary, Side, Unstructured, Window};
use support::add_line;

/// Adds the window as one surface, and the sizes of its triangles.
pub(super) fn add(geo: &mut Script, window: &Window, recipe: &Unstructured) {
    let (w, rho, r) = (window.0.w_lig, window.0.fillet_radius(), window.0.r_win);
    let centre = geo.point([0.0, 0.0]);
    let tip = geo.point(window.0.tip());
    let [hole_b, hole_a] = [Side::B, Side::A].map(|side| geo.point(window.kerf_at_hole(side)));
    // An arc in gmsh must be shorter than a half circle: the hole consists of two arcs that meet
    // opposite the cut.
    let [x, y] = window.0.main_cut();
    let crown = geo.point([-rho * x, -w - rho * y]);
    let [cut_b, cut_a] = [Side::B, Side::A].map(|side| geo.point(window.kerf_at_radius(side, r)));
    let [right, left] = [r, -r].map(|x| geo.point([x, 0.0]));

    let arc_a = geo.arc(left, centre, cut_a);
    let face_a = geo.line(cut_a, hole_a);
    let hole = [geo.arc(hole_a, tip, crown), geo.arc(crown, tip, hole_b)];
    let face_b = geo.line(hole_b, cut_b);
    let arc_b = geo.arc(cut_b, centre, right);
    let edge = geo.line(right, left);
    geo.surface(&[arc_a, face_a, hole[0], hole[1], face_b, arc_b, edge]);
    geo.boundary(Boundary::Hole, &hole);
    geo.boundary(Boundary::ArcA, &[arc_a]);
    geo.boundary(Boundary::ArcB, &[arc_b]);
    let (tip_size, rim_size) = (recipe.tip_size * w, recipe.rim_size * r);
    let reach = (1.5 * w).powi(2);
    add_line!(geo.text, "Field[1] = MathEval;");
    // The harmonic sum is smooth and smaller than each of its two terms.
    add_line!(
        geo.text,
        "Field[1].F = \"1 / (1 / ({tip_size:?} * (1 + (x * x + (y + {w:?}) * (y + {w:?})) \
         / {reach:?})) + 1 / {rim_size:?})\";"
    );
    add_line!(geo.text, "Background Field = 1;");
    for source in ["FromPoints", "FromCurvature", "ExtendFromBoundary"] {
        add_line!(geo.text, "Mesh.CharacteristicLength{source} = 0;");
    }
}
