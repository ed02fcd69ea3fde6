//! The hinge law of a scene, loaded with the files it needs.

use crate::hinge_model::LinearConstants;
use crate::invalid_scene::{InvalidScene, WeightsMismatch};
use crate::keys::{SceneConfig, resolved};
use crate::level::Level;
use crate::scene_error::SceneError;
use crate::solved_hinges::SolvedHinges;
use design::equilibrium::tangent::MIN_PIVOT_RATIO;
use design::hinge_law::{
    Contact, DamageMeasure, HingeLaw, LinearLaw, MeanLaw, Order, SurrogateLaw,
};
use design::sheet::cut_sheet::HingePoint;
use design::sheet::topology::Topology;
use hinge::{HingeDeformation, Regime, SheetMaterial};
use std::f64::consts::FRAC_PI_2;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use surrogate::Surrogate;

/// Stiffness of the contact of panel edges relative to k_theta, and the void angle (rad) at which
/// the barrier becomes infinite; the text of (11) specifies neither. The window of a learned law
/// has no contact of its flanks: if its domain extends below the closed sheet, the barrier becomes
/// infinite at the end of the domain.
const CONTACT_STIFFNESS: f64 = 10.0;
const CONTACT_WALL: f64 = -0.1;
/// Angle (rad) of the secant stiffness of a learned hinge: 20 deg, as for the linear law of section
/// 3.
const TYPICAL_SECANT: f64 = 0.35;

/// What a scene loads for its hinges: all that differs from law to law.
#[derive(Clone)]
pub struct LoadedHinge {
    pub(super) behaviour: HingeBehaviour,
    /// The point at which the deformation is measured.
    pub(super) hinge_point: HingePoint,
    /// The networks that the law reads, its own first, then the networks of the ensemble.
    pub(super) networks: Vec<Surrogate>,
    /// The hinges by finite elements that the level `final` reads.
    pub(super) solved: Option<SolvedHinges>,
}

/// How hinges open.
#[derive(Clone)]
pub(super) enum HingeBehaviour {
    /// Pins open by the same angle, without forces.
    Pinned {
        /// The angle at the start (rad).
        opening: f64,
        /// Whether it is not a design variable.
        held: bool,
    },
    /// Forces follow from the energy of a law and from the contact of panel edges.
    Elastic { law: Arc<dyn HingeLaw>, contact: Contact },
}

/// A law without its numbers.
impl fmt::Debug for LoadedHinge {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("LoadedHinge").finish_non_exhaustive()
    }
}

impl LoadedHinge {
    /// Loads the law of a scene at `path`; `measured` is the material in the thickness of its file,
    /// `known` the networks if they were loaded for it before.
    pub(super) fn load(
        config: &SceneConfig,
        topology: &Topology,
        measured: &SheetMaterial,
        path: &Path,
        known: Option<&[Surrogate]>,
    ) -> Result<Self, SceneError> {
        let networks = match known {
            Some(known) => known.to_vec(),
            None => networks(config, measured, path)?,
        };
        let hinge = match config.level {
            Level::Pin => pinned(config),
            Level::Linear => linear(config, topology),
            Level::Draft | Level::Standard | Level::Fine => learned(config, networks, None),
            Level::Final => {
                let solved = SolvedHinges::load(config, topology, path);
                let solved = solved.map_err(SceneError::at(path))?;
                learned(config, networks, Some(solved))
            }
        };
        let hinge = hinge.map_err(SceneError::at(path))?;
        (hinge.check_objective(config)).map_err(SceneError::at(path))?;
        Ok(hinge)
    }

    /// Whether the hinges carry load, so that the deployed state is an equilibrium.
    pub fn carries_load(&self) -> bool {
        matches!(self.behaviour, HingeBehaviour::Elastic { .. })
    }

    /// The opening angle of pins at the start (rad), if it is a design variable.
    pub(super) fn free_opening(&self) -> Option<f64> {
        match self.behaviour {
            HingeBehaviour::Pinned { opening, held: false } => Some(opening),
            _ => None,
        }
    }

    /// The networks, its own first, if they predict energy and damage of the hinges in their
    /// states.
    pub(super) fn predictors(&self) -> &[Surrogate] {
        match &self.behaviour {
            HingeBehaviour::Elastic { law, .. } if law.domain().is_some() => &self.networks,
            _ => &[],
        }
    }

