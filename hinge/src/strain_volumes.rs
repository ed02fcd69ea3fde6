//! The distribution of accumulated plastic strain over a window, as a histogram of volumes.
//!
//! Bin 0 holds strains above zero and below 0.001. The edges above grow by a factor of sqrt(2) per bin, and
//! the last bin has no upper limit. Any damage measure that depends on the strain alone can be recomputed
//! from the histogram, to within the width of a bin, without another solve.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Number of bins.
const BINS: usize = 24;
/// Upper edge of bin 0.
const FIRST_EDGE: f64 = 1e-3;

/// Volume (mm^3) in each bin of plastic strain.
///
/// Single precision: a volume is resolved only to the volume of one integration point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct StrainVolumes([f32; BINS]);

/// A text that is not a histogram.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("expected {BINS} non-negative volumes separated by blanks, found `{0}`")]
pub struct NoHistogram(String);

impl StrainVolumes {
    /// The histogram of integration points (plastic strain, volume in mm^3). Points without plastic strain are
    /// not counted.
    pub fn from_points(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut volumes = [0.0_f64; BINS];
        for (strain, volume) in points {
            if strain > 0.0 {
                volumes[bin_of(strain)] += volume;
            }
        }
        Self(volumes.map(|volume| volume as f32))
    }

    /// The bins as (lower edge, upper edge, volume in mm^3); the last upper edge is infinite.
    pub fn bins(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        let bins = self.0.into_iter().enumerate();
        bins.map(|(bin, volume)| (edge(bin), edge(bin + 1), f64::from(volume)))
    }
}

/// Lower edge of a bin.
fn edge(bin: usize) -> f64 {
    match bin {
        0 => 0.0,
        BINS => f64::INFINITY,
        _ => FIRST_EDGE * 2f64.powf(0.5 * (bin - 1) as f64),
    }
}

fn bin_of(strain: f64) -> usize {
    (1..BINS).rfind(|bin| strain >= edge(*bin)).unwrap_or(0)
}

impl fmt::Display for StrainVolumes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let texts: Vec<String> = self.0.iter().map(f32::to_string).collect();
        f.write_str(&texts.join(" "))
    }
}

impl FromStr for StrainVolumes {
    type Err = NoHistogram;

    fn from_str(text: &str) -> Result<Self, NoHistogram> {
        let refuse = || NoHistogram(text.to_owned());
        let volumes: Result<Vec<f32>, _> = text.split_whitespace().map(str::parse).collect();
        let volumes = volumes.map_err(|_| refuse())?;
        let valid = volumes.iter().all(|v| v.is_finite() && *v >= 0.0);
        let volumes = volumes.try_into().map_err(|_| refuse())?;
        if valid {
            Ok(Self(volumes))
        } else {
            Err(refuse())
        }
    }
}

impl From<StrainVolumes> for String {
    fn from(volumes: StrainVolumes) -> Self {
        volumes.to_string()
    }
}

impl TryFrom<String> for StrainVolumes {
    type Error = NoHistogram;

    fn try_from(text: String) -> Result<Self, NoHistogram> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_strained_point_is_in_the_bin_that_contains_it() {
        let points: Vec<(f64, f64)> = (0..200).map(|i| (1e-4 * 1.06_f64.powi(i), 0.5)).collect();
        let histogram = StrainVolumes::from_points(points.iter().copied().chain([(0.0, 7.0)]));
        let total: f64 = histogram.bins().map(|(.., volume)| volume).sum();
        assert_eq!(total, 100.0);
        for (lower, upper, volume) in histogram.bins() {
            let within = points
                .iter()
                .filter(|(strain, _)| (lower..upper).contains(strain));
            assert_eq!(volume, 0.5 * within.count() as f64, "{lower} {upper}");
        }
    }

    #[test]
    fn a_histogram_round_trips_through_text_exactly() {
        let histogram = StrainVolumes::from_points([(0.01, 1.0 / 3.0), (0.5, 1e-7), (9.0, 12.5)]);
        assert_eq!(histogram.to_string().parse(), Ok(histogram));
        assert!("1 2 3".parse::<StrainVolumes>().is_err());
        let negative = StrainVolumes::default().to_string().replacen('0', "-1", 1);
        assert!(negative.parse::<StrainVolumes>().is_err());
    }
}
