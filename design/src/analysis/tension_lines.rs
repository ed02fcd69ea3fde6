//! The lines along which tension runs through a deployed sheet; section 3.2, Fig. 6 (d).
//!
//! The quarter of interfaces with the largest tension are links between panels. If several meet at a
//! panel, the straightest pairs are joined, so that every link belongs to one line.

use crate::analysis::force_transmission::ForceTransmission;
use crate::geometry::plane::{complex, point};
use faer::c64;
use std::f64::consts::FRAC_PI_3;

/// Maximum turning angle of a line at a panel (rad).
const MAX_TURN: f64 = FRAC_PI_3;

/// A chain of panels that transmit tension.
#[derive(Clone, Debug, PartialEq)]
pub struct TensionLine {
    /// The panels along the line, in order; the first and the last are equal for a ring.
    pub panels: Vec<usize>,
    /// The interfaces between them.
    pub interfaces: Vec<usize>,
}

impl TensionLine {
    /// Length along the panels' centroids relative to the distance of its ends; 1 for a straight line.
    pub fn arc_over_chord(&self, transmission: &ForceTransmission) -> f64 {
        let at = |panel: usize| complex(transmission.centroids[panel]);
        let arc: f64 = (self.panels.windows(2))
            .map(|pair| (at(pair[1]) - at(pair[0])).norm())
            .sum();
        let (first, last) = (self.panels[0], self.panels[self.panels.len() - 1]);
        arc / (at(last) - at(first)).norm()
    }
}

/// All lines, in descending order of the number of panels.
pub fn tension_lines(transmission: &ForceTransmission) -> Vec<TensionLine> {
    let links = transmission.strongest(|interface| interface.normal);
    let joined = joined(transmission, &links);
    let mut is_taken = vec![false; transmission.interfaces.len()];
    let mut lines = Vec::new();
    // A path begins at a link without predecessor; the remaining links form rings.
    let begins = |h: usize| [0, 1].into_iter().find(|&end| joined[h][end].is_none());
    let open = links.iter().filter_map(|&h| Some((h, begins(h)?)));
    let rings = links.iter().map(|&h| (h, 0));
    for (first, begin) in open.chain(rings) {
        if is_taken[first] {
            continue;
        }
        let panels_of = |h: usize| transmission.interfaces[h].panels;
        let (mut line, mut link) = (Vec::new(), first);
        let mut panels = vec![panels_of(first)[begin]];
        loop {
            is_taken[link] = true;
            line.push(link);
            let [a, b] = panels_of(link);
            let here = panels[panels.len() - 1];
            let end = usize::from(here == a);
            panels.push(if end == 1 { b } else { a });
            match joined[link][end] {
                Some(next) if !is_taken[next] => link = next,
                _ => break,
            }
        }
        lines.push(TensionLine {
            panels,
            interfaces: line,
        });
    }
    lines.sort_by_key(|line| std::cmp::Reverse(line.panels.len()));
    lines
}

/// The links that each link is joined to at its panels A and B.
fn joined(transmission: &ForceTransmission, links: &[usize]) -> Vec<[Option<usize>; 2]> {
    let mut joints = Vec::new();
    for (i, &one) in links.iter().enumerate() {
        for &other in &links[i + 1..] {
            for (end, &panel) in transmission.interfaces[one].panels.iter().enumerate() {
                let shared = transmission.interfaces[other].panels;
                if let Some(other_end) = shared.iter().position(|&p| p == panel) {
                    let turn = turn(transmission, panel, [one, other]);
                    if turn < MAX_TURN {
                        joints.push((turn, (one, end), (other, other_end)));
                    }
                }
            }
        }
    }
    joints.sort_by(|x, y| x.0.total_cmp(&y.0));
    let mut joined = vec![[None; 2]; transmission.interfaces.len()];
    for (_, (one, end), (other, other_end)) in joints {
        if joined[one][end].is_none() && joined[other][other_end].is_none() {
            joined[one][end] = Some(other);
            joined[other][other_end] = Some(one);
        }
    }
    joined
}

/// The angle between the directions of two links at a panel (rad).
fn turn(transmission: &ForceTransmission, panel: usize, links: [usize; 2]) -> f64 {
    let centre = complex(transmission.centroids[panel]);
    let [one, other] = links.map(|h| complex(transmission.interfaces[h].at) - centre);
    let along: c64 = -other * one.conj();
    let [x, y] = point(along);
    y.atan2(x).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::force_transmission::{Interface, PanelMoment};

    fn transmission(
        links: &[([usize; 2], [f64; 2], f64)],
        centroids: &[[f64; 2]],
    ) -> ForceTransmission {
        let interfaces = links.iter().map(|&(panels, at, normal)| Interface {
            panels,
            at,
            normal,
            tangential: 0.0,
            translational: 0.0,
            rotational: 0.0,
        });
        // A quarter of the interfaces is strong.
        let weak = Interface {
            panels: [0, 1],
            at: [0.0; 2],
            normal: -1.0,
            tangential: 0.0,
            translational: 0.0,
            rotational: 0.0,
        };
        ForceTransmission {
            interfaces: interfaces.chain(vec![weak; 3 * links.len()]).collect(),
            centroids: centroids.to_vec(),
            moments: vec![PanelMoment::default(); centroids.len()],
            areas: vec![1.0; centroids.len()],
        }
    }

    #[test]
    fn the_straight_connection_through_a_crossing_is_one_line() {
        // Panel 0 in the middle, pulled from the west, the east and the north.
        let cross = transmission(
            &[
                ([0, 1], [-1.0, 0.0], 3.0),
                ([2, 0], [1.0, 0.1], 2.0),
                ([0, 3], [0.0, 1.0], 1.0),
            ],
            &[[0.0; 2], [-2.0, 0.0], [2.0, 0.2], [0.0, 2.0]],
        );
        let lines = tension_lines(&cross);
        assert_eq!(lines.len(), 2);
        assert_eq!(lines[0].panels, [1, 0, 2]);
        assert_eq!(lines[0].interfaces, [0, 1]);
        assert!((lines[0].arc_over_chord(&cross) - 1.0012).abs() < 1e-4);
        assert_eq!(
            (lines[1].interfaces.as_slice(), lines[1].panels.len()),
            (&[2][..], 2)
        );
    }

    #[test]
    fn a_ring_is_a_line_too() {
        let corner = |k: usize| {
            let (sin, cos) = (FRAC_PI_3 * k as f64 / 2.0).sin_cos();
            [10.0 * cos, 10.0 * sin]
        };
        let between = |k: usize| {
            let [p, q] = [corner(k), corner(k + 1)];
            [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
        };
        let links: Vec<_> = (0..12)
            .map(|k| ([k, (k + 1) % 12], between(k), 1.0))
            .collect();
        let centroids: Vec<_> = (0..12).map(corner).collect();
        let lines = tension_lines(&transmission(&links, &centroids));
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].interfaces.len(), 12);
    }

    #[test]
    fn a_sheet_without_tension_has_no_line() {
        assert!(
            tension_lines(&transmission(&[([0, 1], [0.0; 2], -1.0)], &[[0.0; 2]; 2])).is_empty()
        );
    }
}
