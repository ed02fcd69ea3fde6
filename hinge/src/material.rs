//! The sheet material, as measured on tensile specimens; section 4.1.

use crate::Regime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;
use support::{Fault, at, ensure, fault, key_limits, refuse, toml_file};

/// Standard acceleration of gravity, rounded (m/s^2 = N/kg).
pub const STANDARD_GRAVITY: f64 = 9.81;

/// A uniform sheet: thickness, isotropic elasticity, tabulated J2 hardening, fracture strain. Its
/// TOML files are in `configs/materials/`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SheetMaterial {
    /// Name of the material; it is stored in databases and weights.
    pub name: String,
    /// Thickness of the sheet (mm).
    #[schemars(range(min = 0.02, max = 10.0))]
    pub thickness: f64,
    /// Young's modulus (MPa): tungsten has 411 000.
    #[schemars(range(min = 10.0, max = 5e5))]
    pub young: f64,
    /// Poisson's ratio.
    #[schemars(range(min = 0.0, max = 0.499))]
    pub poisson: f64,
    /// Density (kg/m^3): the weight of the sheet, and (21)-(22). No window solve uses it.
    #[schemars(range(min = 50.0, max = 25e3))]
    pub density_kg_m3: f64,
    /// Equivalent plastic strain at fracture, eps_f of (12).
    #[schemars(range(min = 1e-3, max = 10.0))]
    pub fracture_strain: f64,
    /// Rows [true stress (MPa), true plastic strain]; the stress is above 0 and below `young`, the
    /// strain starts at zero and increases.
    pub plastic: Vec<[f64; 2]>,
    /// Relative standard deviation of the stress at equal strain, of the sheet that is cut from
    /// this law, for the error budget of a design; `kirigami material fit` writes the deviation of
    /// its specimens. No window solve uses it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub stress_deviation: Option<f64>,
    /// Creep under a load that stays, by order of magnitude; without it the report says that it is
    /// not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub creep: Option<Creep>,
}

/// Creep of the material, by order of magnitude, which the report of a design states; no solve uses
/// it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Creep {
    /// Deformation after `years` under a constant small load, over that at once (ISO 9967: the
    /// creep ratio); the stiffness falls to its reciprocal.
    #[schemars(range(min = 1.0, max = 100.0))]
    pub ratio: f64,
    /// Time under load, in years.
    #[schemars(range(min = 1e-3, max = 100.0))]
    pub years: f64,
}

/// Densities below this (kg/m^3) are densities of plastics and papers.
const LIGHTEST_METAL: f64 = 1700.0;
/// Maximum of Young's modulus over density (MPa m^3/kg): laminates of carbon fibre have up to 190,
/// beryllium 155, metals 20 to 30, plastics 0.2 to 7.
const STIFFEST: f64 = 200.0;

impl SheetMaterial {
    /// The regime of a ligament of `w_lig` (mm) in a sheet of this thickness.
    pub fn regime(&self, w_lig: f64) -> Regime {
        Regime::of(w_lig / self.thickness)
    }

    /// Reads a material and rejects impossible values.
    pub fn load(path: &Path) -> Result<Self, Fault> {
        let material: Self = toml_file::read(path)?;
        material.validate().map_err(at(path.display()))?;
        Ok(material)
    }

    /// The material as solves record it: without deviation and creep, which they do not depend on.
    #[must_use]
    pub fn as_solved(&self) -> Self {
        Self { stress_deviation: None, creep: None, ..self.clone() }
    }

    /// The material with `factor` times the stress at every strain.
    #[must_use]
    pub fn stressed(&self, factor: f64) -> Self {
        Self {
            young: factor * self.young,
            plastic: (self.plastic.iter())
                .map(|[stress, strain]| [factor * stress, *strain])
                .collect(),
            ..self.clone()
        }
    }

    /// Mass of a unit of area (kg/mm^2).
    pub fn mass_by_area(&self) -> f64 {
        1e-9 * self.density_kg_m3 * self.thickness
    }

    /// Whether it has the density of a metal.
    pub fn is_metal(&self) -> bool {
        self.density_kg_m3 >= LIGHTEST_METAL
    }

    /// Weight of a unit of area (N/mm^2).
    pub fn weight_by_area(&self) -> f64 {
        STANDARD_GRAVITY * self.mass_by_area()
    }

