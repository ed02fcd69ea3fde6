//! Vector-Jacobian products of pattern, sheet and ideal deployment against finite differences.

use crate::cases;
use crate::prelude::*;
use design::geometry::plane::{complex, point};
use design::sheet::ideal_deployment::ideal_deployment_pullback;

const WIDTHS: WidthChart = WidthChart { w_minus: 0.05, w_plus: 0.25 };

fn start() -> DesignVector {
    let case = case("p1_3x3_random");
    DesignVector {
        pattern: coordinates(&case),
        omega: Random::new(1).numbers(cases::grid(&case).hinge_count(), 1.0),
        opening: None,
    }
}

fn cut(design: &DesignVector, outline: Outline, options: SheetOptions) -> (CutPattern, Sheet) {
    let grid = cases::grid(&case("p1_3x3_random"));
    let pattern = CutPattern::new(grid, outline, &design.pattern).unwrap();
    let widths = design.omega.iter().map(|&omega| WIDTHS.width(omega));
    let sheet = Sheet::new(&pattern, &widths.collect::<Vec<_>>(), options).unwrap();
    (pattern, sheet)
}

/// The gradient in the design, from a gradient in the sheet.
fn pulled_back(
    pattern: &CutPattern,
    sheet: &Sheet,
    gradient: &SheetGradient,
    design: &DesignVector,
) -> DesignVector {
    let (by_points, by_width) = sheet.pullback(gradient);
    let by_omega = std::iter::zip(&design.omega, by_width);
    let by_omega = by_omega.map(|(&omega, by_width)| by_width * WIDTHS.slope(omega));
    DesignVector {
        pattern: pattern.pullback(&by_points).0,
        omega: by_omega.collect(),
        opening: None,
    }
}

fn assert_slopes(value: impl Fn(&DesignVector) -> f64, at: &DesignVector, found: &DesignVector) {
    let allowed = |slope: f64| 1e-7 * (1.0 + slope.abs());
    let value = |x: &[f64]| value(&at.with_flat(x));
    assert_gradient(value, &at.to_flat(), &found.to_flat(), 1e-5, allowed);
}

#[test]
fn gradients_in_the_sheet_are_pulled_back_to_the_design() {
    let design = start();
    let given = cases::outline(&case("p1_3x3_random"));
    for hinge_point in [HingePoint::Corner, HingePoint::CutTip] {
        for outline in [given, TAPERED] {
            // A hole of the same diameter at every hinge has a radius over w_lig that depends on
            // the width.
            let mut options = SheetOptions { hinge_point, ..AT_TIP };
            options.process.hole = HoleSize::Diameter(0.3);
            // One point of each kind besides the centroid.
            let points = [
                attached(1, PanelPoint::Middle([0, 1])),
                attached(5, PanelPoint::Fixed([2.5, 1.5])),
            ];
            let held = |design: &DesignVector| {
                let (pattern, sheet) = cut(design, outline, options);
                (pattern, sheet.attached_at(&points))
            };
            let (pattern, sheet) = held(&design);
            let weights = random_weights(&sheet);
            let value = |design: &DesignVector| weighted(&held(design).1, &weights);
            let found = pulled_back(&pattern, &sheet, &weights, &design);
            assert_slopes(value, &design, &found);
        }
    }
}

fn random_weights(sheet: &Sheet) -> SheetGradient {
    let mut random = Random::new(7);
    let (panels, hinges) = (sheet.panels.len(), sheet.hinges.len());
    SheetGradient {
        corners: (random.arrays(4 * panels, 1.0).as_chunks().0.iter())
            .map(|corners: &[[f64; 2]; 4]| corners.map(complex))
            .collect(),
        references: random.arrays(panels, 1.0).into_iter().map(complex).collect(),
        centroids: random.arrays(panels, 1.0).into_iter().map(complex).collect(),
        areas: random.numbers(panels, 1.0),
        attachments: random.arrays(hinges, 1.0).into_iter().map(complex).collect(),
        tips: random.arrays(hinges, 1.0).into_iter().map(complex).collect(),
        frame_angles: random.numbers(hinges, 1.0),
        alphas: random.numbers(hinges, 1.0),
        widths: random.numbers(hinges, 1.0),
        holes: random.numbers(hinges, 1.0),
    }
}

fn weighted(sheet: &Sheet, weights: &SheetGradient) -> f64 {
    let mut sum = 0.0;
    for (k, panel) in sheet.panels.iter().enumerate() {
        let by_corners = weights.corners[k].map(point);
        sum += dot(panel.corners.as_flattened(), by_corners.as_flattened());
        sum += dot(&panel.reference, &point(weights.references[k]));
        sum += dot(&panel.centroid, &point(weights.centroids[k]));
        sum += panel.area * weights.areas[k];
    }
    for (h, hinge) in sheet.hinges.iter().enumerate() {
        sum += dot(&hinge.attachment, &point(weights.attachments[h]));
        sum += dot(&hinge.tip, &point(weights.tips[h]));
        sum += weights.frame_angles[h] * hinge.e_sec[1].atan2(hinge.e_sec[0]);
        sum += weights.alphas[h] * hinge.alpha + weights.widths[h] * hinge.w_lig;
        sum += weights.holes[h] * sheet.designs()[h].fillet_ratio;
    }
    sum
}

#[test]
fn the_ideal_deployment_is_pulled_back_to_the_design_and_the_opening() {
    let design = DesignVector { opening: Some(0.9), ..start() };
    let given = cases::outline(&case("p1_3x3_random"));
    let weights: Vec<[f64; 3]> = Random::new(8).arrays(9, 1.0);
    let value = |design: &DesignVector| {
        let (_, sheet) = cut(design, given, AT_CORNER);
        let configuration = ideal_deployment(&sheet, design.opening.unwrap());
        dot(configuration.as_flattened(), weights.as_flattened())
    };
    let (pattern, sheet) = cut(&design, given, AT_CORNER);
    let mut by_sheet = SheetGradient::zeros(&sheet.topology);
    let by_opening = ideal_deployment_pullback(&sheet, 0.9, &weights, &mut by_sheet);
    let found = DesignVector {
        opening: Some(by_opening),
        ..pulled_back(&pattern, &sheet, &by_sheet, &design)
    };
    assert_slopes(value, &design, &found);
}
