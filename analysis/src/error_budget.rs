//! The error budget of a deployed sheet: by how much each cause of errors moves its panel corners
//! and changes its load.
//!
//! To first order an error of the hinge forces moves the sheet by [`ForceResponse`].
//! A cause gives the standard deviations of these forces ([`ForceErrors`]), from what was measured:
//!
//! | cause | force errors | of the hinges | measured |
//! |---|---|---|---|
//! | network | deviations of the ensemble at the states of the sheet | as the networks have them | the ensemble of the scene |
//! | window mesh | errors of the weights relative to a finer mesh, over the force | alike in like states | spot check on the card |
//! | material law | in proportion to the force | common | the material file |
//! | imperfection | in proportion to the force | independent | docs/results/window, docs/results/plates |
//! | loading path | in proportion to the force and the separation from the ray | independent | docs/TRIED.md |
//! | kerf | of a ligament that is narrower and of a hole that is wider, each by half of its tolerance | common | the scene |
//! | thickness | by similarity, of its tolerance | common | the scene |
//! | tilt | none: heights of the corners, by the bumps of ligaments | | docs/results/flatness |
//!
//! Finite elements of all hinges of the sheet replace the first two and the loading path. What they
//! leave is the movement of the panels in their last round.
//!
//! What is not measured is not known: the sum of the others is a lower bound.

use crate::actuation_curve::ActuationCurve;
use crate::force_errors::{Deviations, ForceErrors};
use crate::out_of_plane::out_of_plane;
use crate::path_separation::path_separation;
use design::equilibrium::force_response::ForceResponse;
use design::hinge_law::{HingeEnergy, Order};
use design::objective::design_problem::{Deployment, DesignProblem};
use design::objective::response::by_thickness;
use hinge::{HingeDesign, Regime};
use scene::{Posture, Scene};
use serde::{Deserialize, Serialize};
use strum::VariantArray;
use support::statistics::rms_and_maximum;
use surrogate::{SpotCheck, Surrogate};

/// Ligament width over thickness, and the relative change of M_theta in a pure rotation if the
/// imperfection has two thicknesses instead of one: the larger of two cut angles
/// (docs/results/window, polyester film of 0.5 mm).
const FILM_IMPERFECTION: [[f64; 2]; 3] = [[10.0, 0.0970], [36.0, 0.0247], [50.0, 0.0161]];
/// The same if it has 0.1 instead of 0.02 thicknesses (docs/results/window, polypropylene plate of
/// 3 mm).
const PLATE_IMPERFECTION: [[f64; 2]; 3] = [[1.0 / 3.0, 0.0127], [2.0 / 3.0, 0.0081], [1.0, 0.0075]];
/// The fraction by which the forces differ at a separation of the path from its ray of one ligament
/// width; they do in proportion to it. Film: the law through all detours (docs/TRIED.md, polyester
/// film of 0.5 mm). Plate, and a law of bent rays: root mean square over fourteen paths in plates
/// (docs/results/plates, polypropylene of 3 mm).
const DETOUR_OF_FILM: f64 = 0.05 / 0.17;
const DETOUR_OF_PLATE: f64 = 6.2;
const DETOUR_OF_BENT_RAYS: f64 = 3.6;
/// The largest fraction that was found in plates, and with bent rays.
const MOST_DETOUR_OF_PLATE: f64 = 0.63;
const MOST_DETOUR_OF_BENT_RAYS: f64 = 0.4;
/// Yield strain of that film. The forces of a material that yields at a smaller one depend more on
/// the path: the forces of steel, at a thirteenth of it, by some fifty times (docs/results/metals).
/// Materials below half of it are not covered.
const DETOUR_YIELD: f64 = 0.0146;
/// Number of hinges above which no budget is made: it takes three solves a hinge and more.
const MOST_HINGES: usize = 2000;

/// A cause of errors of a deployed sheet, in the order of a budget.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    Serialize,
    Deserialize,
    strum::IntoStaticStr,
    strum::VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "lowercase")]
