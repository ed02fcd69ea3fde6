//! What is recovered from correct points, and how accurately.

use super::*;

#[test]
fn an_exact_measurement_is_recovered_with_its_pose_scale_and_load() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let truth = path.at(POSITION);
    for (scale, factor) in [(Scale::Given, 1.0), (Scale::Free, 0.37)] {
        let points = measured(&path, POSITION, true, factor);
        let found = MeasuredSheet::new(&path, &points, scale).unwrap();
        // The search along the path ends at 1e-9 of a step, of which a panel moves by some mm.
        assert!(squares(&found).sqrt() < 1e-5);
        assert!((found.best.shape.load_factor - truth.load_factor).abs() < 1e-8);
        assert!((found.best.motion.scale() / factor - 1.0).abs() < 1e-8);
        assert!((found.best.motion.rotation() - 0.7).abs() < 1e-8);
        let distances = found.full.points.iter().map(|point| point.distance());
        assert!(distances.sum::<f64>() > 1.0);
        let panels = MeasuredPanel::all(path.sheet, &found.best);
        let openings = openings(path.sheet, &found.best, &panels);
        let expected = hinge_deformations(path.sheet, &truth.configuration);
        assert_eq!(openings.len(), expected.len());
        for (opening, expected) in openings.iter().zip(expected) {
            assert!((opening.measured_deg - expected.theta.to_degrees()).abs() < 1e-9);
        }
    }
}

/// With n points of Gaussian errors sigma and u fitted unknowns, the sum of squares over sigma^2
/// has the chi-squared distribution of 2 n - u degrees of freedom, whose standard deviation is
/// sqrt(2 (2 n - u)). Four of them are exceeded by one of 16 000 measurements.
#[test]
fn gaussian_errors_give_the_rms_of_the_chi_distribution() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    for (scale, unknowns) in [(Scale::Given, 4.0), (Scale::Free, 5.0)] {
        let (sigma, mut sum, mut within, mut free) = (2.0, 0.0, 0.0, 0.0);
        for seed in 0..10 {
            let mut points = corners(&path);
            disturb(&mut points, sigma, seed);
            let found = MeasuredSheet::new(&path, &points, scale).unwrap();
            sum += squares(&found) / sigma.powi(2);
            free += 2.0 * found.best.points.len() as f64 - unknowns;
            let panels = MeasuredPanel::all(path.sheet, &found.best);
            within += (scatter(&panels).unwrap() / sigma).powi(2);
        }
        assert!((sum - free).abs() < 4.0 * (2.0 * free).sqrt(), "{sum}");
        // Ten times 50 panels of eight numbers and three unknowns.
        let inside = (2.0 / 2500.0_f64).sqrt();
        assert!((within / 10.0 - 1.0).abs() < 4.0 * inside, "{within}");
    }
}

/// Normalised by the standard error that each fit states, the squared errors of the load factor
/// have a mean of 1 with a standard deviation of sqrt(2 / 40).
#[test]
fn the_load_factor_is_found_with_the_standard_error_that_is_stated() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let truth = path.at(POSITION).load_factor;
    let mut sum = 0.0;
    for seed in 0..40 {
        let mut points = corners(&path);
        disturb(&mut points, 1.0, 100 + seed);
        let found = MeasuredSheet::new(&path, &points, Scale::Free).unwrap();
        let error = found.best.shape.load_factor - truth;
        sum += (error / found.load_factor_error.unwrap()).powi(2);
    }
    let allowed = 4.0 * (2.0 / 40.0_f64).sqrt();
    assert!((sum / 40.0 - 1.0).abs() < allowed, "{sum}");
}

/// The stated errors of the openings are the errors that the noise causes: their normalised squares
/// have a mean of 1. The 85 openings of a sheet share panels; four standard deviations of 50
/// independent ones are 0.8.
#[test]
fn the_openings_have_the_standard_error_that_is_stated() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let mut points = corners(&path);
    disturb(&mut points, 1.0, 7);
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    let panels = MeasuredPanel::all(path.sheet, &found.best);
    let openings = openings(path.sheet, &found.best, &panels);
    let normalised = openings.iter().map(|opening| {
        let error = opening.measured_deg - opening.predicted_deg;
        (error / opening.error_deg).powi(2)
    });
    let mean = normalised.sum::<f64>() / openings.len() as f64;
    assert!((mean - 1.0).abs() < 0.8, "{mean}");
}

#[test]
fn a_slip_of_the_support_is_removed_and_measured_against_the_closed_sheet() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let closed = measured(&path, 0.0, true, 1.0);
    let mut points = corners(&path);
    let along = [26.6 * 0.8, -26.6 * 0.6];
    for point in &mut points {
        point.position = [point.position[0] + along[0], point.position[1] + along[1]];
    }
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    assert!(squares(&found).sqrt() < 1e-5);
    let flat = ShapePath::flat(path.sheet);
    let closed = MeasuredSheet::new(&flat, &closed, Scale::Given).unwrap();
    assert_eq!(closed.load_factor_error, None);
    let slipped = |panel| slip(path.sheet, &closed.best, &found.best, panel).unwrap();
    let [x, y] = slipped(GRID.panel(0, 4));
    // In the frame of the design, which is turned by 0.7.
    let (sin, cos) = 0.7_f64.sin_cos();
    assert!((x - (cos * along[0] + sin * along[1])).abs() < 1e-6, "{x}");
    assert!((y - (cos * along[1] - sin * along[0])).abs() < 1e-6, "{y}");
}

#[test]
fn missing_points_in_any_order_change_nothing() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let mut points = corners(&path);
    points.retain(|point| (point.mark.panel * 7 + point.mark.corner.unwrap()) % 3 == 0);
    points.reverse();
    let found = MeasuredSheet::new(&path, &points, Scale::Free).unwrap();
    assert!(squares(&found).sqrt() < 1e-5);
    assert!((found.best.position - POSITION).abs() < 1e-6);
    let panels = MeasuredPanel::all(path.sheet, &found.best);
    assert!(openings(path.sheet, &found.best, &panels).len() < path.sheet.hinges.len());
}
