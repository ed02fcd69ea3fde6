//! The ideal deployment in closed form: hinges are pins at the ideal corners, even panels rotate by
//! -theta/2 and odd ones by +theta/2; section 2.1.
//!
//! Panel 0 keeps its reference point. Across a hinge with the corner C
//!
//! ```text
//! u_l = u_k + (1 - R_k)(c_k - C) - (1 - R_l)(c_l - C)
//! ```
//!
//! Because every void is a parallelogram, the result is the same along every sequence of hinges
//! through the sheet. Pitches follow (6).

use crate::{
    geometry::plane::{I, complex, dot, point, turn},
    sheet::{
        cut_sheet::{Sheet, SheetGradient},
        kinematics::Configuration,
    },
};
use faer::c64;
use support::{Fault, ensure};

/// An error unless the opening angle (rad) is finite.
pub fn check_opening(theta: f64) -> Result<(), Fault> {
    ensure!(theta.is_finite(), "the opening angle {theta} rad is not a finite number");
    Ok(())
}

/// The configuration with every hinge open by `theta` (rad).
pub fn ideal_deployment(sheet: &Sheet, theta: f64) -> Configuration {
    let mut translations = vec![c64::ZERO; sheet.panels.len()];
    for link in spanning_tree(sheet) {
        let corner = complex(sheet.hinges[link.hinge].corner);
        let lag = |panel: usize| {
            (1.0 - turn(rotation(sheet, panel, theta)))
                * (complex(sheet.panels[panel].reference) - corner)
        };
        translations[link.child] = translations[link.parent] + lag(link.parent) - lag(link.child);
    }
    translations
        .iter()
        .enumerate()
        .map(|(panel, u)| [u.re, u.im, rotation(sheet, panel, theta)])
        .collect()
}

/// The opened sheet on pins while a panel stays where it is.
pub fn opened_about(sheet: &Sheet, held: usize, theta: f64) -> Configuration {
    let free = ideal_deployment(sheet, theta);
    let [x, y, phi] = free[held];
    let (back, fixed) = (turn(-phi), complex(sheet.panels[held].reference));
    let moved = |(panel, [px, py, pphi]): (usize, &[f64; 3])| {
        let flat = complex(sheet.panels[panel].reference);
        let at = flat + c64::new(*px, *py) - fixed - c64::new(x, y);
        let [ux, uy] = point(back * at + fixed - flat);
        [ux, uy, pphi - phi]
    };
    free.iter().enumerate().map(moved).collect()
}

/// Gradients with respect to the sheet (added to `by_sheet`) and theta (returned) of a function
/// with the given gradient in the ideal deployment.
pub fn ideal_deployment_pullback(
    sheet: &Sheet,
    theta: f64,
    gradient: &[[f64; 3]],
    by_sheet: &mut SheetGradient,
) -> f64 {
    let mut by_translation: Vec<c64> = gradient.iter().map(|&[x, y, _]| c64::new(x, y)).collect();
    let mut by_rotation: Vec<f64> = gradient.iter().map(|&[_, _, phi]| phi).collect();
    for link in spanning_tree(sheet).into_iter().rev() {
        let force = by_translation[link.child];
        by_translation[link.parent] += force;
        let hinge = &sheet.hinges[link.hinge];
        let corner = complex(hinge.corner);
        let (corner_panel, corner_index) = hinge.site.a;
        for (panel, sign) in [(link.parent, 1.0), (link.child, -1.0)] {
            let spin = turn(rotation(sheet, panel, theta));
            let arm = complex(sheet.panels[panel].reference) - corner;
            let by_arm = sign * (1.0 - spin).conj() * force;
            by_sheet.references[panel] += by_arm;
            by_sheet.corners[corner_panel][corner_index] -= by_arm;
            by_rotation[panel] -= sign * dot(force, I * spin * arm);
        }
    }
    by_rotation
        .iter()
        .enumerate()
        .map(|(panel, by_rotation)| by_rotation * rotation(sheet, panel, 1.0))
        .sum()
}

fn rotation(sheet: &Sheet, panel: usize, theta: f64) -> f64 {
    if sheet.topology.is_even(panel) { -0.5 * theta } else { 0.5 * theta }
}

/// A hinge that connects a panel to its parent in the tree.
struct Link {
    hinge: usize,
    parent: usize,
    child: usize,
}

/// A spanning tree from panel 0, parents before children.
fn spanning_tree(sheet: &Sheet) -> Vec<Link> {
    let mut neighbours = vec![Vec::new(); sheet.panels.len()];
    for (hinge, h) in sheet.hinges.iter().enumerate() {
        let [a, b] = h.panels();
        neighbours[a].push((hinge, b));
        neighbours[b].push((hinge, a));
    }
    let mut reached = vec![false; sheet.panels.len()];
    reached[0] = true;
    let mut queue = std::collections::VecDeque::from([0]);
    let mut links = Vec::with_capacity(sheet.panels.len());
    while let Some(parent) = queue.pop_front() {
        for &(hinge, child) in &neighbours[parent] {
            if !std::mem::replace(&mut reached[child], true) {
                queue.push_back(child);
                links.push(Link { hinge, parent, child });
            }
        }
    }
    links
}
