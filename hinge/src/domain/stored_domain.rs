//! The form in which a training domain is stored, and the rules that a stored one must satisfy.

use crate::domain::TrainingDomain;
use crate::domain::directions::DIRECTIONS;
use serde::Deserialize;
use support::fault::Fault;
use support::refuse;

/// The fields of a domain, not checked yet.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Stored {
    w_lig: [f64; 2],
    alpha: [f64; 2],
    #[serde(default)]
    holes: Option<[f64; 2]>,
    #[serde(default)]
    mean_path: [f64; 2],
    centre: [f64; 3],
    half_range: [f64; 3],
    supports: Vec<[f64; DIRECTIONS]>,
}

impl TryFrom<Stored> for TrainingDomain {
    type Error = Fault;

    fn try_from(stored: Stored) -> Result<Self, Fault> {
        let Stored { w_lig, alpha, holes, mean_path, centre, half_range, supports } = stored;
        let is_interval =
            |[minimum, maximum]: [f64; 2]| minimum <= maximum && (maximum - minimum).is_finite();
        let is_positive = |x: &f64| *x > 0.0 && x.is_finite();
        let rules = [
            ("centre is finite", centre.iter().all(|x| x.is_finite())),
            ("half_range > 0", half_range.iter().all(is_positive)),
            ("supports has at least one row", !supports.is_empty()),
            ("supports > 0", supports.iter().flatten().all(is_positive)),
            ("0 < minimum <= maximum for w_lig", is_interval(w_lig) && w_lig[0] > 0.0),
            ("minimum <= maximum for alpha", is_interval(alpha)),
            (
                "0 <= minimum < maximum < 1 for holes",
                holes.is_none_or(|[least, most]| 0.0 <= least && least < most && most < 1.0),
            ),
            ("mean_path is finite", mean_path.iter().all(|c| c.is_finite())),
        ];
        match rules.into_iter().find(|(_, holds)| !holds) {
            Some((rule, _)) => refuse!("the training domain violates the rule `{rule}`"),
            None => Ok(Self { w_lig, alpha, holes, mean_path, centre, half_range, supports }),
        }
    }
}
