//! The limits of the keys of configuration files. The range of a number stands once, as `schemars(range(..))` of its field,
//! and its unit in the first parentheses of the field's documentation, as in "Thickness of the sheet (mm)".

use schemars::{JsonSchema, schema_for};
use serde::Serialize;
use serde_json::Value;
use std::fmt;
use std::ops::{Bound, RangeBounds};

/// A number outside the range of its key. The message names both and, if a factor of 1000 would correct the number, the
/// probable one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value}{}{}", with_space(.unit), self.violation())]
pub struct OutOfRange {
    /// The path of the key, as in `loads[0].force`.
    pub key: String,
    /// The number.
    pub value: f64,
    /// Its unit; empty if it has none.
    pub unit: String,
    /// The admissible numbers.
    pub range: Range,
}

/// The admissible values of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest one.
    pub min: Bound<f64>,
    /// The largest one.
    pub max: Bound<f64>,
}

/// Checks all numbers of a configuration against the ranges of its type; numbers must be finite.
pub fn check<T: JsonSchema + Serialize>(config: &T) -> Result<(), OutOfRange> {
    let schema = schema_for!(T);
    let checker = Checker(schema.as_value());
    // A configuration that is no TOML, such as one with an integer above 2^63, was not read from a file.
    let value = toml::Value::try_from(config);
    value.map_or(Ok(()), |value| checker.check(checker.0, &value, "", ""))
}

/// Checks a number whose range depends on other keys.
pub fn within(key: &str, value: f64, [min, max]: [f64; 2], unit: &str) -> Result<(), OutOfRange> {
    let [min, max] = [min, max].map(|bound| Bound::Included(without_rounding(bound)));
    Range { min, max }.check(key, value, unit)
}

/// The unit that a description states in its first parentheses; empty if there is none.
pub fn unit(description: &str) -> &str {
    let inside = description
        .split_once('(')
        .and_then(|(_, rest)| rest.split_once(')'));
    let unit = inside.map_or("", |(inside, _)| inside);
    let is_unit = unit.split_whitespace().all(|word| UNITS.contains(&word));
    if is_unit { unit } else { "" }
}

/// The factors of units.
const UNITS: [&str; 12] = [
    "mm", "mm^2", "N", "N/mm", "mm/rad", "MPa", "deg", "rad", "s", "kg/m^3", "1/mm", "h",
];

/// A schema with the definitions of its parts.
struct Checker<'a>(&'a Value);

impl Checker<'_> {
    /// Checks a value; `description` is that of the key.
    fn check(
        &self,
        schema: &Value,
        value: &toml::Value,
        key: &str,
        description: &str,
    ) -> Result<(), OutOfRange> {
        let description = schema["description"].as_str().unwrap_or(description);
        if let Some(name) = schema["$ref"].as_str() {
            let name = name.rsplit('/').next().unwrap_or_default();
            return self.check(&self.0["$defs"][name], value, key, description);
        }
        for alternatives in ["anyOf", "oneOf"] {
            for alternative in schema[alternatives].as_array().into_iter().flatten() {
                self.check(alternative, value, key, description)?;
            }
        }
        match value {
            toml::Value::Table(table) => {
                for (name, value) in table {
                    let key = match key {
                        "" => name.clone(),
                        key => format!("{key}.{name}"),
                    };
                    self.check(&schema["properties"][name], value, &key, "")?;
                }
            }
            toml::Value::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    let key = match item {
                        toml::Value::Table(_) => format!("{key}[{i}]"),
                        _ => key.to_owned(),
                    };
                    self.check(&schema["items"], item, &key, description)?;
                }
            }
            toml::Value::Integer(number) => {
                Range::of_schema(schema).check(key, *number as f64, unit(description))?;
            }
            toml::Value::Float(number) => {
                Range::of_schema(schema).check(key, *number, unit(description))?;
            }
            _ => {}
        }
        Ok(())
    }
}

impl Range {
    /// The range that a schema states.
    pub fn of_schema(schema: &Value) -> Self {
        let bound = |included: &str, excluded: &str| {
            let [included, excluded] = [included, excluded].map(|name| schema[name].as_f64());
            let excluded = excluded.map(Bound::Excluded);
            excluded
                .or(included.map(Bound::Included))
                .unwrap_or(Bound::Unbounded)
        };
        Self {
            min: bound("minimum", "exclusiveMinimum"),
            max: bound("maximum", "exclusiveMaximum"),
        }
    }

    fn check(self, key: &str, value: f64, unit: &str) -> Result<(), OutOfRange> {
        if value.is_finite() && self.contains(value) {
            return Ok(());
        }
        Err(OutOfRange {
            key: key.to_owned(),
            value,
            unit: unit.to_owned(),
            range: self,
        })
    }

    /// Whether a number is admissible.
    fn contains(self, value: f64) -> bool {
        (self.min, self.max).contains(&value)
    }

