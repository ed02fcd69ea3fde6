//! The median of several networks as further targets of one network (knowledge distillation).
//!
//! Networks that start from different weights make different errors between the rays, and their
//! median has smaller errors than each has in the mean. One network that is also trained on it, at
//! states that no solver has computed, approaches it at the cost of one network. A network that is
//! wrong by orders of magnitude moves the median no further than to a value between the values of
//! the others. (Hinton, Vinyals and Dean, "Distilling the knowledge in a neural network", 2015.)

use dataset::Database;
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use support::statistics::median;
use surrogate::{DistillationRecord, Surrogate, Teacher};

/// States whose targets are the median predictions of an ensemble.
#[derive(Debug)]
pub struct Distillation {
    pub(crate) record: DistillationRecord,
    pub(crate) samples: Vec<(HingeDesign, HingeSample)>,
}

/// What a network is trained on: the rows of a database, and the median of an ensemble.
#[derive(Clone, Copy, Debug)]
pub struct TrainingData<'a> {
    /// The rows. Scales, training domain, validation and test are only of these.
    pub database: &'a Database,
    /// Further states for the training.
    pub distillation: Option<&'a Distillation>,
}

impl<'a> From<&'a Database> for TrainingData<'a> {
    fn from(database: &'a Database) -> Self {
        Self { database, distillation: None }
    }
}

impl TrainingData<'_> {
    /// What the card of a network states about the distillation.
    pub fn record(&self) -> Option<&DistillationRecord> {
        self.distillation.map(|median| &median.record)
    }
}

impl Distillation {
    /// The median predictions of the members at the states, each quantity by itself.
    ///
    /// # Panics
    /// If there are no members.
    pub fn new(members: &[Surrogate], states: &[(HingeDesign, HingeDeformation)]) -> Self {
        assert!(!members.is_empty(), "a median needs at least one network");
        let (designs, deformations): (Vec<_>, Vec<_>) = states.iter().copied().unzip();
        let predicted: Vec<Vec<HingeSample>> =
            (members.iter()).map(|member| member.samples(&designs, &deformations)).collect();
        let samples = designs.into_iter().enumerate().map(|(state, design)| {
            let members: Vec<_> = predicted.iter().map(|member| &member[state]).collect();
            (design, medians(&members))
        });
        let samples: Vec<_> = samples.collect();
        let bytes = serde_json::to_vec(&samples).expect("designs and samples are numbers");
        let record = DistillationRecord {
            teachers: (members.iter())
                .map(|network| Teacher {
                    weights: network.hash(),
                    fine_tuned_from: network.card().fine_tuned_from.clone(),
                })
                .collect(),
            hash: blake3::hash(&bytes).to_hex().to_string(),
        };
        Self { record, samples }
    }
}

/// The medians of W, forces and damage at one state. D_peak is unknown if one network does not
/// predict it.
fn medians(members: &[&HingeSample]) -> HingeSample {
    let of = |value: fn(&HingeSample) -> f64| {
        median(members.iter().map(|sample| value(sample)).collect())
    };
    let peaks: Option<Vec<f64>> = members.iter().map(|sample| sample.d_peak).collect();
    HingeSample {
        w: of(|sample| sample.w),
        f_a: of(|sample| sample.f_a),
        f_s: of(|sample| sample.f_s),
        m_theta: of(|sample| sample.m_theta),
        d: of(|sample| sample.d),
        d_peak: peaks.map(median),
        ..*members[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeConstants;
    use std::path::Path;

    #[test]
    fn a_distillation_has_the_median_of_three_networks() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/pet-0.5mm");
        let members = ["medium", "medium-1", "small"].map(|name| {
            Surrogate::load(&folder.join(name).with_added_extension("safetensors")).unwrap()
        });
        let design = HingeConstants::PAPER.hinge(15.0, 1.2);
        let state = HingeDeformation::from_eta(-0.2, 0.1, 0.4, design.w_lig);
        let distillation = Distillation::new(&members, &[(design, state)]);
        let of_members = members.map(|member| member.samples(&[design], &[state])[0]);
        let quantities: [fn(&HingeSample) -> f64; 3] =
            [|sample| sample.w, |sample| sample.m_theta, |sample| sample.d];
        for value in quantities {
            let mut values = of_members.each_ref().map(value);
            values.sort_by(f64::total_cmp);
            assert!(values[0] < values[1] && values[1] < values[2], "{values:?}");
            assert_eq!(value(&distillation.samples[0].1), values[1]);
        }
    }

    #[test]
    fn the_median_lies_among_the_sane_networks_and_is_unknown_with_an_unknown_d_peak() {
        let sample = |w: f64, d_peak| HingeSample {
            theta: 0.5,
            w,
            f_s: -w,
            d: 0.1 * w,
            d_peak,
            ..HingeSample::default()
        };
        let [one, two, three] = [1.0, 2.0, 3.0].map(|w| sample(w, Some(0.2 * w)));
        let wild = sample(1e6, Some(1.0));
        let known = medians(&[&wild, &two, &one, &three]);
        assert_eq!((known.w, known.f_s, known.theta), (2.5, -2.5, 0.5));
        assert!((known.d - 0.25).abs() < 1e-15);
        assert!((known.d_peak.unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(medians(&[&three, &one, &two]).w, 2.0);
        assert_eq!(medians(&[&one, &sample(3.0, None)]).d_peak, None);
    }
}
