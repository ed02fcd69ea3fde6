//! The form in which a training domain is stored, and the rules that a stored one must satisfy.

use crate::domain::TrainingDomain;
use crate::domain::directions::DIRECTIONS;
use serde::{Deserialize, Serialize};

/// A stored domain that violates a rule.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the training domain violates the rule `{0}`")]
pub struct InvalidDomain(&'static str);

/// The serialised form of a domain.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Fitted {
    w_lig: [f64; 2],
    alpha: [f64; 2],
    centre: [f64; 3],
    half_range: [f64; 3],
    supports: Vec<Vec<f64>>,
}

/// The forms in which a domain may be stored: older files contain a box instead of supports.
#[derive(Deserialize)]
#[serde(untagged)]
pub(super) enum Stored {
    Fitted(Fitted),
    Box(Intervals),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Intervals {
    eta_a: [f64; 2],
    eta_s: [f64; 2],
    theta: [f64; 2],
    w_lig: [f64; 2],
    alpha: [f64; 2],
}

impl From<TrainingDomain> for Fitted {
    fn from(domain: TrainingDomain) -> Self {
        Self {
            w_lig: domain.w_lig,
            alpha: domain.alpha,
            centre: domain.centre,
            half_range: domain.half_range,
            supports: domain.supports.iter().map(|row| row.to_vec()).collect(),
        }
    }
}

impl TryFrom<Stored> for TrainingDomain {
    type Error = InvalidDomain;

    fn try_from(stored: Stored) -> Result<Self, InvalidDomain> {
        let check = |holds: bool, rule| {
            if holds {
                Ok(())
            } else {
                Err(InvalidDomain(rule))
            }
        };
        let is_interval =
            |[minimum, maximum]: [f64; 2]| minimum <= maximum && (maximum - minimum).is_finite();
        let domain = match stored {
            Stored::Box(Intervals {
                eta_a,
                eta_s,
                theta,
                w_lig,
                alpha,
            }) => {
                let state = [eta_a, eta_s, theta];
                check(
                    state.into_iter().all(is_interval),
                    "minimum <= maximum for eta_a, eta_s, theta",
                )?;
                Self::of_box(state, w_lig, alpha)
            }
            Stored::Fitted(fitted) => {
                let positive = |x: &f64| *x > 0.0 && x.is_finite();
                check(
                    fitted.centre.iter().all(|x| x.is_finite()),
                    "centre is finite",
                )?;
                check(fitted.half_range.iter().all(positive), "half_range > 0")?;
                check(!fitted.supports.is_empty(), "supports has at least one row")?;
                check(
                    fitted.supports.iter().flatten().all(positive),
                    "supports > 0",
                )?;
                let rows = fitted
                    .supports
                    .into_iter()
                    .map(<[f64; DIRECTIONS]>::try_from);
                Self {
                    w_lig: fitted.w_lig,
                    alpha: fitted.alpha,
                    centre: fitted.centre,
                    half_range: fitted.half_range,
                    supports: rows
                        .collect::<Result<_, _>>()
                        .map_err(|_| InvalidDomain("every row of supports has 26 values"))?,
                }
            }
        };
        check(
            is_interval(domain.w_lig) && domain.w_lig[0] > 0.0,
            "0 < minimum <= maximum for w_lig",
        )?;
        check(is_interval(domain.alpha), "minimum <= maximum for alpha")?;
        Ok(domain)
    }
}
