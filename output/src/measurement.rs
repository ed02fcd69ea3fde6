//! The report of a measured sheet: agreement with the path in the measures of section 4.4,
//! openings.
//!
//! `Serialize` writes all numbers, `Display` a page; `residuals_csv` and `openings_csv` the tables.

mod agreement;
mod tables;

pub use agreement::{Agreement, OpeningSpread, Spread};

use analysis::{
    measured_openings::{MeasuredOpening, MeasuredPanel, openings, scatter, slip},
    measured_points::FittedPoint,
    measured_sheet::MeasuredSheet,
    path_fit::Fit,
};
use design::{geometry::plane::point, sheet::cut_sheet::Sheet};
use faer::c64;
use serde::Serialize;
use support::Point;

/// A measured sheet in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct MeasurementReport {
    /// Title of the scene.
    pub title: String,
    /// The larger of width and height of the flat sheet, to which percentages refer (mm).
    pub sheet_size: f64,
    /// Number of measured points.
    pub points: usize,
    /// Position of the design's origin in the frame of the measurement (mm), rotation (deg) and
    /// scale.
    pub motion: Alignment,
    /// Agreement at the end of the path: full load, or the full stroke.
    pub full: Agreement,
    /// Agreement at the state of the path that fits best.
    pub best: Agreement,
    /// Standard error of the load factor of `best`; `None` if the points do not determine it.
    pub load_factor_error: Option<f64>,
    /// Whether the best state is the end of the path, so that the sheet may be opened further than
    /// at full load.
    pub at_the_end: bool,
    /// Standard deviation of one measured coordinate about rigid panels (mm).
    pub scatter: Option<f64>,
    /// The measurement of the closed sheet, if there is one.
    pub closed: Option<Closed>,
    /// Measured panels, at the best state.
    pub panels: Vec<MeasuredPanel>,
    /// Measured hinges, at the best state.
    pub openings: Vec<MeasuredOpening>,
    #[serde(skip)]
    best_points: Vec<FittedPoint>,
}

/// The rigid motion from the design to the measurement.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Alignment {
    /// Position of the design's origin (mm, or pixels if the points are in pixels).
    pub origin: Point,
    /// Rotation (deg).
    pub rotation_deg: f64,
    /// Measured lengths over lengths of the design.
    pub scale: f64,
}

/// The measurement of the closed sheet, whose shape is known: the floor of the measurement.
#[derive(Clone, Debug, Serialize)]
pub struct Closed {
    /// Agreement of the closed sheet with the flat design.
    pub floor: Agreement,
    /// Panels whose deployed centre is farther from its prediction than the rms of the closed
    /// centres.
    pub centres_above: Vec<usize>,
    /// Motion of the supported panels between the two measurements that the model does not predict.
    pub slips: Vec<Slip>,
}

/// Slip of a support.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Slip {
    /// The supported panel.
    pub panel: usize,
    /// Its slip in the frame of the design (mm).
    pub slip: Point,
}

impl MeasurementReport {
    /// The report of a measured sheet; `closed` is the measurement of the same sheet before it was
    /// deployed, and `supported` are the panels whose slip between the two is of interest.
    pub fn new(
        title: &str,
        sheet: &Sheet,
        measured: &MeasuredSheet,
        closed: Option<&Fit>,
        supported: &[usize],
    ) -> Self {
        let MeasuredSheet { best, full, .. } = measured;
        let panels = MeasuredPanel::all(sheet, best);
        let openings = openings(sheet, best, &panels);
        Self {
            title: title.to_owned(),
            sheet_size: sheet.outline.size(),
            points: best.points.len(),
            motion: Alignment {
                origin: point(best.motion.of(c64::ZERO)),
                rotation_deg: best.motion.rotation().to_degrees(),
                scale: best.motion.scale(),
            },
            full: Agreement::new(sheet, full),
            best: Agreement::new(sheet, best),
            load_factor_error: measured.load_factor_error,
            at_the_end: best.position > full.position - 1e-6,
            scatter: scatter(&panels),
            closed: closed.map(|closed| Closed::new(sheet, closed, best, &panels, supported)),
            panels,
            openings,
            best_points: best.points.clone(),
        }
    }
}

impl Closed {
    fn new(
        sheet: &Sheet,
        closed: &Fit,
        deployed: &Fit,
        panels: &[MeasuredPanel],
        supported: &[usize],
    ) -> Self {
        let floor = Agreement::new(sheet, closed);
        let level = floor.centres.as_ref().map_or(f64::INFINITY, |centres| centres.rms);
        let above = panels.iter().filter(|panel| panel.distance() > level);
        let slips = supported.iter().filter_map(|&panel| {
            let slip = slip(sheet, closed, deployed, panel)?;
            Some(Slip { panel, slip })
        });
        Self {
            centres_above: above.map(|panel| panel.panel).collect(),
            slips: slips.collect(),
            floor,
        }
    }
}
