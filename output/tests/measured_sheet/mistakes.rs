//! Outliers, mistakes of the file, and points that cannot be compared.

use super::*;

#[test]
fn three_of_200_points_that_are_wrong_by_20_mm_are_named() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let mut points = corners(&path);
    assert_eq!(points.len(), 200);
    disturb(&mut points, 2.0, 3);
    let clean = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    for (wrong, by) in [(11, [20.0, 0.0]), (90, [-12.0, 16.0]), (173, [0.0, -20.0])] {
        points[wrong].position[0] += by[0];
        points[wrong].position[1] += by[1];
    }
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    let outliers = found.best.points.iter().enumerate();
    let outliers: Vec<usize> = outliers
        .filter(|(_, it)| it.outlier)
        .map(|pair| pair.0)
        .collect();
    assert_eq!(outliers, [11, 90, 173]);
    assert_eq!(found.renumbered, []);
    // Three points of 200 fewer move the load factor by less than its standard error.
    let moved = found.best.shape.load_factor - clean.best.shape.load_factor;
    assert!(moved.abs() < clean.load_factor_error.unwrap(), "{moved}");
}

#[test]
fn a_third_of_the_points_may_be_anywhere() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let mut points = corners(&path);
    for (i, point) in points.iter_mut().enumerate().filter(|(i, _)| i % 3 == 0) {
        point.position = [1e4 * (i as f64).sin(), 1e4];
    }
    let found = MeasuredSheet::new(&path, &points, Scale::Free).unwrap();
    assert!((found.best.position - POSITION).abs() < 1e-6);
    assert!(
        found
            .best
            .points
            .iter()
            .enumerate()
            .all(|(i, it)| it.outlier == (i % 3 == 0))
    );
}

#[test]
fn swapped_panels_and_turned_corners_are_named() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let mut points = corners(&path);
    disturb(&mut points, 0.5, 5);
    for point in &mut points {
        match point.mark.panel {
            7 => point.mark.panel = 32,
            32 => point.mark.panel = 7,
            20 => point.mark.corner = point.mark.corner.map(|corner| (corner + 1) % 4),
            _ => {}
        }
    }
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    let plain = [0, 1, 2, 3];
    let expected = [
        Renumbered {
            panel: 7,
            lies_at: 32,
            corners: plain,
        },
        Renumbered {
            panel: 20,
            lies_at: 20,
            corners: [3, 0, 1, 2],
        },
        Renumbered {
            panel: 32,
            lies_at: 7,
            corners: plain,
        },
    ];
    assert_eq!(found.renumbered, expected);
    assert_eq!(
        found
            .best
            .points
            .iter()
            .filter(|point| point.outlier)
            .count(),
        12
    );
}

#[test]
fn mistakes_of_the_whole_file_are_errors_that_say_which() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let refused = |change: &dyn Fn(&mut MeasuredPoint), scale| {
        let mut points = corners(&path);
        disturb(&mut points, 1.0, 9);
        points.iter_mut().for_each(change);
        MeasuredSheet::new(&path, &points, scale).unwrap_err()
    };
    for scale in [Scale::Given, Scale::Free] {
        let mirrored = refused(&|point| point.position[1] *= -1.0, scale);
        assert!(
            matches!(
                mirrored,
                MeasurementError::Misread(Misread::Mirrored { .. })
            ),
            "{mirrored}"
        );
        let turned = refused(
            &|point| point.mark.corner = point.mark.corner.map(|corner| (corner + 3) % 4),
            scale,
        );
        let MeasurementError::Misread(Misread::CornerOrder { order, .. }) = turned else {
            panic!("{turned}");
        };
        assert_eq!(order, [1, 2, 3, 0]);
    }
    let in_cm = refused(
        &|point| point.position = point.position.map(|x| x / 10.0),
        Scale::Given,
    );
    let MeasurementError::Misread(Misread::Scale { factor, .. }) = in_cm else {
        panic!("{in_cm}");
    };
    // The scale of 200 points that scatter by 1 mm over 1 m is known to much better than 1 %.
    assert!((factor / 0.1 - 1.0).abs() < 0.01, "{factor}");
}

