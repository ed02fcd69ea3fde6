//! The cut lines of the uniform 3 x 3 sheet against numbers computed by hand, and the cut lines of
//! irregular sheets against the rule that no cut enters a ligament; cutting order, numbers of
//! random sheets; the files, read back.
//!
//! The uniform sheet of 400 mm panels and 18 mm ligaments, with its four interior slits:
//!
//! ```text
//!  1200 +-----+--o--+--|--+      Every interior slit spans two panels: 800 mm minus a ligament
//!       |     |     |  |  |      at each end. Every slit that is open on the outline spans one panel.
//!   800 |--o  |  -------- o      o: a hinge on the outline, |: a slit open on it
//! ```

mod attachments;
mod files;
mod order_and_numbers;

use design::pattern::coordinates::PatternCoordinates;
use design::pattern::cut_pattern::{CutPattern, Outline};
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::{HingePoint, Sheet, SheetOptions};
use hinge::{HingeConstants, SheetMaterial};
use output::cut_file::{CutLines, Layer, SheetDrawing, Slit};
use output::display::Shape;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use scene::CuttingConfig;
use testkit::derivatives::assert_close;

const W_LIG: f64 = 18.0;
const FILLET_RATIO: f64 = 0.16;
const KERF: f64 = 0.2;

fn material() -> SheetMaterial {
    let film = "../configs/materials/pet-0.5mm.toml";
    SheetMaterial::load(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(film)).unwrap()
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}

fn sheet(grid: Grid, coordinates: &PatternCoordinates, w_lig: f64) -> (CutPattern, Sheet) {
    let [width, height] = [grid.m, grid.n].map(|panels| 400.0 * panels as f64);
    let pattern = CutPattern::new(grid, Outline::rectangle(width, height), coordinates).unwrap();
    let options =
        SheetOptions { hinge_point: HingePoint::CutTip, process: HingeConstants::PAPER.into() };
    let widths = vec![w_lig; grid.hinge_count()];
    let sheet = Sheet::new(&pattern, &widths, options).unwrap();
    (pattern, sheet)
}

fn uniform(w_lig: f64) -> (CutPattern, Sheet) {
    let grid = Grid { m: 3, n: 3 };
    sheet(grid, &PatternCoordinates::uniform(grid), w_lig)
}

fn uniform_cuts() -> CutLines {
    let (pattern, sheet) = uniform(W_LIG);
    cut_lines(&pattern, &sheet)
}

fn cut_lines(pattern: &CutPattern, sheet: &Sheet) -> CutLines {
    let cutting = CuttingConfig { kerf: Some(KERF), ..CuttingConfig::default() };
    CutLines::new(pattern, sheet, cutting, &[]).unwrap()
}

/// The cut lines of irregular sheets of several sizes, with their drawings.
fn irregular_sheets() -> impl Iterator<Item = (Sheet, CutLines, SheetDrawing)> {
    let sizes = [(2, 2), (3, 3), (2, 5), (4, 3), (6, 5), (7, 7)];
    sizes.into_iter().map(|(m, n)| {
        let (pattern, sheet) = irregular(Grid { m, n }, (10 * m + n) as u64);
        let cuts = cut_lines(&pattern, &sheet);
        let drawing = SheetDrawing::new(&cuts, &sheet, &material());
        (sheet, cuts, drawing)
    })
}

fn irregular(grid: Grid, seed: u64) -> (CutPattern, Sheet) {
    sheet(grid, &drawn(grid, seed, 0.4), W_LIG)
}

/// Coordinates between -`size` and `size`.
fn drawn(grid: Grid, seed: u64, size: f64) -> PatternCoordinates {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut coordinates = PatternCoordinates::uniform(grid);
    let edges = coordinates.ell.iter_mut().flatten();
    let logits = coordinates.z.iter_mut().chain(edges);
    logits.for_each(|logit| *logit = random.random_range(-size..size));
    coordinates
}

