//! The sheet material as measured on tensile specimens; section 4.1.

use serde::{Deserialize, Serialize};

/// A uniform sheet: thickness, isotropic elasticity, tabulated J2 hardening, fracture strain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SheetMaterial {
    pub name: String,
    /// mm
    pub thickness: f64,
    /// Young's modulus (MPa).
    pub young: f64,
    /// Poisson's ratio, in [0, 0.5).
    pub poisson: f64,
    /// kg/m^3, the unit of data sheets; only (21)-(22) read it.
    pub density_kg_m3: f64,
    /// Equivalent plastic strain at fracture, eps_f of (12).
    pub fracture_strain: f64,
    /// Rows [true stress (MPa), true plastic strain], the first at zero plastic strain.
    pub plastic: Vec<[f64; 2]>,
}

/// A material that cannot be, or that was written in other units.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("material `{material}`: {reason}")]
pub struct InvalidMaterial {
    pub material: String,
    pub reason: String,
}

impl SheetMaterial {
    /// What tells two laws of one name apart: BLAKE3 of all that a window solve knows of the
    /// material, 16 hexadecimal digits. Name and density do not count.
    pub fn law_hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let numbers = [
            self.thickness,
            self.young,
            self.poisson,
            self.fracture_strain,
        ];
        for number in numbers.iter().chain(self.plastic.iter().flatten()) {
            hasher.update(&number.to_le_bytes());
        }
        hasher.finalize().to_hex()[..16].to_owned()
    }

    /// Refuses impossible values and the usual unit slips (GPa for MPa, m for mm, g/cm^3 for kg/m^3).
    pub fn validate(&self) -> Result<(), InvalidMaterial> {
        let refuse = |reason: String| {
            Err(InvalidMaterial {
                material: self.name.clone(),
                reason,
            })
        };
        let limits = [
            ("thickness", self.thickness, 0.02, 10.0, "mm", 1e3),
            ("young", self.young, 10.0, 1e6, "MPa", 1e3),
            ("poisson", self.poisson, 0.0, 0.499, "", f64::NAN),
            (
                "density_kg_m3",
                self.density_kg_m3,
                50.0,
                25e3,
                "kg/m^3",
                1e3,
            ),
            (
                "fracture_strain",
                self.fracture_strain,
                1e-3,
                10.0,
                "",
                f64::NAN,
            ),
        ];
        for (name, value, least, greatest, unit, slip) in limits {
            if !(least..=greatest).contains(&value) {
                let hint = if (least..=greatest).contains(&(slip * value)) {
                    format!("; did you mean {} {unit}?", slip * value)
                } else {
                    String::new()
                };
                return refuse(format!(
                    "{name} = {value} violates {least} <= {name} <= {greatest} {unit}{hint}"
                ));
            }
        }
        match self.plastic.first() {
            None => return refuse("the table `plastic` is empty".into()),
            Some(&[_, strain]) if strain != 0.0 => {
                return refuse(format!(
                    "`plastic` must start at zero strain, not at {strain}"
                ));
            }
            Some(_) => {}
        }
        for (row, &[stress, strain]) in self.plastic.iter().enumerate() {
            if !(stress > 0.0 && stress < self.young && strain.is_finite()) {
                return refuse(format!(
                    "`plastic` row {row}: stress = {stress} MPa violates 0 < stress < young"
                ));
            }
        }
        for (row, pair) in self.plastic.windows(2).enumerate() {
            if pair[1][1] <= pair[0][1] {
                return refuse(format!(
                    "`plastic` rows {row} and {}: plastic strain must increase",
                    row + 1
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film() -> SheetMaterial {
        SheetMaterial {
            name: "film".into(),
            thickness: 0.5,
            young: 3000.0,
            poisson: 0.4,
            density_kg_m3: 1390.0,
            fracture_strain: 1.784,
            plastic: vec![[44.0, 0.0], [33.6, 0.05], [200.0, 1.784]],
        }
    }

    #[test]
    fn the_law_is_told_apart_by_its_numbers_alone() {
        let renamed = SheetMaterial {
            name: "other".into(),
            density_kg_m3: 1000.0,
            ..film()
        };
        assert_eq!(renamed.law_hash(), film().law_hash());
        let mut harder = film();
        harder.plastic[2][0] += 1e-9;
        assert_ne!(harder.law_hash(), film().law_hash());
        assert_eq!(film().law_hash().len(), 16);
    }

    #[test]
    fn softening_is_accepted() {
        film().validate().unwrap();
    }

    #[test]
    fn unit_slips_and_impossible_tables_are_refused() {
        let cases = [
            (
                SheetMaterial {
                    young: 3.0,
                    ..film()
                },
                "did you mean 3000 MPa",
            ),
            (
                SheetMaterial {
                    thickness: 0.0005,
                    ..film()
                },
                "did you mean 0.5 mm",
            ),
            (
                SheetMaterial {
                    density_kg_m3: 1.39,
                    ..film()
                },
                "did you mean 1390 kg/m^3",
            ),
            (
                SheetMaterial {
                    poisson: 0.5,
                    ..film()
                },
                "poisson",
            ),
            (
                SheetMaterial {
                    plastic: vec![],
                    ..film()
                },
                "empty",
            ),
            (
                SheetMaterial {
                    plastic: vec![[44.0, 0.1]],
                    ..film()
                },
                "zero strain",
            ),
            (
                SheetMaterial {
                    plastic: vec![[44.0, 0.0], [50.0, 0.0]],
                    ..film()
                },
                "increase",
            ),
            (
                SheetMaterial {
                    plastic: vec![[-44.0, 0.0]],
                    ..film()
                },
                "0 < stress",
            ),
        ];
        for (material, expected) in cases {
            let message = material.validate().unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
