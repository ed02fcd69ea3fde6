//! The material that a sheet is cut from: papers by their names, other stock by its sides.

use schemars::JsonSchema;
use serde::{
    Deserialize, Serialize,
    de::{IntoDeserializer, value::Error},
};
use std::{ops::RangeInclusive, str::FromStr};

/// A paper: ISO 216 A, or of North America (ANSI A and B).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema, strum::Display)]
#[serde(rename_all = "lowercase")]
#[strum(serialize_all = "lowercase")]
pub enum Paper {
    /// 148 x 210 mm.
    A5,
    /// 210 x 297 mm.
    A4,
    /// 297 x 420 mm.
    A3,
    /// 420 x 594 mm.
    A2,
    /// 594 x 841 mm.
    A1,
    /// 841 x 1189 mm.
    A0,
    /// 8.5 x 11 inches.
    Letter,
    /// 11 x 17 inches.
    Tabloid,
}

impl Paper {
    /// Width and height in portrait (mm).
    pub fn size(self) -> [f64; 2] {
        match self {
            Self::A5 => [148.0, 210.0],
            Self::A4 => [210.0, 297.0],
            Self::A3 => [297.0, 420.0],
            Self::A2 => [420.0, 594.0],
            Self::A1 => [594.0, 841.0],
            Self::A0 => [841.0, 1189.0],
            Self::Letter => [215.9, 279.4],
            Self::Tabloid => [279.4, 431.8],
        }
    }
}

impl FromStr for Paper {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::deserialize(name.to_lowercase().into_deserializer())
    }
}

/// A sheet of material, in either orientation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected the name of a paper, \"a5\" to \"a0\", \"letter\" or \"tabloid\", or [width, height] (mm)"
)]
#[schemars(inline)]
pub enum Stock {
    /// A paper in portrait.
    Paper(Paper),
    /// Width and height (mm).
    Sides(#[schemars(inner(range(min = 1.0, max = 1e5)))] [f64; 2]),
}

impl Stock {
    /// Sides of a stock (mm); the range of the key has the same numbers.
    pub const SIDES: RangeInclusive<f64> = 1.0..=1e5;

    /// Width and height (mm).
    pub fn size(self) -> [f64; 2] {
        match self {
            Self::Paper(paper) => paper.size(),
            Self::Sides(sides) => sides,
        }
    }
}
