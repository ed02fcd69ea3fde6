//! Where a silhouette stands on an opened sheet: the similarity with the least squared distances of
//! the corners of the sheet from the silhouette and of points on the silhouette from the sheet, by
//! repeated fits to nearest points (Besl and McKay, IEEE Trans. PAMI 14, 1992, 239).

use design::geometry::plane::{complex, point};
use design::geometry::polygon::nearest_on_outline;
use design::geometry::similarity::{Pair, Scale, Similarity};

/// Number of fits.
const FITS: usize = 50;
/// Number of points on the silhouette.
const POINTS: usize = 200;

/// The place of `silhouette`, a closed curve, on the deployed `outline` (mm), near a first `guess`.
pub fn place(silhouette: &[[f64; 2]], outline: &[[f64; 2]], guess: Similarity) -> Similarity {
    let every = (silhouette.len() / POINTS).max(1);
    let mut place = guess;
    for _ in 0..FITS {
        let of_corner = |corner: &[f64; 2]| -> Pair {
            let corner = complex(*corner);
            let nearest = nearest_on_outline(point(place.back(corner)), silhouette);
            [complex(nearest), corner]
        };
        let of_point = |at: &[f64; 2]| -> Pair {
            let at = complex(*at);
            [at, complex(nearest_on_outline(point(place.of(at)), outline))]
        };
        let corners = outline.iter().map(of_corner);
        let points = silhouette.iter().step_by(every).map(of_point);
        let pairs: Vec<Pair> = corners.chain(points).collect();
        match Similarity::least_squares(&pairs, Scale::Free) {
            Some(better) => place = better,
            None => break,
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::c64;

    #[test]
    fn an_outline_is_found_near_its_place() {
        let silhouette = [[0.0, 0.0], [40.0, 0.0], [40.0, 10.0], [15.0, 30.0], [0.0, 20.0]];
        let motion = Similarity { turn: c64::cis(0.5) * 3.0, shift: c64::new(200.0, -70.0) };
        let outline = silhouette.map(|p| point(motion.of(complex(p))));
        let guess = Similarity {
            turn: motion.turn * c64::cis(0.1) * 1.05,
            shift: motion.shift + c64::new(4.0, -3.0),
        };
        let found = place(&silhouette, &outline, guess);
        assert!((found.turn - motion.turn).norm() < 1e-3, "{found:?}");
        assert!((found.shift - motion.shift).norm() < 0.02, "{found:?}");
    }
}
