//! The visible paths of an SVG document and their parts. A clip may surround a path, and hides nothing
//! of it.

use crate::drawing::contour::flatten;
use design::geometry::polygon;
use support::{Fault, refuse};
use usvg::{
    ClipPath, Group, Node, Path, Transform,
    tiny_skia_path::{PathSegment, Point},
};

/// How far a path may reach out of a clip around it, over the length of an edge of the clip:
/// rounding.
const FRAME: f64 = 1e-5;
pub(super) fn is_filled(path: &Path) -> bool {
    path.fill().is_some_and(|fill| fill.opacity().get() > 0.0)
}

/// Adds the visible paths of a group, in document order; an error if only a part of them is drawn.
pub(super) fn add_visible<'a>(group: &'a Group, paths: &mut Vec<&'a Path>) -> Result<(), Fault> {
    if group.opacity().get() == 0.0 {
        return Ok(());
    }
    let before = paths.len();
    for node in group.children() {
        match node {
            Node::Group(group) => add_visible(group, paths)?,
            Node::Path(path) => {
                let stroked = (path.stroke()).is_some_and(|stroke| stroke.opacity().get() > 0.0);
                if path.is_visible() && (is_filled(path) || stroked) {
                    paths.push(path);
                }
            }
            Node::Image(_) | Node::Text(_) => {}
        }
    }
    let clip = group.clip_path();
    let clip = clip.filter(|clip| !surrounds(clip, group.abs_transform(), &paths[before..]));
    let clip = clip.map(|clip| ("clipPath", clip.id()));
    let cut = clip.or_else(|| group.mask().map(|mask| ("mask", mask.id())));
    match cut {
        Some((element, id)) if paths.len() > before => refuse!(
            "the path is drawn in part alone, because of the {element} `{id}`; release it in the drawing program, so that the \
             path itself is the outline"
        ),
        _ => Ok(()),
    }
}

/// Whether a clip is one convex path around paths, so that it hides nothing of them, as the frame
/// of an artboard.
fn surrounds(clip: &ClipPath, transform: Transform, paths: &[&Path]) -> bool {
    let [Node::Path(frame)] = clip.root().children() else {
        return false;
    };
    let placed = |path: &Path, transform: Transform| -> Vec<[f64; 2]> {
        let points = subpaths(path).into_iter().flat_map(|part| part.points);
        points.map(|point| transformed(transform, point)).collect()
    };
    let to_page = transform.pre_concat(clip.transform());
    let frame = placed(frame, to_page.pre_concat(frame.abs_transform()));
    let sign = polygon::area(&frame).signum();
    let inside = |p: &[f64; 2]| {
        polygon::edges(&frame).all(|(a, b)| {
            let along = [b[0] - a[0], b[1] - a[1]];
            let off = sign * (along[0] * (p[1] - a[1]) - along[1] * (p[0] - a[0]));
            off >= -FRAME * (along[0] * along[0] + along[1] * along[1])
        })
    };
    let is_convex = clip.clip_path().is_none() && frame.iter().all(inside);
    is_convex && paths.iter().all(|path| placed(path, path.abs_transform()).iter().all(inside))
}

/// A part of a path between two moves.
pub(super) struct Subpath {
    pub points: Vec<[f64; 2]>,
    pub closed: bool,
}

/// The parts of a path, before its transform. A move that draws nothing is none.
pub(super) fn subpaths(path: &Path) -> Vec<Subpath> {
    let mut parts: Vec<Subpath> = Vec::new();
    for segment in path.data().segments() {
        if let PathSegment::MoveTo(to) = segment {
            let points = vec![pair(to)];
            parts.push(Subpath { points, closed: false });
        }
        let Some(Subpath { points, closed }) = parts.last_mut() else {
            continue;
        };
        match segment {
            PathSegment::MoveTo(_) => {}
            PathSegment::LineTo(to) => points.push(pair(to)),
            PathSegment::QuadTo(b, to) => flatten(points, &[pair(b), pair(to)]),
            PathSegment::CubicTo(b, c, to) => flatten(points, &[pair(b), pair(c), pair(to)]),
            PathSegment::Close => *closed = true,
        }
    }
    parts.retain(|part| part.points.iter().any(|point| *point != part.points[0]));
    parts
}

fn pair(point: Point) -> [f64; 2] {
    [f64::from(point.x), f64::from(point.y)]
}

pub(super) fn transformed(transform: Transform, [x, y]: [f64; 2]) -> [f64; 2] {
    let t = transform;
    let [sx, kx, ky, sy, tx, ty] = [t.sx, t.kx, t.ky, t.sy, t.tx, t.ty].map(f64::from);
    [sx * x + kx * y + tx, ky * x + sy * y + ty]
}
