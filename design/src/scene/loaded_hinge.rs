//! The hinge law of a scene, loaded with the files it needs.

use crate::equilibrium::tangent::MIN_PIVOT_RATIO;
use crate::hinge_law::{CondensedLaw, Contact, DamageMeasure, LinearLaw, SurrogateLaw};
use crate::scene::checks::within;
use crate::scene::hinge_model::{HingeModel, LinearConstants, PinConfig, SurrogateFile};
use crate::scene::keys::SceneConfig;
use crate::scene::relative_path::beside;
use crate::scene::scene_error::SceneError;
use hinge::SheetMaterial;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use std::sync::Arc;
use surrogate::Surrogate;

/// Stiffness of the contact of panel edges relative to k_theta, and the void angle (rad) at which the barrier
/// becomes infinite; the text of (11) specifies neither. The window of a learned law has no contact of its
/// flanks: if its domain extends below the closed sheet, the barrier becomes infinite at the end of the domain.
const CONTACT_STIFFNESS: f64 = 10.0;
const CONTACT_WALL: f64 = -0.1;
/// Angle (rad) of the secant stiffness of a learned hinge: 20 deg, as for the linear law of section 3.
const TYPICAL_SECANT: f64 = 0.35;

/// A [`HingeModel`] with its constants or its weights.
#[derive(Clone, Debug)]
pub(super) enum LoadedHinge {
    /// The opening angle at the start (rad).
    Pin { opening: f64 },
    Linear {
        law: Arc<LinearLaw>,
        contact: Contact,
    },
    Condensed {
        law: Arc<CondensedLaw>,
        contact: Contact,
    },
    Surrogate {
        law: Arc<SurrogateLaw>,
        ensemble: Vec<Surrogate>,
        contact: Contact,
    },
}

impl LoadedHinge {
    /// Loads the law of a scene at `path`; `measured` is the material in the thickness of its file.
    pub(super) fn load(
        config: &SceneConfig,
        measured: &SheetMaterial,
        path: &Path,
    ) -> Result<Self, SceneError> {
        let refuse = |reason| SceneError::Value {
            path: path.to_owned(),
            reason,
        };
        let load = |section: &str, weights: &Path| {
            let weights = beside(path, weights);
            if !weights.is_file() {
                return Err(refuse(format!(
                    "{section}.weights: there is no file {}: train it, or give the constants of \
                     hinge = \"linear\"",
                    weights.display()
                )));
            }
            learned(config, measured, path, &weights)
        };
        let missing = |section: &str| {
            refuse(format!(
                "hinge = \"{section}\" needs the section [{section}]"
            ))
        };
        match config.hinge {
            HingeModel::Pin => {
                let pin = config.pin.ok_or_else(|| missing("pin"))?;
                pinned(config, pin).map_err(refuse)
            }
            HingeModel::Linear => match (config.linear, &config.condensed) {
                (Some(constants), None) => linear(config, constants).map_err(refuse),
                (None, Some(file)) => {
                    no_damage(config).map_err(refuse)?;
                    within(
                        "condensed.secant_deg",
                        file.secant_deg,
                        [-180.0, 180.0],
                        "deg",
                    )
                    .map_err(refuse)?;
                    let surrogate = load("condensed", &file.weights)?;
                    condensed(config, surrogate, file.secant_deg).map_err(refuse)
                }
                (None, None) => Err(missing("linear")),
                (Some(_), Some(_)) => {
                    let reason = "hinge = \"linear\" takes either [linear] or [condensed]";
                    Err(refuse(reason.into()))
                }
            },
            HingeModel::Surrogate => {
                let file = config.surrogate.as_ref();
                let SurrogateFile { weights, ensemble } =
                    file.ok_or_else(|| missing("surrogate"))?;
                let surrogate = load("surrogate", weights)?;
                let ensemble: Vec<Surrogate> = (ensemble.iter())
                    .map(|file| load("surrogate", file))
                    .collect::<Result<_, _>>()?;
                same_training(&surrogate, &ensemble).map_err(refuse)?;
                peak_known(config, &surrogate).map_err(refuse)?;
                learned_with_contact(config, surrogate, ensemble).map_err(refuse)
            }
        }
    }
}

