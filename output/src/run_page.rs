//! `run.html`: a run on one page that needs no other file and no network. `kirigami studio` shows a
//! scene on the same page, with controls.
//!
//! The page consists of a template, a style, scripts and the data of the run as JSON, in which long
//! lists of numbers are base64 of little-endian 32-bit floats. The data are inserted as text that
//! contains no `<`, so that no title can end the element that holds them.

mod hinge_states;
mod packed;
mod page_data;

pub use page_data::{history, page_data, sheet_data};

use crate::{display::text_of_element, report::Report};
use scene::{Scene, design_run::Designed};

const TEMPLATE: &str = include_str!("run_page/page.html");
const STYLE: &str = include_str!("run_page/page.css");
const SCRIPTS: [&str; 8] = [
    include_str!("run_page/data.js"),
    include_str!("run_page/colours.js"),
    include_str!("run_page/labels.js"),
    include_str!("run_page/sheet.js"),
    include_str!("run_page/charts.js"),
    include_str!("run_page/hinge.js"),
    include_str!("run_page/paper.js"),
    include_str!("run_page/view.js"),
];
const OF_RUN: &str = include_str!("run_page/page.js");

/// What a page adds to the view of a sheet.
#[derive(Default)]
pub struct PageContent<'a> {
    /// Its title.
    pub title: &'a str,
    /// What it may connect to, as a directive of its content security policy.
    pub connections: &'a str,
    /// HTML before the cards.
    pub controls: &'a str,
    /// Style after the style of the view.
    pub style: &'a str,
    /// Scripts after the scripts of the view.
    pub scripts: String,
    /// Data as JSON.
    pub data: &'a str,
}

pub(super) fn run_page(scene: &Scene, designed: &Designed, report: &Report) -> String {
    let data = page_data(scene, designed, report).to_string();
    let page = PageContent {
        title: &report.title,
        scripts: OF_RUN.to_owned(),
        data: &data,
        ..PageContent::default()
    };
    page.to_html()
}

impl PageContent<'_> {
    /// The text of the page.
    pub fn to_html(&self) -> String {
        let filled = |marker: &str| match marker {
            "title" => text_of_element(self.title),
            "style" => STYLE.to_owned() + self.style,
            "scripts" => SCRIPTS.concat() + &self.scripts,
            "connections" => self.connections.to_owned(),
            "controls" => self.controls.to_owned(),
            _ => self.data.replace('<', "\\u003c"),
        };
        // Only the template is searched for markers: a title may contain one.
        let mut pieces = TEMPLATE.split("{{");
        let mut page = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let (marker, text) = piece.split_once("}}").unwrap_or((piece, ""));
            page += &filled(marker);
            page += text;
        }
        page
    }
}
