//! Records of a testing machine for laws that are known in closed form.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A uniaxial law: the true stress (MPa) at a plastic strain, and Young's modulus (MPa).
#[derive(Clone, Copy)]
pub struct Law {
    pub name: &'static str,
    pub young: f64,
    pub stress: fn(f64) -> f64,
    /// Plastic strain at which the record ends.
    pub end: f64,
}

/// sigma = 200 + 1000 eps_p
pub const LINEAR: Law = Law {
    name: "linear hardening",
    young: 70e3,
    stress: |plastic| 200.0 + 1000.0 * plastic,
    end: 0.15,
};

/// sigma = 120 + 130 (1 - exp(-12 eps_p)); Voce. It necks at eps_p = 0.145.
pub const VOCE: Law = Law {
    name: "Voce",
    young: 70e3,
    stress: |plastic| 120.0 + 130.0 * (1.0 - (-12.0 * plastic).exp()),
    end: 0.12,
};

/// eps_p = 0.002 (sigma / 300)^8; Ramberg and Osgood.
pub const RAMBERG_OSGOOD: Law = Law {
    name: "Ramberg-Osgood",
    young: 200e3,
    stress: |plastic| 300.0 * (plastic / 0.002).powf(1.0 / 8.0),
    end: 0.08,
};

/// sigma = 44 + 8 (L^2 - 1 / L) with L = exp(eps_p); Haward and Thackray. It necks at the yield and
/// draws.
pub const FILM: Law = Law {
    name: "cold drawing",
    young: 3000.0,
    stress: |plastic| 44.0 + 8.0 * ((2.0 * plastic).exp() - (-plastic).exp()),
    end: 1.4,
};

/// The draw of a film, in closed form up to the quadrature.
#[derive(Clone, Copy, Debug)]
pub struct Plateau {
    pub stress: f64,
    pub ratio: f64,
    pub upper_yield: f64,
}

impl Law {
    /// Nominal [strain, stress] at a plastic strain.
    fn nominal(&self, plastic: f64) -> [f64; 2] {
        let stress = (self.stress)(plastic);
        let stretch = (plastic + stress / self.young).exp();
        [stretch - 1.0, stress / stretch]
    }

    /// The nominal curve of a uniform specimen, densely.
    fn uniform(&self) -> Vec<[f64; 2]> {
        let yields = (self.stress)(0.0);
        let elastic = (0..500).map(|i| {
            let stress = yields * f64::from(i) / 500.0;
            let stretch = (stress / self.young).exp();
            [stretch - 1.0, stress / stretch]
        });
        let plastic =
            (0..=40_000).map(|i| self.nominal(self.end * (f64::from(i) / 40_000.0).powi(2)));
        let mut curve: Vec<[f64; 2]> = elastic.chain(plastic).collect();
        curve.dedup_by_key(|row| row[0]);
        curve
    }

    /// Stress and draw ratio of the running neck by Maxwell's rule: equal areas of the local curve
    /// above and below.
    pub fn plateau(&self) -> Plateau {
        let curve = self.uniform();
        let (top, upper_yield) = (0..curve.len() / 4)
            .map(|i| (i, curve[i][1]))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        let end = |level: f64| curve.iter().rposition(|row| row[1] <= level).unwrap();
        let excess = |level: f64| -> f64 {
            let rows = curve[top..=end(level)].windows(2);
            rows.map(|p| (0.5 * (p[0][1] + p[1][1]) - level) * (p[1][0] - p[0][0])).sum()
        };
        let least = curve[top..].iter().map(|row| row[1]).fold(f64::INFINITY, f64::min);
        let [mut low, mut high] = [least, upper_yield];
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match excess(middle) > 0.0 {
                true => low = middle,
                false => high = middle,
            }
        }
        Plateau { stress: low, ratio: 1.0 + curve[end(low)][0], upper_yield }
    }

    /// The record of a specimen: rows [nominal strain, nominal stress] at a constant rate of the
    /// strain.
    pub fn record(&self, rows: usize) -> Vec<[f64; 2]> {
        self.record_to(self.end, rows)
    }

    /// The same up to another plastic strain.
    pub fn record_to(&self, end: f64, rows: usize) -> Vec<[f64; 2]> {
        let mut curve = Law { end, ..*self }.uniform();
        if self.name == FILM.name {
            let Plateau { stress, ratio, upper_yield } = self.plateau();
            let top = curve.iter().position(|row| row[1] >= upper_yield).unwrap();
            let fallen = curve[top][0] + 0.05;
            for row in curve[top..].iter_mut().filter(|row| 1.0 + row[0] < ratio) {
                let share = ((row[0] - fallen + 0.05) / 0.05).min(1.0);
                row[1] = upper_yield + share * (stress - upper_yield);
            }
        }
        let last = curve[curve.len() - 1][0];
        let strains = (0..rows).map(|i| last * i as f64 / (rows - 1) as f64);
        strains.map(|strain| [strain, at(&curve, strain)]).collect()
    }

    /// The nominal stress at a plastic strain of 0.2 %.
    pub fn offset_yield(&self) -> f64 {
        let [strain, stress] = [0, 1].map(|of| move |plastic: f64| self.nominal(plastic)[of]);
        let (mut low, mut high) = (0.0, 0.01);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match strain(middle) - stress(middle) / self.young < 0.002 {
                true => low = middle,
                false => high = middle,
            }
        }
        stress(low)
    }
}

/// Linear interpolation of [x, y] rows with increasing x.
pub fn at(curve: &[[f64; 2]], x: f64) -> f64 {
    let after = curve.partition_point(|row| row[0] < x).clamp(1, curve.len() - 1);
    let ([x0, y0], [x1, y1]) = (curve[after - 1], curve[after]);
    y0 + (y1 - y0) * (x - x0) / (x1 - x0)
}

/// Normally distributed numbers from a seed: the sum of twelve uniform ones.
pub struct Noise(pub u64);

impl Noise {
    pub fn integer(&mut self) -> u64 {
        // splitmix64
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn normal(&mut self) -> f64 {
        let uniform = |noise: &mut Self| noise.integer() as f64 / u64::MAX as f64;
        (0..12).map(|_| uniform(self)).sum::<f64>() - 6.0
    }
}

/// Rows as a comma-separated file with a header.
pub fn csv(header: &str, rows: &[[f64; 2]]) -> String {
    let mut text = format!("{header}\n");
    for [strain, stress] in rows {
        writeln!(text, "{strain},{stress}").unwrap();
    }
    text
}

pub const HEADER: &str = "Tensile strain (1),Tensile stress (MPa)";

/// Writes files into a folder.
pub fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}