pub enum Cause {
    /// Spread of the networks of the ensemble.
    Network,
    /// Errors of the weights relative to a finer mesh of the windows.
    #[strum(serialize = "window mesh")]
    WindowMesh,
    /// The stress at equal strain.
    #[strum(serialize = "material law")]
    MaterialLaw,
    /// The imperfection from which the ligament buckles.
    Imperfection,
    /// The energy of a hinge as a function of its state alone.
    #[strum(serialize = "loading path")]
    LoadingPath,
    /// The width that the cutter removes.
    Kerf,
    /// The thickness of the sheet.
    Thickness,
    /// Panels that tilt, which are in the plane in the model.
    Tilt,
    /// What is left if the sheet was balanced with finite elements for its hinges.
    Balance,
}

/// One cause of errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contribution {
    /// What causes the errors.
    pub cause: Cause,
    /// Where their size is from or, if that is not known, why.
    pub source: String,
    /// `None` if it is not known.
    pub effect: Option<Effect>,
}

/// Standard deviations of a deployed sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// Of the panel corners (mm): root mean square and maximum.
    pub corners: [f64; 2],
    /// Of the load that the prescribed displacement takes, relative to it; `None` under dead loads.
    pub load: Option<f64>,
    /// Whether it is a lower bound: a sum of which a part is not known.
    pub at_least: bool,
    /// Of every panel corner, SW, SE, NE and NW of every panel (mm).
    #[serde(skip)]
    pub by_corner: Vec<f64>,
}

/// The error budget of a deployed sheet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorBudget {
    /// All causes.
    pub contributions: Vec<Contribution>,
    /// The root of the sum of the squares of those that are known.
    pub total: Effect,
}

/// Force errors with their source, or why they are not known.
type Known = Result<(ForceErrors, String), String>;

/// A deployed sheet at full load.
struct Deployed<'a> {
    scene: &'a Scene,
    deployment: &'a Deployment,
    designs: Vec<HingeDesign>,
    /// Of the hinge law, without contact.
    energies: Vec<HingeEnergy>,
}

impl Cause {
    /// Its name.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Whether finite elements of the hinges of a sheet see its errors: they have the imperfection,
    /// the material, the kerf and the thickness of the scene.
    pub fn is_seen_by_elements(self) -> bool {
        matches!(self, Self::Network | Self::WindowMesh | Self::LoadingPath)
    }
}

impl ErrorBudget {
    /// The budget of a deployed design of a scene with a learned hinge law; `None` for another law,
    /// if full load is not reached, if the tangent there is singular, or for more than 2000 hinges.
    /// `residual` is the largest movement of a panel corner in the last balance with finite
    /// elements (mm), if the design was balanced with them.
    pub fn new(
        scene: &Scene,
        problem: &DesignProblem,
        deployment: &Deployment,
        residual: Option<f64>,
    ) -> Option<Self> {
        scene.surrogate()?;
        let mechanics = problem.model.mechanics()?;
        let last = deployment.at_full_load().ok()?;
        let sheet = &deployment.sheet;
        if sheet.hinges.len() > MOST_HINGES {
            return None;
        }
        let designs = sheet.designs();
        let law = mechanics.law.prepare(&designs);
        let response =
            ForceResponse::new(&mechanics.solver, mechanics.hinged(sheet, &*law, false), last)?;
        let deployed = Deployed {
            scene,
            deployment,
            energies: law.energies(&last.deformations, Order::Design),
            designs,
        };
        let [_, load] = *ActuationCurve::new(mechanics, deployment)?.points.last()?;
        let mut budget =
            Self { contributions: Vec::new(), total: Effect::none(sheet.panels.len()) };
        let replaced = |cause: &Cause| residual.is_some() && cause.is_seen_by_elements();
        for &cause in Cause::VARIANTS.iter().filter(|cause| !replaced(cause)) {
            let Some(known) = deployed.errors(cause) else {
                continue;
            };
            let (source, effect) = match known {
                Ok((errors, source)) => {
                    let deviations = errors.deviations(&response, sheet, last)?;
                    (source, Some(Effect::new(deviations, load)))
                }
                Err(reason) => (reason, None),
            };
            budget.contributions.push(Contribution { cause, source, effect });
        }
        if let Some(heights) = heights(scene, problem, deployment) {
            let (source, effect) = match heights {
                Ok(corners) => {
                    let deviations = Deviations { corners, load: None };
                    let source = format!(
                        "heights of the corners, if all ligaments have a bump of {} thicknesses on the same side (docs/results/flatness)",
                        Regime::Plate.bump()
                    );
                    (source, Some(Effect::new(deviations, load)))
                }
                Err(reason) => (reason.to_owned(), None),
            };
            budget.contributions.push(Contribution { cause: Cause::Tilt, source, effect });
        }
        if let Some(residual) = residual {
            let deviations =
                Deviations { corners: vec![residual; 4 * sheet.panels.len()], load: None };
            budget.contributions.push(Contribution {
                cause: Cause::Balance,
                source: "largest movement in the last balance with finite elements of every hinge, which replace networks, mesh and path".into(),
                effect: Some(Effect::new(deviations, load)),
            });
        }
        budget.total = budget.sum(|_| true);
        Some(budget)
    }

