//! Holes for nails and hooks, clips, and where they must not be.

use super::{W_LIG, uniform};
use design::sheet::cut_sheet::AttachmentPoint;
use design::sheet::cut_sheet::PanelPoint;
use output::cut_file::{CutLines, Layer, attachment_list, dxf};
use output::display::Shape;
use scene::CuttingConfig;
use support::Fault;

fn attachment(point: PanelPoint) -> AttachmentPoint {
    AttachmentPoint {
        name: "load, panel [1,1]".to_owned(),
        panel: 4,
        point,
        ..AttachmentPoint::default()
    }
}

fn cuts(attachment: AttachmentPoint) -> Result<CutLines, Fault> {
    let (pattern, sheet) = uniform(W_LIG);
    CutLines::new(&pattern, &sheet, CuttingConfig::default(), &[attachment])
}

/// The middle of the sheet and of its panel 4, and half the side of that.
fn middle() -> ([f64; 2], f64) {
    let (_, sheet) = uniform(W_LIG);
    let panel = &sheet.panels[4];
    (panel.centroid, 0.5 * panel.area.sqrt())
}

#[test]
fn a_hole_is_cut_and_listed() {
    let ([x, y], _) = middle();
    let at = [x - 3.0, y + 2.0];
    let hooked = AttachmentPoint { hole: Some(6.0), ..attachment(PanelPoint::Fixed(at)) };
    let cuts = cuts(hooked).unwrap();
    let drawing = cuts.drawing();
    let holes: Vec<&Shape> = drawing.on(Layer::AttachmentHoles).collect();
    let radius = 3.0 - 0.5 * cuts.slit_width;
    assert_eq!(holes, [&Shape::Circle { centre: at, radius }]);
    assert!(drawing.on(Layer::Attachments).next().is_none());
    // The holes of the ligaments are as many as without it.
    assert_eq!(drawing.on(Layer::Holes).count(), 12);
    assert!(dxf(&drawing).contains("ATTACHMENT_HOLES"));
    let row = format!("\"load, panel [1,1]\",4,{:.3},{:.3},6.000,\n", at[0], at[1]);
    assert!(attachment_list(&cuts, None).ends_with(&row));
}

#[test]
fn a_clip_lies_on_its_edge_and_is_not_cut() {
    let ([x, y], half) = middle();
    let clip = |width: f64| AttachmentPoint {
        clip: Some(width),
        ..attachment(PanelPoint::Middle([0, 1]))
    };
    let drawing = cuts(clip(10.0)).unwrap().drawing();
    let [Shape::Line(ends)] = drawing.on(Layer::Attachments).collect::<Vec<_>>()[..] else {
        panic!("no line");
    };
    let expected = [[x - 5.0, y - half], [x + 5.0, y - half]];
    for (found, expected) in std::iter::zip(ends, &expected) {
        assert!((found[0] - expected[0]).abs() < 1e-9 && (found[1] - expected[1]).abs() < 1e-9);
    }
    assert!(!Layer::Attachments.is_cut() && Layer::AttachmentHoles.is_cut());
    for (width, expected) in [(2.1 * half, "wide"), (1.5 * half, "from the tip")] {
        let error = cuts(clip(width)).unwrap_err().to_string();
        assert!(error.starts_with("the clip of load, panel [1,1] is"), "{error}");
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_hole_near_an_edge_or_a_hinge_is_refused() {
    let ([x, y], half) = middle();
    let hole = |at: [f64; 2], diameter: f64| {
        let hooked = AttachmentPoint { hole: Some(diameter), ..attachment(PanelPoint::Fixed(at)) };
        cuts(hooked).map(|_| ()).map_err(|error| error.to_string())
    };
    // A radius of material is left at the distance of a diameter, and half a slit, from the cut.
    let kerf = 0.5 * super::KERF;
    hole([x, y - half + 8.0 + kerf + 1e-6], 8.0).unwrap();
    let error = hole([x, y - half + 8.0 + kerf - 1e-3], 8.0).unwrap_err();
    assert!(error.contains("the edge of its panel"), "{error}");
    let (_, sheet) = uniform(W_LIG);
    let mut hinges = sheet.hinges.iter();
    let near = hinges.find(|hinge| hinge.panels().contains(&4));
    let tip = near.unwrap().tip;
    let towards = |share: f64| [0, 1].map(|c| tip[c] + share * ([x, y][c] - tip[c]));
    let error = hole(towards(0.3), 2.0).unwrap_err();
    assert!(error.contains("the tip of hinge"), "{error}");
}

#[test]
fn a_point_without_hole_and_clip_is_marked() {
    let cuts = cuts(attachment(PanelPoint::Centroid)).unwrap();
    assert_eq!(cuts.drawing().on(Layer::Attachments).count(), 2);
    assert!(attachment_list(&cuts, None).ends_with(",,\n"));
}
