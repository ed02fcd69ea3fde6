//! Progress with time left, silent when standard error is not a terminal.

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::time::Duration;

/// A bar of `total` units of `what`; [`show`] moves it.
pub fn bar(total: usize, what: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix:>14} [{bar:30}] {pos}/{len}  {wide_msg}")
        .expect("the template is a constant");
    ProgressBar::new(total as u64)
        .with_style(style.progress_chars("=> "))
        .with_prefix(what)
}

/// Moves the bar to `done` and shows the time left, by the bar's own estimate if none is given.
pub fn show(bar: &ProgressBar, done: usize, seconds_left: Option<f64>, message: &str) {
    bar.set_position(done as u64);
    let left = seconds_left.map_or_else(|| bar.eta(), Duration::from_secs_f64);
    bar.set_message(format!("{} left  {message}", HumanDuration(left)));
}

/// Seconds for people.
pub fn duration(seconds: f64) -> String {
    HumanDuration(Duration::from_secs_f64(seconds)).to_string()
}
