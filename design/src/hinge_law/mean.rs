//! The mean of several laws of the same hinges: of the networks of an ensemble, whose errors partly
//! cancel.

use crate::hinge_law::law::{
    DamageMeasure, HingeDamage, HingeEnergy, HingeLaw, Order, PreparedLaw,
};
use hinge::{HingeDeformation, HingeDesign, TrainingDomain};
use std::sync::Arc;
use support::vectors;

/// The mean of laws with one training domain.
pub struct MeanLaw {
    /// The laws, at least one.
    pub laws: Vec<Arc<dyn HingeLaw>>,
}

/// The same for the hinges of one sheet.
struct PreparedMean<'a> {
    laws: Vec<Box<dyn PreparedLaw + 'a>>,
}

impl HingeLaw for MeanLaw {
    fn prepare<'a>(&'a self, designs: &[HingeDesign]) -> Box<dyn PreparedLaw + 'a> {
        let laws = self.laws.iter().map(|law| law.prepare(designs));
        Box::new(PreparedMean { laws: laws.collect() })
    }

    fn damage_scale(&self, measure: DamageMeasure) -> Option<f64> {
        self.laws[0].damage_scale(measure)
    }

    fn domain(&self) -> Option<&TrainingDomain> {
        self.laws[0].domain()
    }

    fn scaled(&self, thickness: f64, stress: f64) -> Option<Arc<dyn HingeLaw>> {
        let laws = self.laws.iter().map(|law| law.scaled(thickness, stress));
        Some(Arc::new(Self { laws: laws.collect::<Option<_>>()? }))
    }

    fn scales(&self) -> [bool; 2] {
        self.laws[0].scales()
    }
}

impl PreparedLaw for PreparedMean<'_> {
    fn energies(&self, deformations: &[HingeDeformation], order: Order) -> Vec<HingeEnergy> {
        self.mean(
            |law| law.energies(deformations, order),
            |mean, part, fraction| {
                mean.w += fraction * part.w;
                vectors::add(&mut mean.forces, &part.forces, fraction);
                let (sum, rows) = (mean.tangent.as_flattened_mut(), part.tangent.as_flattened());
                vectors::add(sum, rows, fraction);
                mean.design += part.design * fraction;
                let rows = mean.mixed.iter_mut().zip(part.mixed);
                rows.for_each(|(mean, part)| *mean += part * fraction);
            },
        )
    }

    fn damage(&self, deformations: &[HingeDeformation], with_gradient: bool) -> Vec<HingeDamage> {
        self.mean(
            |law| law.damage(deformations, with_gradient),
            |mean, part, fraction| {
                mean.d += fraction * part.d;
                mean.gradient += part.gradient * fraction;
                let peaks = mean.d_peak.zip(part.d_peak);
                mean.d_peak = peaks.map(|(mean, part)| mean + fraction * part);
                mean.peak_gradient += part.peak_gradient * fraction;
            },
        )
    }

    fn resolution(&self) -> f64 {
        self.laws[0].resolution()
    }

    fn inside(&self, deformations: &[HingeDeformation]) -> Vec<bool> {
        self.laws[0].inside(deformations)
    }
}

impl PreparedMean<'_> {
    /// The mean over the laws of their values at every hinge; `add` adds a multiple of the value of
    /// one law to a sum.
    fn mean<T: Clone>(
        &self,
        of: impl Fn(&dyn PreparedLaw) -> Vec<T>,
        add: impl Fn(&mut T, &T, f64),
    ) -> Vec<T> {
        let fraction = 1.0 / self.laws.len() as f64;
        let mut laws = self.laws.iter().map(|law| of(&**law));
        let mut mean = laws.next().unwrap_or_default();
        mean.iter_mut().for_each(|first| {
            let whole = first.clone();
            add(first, &whole, fraction - 1.0);
        });
        for law in laws {
            for (mean, part) in mean.iter_mut().zip(&law) {
                add(mean, part, fraction);
            }
        }
        mean
    }
}