fn length([a, b]: [[f64; 2]; 2]) -> f64 {
    f64::hypot(b[0] - a[0], b[1] - a[1])
}

/// Distance from a point to the segment between two others.
fn distance(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let f = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
    let f = f.clamp(0.0, 1.0);
    length([p, [a[0] + f * d[0], a[1] + f * d[1]]])
}

#[test]
fn the_uniform_sheet_has_eight_slits_and_twelve_holes_at_their_positions() {
    let cuts = uniform_cuts();
    assert_eq!(cuts.slits.len(), 8);
    assert_eq!(cuts.holes.len(), 12);

    let mut lengths: Vec<f64> = cuts.slits.iter().map(|slit| length(slit.ends)).collect();
    lengths.sort_by(f64::total_cmp);
    for (found, expected) in lengths.iter().zip([[381.9; 4], [763.9; 4]].as_flattened()) {
        assert!((found - expected).abs() < 1e-9, "{lengths:?}");
    }
    let by_hand = [
        // C_10 runs from the outline to the flank of C_11; C_11 runs from the left edge to C_21.
        [[400.0, 381.9], [400.0, 0.0]],
        [[18.0, 400.0], [781.9, 400.0]],
        [[800.0, 18.0], [800.0, 781.9]],
    ];
    for expected in by_hand {
        let same = |p: [f64; 2], q: [f64; 2]| length([p, q]) < 1e-9;
        let along = |[p, q]: [[f64; 2]; 2]| same(p, expected[0]) && same(q, expected[1]);
        let found = |[a, b]: [[f64; 2]; 2]| along([a, b]) || along([b, a]);
        let found = cuts.slits.iter().any(|slit| found(slit.ends));
        assert!(found, "{expected:?} is missing from {:?}", cuts.slits);
    }
    for hole in &cuts.holes {
        assert_close(hole.radius, 2.88, 1e-12);
    }
    let drawing = cuts.drawing();
    for path in drawing.on(Layer::Holes) {
        let Shape::Circle { radius, .. } = path else { panic!("{path:?}") };
        assert_close(*radius, 2.78, 1e-12);
    }
    let outline = cuts.tool_outlines().remove(0);
    assert!((outline[0][0] + 0.1).abs() < 1e-12 && (outline[2][1] - 1200.1).abs() < 1e-9);
}

#[test]
fn every_slit_ends_in_the_hole_of_its_hinge_or_on_the_outline() {
    for (m, n) in [(2, 2), (3, 3), (2, 5), (4, 3), (6, 5)] {
        let grid = Grid { m, n };
        let (pattern, sheet) = irregular(grid, (10 * m + n) as u64);
        let cuts = cut_lines(&pattern, &sheet);
        let mut visits = vec![0; cuts.holes.len()];
        for slit in &cuts.slits {
            for (end, hinge) in slit.ends.iter().zip(slit.hinges) {
                match hinge {
                    Some(h) => {
                        visits[h] += 1;
                        let hinge = &sheet.hinges[h];
                        assert_eq!(*end, hinge.tip);
                        let ligament = hinge.set_back / hinge.alpha.sin();
                        assert_close(length([*end, hinge.corner]), ligament, 1e-9);
                    }
                    None => {
                        let [x, y] = *end;
                        let [width, height] = [m, n].map(|panels| 400.0 * panels as f64);
                        let gap = [x, y, width - x, height - y].map(f64::abs);
                        assert!(least(gap.into_iter()) < 1e-9);
                    }
                }
            }
        }
        assert_eq!(visits, vec![1; cuts.holes.len()], "{m} x {n}");
        // One slit per interior cut and one per cut that is open on the outline.
        let slits = cuts.slits.iter();
        let open = slits.filter(|slit| slit.hinges[1].is_none()).count();
        assert_eq!(cuts.slits.len() - open, grid.aspect_ratio_count());
        assert_eq!(2 * (cuts.slits.len() - open) + open, grid.hinge_count());
    }
}

