//! The mean of several networks as further targets of one network (knowledge distillation).
//!
//! Networks that start from different weights make different errors between the rays, and their mean has smaller errors
//! than each. One network that is also trained on this mean, at states that no solver has computed, has nearly the errors
//! of the mean and the cost of one network.
//! (Hinton, Vinyals and Dean, "Distilling the knowledge in a neural network", 2015.)

use dataset::Database;
use hinge::{HingeDeformation, HingeDesign, HingeSample};
use surrogate::{Order, Surrogate};

/// States whose targets are the mean predictions of an ensemble.
#[derive(Clone, Debug)]
pub struct Lesson {
    /// [`Surrogate::hash`] of each member.
    pub(crate) taught_by: Vec<String>,
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
    /// The hashes of the networks of the lesson.
    pub fn taught_by(&self) -> &[String] {
        self.lesson.map_or(&[], |lesson| &lesson.taught_by)
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
            .map(|member| predictions(member, &designs, &deformations))
            .collect();
        let of_state = |state: usize| mean(predicted.iter().map(|member| member[state]));
        Self {
            taught_by: members.iter().map(Surrogate::hash).collect(),
            samples: (designs.into_iter().enumerate())
                .map(|(state, design)| (design, of_state(state)))
                .collect(),
        }
    }
}

/// Deformation, W, forces and damage of one network. The other quantities of the samples are zero.
fn predictions(
    network: &Surrogate,
    designs: &[HingeDesign],
    deformations: &[HingeDeformation],
) -> Vec<HingeSample> {
    let prepared = network.prepare(designs);
    let energies = network.evaluate(&prepared, deformations, Order::Forces);
    let damages = network.damage_values(designs, deformations);
    (deformations.iter().zip(energies).zip(damages))
        .map(|((deformation, energy), damage)| {
            let [a, s, theta] = deformation.to_array();
            let [f_a, f_s, m_theta] = energy.forces;
            HingeSample {
                a,
                s,
                theta,
                w: energy.w,
                f_a,
                f_s,
                m_theta,
                d: damage.d,
                d_peak: damage.d_peak,
                ..HingeSample::default()
            }
        })
        .collect()
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