    /// The root of the sum of the squares of the contributions whose causes `count`; a lower bound
    /// if one is not known.
    pub fn sum(&self, count: impl Fn(Cause) -> bool) -> Effect {
        let counted = || self.contributions.iter().filter(|part| count(part.cause));
        let effects = counted().filter_map(|part| part.effect.as_ref());
        let none = Effect::none(self.total.by_corner.len() / 4);
        Effect {
            at_least: counted().any(|part| part.effect.is_none()),
            ..effects.fold(none, |sum, effect| sum.with(effect))
        }
    }
}

/// How far the corners of a deployed sheet are from the plane (mm), or why that is not known;
/// `None` if the panels are held flat.
fn heights(
    scene: &Scene,
    problem: &DesignProblem,
    deployment: &Deployment,
) -> Option<Result<Vec<f64>, &'static str>> {
    let Some(posture) = scene.config.posture else {
        return Some(Err("the scene has no posture"));
    };
    if posture.kind == Posture::HeldFlat {
        return None;
    }
    let Some(path) = out_of_plane(scene, problem, deployment) else {
        return Some(Err(
            "panels of a film, and of a plate that no clip or clamp holds, leave the plane (docs/results/flatness)",
        ));
    };
    let configuration = &deployment.final_step().configuration;
    let heights = path.last()?.heights(&deployment.sheet, configuration);
    let heights = heights.ok_or("the panels leave the plane (docs/results/flatness)");
    Some(heights.map(|heights| heights.into_iter().map(f64::abs).collect()))
}

impl Effect {
    fn none(panels: usize) -> Self {
        Self { corners: [0.0; 2], load: None, at_least: false, by_corner: vec![0.0; 4 * panels] }
    }

    fn new(deviations: Deviations, load: f64) -> Self {
        Self {
            corners: rms_and_maximum(deviations.corners.iter().copied()),
            load: deviations.load.map(|deviation| deviation / load.abs()),
            at_least: false,
            by_corner: deviations.corners,
        }
    }

    /// The root of the sum of the squares of both, which are known.
    fn with(&self, other: &Self) -> Self {
        let corners = std::iter::zip(&self.by_corner, &other.by_corner);
        let by_corner: Vec<f64> = corners.map(|(one, other)| one.hypot(*other)).collect();
        let loads = [self.load, other.load].into_iter().flatten();
        Self {
            corners: rms_and_maximum(by_corner.iter().copied()),
            load: loads.reduce(f64::hypot),
            at_least: false,
            by_corner,
        }
    }
}

