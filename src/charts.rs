//! Charts of trainings, studies and replays, as SVG: what they share, and one file a kind.

mod calibration;
mod capacity;
mod costs;
mod front;
mod learning_curve;
mod parity;
mod rays;
mod routes;
mod separations;
mod slices;
mod solutions;
mod taylor;
mod window;

pub use calibration::{Calibration, calibration};
pub use capacity::{CapacityCurve, capacity};
pub use costs::{CostPanel, costs};
pub use front::{FrontPanel, front};
pub use learning_curve::learning_curve;
pub use parity::{ParityChart, parity};
pub use rays::{Curve, against_rays};
pub use routes::{RoutePanel, routes};
pub use separations::{SeparationChart, separations};
pub use slices::{Slice, slices};
pub use solutions::{SolutionChart, solutions};
pub use taylor::{TaylorLine, taylor};
pub use window::{StudyPanel, studies};

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::ops::Range;

const POINT: RGBColor = RGBColor(31, 110, 140);
const VALIDATION: RGBColor = RGBColor(217, 95, 2);
const SLICES: [RGBColor; 5] = [
    POINT,
    VALIDATION,
    RGBColor(117, 112, 179),
    RGBColor(102, 166, 30),
    RGBColor(166, 118, 29),
];
const GUIDE: RGBColor = RGBColor(120, 120, 120);
const FONT: &str = "DejaVu Sans";

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type DrawResult =
    Result<(), DrawingAreaErrorKind<<SVGBackend<'static> as DrawingBackend>::ErrorType>>;

/// A picture of the given size on white.
fn drawn(size: (u32, u32), draw: impl FnOnce(&Area) -> DrawResult) -> Result<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let whole = || -> DrawResult {
            root.fill(&WHITE)?;
            draw(&root)?;
            root.present()
        };
        whole().map_err(|error| anyhow!("cannot draw the chart: {error}"))?;
    }
    Ok(svg)
}

/// The decades that hold the values, which are positive.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (least, greatest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| {
        (l.min(v), g.max(v))
    });
    if least > greatest {
        return 1e-3..1.0;
    }
    let (from, to) = (least.log10().floor(), greatest.log10().floor() + 1.0);
    10f64.powf(from)..10f64.powf(to)
}

/// The range of the values with a margin of a twentieth at both ends.
fn padded(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (least, greatest) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| {
        (l.min(v), g.max(v))
    });
    if least > greatest {
        return 0.0..1.0;
    }
    let margin = 0.05 * (greatest - least).max(1e-12);
    least - margin..greatest + margin
}
