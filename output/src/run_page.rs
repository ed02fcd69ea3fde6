//! `run.html`: a run on one page that needs no other file and no network.
//!
//! The page consists of a template, a style, scripts and the data of the run as JSON, in which long lists of numbers
//! are base64 of little-endian 32-bit floats. The data are inserted as text that contains no `<`, so that no title
//! can end the element that holds them.

mod hinge_states;
mod packed;
mod page_data;

use crate::display::text_of_element;
use crate::report::Report;
use design::scene::Scene;
use design::scene::design_run::Designed;
use page_data::PageData;

const TEMPLATE: &str = include_str!("run_page/page.html");
const STYLE: &str = include_str!("run_page/page.css");
const SCRIPTS: [&str; 7] = [
    include_str!("run_page/data.js"),
    include_str!("run_page/colours.js"),
    include_str!("run_page/labels.js"),
    include_str!("run_page/sheet.js"),
    include_str!("run_page/charts.js"),
    include_str!("run_page/hinge.js"),
    include_str!("run_page/page.js"),
];

pub(super) fn run_page(
    scene: &Scene,
    designed: &Designed,
    report: &Report,
) -> Result<String, serde_json::Error> {
    let data = serde_json::to_string(&PageData::new(scene, designed, report))?;
    let filled = |marker: &str| match marker {
        "title" => text_of_element(&report.title),
        "style" => STYLE.to_owned(),
        "scripts" => SCRIPTS.concat(),
        _ => data.replace('<', "\\u003c"),
    };
    // Only the template is searched for markers: a title may contain one.
    let mut pieces = TEMPLATE.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (marker, text) = piece.split_once("}}").unwrap_or((piece, ""));
        page += &filled(marker);
        page += text;
    }
    Ok(page)
}