impl Deployed<'_> {
    /// `None` for a cause that there is not by the law alone.
    fn errors(&self, cause: Cause) -> Option<Known> {
        Some(match cause {
            Cause::Network => return self.networks(),
            Cause::WindowMesh => self.window_mesh(),
            Cause::MaterialLaw => self.material_law(),
            Cause::Imperfection => self.imperfection(),
            Cause::LoadingPath => self.loading_path(),
            Cause::Kerf => self.kerf(),
            Cause::Thickness => self.thickness(),
            Cause::Tilt | Cause::Balance => return None,
        })
    }

    /// (F_a, F_s, M_theta) of every hinge by the hinge law.
    fn forces(&self) -> Vec<[f64; 3]> {
        self.energies.iter().map(|energy| energy.forces).collect()
    }

    /// Norm of (F_a, F_s, M_theta / w_lig) of every hinge (N).
    fn norms(&self) -> Vec<f64> {
        let hinges = self.energies.iter().zip(&self.designs);
        let norm = |(energy, design): (&HingeEnergy, &HingeDesign)| {
            let [f_a, f_s, m_theta] = energy.forces;
            f_a.hypot(f_s).hypot(m_theta / design.w_lig)
        };
        hinges.map(norm).collect()
    }

    /// The spot check of the weights, if its mesh and the errors of its forces are known; an error
    /// outside the training domain, where no check was made.
    fn spot_check(&self) -> Result<(&SpotCheck, &str, [f64; 3]), String> {
        if self.deployment.final_step().inside.contains(&false) {
            return Err("hinges are outside the training domain".into());
        }
        let check = self.scene.surrogate().and_then(|weights| weights.card().spot_check.as_ref());
        let check = check.ok_or("no spot check on the card: `surrogate test --record`")?;
        let known = check.tier.as_deref().zip(check.forces);
        let (tier, forces) = known.ok_or(
            "the spot check on the card is without mesh or forces: `surrogate test --record`",
        )?;
        Ok((check, tier, forces))
    }

    /// The errors of the weights at their spot check, with the source.
    fn checked(&self) -> Known {
        let (check, tier, forces) = self.spot_check()?;
        let sizes: Vec<[f64; 3]> =
            (self.norms().into_iter()).map(|norm| forces.map(|error| error * norm)).collect();
        let states = &self.deployment.final_step().deformations;
        let [f_a, s, m] = forces.map(|error| 100.0 * error);
        let source =
            format!("{f_a:.1}, {s:.1}, {m:.1} % of the force, {} states on `{tier}`", check.inside);
        Ok((ForceErrors::alike(&sizes, &self.designs, states), source))
    }

    /// Whether the states of the spot check have another mesh than the training rays, so that its
    /// errors contain the error of the mesh.
    fn is_checked_on_finer_mesh(&self) -> bool {
        let trained = self.scene.surrogate().map(|weights| &weights.card().tier);
        let checked = self.spot_check().ok().map(|(_, tier, _)| tier);
        checked.is_some_and(|checked| trained.is_some_and(|trained| trained != checked))
    }

    /// `None` if only the spot check knows it, on a finer mesh: it is a part of that row.
    fn networks(&self) -> Option<Known> {
        let (mut modes, mut sources) = (Vec::new(), Vec::new());
        let networks = self.scene.networks();
        if networks.len() > 1 {
            let states = &self.deployment.final_step().deformations;
            let forces = networks.iter().map(|network| {
                let energies =
                    network.evaluate(&network.prepare(&self.designs), states, Order::Forces);
                energies.iter().map(|energy| energy.forces).collect()
            });
            modes = ForceErrors::spread(&forces.collect::<Vec<_>>()).modes;
            sources.push(format!("spread of {} networks in these states", networks.len()));
        }
        let on_finer_mesh = self.is_checked_on_finer_mesh();
        if !on_finer_mesh && let Ok((errors, source)) = self.checked() {
            modes.extend(errors.modes);
            sources.push(source);
        }
        if sources.is_empty() {
            let unknown = self.spot_check().err();
            return unknown.map(|why| Err(format!("no ensemble; {why}")));
        }
        Some(Ok((ForceErrors { modes }, sources.join("; "))))
    }

    fn window_mesh(&self) -> Known {
        let (_, tier, _) = self.spot_check()?;
        if self.is_checked_on_finer_mesh() {
            self.checked()
        } else {
            Err(format!("the weights were not checked on a finer mesh than `{tier}`"))
        }
    }

    fn material_law(&self) -> Known {
        let material = &self.scene.material;
        let deviation = material
            .stress_deviation
            .ok_or_else(|| format!("{} has no stress_deviation", material.name))?;
        let forces: Vec<[f64; 3]> = (self.forces().into_iter())
            .map(|forces| forces.map(|force| deviation * force))
            .collect();
        let source = format!("stress {:.1} %, material file", 100.0 * deviation);
        Ok((ForceErrors::common(&forces), source))
    }

    fn imperfection(&self) -> Known {
        let thickness = self.scene.material.thickness;
        let mut forces = self.forces();
        let mut largest = (0.0_f64, "");
        for (force, design) in forces.iter_mut().zip(&self.designs) {
            let ratio = design.w_lig / thickness;
            let (table, page) = match Regime::of(ratio) {
                Regime::Film => (&FILM_IMPERFECTION, "docs/results/window"),
                Regime::Plate => (&PLATE_IMPERFECTION, "docs/results/plates"),
            };
            let change = interpolated(table, ratio)
                .ok_or_else(|| format!("not measured for ligaments of {ratio:.1} thicknesses"))?;
            *force = force.map(|force| change * force);
            if change > largest.0 {
                largest = (change, page);
            }
        }
        let (change, page) = largest;
        let percent = 100.0 * change;
        let source = format!("up to {percent:.1} % of the force of a hinge ({page})");
        Ok((ForceErrors::along(&forces), source))
    }

    fn loading_path(&self) -> Known {
        let material = &self.scene.material;
        let thickness = material.thickness;
        let yields_at = material.plastic[0][0] / material.young;
        if yields_at < 0.5 * DETOUR_YIELD {
            return Err(format!(
                "measured for the polyester film; this material yields at {:.2} % (docs/results/metals)",
                100.0 * yields_at
            ));
        }
        let path = &self.deployment.path;
        let curvature = self.scene.surrogate().map_or(0.0, Surrogate::ray_curvature);
        let mut sizes = self.norms();
        let mut largest = 0.0_f64;
        for (h, (size, design)) in sizes.iter_mut().zip(&self.designs).enumerate() {
            let states: Vec<_> = path.iter().map(|step| step.deformations[h]).collect();
            let regime = Regime::of(design.w_lig / thickness);
            let separation = path_separation(design.w_lig, curvature, &states);
            *size *= match regime {
                Regime::Film => DETOUR_OF_FILM * separation,
                Regime::Plate if curvature > 0.0 => {
                    f64::min(DETOUR_OF_BENT_RAYS * separation, MOST_DETOUR_OF_BENT_RAYS)
                }
                Regime::Plate => f64::min(DETOUR_OF_PLATE * separation, MOST_DETOUR_OF_PLATE),
            };
            largest = largest.max(separation);
        }
        let source =
            format!("up to {largest:.3} w_lig from the ray (docs/TRIED.md, docs/results/plates)");
        Ok((ForceErrors::isotropic(&sizes, &self.designs), source))
    }

    fn kerf(&self) -> Known {
        let tolerance = self.scene.config.tolerances.kerf;
        let tolerance = tolerance.ok_or("no tolerances.kerf in the scene")?;
        let narrower = -0.5 * (0.5 * tolerance);
        let errors: Vec<[f64; 3]> = (self.energies.iter())
            .zip(&self.designs)
            .map(|(energy, design)| {
                let by_hole = (1.0 + design.fillet_ratio) / design.w_lig;
                (energy.mixed).map(|by| narrower * (by.w_lig - by_hole * by.hole))
            })
            .collect();
        let source = format!("+- {tolerance} mm, two standard deviations");
        Ok((ForceErrors::common(&errors), source))
    }

    fn thickness(&self) -> Known {
        let tolerance = self.scene.config.tolerances.thickness;
        let tolerance = tolerance.ok_or("no tolerances.thickness in the scene")?;
        let relative = (0.5 * tolerance) / self.scene.material.thickness;
        let states = &self.deployment.final_step().deformations;
        let hinges = self.energies.iter().zip(&self.designs).zip(states);
        let errors: Vec<[f64; 3]> = hinges
            .map(|((energy, design), state)| {
                by_thickness(energy, state, design.w_lig).map(|change| relative * change)
            })
            .collect();
        let source = format!("+- {tolerance} mm, two standard deviations");
        Ok((ForceErrors::common(&errors), source))
    }
}

/// Between the points [x, y] of a table, linear in the logarithms; `None` outside.
pub(crate) fn interpolated(table: &[[f64; 2]], x: f64) -> Option<f64> {
    let pair = table.windows(2).find(|pair| (pair[0][0]..=pair[1][0]).contains(&x))?;
    let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
    let part = (x / x0).ln() / (x1 / x0).ln();
    Some(y0 * (y1 / y0).powf(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_met_at_its_points_and_not_left() {
        for [x, y] in FILM_IMPERFECTION {
            assert!((interpolated(&FILM_IMPERFECTION, x).unwrap() - y).abs() < 1e-15);
        }
        let between = interpolated(&FILM_IMPERFECTION, 20.0).unwrap();
        assert!((0.04..0.06).contains(&between), "{between}");
        assert_eq!(interpolated(&FILM_IMPERFECTION, 5.0), None);
        assert_eq!(interpolated(&FILM_IMPERFECTION, 51.0), None);
    }
}
