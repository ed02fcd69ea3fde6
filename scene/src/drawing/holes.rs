//! The contours that lie in others: the holes of an outline.

use crate::drawing::contour::{Contour, LISTED, crossing};
use design::geometry::polygon;
use support::{Fault, refuse};

/// Smallest area of a hole over the area of the outline: specks of a tracing are smaller.
const SPECK: f64 = 1e-4;

/// For each contour those before it, the larger ones, that it lies in, at least in part.
pub(super) fn around(contours: &[Contour]) -> Vec<Vec<usize>> {
    let boxes: Vec<_> = contours.iter().map(Contour::bounds).collect();
    let mut around = vec![Vec::new(); contours.len()];
    for outer in (0..contours.len()).filter(|outer| contours[*outer].is_whole()) {
        let overlaps = |inner: usize| {
            let ([low, high], [other_low, other_high]) = (boxes[inner], boxes[outer]);
            (0..2).all(|c| low[c] <= other_high[c] && other_low[c] <= high[c])
        };
        for inner in outer + 1..contours.len() {
            let contour = &contours[inner];
            if contour.is_whole()
                && overlaps(inner)
                && contour.points.iter().any(|at| polygon::contains(&contours[outer].points, *at))
            {
                around[inner].push(outer);
            }
        }
    }
    around
}

/// The numbers of the holes of a contour, and what in it is left out. A contour in another one has
/// none.
pub(super) fn of(
    outline: usize,
    contours: &[Contour],
    around: &[Vec<usize>],
) -> Result<(Vec<usize>, Vec<String>), Fault> {
    if !around[outline].is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let area = |contour: usize| polygon::area(&contours[contour].points).abs();
    let inner = (0..contours.len()).filter(|inner| around[*inner].contains(&outline));
    let (inner, specks): (Vec<_>, Vec<_>) =
        inner.partition(|inner| area(*inner) >= SPECK * area(outline));
    for contour in &inner {
        contours[*contour].check()?;
    }
    let all = inner.iter().chain([&outline]).map(|contour| &contours[*contour]);
    if let Some([x, y]) = crossing(&all.collect::<Vec<_>>()) {
        refuse!(
            "contours cross or touch each other near ({x}, {y}); move them apart, or delete one of them"
        );
    }
    let (holes, islands): (Vec<_>, Vec<_>) =
        inner.into_iter().partition(|inner| around[*inner].len() == 1);
    let left_out = [
        (specks, "smaller than a ten-thousandth of it"),
        (islands, "in its holes, each a piece of its own"),
    ];
    let notes = left_out.into_iter().filter(|(which, _)| !which.is_empty()).map(|(which, why)| {
        let numbers = which.iter().take(LISTED).map(|i| format!("#{}, ", i + 1));
        let more = if which.len() > LISTED { "and more, " } else { "" };
        format!("left out: {}{more}{why}", numbers.collect::<String>())
    });
    Ok((holes, notes.collect()))
}

#[cfg(test)]
mod tests {
    use super::Fault;
    use crate::drawing::drawn_outline::{DrawnOutline, of_text};

    /// Contours of squares, each by its lower left corner and its side.
    fn squares(squares: &[[f64; 3]], number: Option<usize>) -> Result<DrawnOutline, Fault> {
        let paths = squares.iter().map(|[x, y, side]| format!("M{x} {y}h{side}v{side}h-{side}z"));
        let data = paths.collect::<String>();
        of_text(
            &format!("<svg xmlns='http://www.w3.org/2000/svg'><path d='{data}'/></svg>"),
            number,
        )
    }

    const NEST: [[f64; 3]; 5] = [
        [0.0, 0.0, 100.0],
        [10.0, 10.0, 50.0],
        [20.0, 20.0, 30.0],
        [80.0, 80.0, 9.0],
        [70.0, 9.0, 0.5],
    ];

    #[test]
    fn contours_in_an_outline_are_its_holes() {
        let outline = squares(&NEST, None).unwrap();
        assert_eq!(outline.vertices.len(), 4);
        let corners: Vec<_> = outline.holes.iter().map(|hole| hole[0]).collect();
        assert_eq!(corners, [[10.0, -10.0], [80.0, -80.0]]);
        let [specks, islands] = &outline.warnings[..] else { panic!("{:?}", outline.warnings) };
        assert!(specks.contains("left out: #5, smaller"), "{specks}");
        assert!(islands.contains("left out: #3, in its holes"), "{islands}");
        let hole = squares(&NEST, Some(2)).unwrap();
        assert!(hole.holes.is_empty() && hole.warnings.is_empty());
    }

    #[test]
    fn one_piece_of_several_is_chosen_with_its_holes() {
        let pieces = [&NEST[..], &[[200.0, 0.0, 90.0], [210.0, 5.0, 40.0]]].concat();
        let error = squares(&pieces, None).unwrap_err().to_string();
        assert!(
            error.contains("2 pieces, by size #1 100 x 100 at (0, 0), #2 90 x 90 at (200, 0);"),
            "{error}"
        );
        let second = squares(&pieces, Some(2)).unwrap();
        assert_eq!((second.vertices[0], second.holes.len()), ([200.0, 0.0], 1));
    }

    #[test]
    fn holes_that_cross_or_touch_are_refused_with_the_place() {
        for (hole, place) in [
            ([90.0, 40.0, 20.0], "near (100, "),
            ([55.0, 20.0, 20.0], "near (60, 20)"),
            ([60.0, 20.0, 20.0], "near (60, 20)"),
            ([50.0, 80.0, 20.0], "0, 100)"),
        ] {
            let error = squares(&[NEST[0], NEST[1], hole], None).unwrap_err().to_string();
            assert!(error.contains("cross or touch each other"), "{error}");
            assert!(error.contains(place), "{error}");
        }
    }
}