/// Weights at the thickness of the sheet of the scene at `path`, or an error if they are not for its hinges. `measured`
/// is the material in the thickness of its file.
pub(super) fn learned(
    config: &SceneConfig,
    measured: &SheetMaterial,
    path: &Path,
    weights: &Path,
) -> Result<Surrogate, SceneError> {
    let surrogate = Surrogate::load(weights)?;
    fitted(config, measured, surrogate).map_err(|reason| SceneError::Value {
        path: path.to_owned(),
        reason: format!("the weights {} are for {reason}", weights.display()),
    })
}

/// The linear law of a learned energy; the contact has the same stiffness relative to the hinges of the start as
/// with given constants.
fn condensed(
    config: &SceneConfig,
    surrogate: Surrogate,
    secant_deg: f64,
) -> Result<LoadedHinge, String> {
    let law = CondensedLaw::new(surrogate, secant_deg.to_radians());
    let [k_a, k_s, k_theta] = constants_at_start(config, &law);
    if !(k_a > 0.0 && k_s > 0.0 && k_theta > 0.0) {
        return Err(format!(
            "condensed: at w_lig = {} mm the weights have k_a = {k_a} N/mm, k_s = {k_s} N/mm, \
             k_theta = {k_theta} N mm, which must all be positive: use hinge = \"surrogate\" or other weights",
            config.ligament.start
        ));
    }
    Ok(LoadedHinge::Condensed {
        law: Arc::new(law),
        contact: contact(config, k_theta, CONTACT_WALL)?,
    })
}

/// The learned law; the contact stiffness is relative to the secant stiffness of a hinge of the start.
fn learned_with_contact(
    config: &SceneConfig,
    surrogate: Surrogate,
    ensemble: Vec<Surrogate>,
) -> Result<LoadedHinge, String> {
    let [_, _, [closed, _]] = surrogate.domain().bounds();
    let wall = if closed < 0.0 { closed } else { CONTACT_WALL };
    let secant = CondensedLaw::new(surrogate.clone(), TYPICAL_SECANT);
    let [.., k_theta] = constants_at_start(config, &secant);
    Ok(LoadedHinge::Surrogate {
        law: Arc::new(SurrogateLaw::new(surrogate)),
        ensemble,
        contact: contact(config, k_theta.abs().max(f64::MIN_POSITIVE), wall)?,
    })
}

/// (k_a, k_s, k_theta) of a hinge with the start width and cuts at a right angle.
fn constants_at_start(config: &SceneConfig, law: &CondensedLaw) -> [f64; 3] {
    let typical = config.process.hinge(config.ligament.start, FRAC_PI_2);
    law.constants(&[typical])[0].map(|constant| constant.value)
}

/// The contact of a scene, or by default one for hinges with the stiffness `k_theta` that becomes infinite at the
/// void angle `wall` (rad).
fn contact(config: &SceneConfig, k_theta: f64, wall: f64) -> Result<Contact, String> {
    match config.contact {
        Some(contact) => contact.contact(),
        None => {
            Contact::new(CONTACT_STIFFNESS * k_theta, wall, 0.0).map_err(|error| error.to_string())
        }
    }
}

/// The spread of networks trained on different data estimates the error of neither.
fn same_training(surrogate: &Surrogate, ensemble: &[Surrogate]) -> Result<(), String> {
    let data = |it: &Surrogate| (it.card().dataset_hash.clone(), it.card().split_hash.clone());
    match ensemble.iter().all(|other| data(other) == data(surrogate)) {
        true => Ok(()),
        false => Err(
            "surrogate.ensemble: all networks must be trained on the data of surrogate.weights"
                .into(),
        ),
    }
}

/// An objective on D_peak needs weights that predict it.
fn peak_known(config: &SceneConfig, surrogate: &Surrogate) -> Result<(), String> {
    let objective = &config.objective;
    let needed = objective.damage > 0.0 && objective.damage_measure == DamageMeasure::Peak;
    if needed && surrogate.card().peak_scale.is_none() {
        return Err(
            "objective.damage_measure = \"peak\": the weights do not predict D_peak: use \"mean\", or train \
             on a database that contains it"
                .into(),
        );
    }
    Ok(())
}

