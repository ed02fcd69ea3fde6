//! The cut lines of the uniform 3 x 3 sheet against numbers computed by hand, and those of irregular sheets against the
//! rule that no cut enters a ligament; cutting order, numbers of random sheets; the files, read back.
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
use design::scene::CuttingConfig;
use design::sheet::cut_sheet::{HingePoint, Sheet, SheetOptions};
use hinge::{HingeConstants, SheetMaterial};
use output::cut_file::{CutLines, FabricationError, SheetDrawing, Slit};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const W_LIG: f64 = 18.0;
const FILLET_RATIO: f64 = 0.16;
const KERF: f64 = 0.2;

fn material() -> SheetMaterial {
    SheetMaterial {
        name: "film".into(),
        thickness: 0.5,
        young: 3000.0,
        poisson: 0.4,
        density_kg_m3: 1390.0,
        fracture_strain: 1.784,
        plastic: vec![[44.0, 0.0]],
        ..SheetMaterial::default()
    }
}

fn sheet(grid: Grid, coordinates: &PatternCoordinates, w_lig: f64) -> (CutPattern, Sheet) {
    let [width, height] = [grid.m, grid.n].map(|panels| 400.0 * panels as f64);
    let pattern = CutPattern::new(grid, Outline::rectangle(width, height), coordinates).unwrap();
    let options = SheetOptions {
        hinge_point: HingePoint::CutTip,
        process: HingeConstants {
            fillet_ratio: FILLET_RATIO,
            kerf: KERF,
            r_win: 100.0,
        }
        .into(),
    };
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
    CutLines::new(pattern, sheet, CuttingConfig::default(), &[]).unwrap()
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
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut coordinates = PatternCoordinates::uniform(grid);
    for logit in coordinates
        .z
        .iter_mut()
        .chain(coordinates.ell.iter_mut().flatten())
    {
        *logit = random.random_range(-0.4..0.4);
    }
    sheet(grid, &coordinates, W_LIG)
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
        let found = cuts.slits.iter().any(|slit| {
            let [a, b] = slit.ends;
            let same = |p: [f64; 2], q: [f64; 2]| length([p, q]) < 1e-9;
            (same(a, expected[0]) && same(b, expected[1]))
                || (same(a, expected[1]) && same(b, expected[0]))
        });
        assert!(found, "{expected:?} is missing from {:?}", cuts.slits);
    }
    for hole in &cuts.holes {
        assert!((hole.radius - 2.88).abs() < 1e-12);
        assert!((cuts.tool_radius(hole) - 2.78).abs() < 1e-12);
    }
    let outline = cuts.tool_outline();
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
                    Some(hinge) => {
                        visits[hinge] += 1;
                        assert_eq!(*end, sheet.hinges[hinge].tip);
                        let corner = sheet.hinges[hinge].corner;
                        let ligament =
                            sheet.hinges[hinge].set_back / sheet.hinges[hinge].alpha.sin();
                        assert!((length([*end, corner]) - ligament).abs() < 1e-9);
                    }
                    None => {
                        let [x, y] = *end;
                        let [width, height] = [m, n].map(|panels| 400.0 * panels as f64);
                        let gap = [x, y, width - x, height - y].map(f64::abs);
                        assert!(gap.into_iter().fold(f64::MAX, f64::min) < 1e-9);
                    }
                }
            }
        }
        assert!(
            visits.iter().all(|&count| count == 1),
            "{m} x {n}: {visits:?}"
        );
        // One slit per interior cut and one per cut that is open on the outline.
        let open = cuts
            .slits
            .iter()
            .filter(|slit| slit.hinges[1].is_none())
            .count();
        assert_eq!(cuts.slits.len() - open, grid.aspect_ratio_count());
        assert_eq!(2 * (cuts.slits.len() - open) + open, grid.hinge_count());
    }
}

