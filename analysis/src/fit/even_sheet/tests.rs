use super::*;
use crate::fit::even_pattern::{Opening, hinge, pairs};
use design::geometry::polygon::{area, self_crossing};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

const LIMITS: Limits = Limits {
    stock: [99.0; 2],
    opening: Opening { angle: 1.047, set_back: 0.0 },
    window: 0.42,
    width: 0.2,
    gap: 0.02,
    slit: 0.0125,
};

/// A closed curve about the origin with a radius that varies in waves.
fn blob(random: &mut ChaCha8Rng, radius: f64) -> Ring {
    let waves: Vec<[f64; 2]> = (1..6)
        .map(|k| [random.random_range(0.0..0.35) / f64::from(k), random.random_range(0.0..TAU)])
        .collect();
    let at = |i: usize| {
        let angle = TAU * i as f64 / 90.0;
        let wave =
            |(k, [size, phase]): (usize, &[f64; 2])| size * ((k + 1) as f64 * angle + phase).cos();
        let r = radius * (1.0 + waves.iter().enumerate().map(wave).sum::<f64>()).max(0.25);
        [r * angle.cos(), r * angle.sin()]
    };
    (0..90).map(at).collect()
}

fn drawn(seed: u64) -> Region {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut drawing = Region::even_odd(vec![blob(&mut random, 10.0)]);
    for _ in 0..random.random_range(0..3) {
        let shift = [0, 1].map(|_| random.random_range(-5.0..5.0));
        let radius = random.random_range(1.0..3.0);
        let hole =
            blob(&mut random, radius).iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]).collect();
        drawing = drawing.minus(&Region::even_odd(vec![hole]));
    }
    drawing.polygons.truncate(1);
    // A handle that is too narrow for squares.
    let handle = vec![[0.0, -0.8], [19.0, -0.8], [19.0, 0.8], [0.0, 0.8]];
    let handle = Region::union_of(vec![handle]);
    if seed.is_multiple_of(2) { drawing } else { drawing.union(&handle) }
}

/// What one sees of panels, by points of a raster instead of polygons.
fn seen_in_points(panels: Vec<Ring>, drawing: &Region) -> f64 {
    const REACH: i32 = 10;
    let mean = panels.iter().map(|panel| area(panel)).sum::<f64>() / panels.len() as f64;
    let gap = f64::max(0.04 * drawing.longer_side(), 0.6 * mean.sqrt());
    let step = gap / f64::from(REACH);
    let [low, _] = drawing.bounds();
    let at = |[i, j]: [i32; 2]| [low[0] + step * f64::from(i), low[1] + step * f64::from(j)];
    let all = (-REACH..=REACH).flat_map(|x| (-REACH..=REACH).map(move |y| [x, y]));
    let disc: Vec<_> = all.filter(|[x, y]| x * x + y * y <= REACH * REACH).collect();
    let around = |[i, j]: [i32; 2]| disc.iter().map(move |[x, y]| [i + x, j + y]);
    let panels = Raster::new(&Region::union_of(panels), step);
    let side = -30..290;
    let is_near = |point| around(point).any(|it| panels.contains(at(it)));
    let row = |i| side.clone().map(|j| is_near([i, j])).collect();
    let near: Vec<Vec<bool>> = side.clone().map(row).collect();
    let is_closed = |[i, j]: [i32; 2]| {
        near.get((i + 30) as usize).is_some_and(|row| row.get((j + 30) as usize) == Some(&true))
    };
    let points = side.clone().flat_map(|i| side.clone().map(move |j| [i, j]));
    let found = points.map(|it| [drawing.contains(at(it)), around(it).all(is_closed)]);
    let found: Vec<[bool; 2]> = found.collect();
    let count = |of: fn(&&[bool; 2]) -> bool| found.iter().filter(of).count() as f64;
    count(|it| it[0] && it[1]) / count(|it| it[0] || it[1])
}

/// A square that the others do not need is taken out and added again; without one in the middle of
/// a bridge, and with one outside, the sheet is refused.
fn assert_toggled(sheet: &EvenSheet) {
    let still = Similarity { turn: c64::ONE, shift: c64::ZERO };
    let toggle = |loops: &BTreeSet<GridIndex>, cell| {
        let at = moved(LIMITS.opening.motion(cell), centre(cell));
        EvenSheet::toggled(&sheet.drawing, still, LIMITS, loops.clone(), at)
    };
    let all = squares(&sheet.loops);
    let without = |cell: &GridIndex| Some((*cell, toggle(&sheet.loops, *cell).ok()?));
    let (end, less) = all.iter().find_map(without).unwrap();
    assert!(less.loops.is_subset(&sheet.loops) && !less.panels.contains_key(&end));
    assert!(toggle(&less.loops, end).unwrap().panels.contains_key(&end));
    let refused = |loops: &_, cell| toggle(loops, cell).unwrap_err().to_string();
    assert!(refused(&[0, 1, 2, 3].map(|i| [i, 0]).into(), [2, 0]).contains("no mechanism"));
    assert!(
        refused(&sheet.loops, [all.first().unwrap()[0] - 9, end[1]])
            .contains("outside of the target")
    );
}

#[test]
fn drawn_sheets_are_mechanisms_whose_panels_never_overlap() {
    let seen = |seed| {
        let sheet = EvenSheet::new(&drawn(seed), &[10.0], LIMITS, Search { limbs: true, ..QUICK })?;
        let whole: f64 = sheet.panels.values().map(Region::area).sum();
        for step in 0..=20 {
            let opened = Region::union_of(sheet.opened(f64::from(step) / 20.0));
            assert!((opened.area() - whole).abs() < 1e-4 * whole, "{seed} at {step}");
        }
        let topology = sheet.topology();
        let hinges: BTreeSet<_> = sheet.loops.iter().flat_map(|at| pairs(*at)).collect();
        assert_eq!(topology.panel_count(), sheet.panels.len());
        assert_eq!(topology.hinge_count(), hinges.len());
        for trim in topology.trims.iter().flatten() {
            assert!(area(trim) > 0.0 && self_crossing(trim).is_none(), "{seed}: {trim:?}");
        }
        for pair in hinges {
            // The panels have the window of their hinge.
            let corner = hinge(pair).map(f64::from);
            let disc = (0..32).map(|k| {
                let (sin, cos) = (TAU * f64::from(k) / 32.0).sin_cos();
                [corner[0] + 0.4 * cos, corner[1] + 0.4 * sin]
            });
            let disc = Region::union_of(vec![disc.collect()]);
            for cell in pair {
                let square = Region::union_of(vec![crate::fit::even_pattern::corners(cell)]);
                let quarter = disc.common(&square);
                let kept = quarter.common(&sheet.panels[&cell]);
                let slit = 0.4 * LIMITS.slit;
                assert!(kept.area() > 0.999 * quarter.area() - slit, "{seed} {pair:?}");
            }
        }
        if seed % 20 == 0 {
            let seen = seen_in_points(sheet.opened(1.0), &sheet.drawing);
            assert!((sheet.seen - seen).abs() < 0.01, "{seed}: {} {seen}", sheet.seen);
        }
        assert_toggled(&sheet);
        for panel in sheet.panels.values() {
            assert_eq!(panel.polygons.len(), 1);
            assert_eq!(panel.polygons[0].len(), 1, "{seed}: a hole");
        }
        Some(sheet.seen)
    };
    let seen: Vec<f64> = (0..40).into_par_iter().filter_map(seen).collect();
    assert!(seen.len() > 30 && seen.iter().sum::<f64>() > 0.93 * seen.len() as f64, "{seen:?}");
}
