//! Findings about the hinges and the law that predicts them.

use super::{Rule, at, found, rule};
use crate::report::numbers::rounded;
use analysis::calibration::CALIBRATION;
use design::hinge_law::{DamageMeasure, HingeDamage};
use support::Extremes;
use support::severity::Severity::{Error, Note, Warning};

/// Relative difference of two slits that is rounding.
const SAME_SLIT: f64 = 1e-6;
/// Relative error of a force (%) above which a law is inaccurate.
const INACCURATE: f64 = 10.0;

pub(super) const RULES: [Rule; 10] = [
    rule(
        "ligaments-outside-domain",
        Warning,
        [
            "ligaments outside the training domain",
            "w_lig or alpha is outside the database",
            "w_lig: `[ligament] range`; alpha: a wider `alpha_deg` in the campaign",
        ],
        |of| {
            let domain = of.scene.surrogate()?.domain();
            let outside = |[min, max]: [f64; 2], value: f64| !(min..=max).contains(&value);
            let alpha_deg = domain.alpha.map(f64::to_degrees);
            let hinges = of.hinges_where(|row| {
                outside(domain.w_lig, row.w_lig) || outside(alpha_deg, row.alpha_deg)
            });
            let message = format!(
                "ligaments are outside the training domain of the hinge law, w_lig {:.1} to {:.1} mm and alpha \
                 {:.0} to {:.0} deg",
                domain.w_lig[0], domain.w_lig[1], alpha_deg[0], alpha_deg[1]
            );
            at(hinges, message)
        },
    ),
    rule(
        "slit-unknown",
        Warning,
        [
            "the slit is not the one of the weights",
            "its effect was not measured at this ratio to the ligament",
            "narrower slits, wider ligaments",
        ],
        |of| {
            // A learned law has the slits of its training; the effect of others was measured in a range.
            let known = of.scene.surrogate()?.card().hinge.kerf;
            let slit = of.deployment.sheet.options.process.slit_width;
            if (slit / known - 1.0).abs() < SAME_SLIT {
                return None;
            }
            let regime = of.scene.material.regime(of.scene.config.ligament.start);
            let [least, most] = CALIBRATION.of(regime).slit.value;
            let message = format!(
                "the slit of {slit} mm (process.slit_width) is neither the slit of the weights, {} mm, nor between {least} and {most} ligament widths, where its effect on the hinge energy was measured: \
                 use narrower slits or wider ligaments",
                rounded(known, 4)
            );
            at(of.hinges_where(|row| !(least..=most).contains(&(slit / row.w_lig))), message)
        },
    ),
    rule(
        "states-outside-domain",
        Warning,
        [
            "deformations outside the training domain",
            "energy and forces are extrapolated, damage is `?`",
            "`extra_rays` of the campaign, or `objective.domain` above zero",
        ],
        |of| {
            of.scene.surrogate()?;
            let message = "deformations leave the training domain of the hinge law along the path: energy and forces of these \
                           hinges are extrapolated, and their damage is not known";
            at(of.hinges_where(|row| !row.inside), message)
        },
    ),
    rule(
        "path-dependence",
        Note,
        [
            "paths depart from the rays of the hinge law",
            "energy, forces and damage depend on the path",
            "`kirigami verify --equilibrium`",
        ],
        |of| {
            // A learned law was measured along rays.
            let bent_rays = of.scene.surrogate()?.card().bent_rays;
            let regime = of.scene.material.regime(of.scene.config.ligament.range[1]);
            let deviation = CALIBRATION.path_deviation(regime, bent_rays);
            let message = format!(
                "paths depart by more than {} ligament widths from the rays of the hinge law: energy, forces and damage depend on the \
                 path there ({}); check by `kirigami verify --equilibrium`",
                deviation.safe, deviation.source
            );
            at(of.hinges_where(|row| row.path_separation > deviation.safe), message)
        },
    ),
    rule(
        "flanks-touch",
        Warning,
        [
            "the flanks of cuts are pushed into each other",
            "their contact is not modelled: the load is larger than stated",
            "another pull, less compression",
        ],
        |of| {
            // Windows have no contact.
            of.scene.surrogate()?;
            let gaps = of.hinges.iter().map(|row| row.flank_gap);
            let most = -gaps.smallest();
            let message = format!(
                "the flanks of their cuts are pushed into each other, by up to {} mm: contact between them is not modelled, and the load is \
                 larger than stated (docs/TRIED.md)",
                rounded(most, 2)
            );
            at(of.hinges_where(|row| row.flank_gap < 0.0), message)
        },
    ),
    rule(
        "tearing",
        Error,
        [
            "predicted peak damage of 1 or more",
            "the ligament tears",
            "`objective.damage` with `damage_measure = \"peak\"`, wider ligaments, lower load",
        ],
        |of| {
            // The mean reaches 1 later than the peak; weights without D_peak predict the mean only.
            let torn = of.hinges_where(|row| {
                row.damage_peak.or(row.damage).is_some_and(|damage| damage >= 1.0)
            });
            let tears = |damage: &HingeDamage| {
                let peak = DamageMeasure::Peak.known(damage);
                peak.unwrap_or(damage.d) >= 1.0
            };
            let mut weighed = of.deployment.weight_steps().iter();
            let cause = if weighed.any(|step| step.damage.iter().any(tears)) {
                ", under the weight of the sheet alone: hang it from more points, or use wider ligaments"
            } else {
                ""
            };
            at(torn, format!("predicted peak damage of 1 or more: the ligament tears{cause}"))
        },
    ),
    rule(
        "overstrained",
        Error,
        [
            "ligaments translate by more than their width",
            "no hinge law is valid there",
            "lower load, smaller target",
        ],
        |of| {
            let beyond = of.hinges_where(|row| row.eta_a.abs().max(row.eta_s.abs()) > 1.0);
            let message = "ligaments translate by more than their width at full load, where no hinge law is valid: \
                           reduce the load or the size of the target";
            at(beyond, message)
        },
    ),
    rule(
        "weak-weights",
        Warning,
        [
            "the weights are inaccurate",
            "a force is off by more than 10 % at the spot check, else at unseen rays",
            "`kirigami verify --equilibrium`, more rays",
        ],
        |of| {
            // Weights whose forces are off by more than a tenth at their spot check, or at unseen rays, some
            // of which leave the training domain, if they have none.
            let card = of.scene.weights()?.card();
            let (errors, states) = match &card.spot_check {
                Some(check) => (&check.errors, "random"),
                None => (&card.test_errors, "unseen"),
            };
            let forces = [("F_a", errors.f_a), ("F_s", errors.f_s), ("M_theta", errors.m_theta)];
            let forces = forces.map(|(name, error)| (100.0 * error.relative_rmse, name));
            let forces = forces.into_iter().filter(|(error, _)| *error > INACCURATE);
            let (error, name) = forces.largest_by(|(error, _)| *error)?;
            of.run.map(|_| {
                found(format!(
                    "the weights {} are inaccurate: {name} is off by {} % at {states} states; solve more rays, or check this design by \
                     `kirigami verify --equilibrium`",
                    of.weights_file(),
                    rounded(error, 3)
                ))
            })
        },
    ),
    rule(
        "spot-check-outside",
        Warning,
        [
            "the spot check is outside the domain",
            "its errors say little about the weights",
            "more rays",
        ],
        |of| {
            // Weights whose spot check mostly lies outside their training domain.
            let check = of.scene.weights()?.card().spot_check.as_ref()?;
            let (inside, states) = (check.inside, check.errors.rows);
            (of.run.is_some() && 2 * inside < states).then(|| {
                found(format!(
                    "only {inside} of {states} states of the spot check lie inside the training domain of the weights {}: its errors say little \
                     about them; solve more rays",
                    of.weights_file()
                ))
            })
        },
    ),
    rule(
        "other-branch",
        Note,
        [
            "a corrected path was on another branch",
            "designs found by it are not used",
            "none: the search went on",
        ],
        |of| {
            of.run?.designed.search.branch_mismatch().then(|| {
                found(
                    "during the search a corrected path was on another branch than the path followed from the flat sheet: the designs \
                     found by it are not used, and the search went on from the best design whose path was followed",
                )
            })
        },
    ),
];
