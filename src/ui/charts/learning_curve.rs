//! Chart of the losses of a training against the epoch.

use super::*;

/// Training and validation loss against the epoch, the loss on a logarithmic axis.
pub fn learning_curve(training: &[f64], validation: &[f64]) -> Result<String> {
    drawn((720, 420), |root| {
        learning_chart(root, training, validation)
    })
}

fn learning_chart(area: &Area, training: &[f64], validation: &[f64]) -> ChartResult {
    let positive = || {
        training
            .iter()
            .chain(validation)
            .copied()
            .filter(|v| *v > 0.0)
    };
    let min = positive().fold(f64::INFINITY, f64::min);
    let max = positive().fold(0.0, f64::max);
    let epochs = 0..training.len().max(2) - 1;
    let mut chart = ChartBuilder::on(area)
        .caption("Learning curve", (FONT, 16))
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(70)
        .build_cartesian_2d(epochs, (0.8 * min..1.25 * max).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .label_style((FONT, 12))
        .x_desc("epoch")
        .y_desc("loss (15)")
        .y_label_formatter(&|v| format!("{v:.0e}"))
        .draw()?;
    for (name, losses, colour) in [
        ("training", training, POINT),
        ("validation", validation, VALIDATION),
    ] {
        chart
            .draw_series(LineSeries::new(
                losses.iter().copied().enumerate(),
                colour.stroke_width(2),
            ))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font((FONT, 13))
        .border_style(GUIDE)
        .background_style(WHITE)
        .draw()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_learning_curve_survives_a_single_epoch_and_zero_losses() {
        assert!(
            learning_curve(&[1.0], &[0.0])
                .unwrap()
                .contains("validation")
        );
    }
}
