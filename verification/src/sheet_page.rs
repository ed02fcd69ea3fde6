//! The page of a whole sheet by finite elements.

use crate::sheet_check::{HingeCheck, PanelCheck, SheetCheck, StateCheck};
use mesher::Panels;
use support::statistics::median;
use support::table::{Cell, Columns, Table};
use support::{Extremes, document::Document};

/// Number of rows of a path on the page.
const ROWS: usize = 12;

impl SheetCheck {
    /// The page of the check.
    pub fn document(&self) -> Document {
        let ([panels, hinges], [least, most]) = (self.counts, self.slenderness);
        let mut page = Document::default();
        page.heading(1, "The whole sheet, by finite elements");
        page.text(format!(
            "The {}, {}: {panels} panels, {hinges} hinges, windows of tier {}, ligaments {least:.2} to {most:.2} times as wide as the \
             sheet is thick. {} By law: the equilibrium with the \
             scene's hinge law, whose panels are rigid and stay in the plane; between its load steps it is interpolated.",
            self.design,
            self.support.in_words(),
            self.tier,
            match self.model {
                Panels::Rigid => "Every window is meshed, and a panel is a rigid body that holds the arcs of its windows.",
                Panels::Meshed => "Every window and every panel is meshed, and nothing is rigid.",
            },
        ));
        let [meshed, of_law] = self.radius;
        if meshed < of_law {
            page.text(format!(
                "The windows of {of_law} mm of the hinge law have no room between each other: the windows of the mesh have {meshed:.1} mm and more, and \
                 the energies of hinges below lack what is outside of that."
            ));
        }
        page.list(&self.findings);
        page.text(format!(
            "{} {} unknowns, {:.0} CPU s{}.",
            if self.contact {
                "The flanks of a cut touch if its ligament is at most twice as wide as the sheet is thick. Not modelled here: friction, creep."
            } else {
                "Not modelled here: contact of the flanks of the cuts, friction, creep."
            },
            self.unknowns,
            self.cpu_seconds,
            if self.dynamic { ", dynamic" } else { "" },
        ));
        if let Some(last) = self.last() {
            self.add_path(&mut page, last);
        }
        page
    }

    fn add_path(&self, page: &mut Document, last: &StateCheck) {
        page.heading(2, "Along the path");
        page.text(format!(
            "Corners: distance in space between the rigid motion that the nodes of a panel follow best and its place by law; at the end \
             {:.3} % of the longer side of the flat sheet, {:.0} mm, in the root mean square. Panels bend by {:.3} mm at most. \
             Tilt by law is by the bumps of ligaments. Margin: below 1 the panels leave their plane, by law, of its next load step.",
            100.0 * last.corners[0] / self.size,
            self.size,
            last.bending
        ));
        let stride = self.path.len().div_ceil(ROWS).max(1);
        let kept = (self.path.iter().enumerate())
            .filter(|(i, _)| (self.path.len() - 1 - i).is_multiple_of(stride));
        page.table(path_columns().table(kept.map(|(_, state)| state)));
        page.text(format!(
            "Panels outside of the windows hold {:.2} % of the energy.",
            100.0 * self.panel_energy
        ));
        if let Some([by_law, by_elements]) = self.seen {
            page.text(format!("Seen of the target: {by_elements:.3}; by law {by_law:.3}."));
        }
        page.text(self.support_forces());
        page.table(self.hinge_table());
        page.table(self.panel_table());
    }

    /// Median and largest of the forces of the supports.
    fn support_forces(&self) -> String {
        let [by_law, by_elements] = self.supports.each_ref().map(|forces| {
            if forces.is_empty() {
                return "not known".to_owned();
            }
            let largest = forces.iter().copied().largest();
            format!("median {:.3} N, largest {largest:.3} N", median(forces.clone()))
        });
        format!("Forces of supports: {by_elements}; by law {by_law}.")
    }

    fn hinge_table(&self) -> Table {
        let peak = |peak: Option<f64>| Cell::known(peak.map(|peak| Cell::fixed(peak, 3)), "?");
        Columns::new()
            .column("hinge", |hinge: &HingeCheck| hinge.hinge)
            .column("w_lig\nmm", |hinge| Cell::fixed(hinge.w_lig, 2))
            .column("theta\ndeg", |hinge| Cell::fixed(hinge.theta_deg[1], 2))
            .column("by law", |hinge| Cell::fixed(hinge.theta_deg[0], 2))
            .column("W\nN mm", |hinge| Cell::fixed(hinge.energy[1], 4))
            .column("by law", |hinge| Cell::fixed(hinge.energy[0], 4))
            .column("D_peak", move |hinge| peak(hinge.d_peak[1]))
            .column("by law", move |hinge| peak(hinge.d_peak[0]))
            .table(&self.hinges)
    }

    fn panel_table(&self) -> Table {
        Columns::new()
            .column("panel", |panel: &PanelCheck| panel.panel)
            .column("tilt\ndeg", |panel| Cell::fixed(panel.tilt_deg, 2))
            .column("corner furthest off\nmm", |panel| Cell::fixed(panel.off, 3))
            .column("lowest\nmm", |panel| Cell::fixed(panel.z[0], 2))
            .column("highest\nmm", |panel| Cell::fixed(panel.z[1], 2))
            .column("bending\nmm", |panel| Cell::fixed(panel.bending, 3))
            .table(&self.panels)
    }
}

/// The columns of a path; of a pair, the law is first.
fn path_columns() -> Columns<'static, StateCheck> {
    let of = |pair: Option<[f64; 2]>, i: usize| pair.map(|pair| pair[i]);
    Columns::new()
        .column("path\n%", |state: &StateCheck| Cell::fixed(100.0 * state.fraction, 1))
        .column("stroke\nmm", move |state| Cell::fixed(of(state.stroke, 1), 3))
        .column("by law", move |state| Cell::fixed(of(state.stroke, 0), 3))
        .column("load\nN", move |state| Cell::fixed(of(state.load, 1), 4))
        .column("by law", move |state| Cell::fixed(of(state.load, 0), 4))
        .column("mean opening\ndeg", |state| Cell::fixed(state.opening_deg[1], 2))
        .column("by law", |state| Cell::fixed(state.opening_deg[0], 2))
        .column("corners\nmm", |state| Cell::fixed(state.corners[0], 3))
        .column("max", |state| Cell::fixed(state.corners[1], 3))
        .column("tilt\ndeg", |state| Cell::fixed(state.tilt_deg, 2))
        .column("by law", move |state| Cell::fixed(state.tilt_by_law_deg, 2))
        .column("lift\nmm", |state| Cell::fixed(state.z[1], 2))
        .column("margin", move |state| Cell::fixed(state.margin, 2))
}
