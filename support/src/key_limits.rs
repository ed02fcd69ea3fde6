//! The limits of the keys of configuration files. The range of a number is stated once, as
//! `schemars(range(..))` of its field, and its unit in the first parentheses of the field's
//! documentation, as in "Thickness of the sheet (mm)".

use crate::Fault;
use schemars::{JsonSchema, schema_for};
use serde::Serialize;
use serde_json::Value;
use std::fmt;

/// The smallest and the largest admissible number; infinite without a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range(f64, f64);

/// Checks all numbers of a configuration against the ranges of the type `T`, which has the same
/// keys; numbers must be finite.
pub fn check<T: JsonSchema>(config: &impl Serialize) -> Result<(), Fault> {
    let schema = schema_for!(T);
    let checker = Checker(schema.as_value());
    // A configuration that is no TOML, such as one with an integer above 2^63, was not read from a
    // file.
    let value = toml::Value::try_from(config);
    value.map_or(Ok(()), |value| checker.check(checker.0, &value, "", ""))
}

/// Checks a number whose range depends on other keys. The message names the key and the range and,
/// if a factor of 1000 would correct the number, the probable one.
pub fn within(key: &str, value: f64, [min, max]: [f64; 2], unit: &str) -> Result<(), Fault> {
    let range = min..=max;
    if value.is_finite() && range.contains(&value) {
        return Ok(());
    }
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let [least, most] = [min, max].map(without_rounding);
    let rule = match (min.is_finite(), max.is_finite()) {
        (true, true) => format!("{least} <= {key} <= {most}{unit}"),
        (true, false) => format!("{least} <= {key}{unit}"),
        (false, true) => format!("{key} <= {most}{unit}"),
        (false, false) => format!("{key} is finite"),
    };
    let mut slips = [1e3, 1e-3].map(|factor| without_rounding(factor * value)).into_iter();
    let meant = slips.find(|meant| !unit.is_empty() && range.contains(meant));
    let hint = meant.map_or(String::new(), |meant| format!("; did you mean {meant}{unit}?"));
    // More digits than a person reads become an exponent.
    let value = if value.abs() < 1e16 { value.to_string() } else { format!("{value:e}") };
    Err(fault!("{key} = {value}{unit} violates {rule}{hint}"))
}

/// The unit that a description states in its first parentheses; empty if there is none.
pub fn unit(description: &str) -> &str {
    let inside = description.split_once('(').and_then(|(_, rest)| rest.split_once(')'));
    let unit = inside.map_or("", |(inside, _)| inside);
    let is_unit = unit.split_whitespace().all(|word| UNITS.contains(&word));
    if is_unit { unit } else { "" }
}

/// The factors of the units of keys.
const UNITS: [&str; 12] =
    ["mm", "mm^2", "N", "N/mm", "mm/rad", "MPa", "deg", "rad", "s", "kg/m^3", "1/mm", "h"];

/// A schema with the definitions of its parts.
struct Checker<'a>(&'a Value);

impl Checker<'_> {
    /// Checks a value; `description` is the description of the key.
    fn check(
        &self,
        schema: &Value,
        value: &toml::Value,
        key: &str,
        description: &str,
    ) -> Result<(), Fault> {
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
            toml::Value::Integer(_) | toml::Value::Float(_) => {
                let Range(min, max) = Range::of_schema(schema);
                let number = value.as_integer().map(|number| number as f64);
                let number = number.or(value.as_float()).unwrap_or(f64::NAN);
                within(key, number, [min, max], unit(description))?;
            }
            _ => {}
        }
        Ok(())
    }
}

impl Range {
    /// The range that a schema states.
    pub fn of_schema(schema: &Value) -> Self {
        let limit = |name: &str| schema[name].as_f64();
        Self(
            limit("minimum").unwrap_or(f64::NEG_INFINITY),
            limit("maximum").unwrap_or(f64::INFINITY),
        )
    }
}

impl fmt::Display for Range {
    /// The limits in words, as in `0.02 to 10`; empty without limits.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let short = |x: f64| {
            if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
                x.to_string()
            } else {
                format!("{x:e}")
            }
        };
        match (self.0.is_finite(), self.1.is_finite()) {
            (true, true) => write!(f, "{} to {}", short(self.0), short(self.1)),
            (true, false) => write!(f, "at least {}", short(self.0)),
            (false, true) => write!(f, "at most {}", short(self.1)),
            (false, false) => Ok(()),
        }
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
            #[schemars(range(min = 0.1))]
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
        check::<Sheet>(&sheet).err().map(|error| error.to_string())
    }

    #[test]
    fn a_number_outside_its_range_is_named_with_the_range_and_the_probable_number() {
        assert_eq!(message(|_| ()), None);
        assert_eq!(message(|sheet| sheet.size = None), None);
        let size = "size = 2.8 mm violates 20 <= size <= 20000 mm; did you mean 2800 mm?";
        let force = "loads[0].force = NaN N violates loads[0].force is finite";
        let radius = "shape.circle.radius = 0 mm violates 0.1 <= shape.circle.radius mm";
        for (found, expected) in [
            (message(|sheet| sheet.size = Some([100.0, 2.8])), size),
            (message(|sheet| sheet.steps = 0), "steps = 0 violates 1 <= steps <= 100"),
            (message(|sheet| sheet.loads[0].force[1] = f64::NAN), force),
            (message(|sheet| sheet.shape = Shape::Circle { radius: 0.0 }), radius),
        ] {
            assert_eq!(found.unwrap(), expected);
        }
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
