//! Chart of the losses of a training against the epoch.

use super::axes::{Axis, axes, line, names};
use super::*;

/// Training and validation loss against the epoch, the loss on a logarithmic axis.
pub fn learning_curve(training: &[f64], validation: &[f64]) -> Result<String> {
    drawn((720, 420), |root| learning_chart(root, training, validation))
}

fn learning_chart(area: &Area, training: &[f64], validation: &[f64]) -> ChartResult {
    let losses = || training.iter().chain(validation).copied();
    let positive = || losses().filter(|loss| *loss > 0.0);
    let min = positive().fold(f64::INFINITY, f64::min);
    let max = positive().fold(0.0, f64::max);
    let epochs = Axis {
        range: 0.0..training.len().max(2) as f64 - 1.0,
        name: "epoch",
        tick: |epoch| {
            if (epoch - epoch.round()).abs() < 1e-6 { format!("{epoch:.0}") } else { String::new() }
        },
    };
    let loss = Axis::powers((0.8 * min..1.25 * max).log_scale(), "loss (15)");
    let mut chart = axes(area, "Learning curve", epochs, loss)?;
    for (name, losses, colour) in
        [("training", training, POINT), ("validation", validation, VALIDATION)]
    {
        let points = losses.iter().enumerate();
        let points = points.map(|(epoch, &loss)| (epoch as f64, loss));
        line(&mut chart, name, points, colour.stroke_width(2))?;
    }
    names(&mut chart, SeriesLabelPosition::UpperRight)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_learning_curve_survives_a_single_epoch_and_zero_losses() {
        assert!(learning_curve(&[1.0], &[0.0]).unwrap().contains("validation"));
    }
}