    /// The inequality of a key, as in `0 < kerf <= 2 mm`.
    fn around(self, key: &str, unit: &str) -> String {
        let min = match self.min {
            Bound::Included(min) => format!("{min} <= "),
            Bound::Excluded(min) => format!("{min} < "),
            Bound::Unbounded => String::new(),
        };
        let max = match self.max {
            Bound::Included(max) => format!(" <= {max}"),
            Bound::Excluded(max) => format!(" < {max}"),
            Bound::Unbounded => String::new(),
        };
        format!("{min}{key}{max}{}", with_space(unit))
    }
}

impl fmt::Display for Range {
    /// In words, as in `0.02 to 10`; empty without limits.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let short = |x: f64| {
            if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) {
                format!("{x:e}")
            } else {
                x.to_string()
            }
        };
        match (self.min, self.max) {
            (Bound::Included(min), Bound::Included(max)) => {
                write!(f, "{} to {}", short(min), short(max))
            }
            (Bound::Excluded(min), Bound::Included(max)) => {
                write!(f, "above {} to {}", short(min), short(max))
            }
            (Bound::Included(min), Bound::Excluded(max)) => {
                write!(f, "{} to below {}", short(min), short(max))
            }
            (Bound::Excluded(min), Bound::Excluded(max)) => {
                write!(f, "above {}, below {}", short(min), short(max))
            }
            (Bound::Included(min), Bound::Unbounded) => write!(f, "at least {}", short(min)),
            (Bound::Excluded(min), Bound::Unbounded) => write!(f, "above {}", short(min)),
            (Bound::Unbounded, Bound::Included(max)) => write!(f, "at most {}", short(max)),
            (Bound::Unbounded, Bound::Excluded(max)) => write!(f, "below {}", short(max)),
            (Bound::Unbounded, Bound::Unbounded) => Ok(()),
        }
    }
}

impl OutOfRange {
    fn violation(&self) -> String {
        let Self {
            key, unit, range, ..
        } = self;
        if range.contains(self.value) {
            return " is not a finite number".to_owned();
        }
        format!(" violates {}{}", range.around(key, unit), self.hint())
    }

    fn hint(&self) -> String {
        let slips = [1e3, 1e-3].map(|factor| without_rounding(factor * self.value));
        let meant = slips.into_iter().find(|meant| self.range.contains(*meant));
        let meant = meant.filter(|_| !self.unit.is_empty());
        meant.map_or(String::new(), |meant| {
            format!("; did you mean {meant} {}?", self.unit)
        })
    }
}

fn with_space(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

/// The number with nine significant digits, so that a product is shown without its rounding error.
fn without_rounding(value: f64) -> f64 {
    let digits = format!("{value:.8e}");
    digits.parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, JsonSchema)]
    struct Sheet {
        /// Sides (mm).
        #[schemars(inner(range(min = 20.0, max = 2e4)))]
        size: Option<[f64; 2]>,
        #[schemars(range(min = 1, max = 100))]
        steps: usize,
        loads: Vec<Load>,
        shape: Shape,
    }

    #[derive(Serialize, JsonSchema)]
    struct Load {
        /// Force (N), without limits.
        force: [f64; 2],
    }

    #[derive(Serialize, JsonSchema)]
    #[serde(rename_all = "kebab-case")]
    enum Shape {
        None,
        Circle {
            /// The radius (mm); see (17).
            #[schemars(extend("exclusiveMinimum" = 0))]
            radius: f64,
        },
    }

    fn message(change: impl Fn(&mut Sheet)) -> Option<String> {
        let mut sheet = Sheet {
            size: Some([20.0, 100.0]),
            steps: 1,
            loads: vec![Load { force: [-1e9, 0.0] }],
            shape: Shape::None,
        };
        change(&mut sheet);
        check(&sheet).err().map(|error| error.to_string())
    }

    #[test]
    fn a_number_outside_its_range_is_named_with_the_range_and_the_probable_number() {
        assert_eq!(message(|_| ()), None);
        assert_eq!(message(|sheet| sheet.size = None), None);
        assert_eq!(
            message(|sheet| sheet.size = Some([100.0, 2.8])).unwrap(),
            "size = 2.8 mm violates 20 <= size <= 20000 mm; did you mean 2800 mm?"
        );
        assert_eq!(
            message(|sheet| sheet.steps = 0).unwrap(),
            "steps = 0 violates 1 <= steps <= 100"
        );
        assert_eq!(
            message(|sheet| sheet.loads[0].force[1] = f64::NAN).unwrap(),
            "loads[0].force = NaN N is not a finite number"
        );
        assert_eq!(
            message(|sheet| sheet.shape = Shape::Circle { radius: 0.0 }).unwrap(),
            "shape.circle.radius = 0 mm violates 0 < shape.circle.radius mm"
        );
        let error = within("width", 5e3, [0.0, 10.0], "mm").unwrap_err();
        assert!(error.to_string().ends_with("did you mean 5 mm?"), "{error}");
    }

    #[test]
    fn the_unit_of_a_key_is_in_the_first_parentheses() {
        assert_eq!(unit("Stiffness of the rotation (N mm/rad)."), "N mm/rad");
        assert_eq!(unit("Weight of (17), in (mm)."), "");
        assert_eq!(unit("Number of steps."), "");
    }
}
