//! Values of options with their units: percentages, accuracies and times, and levels.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use scene::Level;
#[cfg(feature = "pipeline")]
use std::time::Duration;

/// How accurately panel corners are to be known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CornerTolerance {
    /// A length (mm).
    Length(f64),
    /// A part of the longer side of the flat sheet.
    Part(f64),
}

/// An accuracy such as `0.5mm` or `0.2%`.
pub(crate) fn accuracy(text: &str) -> Result<CornerTolerance, String> {
    let length = text.strip_suffix("mm");
    let length = length.and_then(|number| number.trim().parse::<f64>().ok());
    match (length, percent(text)) {
        (Some(mm), _) if mm > 0.0 && mm.is_finite() => Ok(CornerTolerance::Length(mm)),
        (_, Ok(percent)) => Ok(CornerTolerance::Part(percent / 100.0)),
        _ => Err(
            "expected a length or a percentage of the longer side of the sheet, for example 0.5mm or 0.2%"
                .into(),
        ),
    }
}

/// The name of a level up to the finest one that a command can use.
pub(crate) fn level_up_to(finest: Level) -> impl TypedValueParser<Value = Level> {
    let levels = Level::ALL.into_iter().filter(move |level| *level <= finest);
    PossibleValuesParser::new(levels.map(Level::name))
        .map(|name| Level::named(&name).expect("the parser takes the names of levels alone"))
}

/// A percentage such as `1%`, as a percentage.
pub(crate) fn percent(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').map(|number| number.trim().parse::<f64>());
    match number {
        Some(Ok(value)) if value > 0.0 && value <= 100.0 => Ok(value),
        _ => Err("expected a percentage above 0 and at most 100, for example 1%".into()),
    }
}

#[cfg(feature = "pipeline")]
/// A time such as `1h`, `30min` or `90s`.
pub(crate) fn time(text: &str) -> Result<Duration, String> {
    let units = [("min", 60.0), ("h", 3600.0), ("s", 1.0)];
    units
        .into_iter()
        .find_map(|(unit, seconds)| {
            let number = text.strip_suffix(unit)?.trim().parse::<f64>().ok()?;
            Duration::try_from_secs_f64(number * seconds).ok()
        })
        .ok_or_else(|| "expected a time with its unit, for example 1h, 30min or 90s".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_need_their_units() {
        assert_eq!(percent("1%"), Ok(1.0));
        assert_eq!(percent("0.5 %"), Ok(0.5));
        for wrong in ["1", "0.01", "0%", "101%", "%", "nan%"] {
            assert!(percent(wrong).is_err(), "{wrong}");
        }
        assert_eq!(accuracy("0.5mm"), Ok(CornerTolerance::Length(0.5)));
        assert_eq!(accuracy("0.5%"), Ok(CornerTolerance::Part(0.005)));
        for wrong in ["0.5", "0mm", "-1mm", "nanmm", "1 cm", "0%"] {
            assert!(accuracy(wrong).is_err(), "{wrong}");
        }
    }

    #[cfg(feature = "pipeline")]
    #[test]
    fn times_need_their_units() {
        assert_eq!(time("1h"), Ok(Duration::from_secs(3600)));
        assert_eq!(time("1.5 min"), Ok(Duration::from_secs(90)));
        assert_eq!(time("0s"), Ok(Duration::ZERO));
        for wrong in ["1", "h", "-1s", "nan h", "1 day", "1e99h"] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }
}
