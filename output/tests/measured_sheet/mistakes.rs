//! Points that cannot be compared, or determine too little.

use super::*;

#[test]
fn centres_alone_need_a_known_scale() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let points = measured(&path, POSITION, false, 1.0);
    let error = MeasuredSheet::new(&path, &points, Scale::Free).unwrap_err().to_string();
    assert!(error.contains("a wider opening look alike: measure corners"), "{error}");
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    assert!((found.best.position - POSITION).abs() < 1e-6);
    let panels = MeasuredPanel::all(path.sheet, &found.best);
    let openings = openings(path.sheet, &found.best, &panels);
    assert_eq!((panels.len(), openings.len()), (50, 0));
}

#[test]
fn points_that_cannot_be_compared_are_refused() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let points = corners(&path);
    let mut same = points.clone();
    (same.iter_mut()).for_each(|point| point.position = [1.0, 2.0]);
    for (points, message) in
        [(&points[..0], "0 measured points"), (&points[..3], "3 measured"), (&same, "coincide")]
    {
        let error = MeasuredSheet::new(&path, points, Scale::Given).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

/// Four corners of one panel fit every state of the path.
#[test]
fn one_panel_determines_no_load_factor() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let mut points = corners(&path);
    points.truncate(4);
    disturb(&mut points, 0.5, 5);
    let panel = points[0].mark.panel;
    assert!(points.iter().all(|point| point.mark.panel == panel));
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    assert_eq!(found.load_factor_error, None);
    let page =
        MeasurementReport::new("one panel", path.sheet, &found, None, &[]).document().to_string();
    for text in ["not determined", "note: the points do not determine the load factor"] {
        assert!(page.contains(text), "{page}");
    }
    let shift = page.lines().find(|line| line.starts_with("removed: shift"));
    assert!(shift.unwrap().contains(") mm, rotation"), "{page}");
}
