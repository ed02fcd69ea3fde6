//! The mean of several networks as further targets of one network (knowledge distillation).
//!
//! Networks that start from different weights make different errors between the rays, and their mean has smaller errors
//! than each. One network that is also trained on this mean, at states that no solver has computed, approaches it at the cost
//! of one network.
//! (Hinton, Vinyals and Dean, "Distilling the knowledge in a neural network", 2015.)

use dataset::Database;
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use surrogate::{LessonRecord, Surrogate, Teacher};

/// States whose targets are the mean predictions of an ensemble.
#[derive(Clone, Debug)]
pub struct Lesson {
    pub(crate) record: LessonRecord,
    pub(crate) samples: Vec<(HingeDesign, HingeSample)>,
}

/// What a network is trained on: the rows of a database, and the lesson of an ensemble.
#[derive(Clone, Copy, Debug)]
pub struct TrainingData<'a> {
    /// The rows. Scales, training domain, validation and test are of these alone.
    pub database: &'a Database,
    /// Further states for the training.
    pub lesson: Option<&'a Lesson>,
}

impl<'a> From<&'a Database> for TrainingData<'a> {
    fn from(database: &'a Database) -> Self {
        Self {
            database,
            lesson: None,
        }
    }
}

impl TrainingData<'_> {
    /// What the card of a network states about the lesson.
    pub fn record(&self) -> Option<&LessonRecord> {
        self.lesson.map(|lesson| &lesson.record)
    }
}

impl Lesson {
    /// The mean predictions of the members at the states.
    ///
    /// # Panics
    /// If there are no members.
    pub fn new(members: &[Surrogate], states: &[(HingeDesign, HingeDeformation)]) -> Self {
        assert!(!members.is_empty(), "a mean needs at least one network");
        let (designs, deformations): (Vec<_>, Vec<_>) = states.iter().copied().unzip();
        let predicted: Vec<Vec<HingeSample>> = (members.iter())
            .map(|member| member.samples(&designs, &deformations))
            .collect();
        let of_state = |state: usize| mean(predicted.iter().map(|member| member[state]));
        let samples: Vec<_> = (designs.into_iter().enumerate())
            .map(|(state, design)| (design, of_state(state)))
            .collect();
        let record = LessonRecord {
            teachers: members.iter().map(teacher).collect(),
            hash: hash(&samples),
        };
        Self { record, samples }
    }
}

fn teacher(network: &Surrogate) -> Teacher {
    Teacher {
        weights: network.hash(),
        fine_tuned_from: network.card().fine_tuned_from.clone(),
    }
}

fn hash(samples: &[(HingeDesign, HingeSample)]) -> String {
    let bytes = serde_json::to_vec(samples).expect("designs and samples are numbers");
    blake3::hash(&bytes).to_hex().to_string()
}

/// The mean of W, forces and damage at one state. D_peak is unknown if one network does not predict it.
fn mean(members: impl Iterator<Item = HingeSample> + Clone) -> HingeSample {
    let count = members.clone().count() as f64;
    let mean =
        |value: fn(&HingeSample) -> f64| members.clone().map(|it| value(&it)).sum::<f64>() / count;
    let peaks: Option<f64> = members.clone().map(|it| it.d_peak).sum();
    HingeSample {
        w: mean(|it| it.w),
        f_a: mean(|it| it.f_a),
        f_s: mean(|it| it.f_s),
        m_theta: mean(|it| it.m_theta),
        d: mean(|it| it.d),
        d_peak: peaks.map(|sum| sum / count),
        ..members.clone().next().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_an_unknown_d_peak_is_unknown() {
        let sample = |w: f64, d_peak| HingeSample {
            theta: 0.5,
            w,
            f_s: -w,
            d: 0.1 * w,
            d_peak,
            ..HingeSample::default()
        };
        let known = mean([sample(1.0, Some(0.2)), sample(3.0, Some(0.6))].into_iter());
        assert_eq!((known.w, known.f_s, known.theta), (2.0, -2.0, 0.5));
        assert!((known.d - 0.2).abs() < 1e-15);
        assert!((known.d_peak.unwrap() - 0.4).abs() < 1e-15);
        assert_eq!(
            mean([sample(1.0, Some(0.2)), sample(3.0, None)].into_iter()).d_peak,
            None
        );
    }
}
