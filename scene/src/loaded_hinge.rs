//! The hinge law of a scene, loaded with the files it needs.

use crate::{
    checks::no_section,
    hinge_model::LinearConstants,
    keys::{SceneConfig, resolved},
    level::Level,
    solved_hinges::SolvedHinges,
};
use design::{
    equilibrium::tangent::MIN_PIVOT_RATIO,
    hinge_law::{Contact, DamageMeasure, HingeLaw, LinearLaw, MeanLaw, Order, SurrogateLaw},
    sheet::{cut_sheet::HingePoint, topology::Topology},
};
use hinge::{HingeDeformation, Regime, SheetMaterial};
use std::{f64::consts::FRAC_PI_2, fmt, path::Path, sync::Arc};
use support::{Fault, at, ensure, refuse};
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
    ) -> Result<Self, Fault> {
        let networks = match known {
            Some(known) => known.to_vec(),
            None => networks(config, measured, path)?,
        };
        let hinge = match config.level {
            Level::Pin => pinned(config),
            Level::Linear => linear(config, topology),
            Level::Final => SolvedHinges::load(config, topology, path)
                .and_then(|solved| learned(config, networks, Some(solved))),
            _ => learned(config, networks, None),
        };
        let checked = hinge.and_then(|hinge| hinge.check_objective(config).map(|()| hinge));
        checked.map_err(at(path.display()))
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
    fn check_objective(&self, config: &SceneConfig) -> Result<(), Fault> {
        let objective = &config.objective;
        ensure!(
            objective.domain <= 0.0 || !self.predictors().is_empty(),
            "objective.domain needs level = \"standard\": no other law has a domain"
        );
        let predicts = |measure| match &self.behaviour {
            HingeBehaviour::Pinned { .. } => false,
            HingeBehaviour::Elastic { law, .. } => law.damage_scale(measure).is_some(),
        };
        if objective.damage == 0.0 || predicts(objective.damage_measure) {
            return Ok(());
        }
        refuse!(
            "{}",
            if predicts(DamageMeasure::Mean) {
                "objective.damage_measure = \"peak\": the weights do not predict D_peak: use \"mean\", or train on a database \
                 that contains it"
            } else {
                "objective.damage: only the learned hinge law predicts damage: use level = \"standard\" or damage = 0"
            }
        )
    }
}

/// The networks that the hinge law reads, at the thickness of the sheet.
fn networks(
    config: &SceneConfig,
    measured: &SheetMaterial,
    path: &Path,
) -> Result<Vec<Surrogate>, Fault> {
    let scene = path.display();
    let mut networks = Vec::new();
    for weights in config.weights_files() {
        let file = resolved(path, &weights);
        let weights = file.display();
        ensure!(
            file.is_file(),
            "{scene}: surrogate.weights: there is no file {weights}: train it, or give the constants of level = \"linear\""
        );
        let surrogate = Surrogate::load(&file)?;
        let place = format!("{scene}: the weights {weights} are for ");
        let fitted = fitted(config, measured, surrogate);
        networks.push(fitted.map_err(|mismatch| place + &mismatch.to_string())?);
    }
    same_training(config, &networks).map_err(at(scene))?;
    Ok(networks)
}

