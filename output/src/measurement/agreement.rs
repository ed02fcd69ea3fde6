//! How far a measured sheet is from a state of its path.

use analysis::{
    measured_openings::{MeasuredOpening, MeasuredPanel, openings},
    path_fit::Fit,
};
use design::sheet::cut_sheet::Sheet;
use serde::Serialize;
use support::Extremes;
use support::statistics::root_mean_square;

/// Agreement of the points with one state, after the rigid motion (and scale) is removed.
#[derive(Clone, Debug, Serialize)]
pub struct Agreement {
    /// Load factor of the state.
    pub load_factor: f64,
    /// Distances of the measured corners from the predicted ones; `None` if no corner was measured.
    pub corners: Option<Spread>,
    /// Distances of the panel centres; `None` if none is measured.
    pub centres: Option<Spread>,
    /// Differences of the hinge openings; `None` if none is measured.
    pub openings: Option<OpeningSpread>,
}

/// Statistics of distances.
#[derive(Clone, Debug, Serialize)]
pub struct Spread {
    /// Number of distances.
    pub count: usize,
    /// Root mean square (mm).
    pub rms: f64,
    /// Root mean square (% of the sheet's size).
    pub rms_percent: f64,
    /// Maximum (mm).
    pub max: f64,
    /// Maximum (% of the sheet's size).
    pub max_percent: f64,
    /// The point of the maximum.
    pub max_at: String,
}

/// Statistics of hinge openings, measured minus predicted.
#[derive(Clone, Debug, Serialize)]
pub struct OpeningSpread {
    /// Number of hinges.
    pub count: usize,
    /// Mean of the measured openings (deg).
    pub measured_mean_deg: f64,
    /// Mean of the predicted openings (deg).
    pub predicted_mean_deg: f64,
    /// Standard deviation of the differences about their mean (deg).
    pub spread_deg: f64,
    /// Maximum difference (deg), and its hinge.
    pub max_deg: f64,
    /// The hinge of the maximum difference.
    pub max_hinge: usize,
}

impl Agreement {
    pub(super) fn new(sheet: &Sheet, fit: &Fit) -> Self {
        let panels = MeasuredPanel::all(sheet, fit);
        let corners = fit.points.iter().filter(|point| point.mark.corner.is_some());
        let corners = corners.map(|point| (point.mark.to_string(), point.distance()));
        let centres = panels.iter().map(|panel| (format!("P{}", panel.panel), panel.distance()));
        let size = sheet.outline.size();
        Self {
            load_factor: fit.shape.load_factor,
            corners: Spread::new(corners.collect(), size),
            centres: Spread::new(centres.collect(), size),
            openings: OpeningSpread::new(&openings(sheet, fit, &panels)),
        }
    }
}

impl Spread {
    fn new(distances: Vec<(String, f64)>, size: f64) -> Option<Self> {
        let count = distances.len();
        let rms = root_mean_square(distances.iter().map(|(_, distance)| *distance));
        let (max_at, max) = distances.into_iter().largest_by(|(_, distance)| *distance)?;
        Some(Self {
            count,
            rms,
            rms_percent: 100.0 * rms / size,
            max,
            max_percent: 100.0 * max / size,
            max_at,
        })
    }
}

impl OpeningSpread {
    fn new(openings: &[MeasuredOpening]) -> Option<Self> {
        let mean = |of: &dyn Fn(&MeasuredOpening) -> f64| -> f64 {
            openings.iter().map(of).sum::<f64>() / openings.len() as f64
        };
        let offset = mean(&MeasuredOpening::difference_deg);
        let worst = openings.iter().largest_by(|opening| opening.difference_deg().abs())?;
        Some(Self {
            count: openings.len(),
            measured_mean_deg: mean(&|opening| opening.measured_deg),
            predicted_mean_deg: mean(&|opening| opening.predicted_deg),
            spread_deg: mean(&|opening| (opening.difference_deg() - offset).powi(2)).sqrt(),
            max_deg: worst.difference_deg(),
            max_hinge: worst.hinge,
        })
    }
}