#[test]
fn no_cut_enters_a_ligament() {
    let grid = Grid { m: 3, n: 3 };
    let irregular = (0..20).map(|seed| irregular(grid, seed));
    for (pattern, sheet) in irregular.chain([uniform(W_LIG)]) {
        let cuts = cut_lines(&pattern, &sheet);
        for (h, hole) in cuts.holes.iter().enumerate() {
            let slits = cuts.slits.iter();
            let others = slits.filter(|slit| !slit.hinges.contains(&Some(h)));
            let nearest = least(others.map(|slit| distance(hole.centre, slit.ends)));
            let left = nearest.min(cuts.clearance(h)) - hole.radius;
            let designed = (1.0 - FILLET_RATIO) * W_LIG;
            assert!(left >= designed - 1e-9, "hinge {h}: {left} mm");
        }
        for (i, slit) in cuts.slits.iter().enumerate() {
            for other in &cuts.slits[..i] {
                let own = slit.ends.iter().map(|end| distance(*end, other.ends));
                let others = other.ends.iter().map(|end| distance(*end, slit.ends));
                let gap = least(own.chain(others));
                assert!(gap >= W_LIG - 1e-9, "{gap}: {slit:?} {other:?}");
            }
        }
    }
}

/// The tool removes half the kerf on either side of a slit; w_lig remains, as in the window.
#[test]
fn a_ligament_has_the_width_of_the_window_model() {
    let (pattern, sheet) = uniform(W_LIG);
    let cuts = cut_lines(&pattern, &sheet);
    for (h, hole) in cuts.holes.iter().enumerate() {
        let own = |slit: &&Slit| slit.hinges.contains(&Some(h));
        let others = cuts.slits.iter().filter(|slit| !own(slit));
        let to_slits = others.map(|slit| distance(hole.centre, slit.ends) - 0.5 * KERF);
        let [x, y] = hole.centre;
        let to_outline = [x, y, 1200.0 - x, 1200.0 - y];
        assert_close(least(to_slits.chain(to_outline)), W_LIG, 1e-9);
        assert_close(cuts.caliper(h), (1.0 - FILLET_RATIO) * W_LIG, 1e-9);
    }
}

#[test]
fn ligaments_that_leave_no_slit_are_refused() {
    let of = |w_lig| {
        let (pattern, sheet) = uniform(w_lig);
        CutLines::new(&pattern, &sheet, CuttingConfig::default(), &[]).unwrap_err().to_string()
    };
    assert!(of(398.0).starts_with("the slit at hinge 0 would be"));
    assert!(of(0.6).starts_with("the hole of hinge 0 is"));
}

/// The ligament at the end of a cut shortens it: in sheets of short panels a cut may end before the
/// ligament opposite it, or leave an edge of a panel whole.
#[test]
fn cuts_that_are_too_short_for_their_ligaments_and_panels_are_refused() {
    let grid = Grid { m: 4, n: 4 };
    let mut refused = [0, 0];
    for seed in 0..300 {
        let (pattern, sheet) = sheet(grid, &drawn(grid, seed, 2.0), 25.0);
        if let Err(error) = CutLines::new(&pattern, &sheet, CuttingConfig::default(), &[]) {
            let error = error.to_string();
            refused[0] += u32::from(error.contains("ends before its ligament"));
            refused[1] += u32::from(error.starts_with("an edge of panel"));
        }
    }
    assert!(refused.iter().all(|count| *count > 0), "{refused:?}");
}

#[test]
fn slits_that_are_open_on_the_outline_are_cut_beyond_it() {
    let cuts = uniform_cuts();
    for slit in &cuts.slits {
        let longer = length(cuts.tool_slit(slit)) - length(slit.ends);
        assert_close(longer, f64::from(slit.hinges[1].is_none()), 1e-9);
        assert_eq!(cuts.tool_slit(slit)[0], slit.ends[0]);
    }
}
