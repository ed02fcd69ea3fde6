//! The cut list: what to drill, what a caliper reads, and the amount of cutting, as CSV.

use crate::cut_file::{
    cut_lines::CutLines,
    totals::{Totals, holes_by_diameter},
};
use analysis::mounting::{Fastener, Mounting};
use design::{geometry::polygon::distance, sheet::cut_sheet::Sheet};

/// One row a hinge: its hole, its ligament as designed and as measured by a caliper next to the
/// hole, and its panels.
pub fn cut_list(sheet: &Sheet, cuts: &CutLines) -> String {
    let mut text = "hinge,hole_diameter_mm,w_lig_mm,caliper_mm,panel_a,panel_b\n".to_owned();
    for (h, (hinge, hole)) in std::iter::zip(&sheet.hinges, &cuts.holes).enumerate() {
        let (diameter, caliper) = (2.0 * hole.radius, cuts.caliper(h));
        let (w_lig, a, b) = (hinge.w_lig, hinge.panel_a(), hinge.panel_b());
        text += &format!("{h},{diameter:.3},{w_lig:.3},{caliper:.3},{a},{b}\n");
    }
    text
}

/// One row an attachment: what holds or pulls which panel, where in the flat sheet, its hole and
/// its clip; of a mounted sheet also its place on the board and the force that it holds.
pub fn attachment_list(cuts: &CutLines, mounting: Option<&Mounting>) -> String {
    let mut text = "attachment,panel,x_mm,y_mm,hole_diameter_mm,clip_width_mm".to_owned();
    text += if mounting.is_some() { ",board_x_mm,board_y_mm,force_n\n" } else { "\n" };
    let fasteners = || mounting.into_iter().flat_map(|mounting| &mounting.fasteners);
    let or_nothing = |size: Option<f64>| size.map_or(String::new(), |size| format!("{size:.3}"));
    for attachment in &cuts.attachments {
        let ([x, y], name) = (attachment.at, &attachment.name);
        let hole = or_nothing(attachment.hole);
        let clip = or_nothing(attachment.clip.map(|[p, q]| distance(p, q)));
        let panel = attachment.panel;
        text += &format!("\"{name}\",{panel},{x:.3},{y:.3},{hole},{clip}");
        let fastener = fasteners().find(|fastener| fastener.panel == panel);
        text += &fastener.map_or(String::new(), |Fastener { place: [x, y], holds, .. }| {
            format!(",{x:.3},{y:.3},{holds:.2}")
        });
        text.push('\n');
    }
    text
}

/// One row a quantity: the totals, and the number of holes by diameter, rounded to 0.1 mm.
pub fn cut_summary(cuts: &CutLines, totals: &Totals) -> String {
    let mut text = format!(
        "quantity,value,unit\nkerf,{},mm\nslit width,{},mm\nover-run,{},mm\nslits,{},\nholes,{},\npierces,{},\ncut length,{:.3},m\n\
         idle travel,{:.3},m\n",
        cuts.kerf(),
        cuts.slit_width,
        cuts.cutting.over_run,
        totals.slits,
        totals.holes,
        totals.pierces,
        totals.cut_m,
        totals.idle_m
    );
    for (tenths, count) in holes_by_diameter(cuts.holes.iter().map(|hole| hole.radius)) {
        text += &format!("holes of diameter {:.1} mm,{count},\n", 0.1 * tenths as f64);
    }
    text
}