    /// Identifies the material law independently of its name: BLAKE3 hash of all material
    /// parameters that a window solve uses, 16 hexadecimal digits. Name and density are not
    /// included.
    pub fn law_hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        let numbers = [self.thickness, self.young, self.poisson, self.fracture_strain];
        for number in numbers.iter().chain(self.plastic.iter().flatten()) {
            hasher.update(&number.to_le_bytes());
        }
        hasher.finalize().to_hex()[..16].to_owned()
    }

    /// Rejects impossible values and the usual unit errors (GPa for MPa, m for mm, g/cm^3 for
    /// kg/m^3).
    pub fn validate(&self) -> Result<(), Fault> {
        self.check().map_err(|reason| fault!("material `{}`: {reason}", self.name))
    }

    fn check(&self) -> Result<(), Fault> {
        key_limits::check::<Self>(self)?;
        let stiffness = self.young / self.density_kg_m3;
        ensure!(
            stiffness <= STIFFEST,
            "young = {} MPa is {stiffness:.0} MPa for each kg/m^3 of its density, more than the {STIFFEST} that any sheet has: check \
                 both, and in a tensile test width, thickness, gauge length and units",
            self.young
        );
        match self.plastic.first() {
            None => refuse!("the table `plastic` is empty"),
            Some(&[_, strain]) if strain != 0.0 => {
                refuse!("`plastic` must start at zero strain, not at {strain}");
            }
            Some(_) => {}
        }
        for (row, &[stress, strain]) in self.plastic.iter().enumerate() {
            ensure!(
                stress > 0.0 && stress < self.young && strain.is_finite(),
                "`plastic` row {row}: stress = {stress} MPa violates 0 < stress < young"
            );
        }
        for (row, pair) in self.plastic.windows(2).enumerate() {
            ensure!(
                pair[1][1] > pair[0][1],
                "`plastic` rows {row} and {}: plastic strain must increase",
                row + 1
            );
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
            ..SheetMaterial::default()
        }
    }

    #[test]
    fn the_law_hash_depends_on_the_parameters_alone() {
        let renamed = SheetMaterial { name: "other".into(), density_kg_m3: 1000.0, ..film() };
        assert_eq!(renamed.law_hash(), film().law_hash());
        let mut harder = film();
        harder.plastic[2][0] += 1e-9;
        assert_ne!(harder.law_hash(), film().law_hash());
        assert_eq!(film().law_hash().len(), 16);
    }

    #[test]
    fn creep_is_a_fact_of_the_report_alone() {
        let creeping = |ratio: f64, years: f64| SheetMaterial {
            creep: Some(Creep { ratio, years }),
            ..film()
        };
        let known = creeping(3.0, 2.0);
        known.validate().unwrap();
        assert_eq!(known.law_hash(), film().law_hash());
        assert_eq!(known.as_solved(), film());
        for (material, expected) in
            [(creeping(0.33, 2.0), "creep.ratio = 0.33"), (creeping(3.0, 0.0), "creep.years = 0")]
        {
            let message = material.validate().unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn softening_is_accepted() {
        assert_eq!(film().validate(), Ok(()));
    }

    #[test]
    fn unit_errors_and_impossible_tables_are_rejected() {
        type Change = fn(&mut SheetMaterial);
        let cases: [(Change, &str); 10] = [
            (|m| m.young = 3.0, "did you mean 3000 MPa"),
            (|m| m.young = 660e3, "young = 660000 MPa violates 10 <= young <= 500000 MPa"),
            (|m| m.young = 300e3, "is 216 MPa for each kg/m^3"),
            (|m| m.thickness = 0.0005, "did you mean 0.5 mm"),
            (|m| m.density_kg_m3 = 1.39, "did you mean 1390 kg/m^3"),
            (|m| m.poisson = 0.5, "poisson"),
            (|m| m.plastic.clear(), "empty"),
            (|m| m.plastic = vec![[44.0, 0.1]], "zero strain"),
            (|m| m.plastic = vec![[44.0, 0.0], [50.0, 0.0]], "increase"),
            (|m| m.plastic = vec![[-44.0, 0.0]], "0 < stress"),
        ];
        for (change, expected) in cases {
            let mut material = film();
            change(&mut material);
            let message = material.validate().unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
