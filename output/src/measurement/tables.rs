//! The report of a measured sheet as parts for people, and its tables.

use crate::measurement::{Agreement, Closed, MeasurementReport, OpeningSpread, Spread};
use analysis::{measured_openings::MeasuredOpening, measured_points::FittedPoint};
use design::objective::scores::shown;
use support::{
    document::Document,
    table::{Cell, Columns, Table},
};

/// Number of hinges and of panels on the printed page; the tables hold all of them.
const LISTED: usize = 12;

impl MeasurementReport {
    /// Measured and predicted position of every point at the best state, in the frame of the design
    /// (mm).
    pub fn residuals_csv(&self) -> String {
        let length = |value: f64| format!("{value:.4}");
        Columns::new()
            .column("panel", |point: &FittedPoint| point.mark.panel)
            .column("corner", |point| Cell::known(point.mark.corner.map(Cell::text), ""))
            .column("measured_x_mm", move |point| length(point.measured[0]))
            .column("measured_y_mm", move |point| length(point.measured[1]))
            .column("predicted_x_mm", move |point| length(point.predicted[0]))
            .column("predicted_y_mm", move |point| length(point.predicted[1]))
            .column("residual_x_mm", move |point| length(point.residual()[0]))
            .column("residual_y_mm", move |point| length(point.residual()[1]))
            .column("distance_mm", move |point| length(point.distance()))
            .table(&self.best_points)
            .csv()
    }

    /// Measured and predicted opening of every measured hinge at the best state.
    pub fn openings_csv(&self) -> String {
        let degrees = |value: f64| format!("{value:.4}");
        Columns::new()
            .column("hinge", |opening: &MeasuredOpening| opening.hinge)
            .column("panel_a", |opening| opening.panels[0])
            .column("panel_b", |opening| opening.panels[1])
            .column("measured_deg", move |opening| degrees(opening.measured_deg))
            .column("error_deg", move |opening| degrees(opening.error_deg))
            .column("predicted_deg", move |opening| degrees(opening.predicted_deg))
            .column("difference_deg", move |opening| degrees(opening.difference_deg()))
            .table(&self.openings)
            .csv()
    }

    /// The report as parts for people.
    pub fn document(&self) -> Document {
        let mut page = Document::default();
        page.heading(1, format!("{}: measured against predicted", self.title));
        page.text("predicted with panels in the plane and without friction");
        page.text(format!("{} points; sheet of {:.1} mm", self.points, self.sheet_size));
        // In mm of the design, also if the points are in pixels.
        let [x, y] = self.motion.origin.map(|x| x / self.motion.scale);
        page.text(format!(
            "removed: shift ({x:.2}, {y:.2}) mm, rotation {:.3} deg, scale {:.5}",
            self.motion.rotation_deg, self.motion.scale
        ));
        if let Some(scatter) = self.scatter {
            page.text(format!("scatter of one coordinate about rigid panels: {scatter:.2} mm"));
        }
        page.table(self.agreement());
        if self.load_factor_error.is_none() {
            page.text(
                "note: the points do not determine the load factor, and the best fit is one of many: measure points on \
                 several panels that turn against each other",
            );
        } else if self.at_the_end {
            page.text(
                "note: the best fit is the end of the path; the sheet may be opened further than predicted",
            );
        }
        if let Some(closed) = &self.closed {
            closed.add_to(&mut page);
        }
        self.add_hinges(&mut page);
        page
    }

    fn agreement(&self) -> Table {
        let best = match self.load_factor_error {
            Some(error) => format!("{} +- {}", shown(self.best.load_factor), shown(error)),
            None => "not determined".to_owned(),
        };
        let mut table = Table::new(["", "end of the path", "best fit"]);
        table.row(["load factor", &shown(self.full.load_factor), &best]);
        let mut row = |name: &str, value: &dyn Fn(&Agreement) -> Option<String>| {
            let [full, best] =
                [&self.full, &self.best].map(|of| value(of).unwrap_or_else(|| "-".to_owned()));
            table.row([name, &full, &best]);
        };
        type Part = fn(&Agreement) -> Option<&Spread>;
        let parts: [(&str, Part); 2] =
            [("corners", |of| of.corners.as_ref()), ("panel centres", |of| of.centres.as_ref())];
        for (name, part) in parts {
            let [rms, percent, maximum] = ["rms (mm)", "rms (% of the sheet)", "maximum (mm)"]
                .map(|quantity| format!("{name}, {quantity}"));
            row(&rms, &|of| Some(format!("{:.2}", part(of)?.rms)));
            row(&percent, &|of| Some(format!("{:.3}", part(of)?.rms_percent)));
            row(&maximum, &|of| Some(format!("{:.2}", part(of)?.max)));
            row("  at", &|of| Some(part(of)?.max_at.clone()));
        }
        type Degrees = fn(&OpeningSpread) -> f64;
        let degrees: [(&str, Degrees); 3] = [
            ("mean measured", |of| of.measured_mean_deg),
            ("mean predicted", |of| of.predicted_mean_deg),
            ("rms about the mean", |of| of.spread_deg),
        ];
        for (name, value) in degrees {
            let name = format!("openings, {name} (deg)");
            row(&name, &|of| Some(format!("{:.2}", value(of.openings.as_ref()?))));
        }
        row("openings, worst (deg)", &|of| Some(format!("{:+.2}", of.openings.as_ref()?.max_deg)));
        row("  at", &|of| Some(format!("hinge {}", of.openings.as_ref()?.max_hinge)));
        table
    }

    fn add_hinges(&self, page: &mut Document) {
        if self.openings.is_empty() {
            page.text("no hinge has two panels with at least two points each");
            return;
        }
        let mut worst: Vec<_> = self.openings.iter().collect();
        worst.sort_by(|a, b| (b.difference_deg().abs()).total_cmp(&a.difference_deg().abs()));
        worst.truncate(LISTED);
        page.text("hinges that differ most, opening in deg (all of them are in openings.csv):");
        let columns = Columns::new()
            .column("hinge", |opening: &MeasuredOpening| opening.hinge)
            .column("panels", |opening| format!("P{} P{}", opening.panels[0], opening.panels[1]))
            .column("measured", |opening| format!("{:.2}", opening.measured_deg))
            .column("+-", |opening| format!("{:.2}", opening.error_deg))
            .column("predicted", |opening| format!("{:.2}", opening.predicted_deg))
            .column("difference", |opening| format!("{:+.2}", opening.difference_deg()));
        page.table(columns.table(worst));
    }
}

impl Closed {
    fn add_to(&self, page: &mut Document) {
        let rms = |spread: &Option<Spread>| {
            spread.as_ref().map_or("-".to_owned(), |spread| format!("{:.2} mm", spread.rms))
        };
        page.text(format!(
            "closed sheet, the floor of the measurement: corners {}, panel centres {} rms",
            rms(&self.floor.corners),
            rms(&self.floor.centres)
        ));
        let above = self.centres_above.iter().map(|panel| format!(" P{panel}"));
        let (count, more) = (above.len(), if above.len() > LISTED { " ..." } else { "" });
        let listed: String = above.take(LISTED).collect();
        page.text(match count {
            0 => "no panel centre is above this floor".to_owned(),
            _ => format!("{count} panel centres are above it:{listed}{more}"),
        });
        page.list(self.slips.iter().map(|slip| {
            let [x, y] = slip.slip;
            format!(
                "slip of the supported panel P{}: {:.2} mm ({x:+.2}, {y:+.2}), if both files are in one frame",
                slip.panel,
                x.hypot(y)
            )
        }));
    }
}
