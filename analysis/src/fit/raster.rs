//! A drawing as points of a raster: whether a point is inside is known without its contours.

use design::geometry::polygon::edges;
use design::geometry::region::Region;

/// Which points of a raster are in a region.
pub(super) struct Raster {
    from: [f64; 2],
    step: f64,
    /// By rows from below.
    inside: Vec<Vec<bool>>,
}

impl Raster {
    pub(super) fn new(region: &Region, step: f64) -> Self {
        let [from, to] = region.bounds();
        let count = |c: usize| ((to[c] - from[c]) / step).ceil() as usize;
        let edges: Vec<_> = region.contours().flat_map(|contour| edges(contour)).collect();
        let row = |row: usize| {
            let y = from[1] + (row as f64 + 0.5) * step;
            let crossed = edges.iter().filter(|(p, q)| (p[1] > y) != (q[1] > y));
            let mut at: Vec<f64> =
                crossed.map(|(p, q)| p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0])).collect();
            at.sort_by(f64::total_cmp);
            let mut points = vec![false; count(0)];
            for ends in at.chunks_exact(2) {
                let [first, last] = [ends[0], ends[1]]
                    .map(|x| (((x - from[0]) / step - 0.5).ceil().max(0.0) as usize).min(count(0)));
                points[first..last].fill(true);
            }
            points
        };
        Self { from, step, inside: (0..count(1)).map(row).collect() }
    }

    /// Whether the point of the raster nearest to a point is in the region.
    pub(super) fn contains(&self, at: [f64; 2]) -> bool {
        let [x, y] = [0, 1].map(|c| (at[c] - self.from[c]) / self.step);
        let row = (y >= 0.0).then(|| self.inside.get(y as usize)).flatten();
        x >= 0.0 && row.and_then(|row| row.get(x as usize)).is_some_and(|inside| *inside)
    }

    /// The points in the region.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        let place = |i: usize, c: usize| self.from[c] + (i as f64 + 0.5) * self.step;
        self.inside.iter().enumerate().flat_map(move |(j, row)| {
            let inside = row.iter().enumerate().filter(|(_, inside)| **inside);
            inside.map(move |(i, _)| [place(i, 0), place(j, 1)])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_has_its_area_in_points() {
        let square = |at: f64, side: f64| {
            vec![[at, at], [at + side, at], [at + side, at + side], [at, at + side]]
        };
        let ring = Region::even_odd(vec![square(0.0, 10.0), square(3.0, 4.0)]);
        let raster = Raster::new(&ring, 0.1);
        let area = 0.01 * raster.points().count() as f64;
        assert!((area - 84.0).abs() < 0.5, "{area}");
        for at in [[1.0, 5.0], [5.0, 5.0], [11.0, 5.0], [-1.0, 5.0], [5.0, 8.0]] {
            assert_eq!(raster.contains(at), ring.contains(at), "{at:?}");
        }
    }
}
