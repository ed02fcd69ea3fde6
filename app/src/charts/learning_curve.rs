//! Chart of the losses of a training against the epoch.

use super::{
    axes::{Axis, Look, chart, series},
    *,
};
use support::Extremes;

/// Training and validation loss against the epoch, the loss on a logarithmic axis.
pub fn learning_curve(training: &[f64], validation: &[f64]) -> Result<String> {
    let positive = || training.iter().chain(validation).copied().filter(|loss| *loss > 0.0);
    let min = positive().smallest();
    let max = positive().largest();
    let epochs = Axis {
        range: 0.0..training.len().max(2) as f64 - 1.0,
        name: "epoch",
        tick: |epoch| {
            if (epoch - epoch.round()).abs() < 1e-6 { format!("{epoch:.0}") } else { String::new() }
        },
    };
    let loss = Axis::powers((0.8 * min..1.25 * max).log_scale(), "loss (15)");
    let curves = [("training", training, POINT), ("validation", validation, VALIDATION)];
    let curves = curves.map(|(name, losses, colour)| {
        let points = losses.iter().enumerate().map(|(epoch, &loss)| (epoch as f64, loss));
        series(name, points, Look::Line, colour.stroke_width(2))
    });
    let names = SeriesLabelPosition::UpperRight;
    drawn((720, 420), |root| chart(root, "Learning curve", (epochs, loss), curves.into(), names))
}
