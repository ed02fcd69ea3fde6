//! The page of a replay, and its table of states.

use crate::compared_states::{SCALE, spread_table};
use crate::recorded_path::RecordedPath;
use crate::replay::{Replay, ReplayedHinge};
use dataset::{COMPARED, ComparedState};
use support::document::Document;
use support::table::{Cell, Columns, Table};

impl Replay {
    /// The page of the replay.
    pub fn document(&self) -> Document {
        let (groups, hinges) = (self.groups(), &self.hinges);
        let states = groups.iter().map(|states| states.len()).sum::<usize>();
        let inside = hinges.iter().map(|hinge| hinge.inside).sum::<f64>() / hinges.len() as f64;
        let total = |energy: fn(&ComparedState) -> f64| -> f64 {
            let ends = groups.iter().filter_map(|states| states.last());
            ends.map(energy).sum()
        };
        let (learned, solved) = (total(|end| end.value[0]), total(|end| end.reference[0]));
        let mut page = Document::default();
        page.heading(1, "The hinges of a sheet, replayed");
        page.text(format!(
            "The {}: {states} states of {} hinges on their paths in the sheet, windows of tier {}; {:.0} % of the \
             states inside the training domain. Differences of the surrogate from the finite elements are root mean \
             squares, relative to the root mean square of the finite elements: {SCALE}. D and D_peak of a hinge are known, \
             and compared, until it leaves the domain.",
            self.name,
            hinges.len(),
            self.tier,
            100.0 * inside,
        ));
        page.table(spread_table(&groups, "hinge"));
        page.text(format!(
            "Energy of these hinges at full load: {learned:.1} N mm by the surrogate, {solved:.1} N mm by finite elements \
             ({:+.2} %).",
            100.0 * (learned / solved - 1.0),
        ));
        page.text("At full load:");
        page.table(ends_table(hinges));
        if !self.unsolved.is_empty() {
            page.text("Not solved, so that the errors at these hinges are not known and count nowhere above:");
        }
        page.list(&self.unsolved);
        page
    }
}

/// Every hinge at full load.
fn ends_table(hinges: &[ReplayedHinge]) -> Table {
    let ends = hinges.iter().filter_map(|hinge| Some((hinge, *hinge.states.last()?)));
    let ends: Vec<(&ReplayedHinge, ComparedState)> = ends.collect();
    let eta = |hinge: &ReplayedHinge| hinge.path.end().eta(hinge.path.design.w_lig);
    let degrees = |angle: f64, decimals| Cell::fixed(angle.to_degrees(), decimals);
    type End<'a> = (&'a ReplayedHinge, ComparedState);
    Columns::new()
        .column("hinge", |(hinge, _): &End| hinge.path.hinge)
        .column("w_lig\nmm", |(hinge, _)| Cell::fixed(hinge.path.design.w_lig, 1))
        .column("alpha\ndeg", |(hinge, _)| degrees(hinge.path.design.alpha, 0))
        .column("eta_a", |(hinge, _)| Cell::fixed(eta(hinge)[0], 3))
        .column("eta_s", |(hinge, _)| Cell::fixed(eta(hinge)[1], 3))
        .column("theta, deg", |(hinge, _)| degrees(hinge.path.end().theta, 1))
        .column("inside", |(hinge, _)| Cell::percent(hinge.inside, 0))
        .column("W\nN mm", |(_, end)| Cell::fixed(end.value[0], 2))
        .column("by FE", |(_, end)| Cell::fixed(end.reference[0], 2))
        .column("M\nN mm", |(_, end)| Cell::fixed(end.value[3], 1))
        .column("by FE", |(_, end)| Cell::fixed(end.reference[3], 1))
        .column("D", |(_, end)| Cell::fixed(end.value[4], 5))
        .column("by FE", |(_, end)| Cell::fixed(end.reference[4], 5))
        .table(&ends)
}

impl Replay {
    /// One row per state; a cell is empty if its value is not known.
    pub fn csv(&self) -> String {
        type State<'a> = (&'a RecordedPath, usize, &'a ComparedState);
        let state = |(path, k, _): &State| path.states[*k];
        let mut columns = Columns::new()
            .column("hinge", |(path, ..): &State| path.hinge)
            .column("w_lig_mm", |(path, ..)| number(path.design.w_lig))
            .column("alpha_deg", |(path, ..)| number(path.design.alpha.to_degrees()))
            .column("step", |(_, k, _)| k + 1)
            .column("eta_a", move |of| number(state(of).eta(of.0.design.w_lig)[0]))
            .column("eta_s", move |of| number(state(of).eta(of.0.design.w_lig)[1]))
            .column("theta_deg", move |of| number(state(of).theta.to_degrees()));
        for (i, name) in COMPARED.iter().enumerate() {
            columns = columns.column(format!("surrogate_{name}"), move |of| number(of.2.value[i]));
        }
        for (i, name) in COMPARED.iter().enumerate() {
            columns = columns.column(format!("fe_{name}"), move |of| number(of.2.reference[i]));
        }
        let states = self.hinges.iter().flat_map(|hinge| {
            let states = hinge.states.iter().enumerate();
            states.map(|(k, state)| (&hinge.path, k, state))
        });
        columns.table(&states.collect::<Vec<State>>()).csv()
    }
}

/// A number with six decimals; an empty cell if it is not known.
fn number(value: f64) -> Cell {
    let known = (!value.is_nan()).then(|| Cell::text(format!("{value:.6}")));
    Cell::known(known, "")
}
