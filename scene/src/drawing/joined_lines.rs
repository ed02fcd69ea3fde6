//! The lines of a drawing as contours: what is drawn twice, as for the fill and for the stroke, counts
//! once, and open lines whose ends meet are joined.

use crate::drawing::contour::Contour;
use design::geometry::polygon;
use std::collections::{HashMap, HashSet};
use support::{Extremes, Point};

/// Distance of two ends that meet, over the size of the drawing.
const JOINED: f64 = 1e-5;

/// The contours, each once, and those that end where others begin as one.
pub(super) fn joined(contours: Vec<Contour>) -> Vec<Contour> {
    let contours = contours.into_iter().map(Contour::merged);
    let contours: Vec<_> = contours.filter(|contour| contour.points.len() > 1).collect();
    let points = contours.iter().flat_map(|contour| &contour.points);
    let bounds = polygon::bounds(points.copied());
    let [width, height] = polygon::size(bounds);
    let within = JOINED * width.max(height);
    let mut nodes = Nodes { low: bounds[0], within, points: Vec::new(), cells: HashMap::new() };
    let (whole, open): (Vec<_>, Vec<_>) = contours.into_iter().partition(Contour::is_whole);
    let mut kept = once(whole, &mut nodes);
    if !open.is_empty() {
        let chains = chains(&open, &kept, &mut nodes);
        kept.extend(chains);
    }
    kept
}

/// Contours that have an inside, each once.
fn once(whole: Vec<Contour>, nodes: &mut Nodes) -> Vec<Contour> {
    let mut twins = HashMap::new();
    let mut kept: Vec<Contour> = Vec::new();
    for contour in whole {
        // Only contours of one bounding box are compared.
        let corners = contour.bounds().map(|p| nodes.node(p));
        let rivals: &mut Vec<usize> = twins.entry(corners).or_default();
        let mut edges = |contour: &Contour| {
            let mut edges = nodes.lines(polygon::edges(&contour.points));
            edges.sort_unstable();
            edges
        };
        let own = if rivals.is_empty() { Vec::new() } else { edges(&contour) };
        match rivals.iter().find(|twin| own.len() > 2 && edges(&kept[**twin]) == own) {
            Some(&twin) => {
                kept[twin].filled |= contour.filled;
                kept[twin].closed |= contour.closed;
            }
            None => {
                rivals.push(kept.len());
                kept.push(contour);
            }
        }
    }
    kept
}

/// The open lines that are on no whole contour, followed from point to point, each line once; they
/// end where more than two meet.
fn chains(open: &[Contour], whole: &[Contour], nodes: &mut Nodes) -> Vec<Contour> {
    let mut lines = HashSet::new();
    for contour in whole {
        lines.extend(nodes.lines(polygon::edges(&contour.points)));
    }
    let rounding = open.iter().map(|contour| contour.rounding).largest();
    let mut links: Vec<Vec<usize>> = Vec::new();
    for contour in open {
        let pairs = contour.points.windows(2).map(|pair| (pair[0], pair[1]));
        for (a, b) in nodes.lines(pairs) {
            if lines.insert((a, b)) {
                links.resize_with(nodes.points.len(), Vec::new);
                links[a].push(b);
                links[b].push(a);
            }
        }
    }
    let meeting: Vec<usize> = links.iter().map(Vec::len).collect();
    let ends = (0..links.len()).filter(|node| meeting[*node] != 2);
    let mut found = Vec::new();
    for first in ends.chain(0..links.len()) {
        while let Some(mut next) = links[first].first().copied() {
            let mut chain = vec![first];
            loop {
                let last = chain[chain.len() - 1];
                links[last].retain(|node| *node != next);
                links[next].retain(|node| *node != last);
                chain.push(next);
                match links[next][..] {
                    [after] if meeting[next] == 2 => next = after,
                    _ => break,
                }
            }
            let closed = chain.len() > 3 && next == first;
            chain.truncate(chain.len() - usize::from(closed));
            if meeting[first] > meeting[next] {
                chain.reverse();
            }
            let branches = meeting[first].max(meeting[next]) > 2;
            let points = chain.into_iter().map(|node| nodes.points[node]).collect();
            found.push(Contour { points, closed, filled: false, branches, rounding });
        }
    }
    found
}

/// Points, those as one that are nearer to each other than a distance.
struct Nodes {
    low: Point,
    within: f64,
    points: Vec<Point>,
    /// The point in a square of a grid.
    cells: HashMap<[i64; 2], usize>,
}

impl Nodes {
    fn node(&mut self, point: Point) -> usize {
        let [x, y] = [0, 1].map(|c| ((point[c] - self.low[c]) / self.within).floor() as i64);
        let around = [0, -1, 1].into_iter().flat_map(|i| [0, -1, 1].map(|j| [x + i, y + j]));
        let near = |node: &usize| {
            let [dx, dy] = [0, 1].map(|c| (self.points[*node][c] - point[c]).abs());
            dx.max(dy) <= self.within
        };
        let known = around.filter_map(|cell| self.cells.get(&cell).copied()).find(near);
        known.unwrap_or_else(|| {
            self.points.push(point);
            self.cells.insert([x, y], self.points.len() - 1);
            self.points.len() - 1
        })
    }

    /// The lines between pairs of points, from the lower to the higher node; a line of no length is
    /// left out.
    fn lines(&mut self, pairs: impl Iterator<Item = (Point, Point)>) -> Vec<(usize, usize)> {
        let ends = pairs.map(|(p, q)| (self.node(p), self.node(q)));
        let ends = ends.filter(|(a, b)| a != b).map(|(a, b)| (a.min(b), a.max(b)));
        ends.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_of_many_pieces_is_joined_in_no_time() {
        use std::f64::consts::{PI, TAU};
        let count = 60_000;
        let at = |i: usize| {
            let (sin, cos) = (TAU * i as f64 / f64::from(count)).sin_cos();
            [150.0 + 100.0 * cos, 150.0 + 100.0 * sin]
        };
        let mut lines: Vec<_> = (0..count as usize)
            .map(|i| Contour { points: vec![at(i), at(i + 1)], ..Contour::default() })
            .collect();
        lines.sort_by(|a, b| a.points[0][0].total_cmp(&b.points[0][0]));
        let start = std::time::Instant::now();
        let found = joined(lines);
        assert!(start.elapsed().as_secs() < 5);
        assert!(found.len() == 1 && found[0].closed);
        assert!((polygon::area(&found[0].points).abs() / 1e4 - PI).abs() < 1e-3);
    }
}
