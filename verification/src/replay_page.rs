//! The page of a replay.

use crate::compared_states::{SCALE, spread_table};
use crate::replay::Replay;
use support::document::Document;

impl Replay {
    /// The page of the replay.
    pub fn document(&self) -> Document {
        let (groups, hinges) = (self.groups(), &self.hinges);
        let states = groups.iter().map(|states| states.len()).sum::<usize>();
        let inside = hinges.iter().map(|hinge| hinge.inside).sum::<f64>() / hinges.len() as f64;
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
        if !self.unsolved.is_empty() {
            page.text("Not solved, so that the errors at these hinges are not known and count nowhere above:");
        }
        page.list(&self.unsolved);
        page
    }
}