#[test]
fn no_cut_enters_a_ligament() {
    let grid = Grid { m: 3, n: 3 };
    let sheets = (0..20)
        .map(|seed| irregular(grid, seed))
        .chain([uniform(W_LIG)]);
    for (pattern, sheet) in sheets {
        let cuts = cut_lines(&pattern, &sheet);
        for (h, hole) in cuts.holes.iter().enumerate() {
            let others = cuts
                .slits
                .iter()
                .filter(|slit| !slit.hinges.contains(&Some(h)));
            let nearest = others
                .map(|slit| distance(hole.centre, slit.ends))
                .fold(f64::INFINITY, f64::min);
            let left = nearest.min(cuts.clearance(h)) - hole.radius;
            let designed = (1.0 - FILLET_RATIO) * W_LIG;
            assert!(
                left >= designed - 1e-9,
                "hinge {h}: {left} of {designed} mm"
            );
        }
        for (i, slit) in cuts.slits.iter().enumerate() {
            for other in &cuts.slits[..i] {
                let gap = [0, 1]
                    .map(|end| {
                        f64::min(
                            distance(slit.ends[end], other.ends),
                            distance(other.ends[end], slit.ends),
                        )
                    })
                    .into_iter()
                    .fold(f64::INFINITY, f64::min);
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
        let left = to_slits.chain(to_outline).fold(f64::INFINITY, f64::min);
        assert!((left - W_LIG).abs() < 1e-9, "hinge {h}: {left}");
        assert!((cuts.caliper(h) - (1.0 - FILLET_RATIO) * W_LIG).abs() < 1e-9);
    }
}

#[test]
fn ligaments_that_leave_no_slit_are_refused() {
    let (pattern, sheet) = uniform(398.0);
    let error = CutLines::new(&pattern, &sheet, CuttingConfig::default(), &[]).unwrap_err();
    assert!(
        matches!(error, FabricationError::SlitVanishes { .. }),
        "{error}"
    );
    let (pattern, sheet) = uniform(0.6);
    let error = CutLines::new(&pattern, &sheet, CuttingConfig::default(), &[]).unwrap_err();
    assert!(
        matches!(error, FabricationError::HoleTooSmall { .. }),
        "{error}"
    );
}

/// The ligament at the end of a cut shortens it: in sheets of short panels a cut may end before the ligament opposite it, or
/// leave an edge of a panel whole.
#[test]
fn cuts_that_are_too_short_for_their_ligaments_and_panels_are_refused() {
    let grid = Grid { m: 4, n: 4 };
    let mut refused = [0, 0];
    for seed in 0..300 {
        let mut dice = ChaCha8Rng::seed_from_u64(seed);
        let mut coordinates = PatternCoordinates::uniform(grid);
        let logits = coordinates
            .z
            .iter_mut()
            .chain(coordinates.ell.iter_mut().flatten());
        logits.for_each(|logit| *logit = dice.random_range(-2.0..2.0));
        let (pattern, sheet) = sheet(grid, &coordinates, 25.0);
        match CutLines::new(&pattern, &sheet, CuttingConfig::default(), &[]) {
            Err(FabricationError::CutEndsBeforeLigament {
                hinge,
                width,
                modelled,
            }) => {
                assert!(width > modelled && modelled == sheet.hinges[hinge].w_lig);
                refused[0] += 1;
            }
            Err(FabricationError::EdgeNotCut { .. }) => refused[1] += 1,
            Err(FabricationError::Differs { .. }) => panic!("seed {seed}: the file differs"),
            _ => {}
        }
    }
    assert!(refused.iter().all(|count| *count > 0), "{refused:?}");
}

#[test]
fn slits_that_are_open_on_the_outline_are_cut_beyond_it() {
    let cuts = uniform_cuts();
    for slit in &cuts.slits {
        let longer = length(cuts.tool_slit(slit)) - length(slit.ends);
        let expected = if slit.hinges[1].is_none() { 1.0 } else { 0.0 };
        assert!((longer - expected).abs() < 1e-9, "{longer}");
        assert_eq!(cuts.tool_slit(slit)[0], slit.ends[0]);
    }
}