#[test]
fn centres_alone_need_a_known_scale() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let points = measured(&path, POSITION, false, 1.0);
    let error = MeasuredSheet::new(&path, &points, Scale::Free).unwrap_err();
    assert_eq!(error, MeasurementError::ScaleUnknown);
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    assert!((found.best.position - POSITION).abs() < 1e-6);
    let panels = MeasuredPanel::all(path.sheet, &found.best);
    assert_eq!(
        (
            panels.len(),
            openings(path.sheet, &found.best, &panels).len()
        ),
        (50, 0)
    );
}

#[test]
fn points_that_cannot_be_compared_are_refused() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let points = corners(&path);
    let refused =
        |points: &[MeasuredPoint]| MeasuredSheet::new(&path, points, Scale::Given).unwrap_err();
    assert_eq!(refused(&[]), MeasurementError::TooFew(0));
    assert_eq!(refused(&points[..3]), MeasurementError::TooFew(3));
    let changed = |change: &dyn Fn(&mut MeasuredPoint)| {
        let mut points = points.clone();
        change(&mut points[5]);
        match refused(&points) {
            MeasurementError::Point {
                index: 5, fault, ..
            } => fault,
            other => panic!("{other}"),
        }
    };
    let first = points[2].mark;
    assert_eq!(
        changed(&|point| point.position[0] = f64::NAN),
        PointFault::NotFinite
    );
    assert_eq!(
        changed(&|point| point.position[1] = f64::INFINITY),
        PointFault::NotFinite
    );
    assert_eq!(
        changed(&|point| point.mark.panel = 50),
        PointFault::NoSuchPanel { last: 49 }
    );
    assert_eq!(
        changed(&|point| point.mark.corner = Some(4)),
        PointFault::NoSuchCorner
    );
    assert_eq!(
        changed(&|point| point.mark = first),
        PointFault::Repeated { first: 2 }
    );
    let mut same = points.clone();
    same.iter_mut()
        .for_each(|point| point.position = [1.0, 2.0]);
    assert_eq!(refused(&same), MeasurementError::Coincide);
}

/// Four corners of one panel fit every state of the path.
#[test]
fn one_panel_determines_no_load_factor() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let mut points = corners(&path);
    points.truncate(4);
    disturb(&mut points, 0.5, 5);
    assert!(
        points
            .iter()
            .all(|point| point.mark.panel == points[0].mark.panel)
    );
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    assert_eq!(found.load_factor_error, None);
    let page = MeasurementReport::new("one panel", path.sheet, &found, None, &[]).to_string();
    for text in [
        "not determined",
        "note: the points do not determine the load factor",
    ] {
        assert!(page.contains(text), "{page}");
    }
    let shift = page.lines().find(|line| line.starts_with("removed: shift"));
    assert!(shift.unwrap().contains(") mm, rotation"), "{page}");
}

#[test]
fn a_deployed_sheet_in_place_of_the_closed_one_is_suspected() {
    let (problem, deployment) = deployed();
    let path = ShapePath::new(&problem, &deployment);
    let points = corners(&path);
    let found = MeasuredSheet::new(&path, &points, Scale::Given).unwrap();
    let flat = ShapePath::flat(path.sheet);
    for (closed, doubtful) in [(measured(&path, 0.0, true, 1.0), false), (points, true)] {
        let closed = MeasuredSheet::new(&flat, &closed, Scale::Given).unwrap();
        let closed = Some(&closed.best);
        let report = MeasurementReport::new("closed", path.sheet, &found, closed, &[]);
        assert_eq!(report.closed.as_ref().unwrap().doubtful, doubtful);
        let page = report.to_string();
        assert_eq!(
            page.contains("warning: these points are more than half"),
            doubtful,
            "{page}"
        );
    }
}
