//! The report of a measured sheet as text and as CSV tables.

use crate::measurement::{Agreement, Closed, MeasurementReport, OpeningSpread, Spread};
use design::objective::scores::shown;
use std::fmt::{self, Write};

/// Number of hinges and of panels on the printed page; the tables hold all of them.
const LISTED: usize = 12;

impl MeasurementReport {
    /// Measured and predicted position of every point at the best state, in the frame of the design (mm).
    pub fn residuals_csv(&self) -> String {
        let mut text =
            "panel,corner,measured_x_mm,measured_y_mm,predicted_x_mm,predicted_y_mm,residual_x_mm,\
                        residual_y_mm,distance_mm\n"
                .to_owned();
        for point in &self.best_points {
            let corner = point.mark.corner.map(|corner| corner.to_string());
            let ([mx, my], [px, py]) = (point.measured, point.predicted);
            let [rx, ry] = point.residual();
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{},{},{mx:.4},{my:.4},{px:.4},{py:.4},{rx:.4},{ry:.4},{:.4}",
                point.mark.panel,
                corner.unwrap_or_default(),
                point.distance()
            );
        }
        text
    }

    /// Measured and predicted opening of every measured hinge at the best state.
    pub fn openings_csv(&self) -> String {
        let mut text =
            "hinge,panel_a,panel_b,measured_deg,error_deg,predicted_deg,difference_deg\n"
                .to_owned();
        for opening in &self.openings {
            let [a, b] = opening.panels;
            let _ = writeln!(
                text,
                "{},{a},{b},{:.4},{:.4},{:.4},{:.4}",
                opening.hinge,
                opening.measured_deg,
                opening.error_deg,
                opening.predicted_deg,
                opening.difference_deg()
            );
        }
        text
    }

    fn agreement(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let best = match self.load_factor_error {
            Some(error) => format!("{} +- {}", shown(self.best.load_factor), shown(error)),
            None => "not determined".to_owned(),
        };
        let full = shown(self.full.load_factor);
        writeln!(f, "{:<38} {:>20} {:>20}", "", "end of the path", "best fit")?;
        writeln!(f, "{:<38} {full:>20} {best:>20}", "load factor")?;
        let mut row = |name: &str, value: &dyn Fn(&Agreement) -> Option<String>| {
            let [full, best] =
                [&self.full, &self.best].map(|of| value(of).unwrap_or_else(|| "-".to_owned()));
            writeln!(f, "{name:<38} {full:>20} {best:>20}")
        };
        type Part = fn(&Agreement) -> Option<&Spread>;
        let parts: [(&str, Part); 2] = [
            ("corners", |of| of.corners.as_ref()),
            ("panel centres", |of| of.centres.as_ref()),
        ];
        for (name, part) in parts {
            let [rms, percent, maximum] = ["rms (mm)", "rms (% of the sheet)", "maximum (mm)"]
                .map(|quantity| format!("{name}, {quantity}"));
            row(&rms, &|of| Some(format!("{:.2}", part(of)?.rms)))?;
            row(&percent, &|of| {
                Some(format!("{:.3}", part(of)?.rms_percent))
            })?;
            row(&maximum, &|of| Some(format!("{:.2}", part(of)?.max)))?;
            row("  at", &|of| Some(part(of)?.max_at.clone()))?;
        }
        type Degrees = fn(&OpeningSpread) -> f64;
        let degrees: [(&str, Degrees); 3] = [
            ("mean measured", |of| of.measured_mean_deg),
            ("mean predicted", |of| of.predicted_mean_deg),
            ("rms about the mean", |of| of.spread_deg),
        ];
        for (name, value) in degrees {
            let name = format!("openings, {name} (deg)");
            row(&name, &|of| {
                Some(format!("{:.2}", value(of.openings.as_ref()?)))
            })?;
        }
        row("openings, worst (deg)", &|of| {
            Some(format!("{:+.2}", of.openings.as_ref()?.max_deg))
        })?;
        row("  at", &|of| {
            Some(format!("hinge {}", of.openings.as_ref()?.max_hinge))
        })
    }

    fn hinges(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.openings.is_empty() {
            return writeln!(f, "\nno hinge has two panels with at least two points each");
        }
        let mut worst: Vec<_> = self.openings.iter().collect();
        worst.sort_by(|a, b| (b.difference_deg().abs()).total_cmp(&a.difference_deg().abs()));
        worst.truncate(LISTED);
        writeln!(
            f,
            "\nhinges that differ most, opening in deg (all of them are in openings.csv):"
        )?;
        writeln!(
            f,
            "  hinge     panels   measured    +-  predicted  difference"
        )?;
        for opening in worst {
            let panels = format!("P{} P{}", opening.panels[0], opening.panels[1]);
            writeln!(
                f,
                "  {:>5} {panels:>10} {:>10.2} {:>5.2} {:>10.2} {:>+11.2}",
                opening.hinge,
                opening.measured_deg,
                opening.error_deg,
                opening.predicted_deg,
                opening.difference_deg()
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for MeasurementReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "{}: measured against predicted\n", self.title)?;
        writeln!(f, "predicted with panels in the plane and without friction")?;
        writeln!(
            f,
            "{} points; sheet of {:.1} mm",
            self.points, self.sheet_size
        )?;
        // In mm of the design, also if the points are in pixels.
        let [x, y] = self.motion.origin.map(|x| x / self.motion.scale);
        let rotation = self.motion.rotation_deg;
        writeln!(
            f,
            "removed: shift ({x:.2}, {y:.2}) mm, rotation {rotation:.3} deg, scale {:.5}",
            self.motion.scale
        )?;
        if let Some(scatter) = self.scatter {
            writeln!(
                f,
                "scatter of one coordinate about rigid panels: {scatter:.2} mm"
            )?;
        }
        writeln!(f)?;
        self.agreement(f)?;
        if self.load_factor_error.is_none() {
            writeln!(
                f,
                "\nnote: the points do not determine the load factor, and the best fit is one of many: measure points on \
                 several panels that turn against each other"
            )?;
        } else if self.at_the_end {
            writeln!(
                f,
                "\nnote: the best fit is the end of the path; the sheet may be opened further than predicted"
            )?;
        }
        if let Some(closed) = &self.closed {
            closed.fmt(f)?;
        }
        self.hinges(f)
    }
}

impl fmt::Display for Closed {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let rms = |spread: &Option<Spread>| {
            spread
                .as_ref()
                .map_or("-".to_owned(), |spread| format!("{:.2} mm", spread.rms))
        };
        writeln!(
            f,
            "\nclosed sheet, the floor of the measurement: corners {}, panel centres {} rms",
            rms(&self.floor.corners),
            rms(&self.floor.centres)
        )?;
        let above = self.centres_above.iter().map(|panel| format!(" P{panel}"));
        let (count, more) = (above.len(), if above.len() > LISTED { " ..." } else { "" });
        let listed: String = above.take(LISTED).collect();
        match count {
            0 => writeln!(f, "no panel centre is above this floor")?,
            _ => writeln!(f, "{count} panel centres are above it:{listed}{more}")?,
        }
        for slip in &self.slips {
            let [x, y] = slip.slip;
            let length = x.hypot(y);
            writeln!(
                f,
                "slip of the supported panel P{}: {length:.2} mm ({x:+.2}, {y:+.2}), if both files are in one frame",
                slip.panel
            )?;
        }
        Ok(())
    }
}