/// The learned law; the contact stiffness is relative to the secant stiffness of a hinge of the
/// start.
fn learned(
    config: &SceneConfig,
    networks: Vec<Surrogate>,
    solved: Option<SolvedHinges>,
) -> Result<LoadedHinge, Fault> {
    let surrogate = networks.first().ok_or_else(|| no_section("surrogate"))?;
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
fn contact(k_theta: f64, wall: f64) -> Result<Contact, Fault> {
    Contact::new(CONTACT_STIFFNESS * k_theta, wall, 0.0)
}

/// The spread of networks trained on different data estimates the error of neither, and the spread
/// of one network is zero.
fn same_training(config: &SceneConfig, networks: &[Surrogate]) -> Result<(), Fault> {
    let hashes: Vec<String> = networks.iter().map(Surrogate::hash).collect();
    let twice = (1..hashes.len()).find_map(|j| {
        let i = hashes[..j].iter().position(|hash| *hash == hashes[j])?;
        Some([i, j])
    });
    if let Some(twice) = twice {
        let files = config.weights_files();
        let [one, other] = twice.map(|i| files[i].display());
        refuse!(
            "surrogate.ensemble: {one} and {other} are the same network, whose spread is zero: name networks of other seeds"
        );
    }
    let data = |network: &Surrogate| {
        let card = network.card();
        (card.dataset_hash.clone(), card.split_hash.clone())
    };
    ensure!(
        networks.windows(2).all(|pair| data(&pair[0]) == data(&pair[1])),
        "surrogate.ensemble: all networks must be trained on the data of surrogate.weights"
    );
    Ok(())
}

fn pinned(config: &SceneConfig) -> Result<LoadedHinge, Fault> {
    let pin = config.pin.ok_or_else(|| no_section("pin"))?;
    ensure!(
        config.supports.is_empty() && !config.has_loads() && config.drive.is_none(),
        "supports, loads, edge_loads, opening_couples, drive: level = \"pin\" has no equilibrium: remove these \
         sections, or use level = \"linear\""
    );
    Ok(LoadedHinge {
        behaviour: HingeBehaviour::Pinned { opening: pin.opening_deg.to_radians(), held: pin.held },
        hinge_point: HingePoint::Corner,
        networks: Vec::new(),
        solved: None,
    })
}

fn linear(config: &SceneConfig, topology: &Topology) -> Result<LoadedHinge, Fault> {
    let constants = config.linear.ok_or_else(|| no_section("linear"))?;
    let LinearConstants { k_a, k_s, k_theta } = constants;
    let panel = config.sheet.mean_panel_area().abs();
    let ratio = k_theta / (k_a.max(k_s) * panel);
    ensure!(
        ratio >= MIN_PIVOT_RATIO,
        "linear.k_theta is {ratio:.0e} times the greater of linear.k_a and linear.k_s times the area of a panel: below \
         {MIN_PIVOT_RATIO:.0e} rotations are lost in the rounding of the translations. Raise k_theta, or lower k_a and k_s"
    );
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
/// for hinges similar to those it was trained with; the kerf of the cutter may differ. An error says
/// what the weights are for.
fn fitted(
    config: &SceneConfig,
    material: &SheetMaterial,
    surrogate: Surrogate,
) -> Result<Surrogate, Fault> {
    let (card, process) = (surrogate.card(), config.process);
    let (law, named, file) = (material.law_hash(), &card.material, &material.name);
    match &card.material_hash {
        Some(trained) => ensure!(
            *trained == law,
            "another material law than the scene: `{named}` ({trained}; the file `{file}` has {law}). Name \
             the material file of the training, with its thickness; the key `thickness` of the scene gives the sheet another. \
             If its numbers have changed, train again"
        ),
        None => ensure!(named == file, "the material `{named}`, the scene's is `{file}`"),
    }
    let scale = config.scale(material);
    let trained = card.domain.w_lig.map(|w_lig| w_lig / material.thickness);
    let range = (config.ligament.range).map(|w_lig| w_lig / scale / material.thickness);
    let regime = Regime::of(trained[1]);
    ensure!(
        range.into_iter().all(|width| Regime::of(width) == regime),
        "ligaments of {:.2} to {:.2} thicknesses, but ligament.range of the scene is {:.2} to {:.2} thicknesses of its sheet: \
         ligaments no wider than the sheet is thick bend in its plane, wider ones buckle, and no law holds for both. \
         Change ligament.range or the weights",
        trained[0],
        trained[1],
        range[0],
        range[1]
    );
    let trained = surrogate.holes();
    let [narrowest, widest] = config.ligament.range;
    // The widest ligament has the smallest ratio of a hole of given diameter.
    let scene = [widest, narrowest].map(|w_lig| process.hinge(w_lig, FRAC_PI_2).fillet_ratio);
    ensure!(
        scene[0] >= trained[0] && scene[1] <= trained[1],
        "holes with a radius of {} w_lig, but the scene has {}: change `fillet_ratio` or `hole_diameter` in [process], \
         or name weights for such holes",
        ratios(trained),
        ratios(scene)
    );
    let (trained, scene) = (scale * card.hinge.r_win, process.r_win);
    ensure!(
        (scene / trained - 1.0).abs() <= ROUNDED,
        "windows of r_win = {trained} mm in a sheet of this thickness, but the scene has process.r_win = {scene}"
    );
    Ok(if scale == 1.0 { surrogate } else { surrogate.scaled(scale) })
}

/// One radius of holes over w_lig, or the range of several.
fn ratios([least, most]: [f64; 2]) -> String {
    if least == most { format!("{least}") } else { format!("{least:.3} to {most:.3}") }
}