/// Only the learned law predicts damage.
fn no_damage(config: &SceneConfig) -> Result<(), String> {
    if config.objective.damage == 0.0 {
        return Ok(());
    }
    Err(
        "objective.damage: only the learned hinge law predicts damage: use \
         hinge = \"surrogate\" or damage = 0"
            .into(),
    )
}

fn pinned(config: &SceneConfig, pin: PinConfig) -> Result<LoadedHinge, String> {
    no_damage(config)?;
    within("pin.opening_deg", pin.opening_deg, [-180.0, 180.0], "deg")?;
    let held_or_loaded = !config.supports.is_empty()
        || !config.loads.is_empty()
        || !config.edge_loads.is_empty()
        || !config.opening_couples.is_empty();
    if held_or_loaded || config.drive.is_some() || config.contact.is_some() {
        return Err(
            "supports, loads, edge_loads, opening_couples, drive, contact: hinge = \"pin\" has no equilibrium: \
             remove these sections, or use hinge = \"linear\""
                .into(),
        );
    }
    let opening = pin.opening_deg.to_radians();
    Ok(LoadedHinge::Pin { opening })
}

fn linear(config: &SceneConfig, constants: LinearConstants) -> Result<LoadedHinge, String> {
    no_damage(config)?;
    let LinearConstants { k_a, k_s, k_theta } = constants;
    within("linear.k_a", k_a, [1e-3, 1e6], "N/mm")?;
    within("linear.k_s", k_s, [1e-3, 1e6], "N/mm")?;
    within("linear.k_theta", k_theta, [1e-3, 1e9], "N mm/rad")?;
    let grid = config.sheet.grid();
    let panel = config.sheet.outline().area().abs() / grid.panel_count() as f64;
    let ratio = k_theta / (k_a.max(k_s) * panel);
    if ratio < MIN_PIVOT_RATIO {
        return Err(format!(
            "linear.k_theta is {ratio:.0e} times the greater of linear.k_a and linear.k_s times the area of a panel: below \
             {MIN_PIVOT_RATIO:.0e} rotations are lost in the rounding of the translations. Raise k_theta, or lower k_a \
             and k_s"
        ));
    }
    let law = LinearLaw::uniform([k_a, k_s, k_theta], grid.hinge_count())
        .map_err(|error| error.to_string())?;
    let contact = contact(config, k_theta, CONTACT_WALL)?;
    Ok(LoadedHinge::Linear {
        law: Arc::new(law),
        contact,
    })
}

/// Relative difference of r_win from that of the weights that rounding in a scene file may cause.
const ROUNDED: f64 = 1e-6;

/// The surrogate at the thickness of the scene's sheet. It is valid only for the material law and for hinges similar
/// to those it was trained with; the kerf of the cutter may differ.
fn fitted(
    config: &SceneConfig,
    material: &SheetMaterial,
    surrogate: Surrogate,
) -> Result<Surrogate, String> {
    let (card, process) = (surrogate.card(), config.process);
    let law = material.law_hash();
    match &card.material_hash {
        Some(trained) if *trained == law => {}
        Some(trained) => {
            return Err(format!(
                "another material law than that of the scene: `{}` ({trained}, that of the file `{}` is {law}). Name the \
                 material file of the training, with its thickness; the key `thickness` of the scene gives that of \
                 the sheet. If its numbers have changed, train again",
                card.material, material.name
            ));
        }
        None if card.material == material.name => {}
        None => {
            return Err(format!(
                "the material `{}`, the scene's is `{}`",
                card.material, material.name
            ));
        }
    }
    let scale = config.scale(material);
    if card.hinge.fillet_ratio != process.fillet_ratio {
        return Err(format!(
            "fillet_ratio = {}, but the scene has process.fillet_ratio = {}",
            card.hinge.fillet_ratio, process.fillet_ratio
        ));
    }
    let r_win = scale * card.hinge.r_win;
    if (process.r_win / r_win - 1.0).abs() > ROUNDED {
        return Err(format!(
            "windows of r_win = {r_win} mm in a sheet of this thickness, but the scene has process.r_win = {}",
            process.r_win
        ));
    }
    Ok(match scale == 1.0 {
        true => surrogate,
        false => surrogate.scaled(scale),
    })
}
