//! A family of laws: Poisson's ratio, and hardening with three numbers, divided by Young's modulus E.
//!
//! ```text
//! sigma(p) / E = y (1 + (q - 1) min(1, p / p_1)) + h p,     p_1 = 0.05
//! ```
//!
//! p: equivalent plastic strain. y: yield strain. q: plateau over the yield stress, below 1 for a law that softens after
//! yield, above 1 for one that saturates. h: hardening modulus after the plateau is reached. q = 1 is bilinear; q = 1 and
//! h = 0 is perfectly plastic; a large y is elastic.

use hinge::SheetMaterial;
use train::LAW_STRAINS;

/// p_1: the plastic strain at which the plateau is reached; over less than 0.05, a drop makes coarse meshes diverge.
const PLATEAU_STRAIN: f64 = 0.05;
/// The plastic strain up to which the hardening of a measured law is read.
const HARDENED_STRAIN: f64 = 0.2;
/// The last row of the table of a law; no window reaches it.
const LAST_STRAIN: f64 = 2.0;

/// Limits of (nu, y, q, h) in the family; each number is drawn uniformly in its logarithm.
pub const LIMITS: [[f64; 2]; 4] = [[0.28, 0.45], [8e-4, 3e-2], [0.65, 2.0], [5e-4, 5e-2]];

/// Poisson's ratio and a hardening law over E.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// nu: Poisson's ratio.
    pub poisson: f64,
    /// y: yield stress over E.
    pub yield_strain: f64,
    /// q: plateau over yield stress.
    pub plateau: f64,
    /// h: hardening modulus over E.
    pub hardening: f64,
}

impl Law {
    /// The law at an index of a low-discrepancy sequence in the box of [`LIMITS`]: any first part of it fills the box.
    /// (Roberts' additive recurrence: the fractions of i / g, ..., i / g^4 with g^5 = g + 1.)
    pub fn of_family(index: usize) -> Self {
        const G: f64 = 1.167_303_978_261_418_7;
        let [poisson, yield_strain, plateau, hardening] = std::array::from_fn(|k| {
            let share = (0.5 + index as f64 / G.powi(k as i32 + 1)).fract();
            let [from, to] = LIMITS[k].map(f64::ln);
            (from + (to - from) * share).exp()
        });
        Self {
            poisson,
            yield_strain,
            plateau,
            hardening,
        }
    }

    /// The law of the family with Poisson's ratio of a material and through
    /// its stresses at the plastic strains 0, 0.05 and 0.2.
    pub fn of_material(material: &SheetMaterial) -> Self {
        let [first, plateau, hardened] =
            [0.0, PLATEAU_STRAIN, HARDENED_STRAIN].map(|p| stress(material, p) / material.young);
        let hardening = (hardened - plateau) / (HARDENED_STRAIN - PLATEAU_STRAIN);
        Self {
            poisson: material.poisson,
            yield_strain: first,
            plateau: (plateau - hardening * PLATEAU_STRAIN) / first,
            hardening,
        }
    }

    /// sigma(p) / E
    pub fn stress(&self, p: f64) -> f64 {
        let reached = (p / PLATEAU_STRAIN).min(1.0);
        self.yield_strain * (1.0 + (self.plateau - 1.0) * reached) + self.hardening * p
    }

    /// Rows [sigma / E, p] of the law.
    fn rows(&self) -> [[f64; 2]; 3] {
        [0.0, PLATEAU_STRAIN, LAST_STRAIN].map(|p| [self.stress(p), p])
    }

    /// [`works`] of the law.
    pub fn works(&self) -> [f64; LAW_STRAINS] {
        works(&self.rows())
    }

    /// The material with the thickness and E of `sheet`, and this law.
    pub fn material(&self, sheet: &SheetMaterial) -> SheetMaterial {
        let rows = self.rows().map(|[stress, p]| [sheet.young * stress, p]);
        SheetMaterial {
            poisson: self.poisson,
            plastic: rows.to_vec(),
            ..sheet.clone()
        }
    }

    /// The size of the energies of the law over E t^3, to which errors are relative: over the family they grow about with
    /// this power of the stress.
    pub fn energy_size(&self) -> f64 {
        self.stress(PLATEAU_STRAIN).powf(0.6)
    }

    /// The numbers of the hardening as features of a network: logarithms of the yield strain and of the stresses at the
    /// plastic strains 0.05 and 0.2 over the yield stress. Hardening that adds little to the stress changes them little.
    pub fn features(&self) -> [f64; 3] {
        [
            self.yield_strain,
            self.stress(PLATEAU_STRAIN) / self.yield_strain,
            self.stress(HARDENED_STRAIN) / self.yield_strain,
        ]
        .map(f64::ln)
    }
}

/// Strains e_j of [`works`], in geometric progression: the smallest elastic for every law, the largest that of a tear.
const STRAINS: [f64; 2] = [5e-4, 0.5];

/// Work of a law over E in uniaxial tension, to strains e_j: phi(e) = integral of sigma / E over the strain. Rows
/// [sigma / E, p]; constant stress after the last one.
pub fn works(rows: &[[f64; 2]]) -> [f64; LAW_STRAINS] {
    let [from, to] = STRAINS;
    std::array::from_fn(|j| {
        let strain = from * f64::powf(to / from, j as f64 / (LAW_STRAINS - 1) as f64);
        work(rows, strain)
    })
}