    /// An error if the objective needs a prediction that the law does not make.
    fn check_objective(&self, config: &SceneConfig) -> Result<(), InvalidScene> {
        let objective = &config.objective;
        if objective.domain > 0.0 && self.predictors().is_empty() {
            return Err(InvalidScene::NoDomain);
        }
        let predicts = |measure| match &self.behaviour {
            HingeBehaviour::Pinned { .. } => false,
            HingeBehaviour::Elastic { law, .. } => law.damage_scale(measure).is_some(),
        };
        if objective.damage == 0.0 || predicts(objective.damage_measure) {
            return Ok(());
        }
        Err(if predicts(DamageMeasure::Mean) {
            InvalidScene::NoPeakDamage
        } else {
            InvalidScene::NoDamage
        })
    }
}

/// The networks that the hinge law reads, at the thickness of the sheet.
fn networks(
    config: &SceneConfig,
    measured: &SheetMaterial,
    path: &Path,
) -> Result<Vec<Surrogate>, SceneError> {
    let load = |weights: PathBuf| {
        let file = resolved(path, &weights);
        if !file.is_file() {
            return Err(SceneError::at(path)(InvalidScene::NoWeights { file }));
        }
        network(config, measured, path, &file)
    };
    let networks: Vec<Surrogate> =
        (config.weights_files().into_iter().map(load)).collect::<Result<_, _>>()?;
    same_training(config, &networks).map_err(SceneError::at(path))?;
    Ok(networks)
}

/// Weights at the thickness of the sheet of the scene at `path`, or an error if they are not for
/// its hinges. `measured` is the material in the thickness of its file.
fn network(
    config: &SceneConfig,
    measured: &SheetMaterial,
    path: &Path,
    weights: &Path,
) -> Result<Surrogate, SceneError> {
    let surrogate = Surrogate::load(weights)?;
    fitted(config, measured, surrogate).map_err(|source| {
        let file = weights.to_owned();
        SceneError::at(path)(InvalidScene::OtherHinges { file, source })
    })
}

/// The learned law; the contact stiffness is relative to the secant stiffness of a hinge of the
/// start.
fn learned(
    config: &SceneConfig,
    networks: Vec<Surrogate>,
    solved: Option<SolvedHinges>,
) -> Result<LoadedHinge, InvalidScene> {
    let surrogate = networks.first();
    let surrogate = surrogate.ok_or(InvalidScene::NoSection("surrogate"))?;
    let [_, _, [closed, _]] = surrogate.domain().bounds();
    let wall = if closed < 0.0 { closed } else { CONTACT_WALL };
    let k_theta = springs_at_start(config, surrogate).k_theta;
    Ok(LoadedHinge {
        behaviour: HingeBehaviour::Elastic {
            law: law_of(config.level, &networks, solved.as_ref()),
            contact: contact(k_theta.abs().max(f64::MIN_POSITIVE), wall)?,
        },
        hinge_point: HingePoint::CutTip,
        networks,
        solved,
    })
}

/// The law of a learned level, of at least one network.
fn law_of(
    level: Level,
    networks: &[Surrogate],
    solved: Option<&SolvedHinges>,
) -> Arc<dyn HingeLaw> {
    let law = |surrogate: &Surrogate| -> Arc<dyn HingeLaw> {
        let surrogate = surrogate.clone();
        Arc::new(SurrogateLaw { surrogate })
    };
    match level {
        Level::Fine => Arc::new(MeanLaw { laws: networks.iter().map(law).collect() }),
        _ => {
            let own = law(&networks[0]);
            match solved {
                Some(solved) => Arc::new(solved.corrected(own)),
                None => own,
            }
        }
    }
}

/// The springs of a hinge with the start width and cuts at a right angle, turned by 20 degrees: the
/// secant of the rotation, the tangents of the translations.
pub(super) fn springs_at_start(config: &SceneConfig, surrogate: &Surrogate) -> LinearConstants {
    let prepared = surrogate.prepare(&[config.process.hinge(config.ligament.start, FRAC_PI_2)]);
    let turned = HingeDeformation::from([0.0, 0.0, TYPICAL_SECANT]);
    let [energy] = &surrogate.evaluate(&prepared, &[turned], Order::Tangent)[..] else {
        unreachable!("one state has one energy")
    };
    LinearConstants {
        k_a: energy.tangent[0][0],
        k_s: energy.tangent[1][1],
        k_theta: (1.0 / TYPICAL_SECANT) * energy.forces[2],
    }
}

/// The contact for hinges with the stiffness `k_theta`, which becomes infinite at the void angle
/// `wall` (rad).
fn contact(k_theta: f64, wall: f64) -> Result<Contact, InvalidScene> {
    Ok(Contact::new(CONTACT_STIFFNESS * k_theta, wall, 0.0)?)
}

