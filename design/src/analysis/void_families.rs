//! Families of unit cells by the shape of their voids; section 3.2.
//!
//! The sheet is tiled by disjoint unit cells, each the four panels about one void. A cell is represented by the
//! point (log longer side, log shorter side) of its void, which deployment does not change. The families
//! are the groups of a k-means partition of these points.

use crate::pattern::cut_pattern::CutPattern;

/// Maximum number of Lloyd's iterations; a few tens suffice for a few hundred points.
const MAX_ITERATIONS: usize = 1000;

/// The vertices of disjoint unit cells, row by row, and the sides of their voids, the longer one first
/// (mm).
pub fn disjoint_voids(pattern: &CutPattern) -> Vec<([usize; 2], [f64; 2])> {
    let vertices = pattern.grid.interior_vertices();
    std::iter::zip(vertices, pattern.void_sides())
        .filter(|((i, j), _)| i % 2 == 1 && j % 2 == 1)
        .map(|((i, j), [a, b])| ([i, j], [a.max(b), a.min(b)]))
        .collect()
}

/// Groups of voids with similar sides.
#[derive(Clone, Debug, PartialEq)]
pub struct VoidFamilies {
    /// Geometric mean of the sides of each family's voids (mm), in descending order.
    pub sides: Vec<[f64; 2]>,
    /// The index of the family of every void.
    pub family: Vec<usize>,
}

impl VoidFamilies {
    /// At most `count` families of voids with the given sides (mm). The first start point is the void
    /// farthest from the mean, each further one the void farthest from the start points before it, so
    /// that the partition depends on the voids alone.
    pub fn new(sides: &[[f64; 2]], count: usize) -> Self {
        let points: Vec<[f64; 2]> = sides.iter().map(|void| void.map(f64::ln)).collect();
        let mut centres = Vec::from_iter(mean(points.iter()));
        for k in 0..count {
            let farthest = (points.iter())
                .max_by(|p, q| nearest(&centres, p).1.total_cmp(&nearest(&centres, q).1));
            match farthest {
                Some(&point) if k == 0 => centres = vec![point],
                Some(&point) if nearest(&centres, &point).1 > 0.0 => centres.push(point),
                _ => break,
            }
        }
        let assign = |centres: &[[f64; 2]]| -> Vec<usize> {
            points
                .iter()
                .map(|point| nearest(centres, point).0)
                .collect()
        };
        let mut family = assign(&centres);
        for _ in 0..MAX_ITERATIONS {
            for (k, centre) in centres.iter_mut().enumerate() {
                let members = std::iter::zip(&points, &family).filter(|(_, f)| **f == k);
                *centre = mean(members.map(|(point, _)| point)).unwrap_or(*centre);
            }
            let next = assign(&centres);
            if next == family {
                break;
            }
            family = next;
        }
        let mut order: Vec<usize> = (0..centres.len()).collect();
        order.sort_by(|&k, &l| centres[l][0].total_cmp(&centres[k][0]));
        let mut rank = vec![0; order.len()];
        for (position, &k) in order.iter().enumerate() {
            rank[k] = position;
        }
        Self {
            sides: order.iter().map(|&k| centres[k].map(f64::exp)).collect(),
            family: family.iter().map(|&k| rank[k]).collect(),
        }
    }
}

/// The nearest of the centres and the squared distance to it.
fn nearest(centres: &[[f64; 2]], point: &[f64; 2]) -> (usize, f64) {
    let distance =
        |centre: &[f64; 2]| (centre[0] - point[0]).powi(2) + (centre[1] - point[1]).powi(2);
    let distances = centres.iter().map(distance).enumerate();
    distances.fold((0, f64::INFINITY), |best, next| {
        if next.1 < best.1 { next } else { best }
    })
}

/// `None` for no points.
fn mean<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Option<[f64; 2]> {
    let (mut sum, mut count) = ([0.0; 2], 0.0);
    for point in points {
        sum = [sum[0] + point[0], sum[1] + point[1]];
        count += 1.0;
    }
    (count > 0.0).then(|| sum.map(|sum| sum / count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::coordinates::PatternCoordinates;
    use crate::pattern::cut_pattern::Outline;
    use crate::pattern::grid::Grid;

    #[test]
    fn three_clouds_are_three_families_the_largest_first() {
        let clouds = [[411.0, 226.0], [725.0, 297.0], [491.0, 360.0]];
        let around =
            |centre: [f64; 2]| [0.98, 1.0, 1.0 / 0.98].map(|f| centre.map(|side| side * f));
        let sides: Vec<[f64; 2]> = clouds.into_iter().flat_map(around).collect();
        let families = VoidFamilies::new(&sides, 3);
        assert_eq!(families.family, [2, 2, 2, 0, 0, 0, 1, 1, 1]);
        for (found, expected) in families.sides.iter().zip([clouds[1], clouds[2], clouds[0]]) {
            assert!((found[0] - expected[0]).abs() < 1e-9 * expected[0]);
            assert!((found[1] - expected[1]).abs() < 1e-9 * expected[1]);
        }
    }

    #[test]
    fn equal_voids_are_one_family_and_no_void_is_none() {
        assert_eq!(VoidFamilies::new(&[[2.0, 1.0]; 5], 3).family, [0; 5]);
        assert!(VoidFamilies::new(&[], 3).family.is_empty());
    }

    #[test]
    fn the_sheet_of_the_paper_has_35_disjoint_unit_cells() {
        let grid = Grid { m: 15, n: 10 };
        let outline = Outline::rectangle(6096.0, 4064.0);
        let pattern = CutPattern::new(grid, outline, &PatternCoordinates::uniform(grid)).unwrap();
        let voids = disjoint_voids(&pattern);
        assert_eq!(voids.len(), 35);
        // Uniform sheet: every void is a square with the side of the pitch.
        assert!(
            voids
                .iter()
                .all(|(_, [a, b])| (a - 406.4).abs() < 1e-9 && (b - a).abs() < 1e-9)
        );
    }
}