fn work(rows: &[[f64; 2]], strain: f64) -> f64 {
    let mut before = [0.0, 0.0];
    let mut work = 0.0;
    // Total strain and stress are linear in p between two rows: the work is that of trapezoids.
    for &[stress, p] in rows {
        let row = [stress + p, stress];
        if row[0] >= strain {
            let share = (strain - before[0]) / (row[0] - before[0]);
            let reached = before[1] + share * (row[1] - before[1]);
            return work + 0.5 * (before[1] + reached) * (strain - before[0]);
        }
        work += 0.5 * (before[1] + row[1]) * (row[0] - before[0]);
        before = row;
    }
    work + before[1] * (strain - before[0])
}

/// [`works`] of the table of a material.
pub fn works_of_material(material: &SheetMaterial) -> [f64; LAW_STRAINS] {
    let rows = material.plastic.iter();
    let rows: Vec<[f64; 2]> = rows
        .map(|[stress, p]| [stress / material.young, *p])
        .collect();
    works(&rows)
}

/// The stress of a material (MPa) at a plastic strain: its table, interpolated linearly and constant after its end.
fn stress(material: &SheetMaterial, p: f64) -> f64 {
    let rows = &material.plastic;
    let after = rows.partition_point(|[_, strain]| *strain < p);
    let Some(&[high, end]) = rows.get(after) else {
        return rows.last().map_or(0.0, |[stress, _]| *stress);
    };
    match after.checked_sub(1).map(|before| rows[before]) {
        Some([low, start]) => low + (high - low) * (p - start) / (end - start),
        None => high,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn shipped(name: &str) -> SheetMaterial {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/materials");
        SheetMaterial::load(&folder.join(name)).unwrap()
    }

    #[test]
    fn limits_of_the_family_are_perfectly_plastic_bilinear_and_elastic_laws() {
        let sheet = shipped("pet-0.5mm.toml");
        let perfect = Law {
            poisson: 0.3,
            yield_strain: 0.002,
            plateau: 1.0,
            hardening: 0.0,
        };
        let table = perfect.material(&sheet).plastic;
        assert!(
            table
                .iter()
                .all(|[stress, _]| *stress == 0.002 * sheet.young)
        );
        assert_eq!(perfect.features()[1..], [0.0, 0.0]);
        let bilinear = Law {
            hardening: 0.01,
            ..perfect
        };
        assert!((bilinear.stress(0.1) - 0.003).abs() < 1e-15);
        // Beyond the strains of a window, a law yields nowhere and is elastic.
        let elastic = Law {
            yield_strain: 0.9,
            ..perfect
        };
        elastic.material(&sheet).validate().unwrap();
        assert!(elastic.features()[0] > LIMITS[1][1].ln());
    }

    #[test]
    fn the_law_of_a_material_has_its_stresses_at_three_strains() {
        let names = [
            "pet-0.5mm.toml",
            "s235-1.5mm.toml",
            "polypropylene-0.8mm.toml",
        ];
        for material in names.map(shipped) {
            let law = Law::of_material(&material);
            for p in [0.0, PLATEAU_STRAIN, HARDENED_STRAIN] {
                let error = law.stress(p) * material.young - stress(&material, p);
                assert!(error.abs() < 1e-9, "{} {p}", material.name);
            }
            let numbers = [law.poisson, law.yield_strain, law.plateau, law.hardening];
            for (number, [from, to]) in numbers.into_iter().zip(LIMITS) {
                assert!((from..=to).contains(&number), "{} {number}", material.name);
            }
        }
        let polypropylene = Law::of_material(&shipped("polypropylene-0.8mm.toml"));
        assert!((polypropylene.plateau - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_work_in_tension_is_elastic_before_yield_and_linear_in_the_strain_on_a_plateau() {
        let rows = [[0.01, 0.0], [0.01, 0.3]];
        assert!((work(&rows, 0.004) - 0.5 * 0.004 * 0.004).abs() < 1e-15);
        assert!((work(&rows, 0.11) - 0.01 * (0.11 - 0.005)).abs() < 1e-15);
        assert!(
            (work(&rows, 0.41) - 0.01 * (0.41 - 0.005)).abs() < 1e-15,
            "after the last row"
        );
        let works = works(&rows);
        assert!((works[0] - 0.5 * STRAINS[0].powi(2)).abs() < 1e-15);
        assert!((works[LAW_STRAINS - 1] - 0.01 * 0.495).abs() < 1e-12);
    }

    #[test]
    fn every_prefix_of_the_family_fills_its_box() {
        // The hardening is spread least evenly: the last number of a recurrence in four dimensions.
        for (count, limit) in [(32, 3), (300, 10)] {
            for (k, [from, to]) in LIMITS.into_iter().enumerate() {
                let below = (0..count).filter(|index| {
                    let law = Law::of_family(*index);
                    let number = [law.poisson, law.yield_strain, law.plateau, law.hardening][k];
                    assert!((from..=to).contains(&number));
                    number < (from * to).sqrt()
                });
                assert!(below.count().abs_diff(count / 2) <= limit);
            }
        }
    }
}