/// The spread of networks trained on different data estimates the error of neither, and the spread
/// of one network is zero.
fn same_training(config: &SceneConfig, networks: &[Surrogate]) -> Result<(), InvalidScene> {
    let hashes: Vec<String> = networks.iter().map(Surrogate::hash).collect();
    let twice = (1..hashes.len()).find_map(|j| {
        let i = hashes[..j].iter().position(|hash| *hash == hashes[j])?;
        Some([i, j])
    });
    if let Some(twice) = twice {
        let files = config.weights_files();
        let files = twice.map(|i| files[i].clone());
        return Err(InvalidScene::SameNetwork { files });
    }
    let data = |network: &Surrogate| {
        let card = network.card();
        (card.dataset_hash.clone(), card.split_hash.clone())
    };
    if networks.windows(2).all(|pair| data(&pair[0]) == data(&pair[1])) {
        return Ok(());
    }
    Err(InvalidScene::OtherTraining)
}

fn pinned(config: &SceneConfig) -> Result<LoadedHinge, InvalidScene> {
    let pin = config.pin.ok_or(InvalidScene::NoSection("pin"))?;
    let held_or_loaded = !config.supports.is_empty() || config.has_loads();
    if held_or_loaded || config.drive.is_some() {
        return Err(InvalidScene::HeldPins);
    }
    Ok(LoadedHinge {
        behaviour: HingeBehaviour::Pinned { opening: pin.opening_deg.to_radians(), held: pin.held },
        hinge_point: HingePoint::Corner,
        networks: Vec::new(),
        solved: None,
    })
}

fn linear(config: &SceneConfig, topology: &Topology) -> Result<LoadedHinge, InvalidScene> {
    let constants = config.linear.ok_or(InvalidScene::NoSection("linear"))?;
    let LinearConstants { k_a, k_s, k_theta } = constants;
    let panel = config.sheet.mean_panel_area().abs();
    let ratio = k_theta / (k_a.max(k_s) * panel);
    if ratio < MIN_PIVOT_RATIO {
        return Err(InvalidScene::Soft { ratio });
    }
    Ok(LoadedHinge {
        behaviour: HingeBehaviour::Elastic {
            law: Arc::new(LinearLaw::uniform([k_a, k_s, k_theta], topology.hinge_count())),
            contact: contact(k_theta, CONTACT_WALL)?,
        },
        hinge_point: HingePoint::Corner,
        networks: Vec::new(),
        solved: None,
    })
}

/// Relative difference of r_win from the r_win of the weights that rounding in a scene file may
/// cause.
const ROUNDED: f64 = 1e-6;

/// The surrogate at the thickness of the scene's sheet. It is valid only for the material law and
/// for hinges similar to those it was trained with; the kerf of the cutter may differ.
fn fitted(
    config: &SceneConfig,
    material: &SheetMaterial,
    surrogate: Surrogate,
) -> Result<Surrogate, WeightsMismatch> {
    let (card, process) = (surrogate.card(), config.process);
    let law = material.law_hash();
    match &card.material_hash {
        Some(trained) if *trained == law => {}
        Some(trained_law) => {
            return Err(WeightsMismatch::Law {
                trained: card.material.clone(),
                trained_law: trained_law.clone(),
                file: material.name.clone(),
                law,
            });
        }
        None if card.material == material.name => {}
        None => {
            return Err(WeightsMismatch::Material {
                trained: card.material.clone(),
                file: material.name.clone(),
            });
        }
    }
    let scale = config.scale(material);
    let trained = card.domain.w_lig.map(|w_lig| w_lig / material.thickness);
    let range = (config.ligament.range).map(|w_lig| w_lig / scale / material.thickness);
    let regime = Regime::of(trained[1]);
    if range.into_iter().any(|width| Regime::of(width) != regime) {
        return Err(WeightsMismatch::Regime { trained, range });
    }
    let trained = surrogate.holes();
    let [narrowest, widest] = config.ligament.range;
    // The widest ligament has the smallest ratio of a hole of given diameter.
    let scene = [widest, narrowest].map(|w_lig| process.hinge(w_lig, FRAC_PI_2).fillet_ratio);
    if scene[0] < trained[0] || scene[1] > trained[1] {
        return Err(WeightsMismatch::Holes { trained, scene });
    }
    let (trained, scene) = (scale * card.hinge.r_win, process.r_win);
    if (scene / trained - 1.0).abs() > ROUNDED {
        return Err(WeightsMismatch::Window { trained, scene });
    }
    Ok(if scale == 1.0 { surrogate } else { surrogate.scaled(scale) })
}
