//! The causes of the error budget: the errors of the hinge forces by each, and their sources.

use crate::calibration::CALIBRATION;
use crate::force_errors::{Modes, alike, along, common, deviations, isotropic, spread};
use crate::out_of_plane::out_of_plane;
use crate::path_separation::path_separation;
use design::equilibrium::force_response::ForceResponse;
use design::hinge_law::{HingeEnergy, Order};
use design::objective::design_problem::{Deployment, DesignProblem};
use design::objective::response::by_thickness;
use hinge::{HingeDeformation, HingeDesign, Regime};
use scene::{Posture, Scene};
use serde::{Deserialize, Serialize};
use support::statistics::rms_and_maximum;
use surrogate::Surrogate;

/// A cause of errors of a deployed sheet, in the order of a budget.
#[derive(
    Clone, Copy, Debug, PartialEq, Serialize, Deserialize, strum::IntoStaticStr, strum::VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "lowercase")]
pub enum ErrorCause {
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
    /// The energy of a hinge as a function only of its state.
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

/// Standard deviations of a deployed sheet.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Effect {
    /// Deviations of the panel corners (mm): root mean square and maximum.
    pub corners: [f64; 2],
    /// Deviation of the load that the prescribed displacement takes, relative to it; `None` under
    /// dead loads.
    pub load: Option<f64>,
    /// Whether it is a lower bound: a sum with an unknown part.
    pub at_least: bool,
    /// Deviation of every panel corner, SW, SE, NE and NW of every panel (mm).
    #[serde(skip)]
    pub by_corner: Vec<f64>,
}

/// A deployed sheet at full load.
pub(crate) struct LoadedSheet<'a> {
    pub scene: &'a Scene,
    pub weights: &'a Surrogate,
    pub problem: &'a DesignProblem,
    pub deployment: &'a Deployment,
    pub designs: Vec<HingeDesign>,
    /// Energies by the hinge law, without contact.
    pub energies: Vec<HingeEnergy>,
    pub response: ForceResponse<'a>,
    pub load: f64,
    /// Movement of the corners in the last balance with finite elements (mm).
    pub residual: Option<f64>,
}

/// A quantity with its source, or why it is unknown.
type Sourced<T> = Result<(T, String), String>;

impl ErrorCause {
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

impl Effect {
    /// An effect on every corner (mm), and relative to the load.
    pub fn new(by_corner: Vec<f64>, load: Option<f64>) -> Self {
        let corners = rms_and_maximum(by_corner.iter().copied());
        Self { corners, load, at_least: false, by_corner }
    }

    /// The root of the sum of the squares of both, which are known.
    pub fn with(self, other: &Self) -> Self {
        let corners = std::iter::zip(&self.by_corner, &other.by_corner);
        let loads = [self.load, other.load].into_iter().flatten();
        let load = loads.reduce(f64::hypot);
        Self::new(corners.map(|(one, other)| one.hypot(*other)).collect(), load)
    }
}

impl LoadedSheet<'_> {
    /// The effect of a cause, `None` in it if the tangent is singular; `None` for a cause that the
    /// sheet does not have.
    pub(crate) fn effect(&self, cause: ErrorCause) -> Option<Sourced<Option<Effect>>> {
        let modes = match cause {
            ErrorCause::Network => self.networks()?,
            ErrorCause::WindowMesh => self.window_mesh(),
            ErrorCause::MaterialLaw => self.material_law(),
            ErrorCause::Imperfection => self.imperfection(),
            ErrorCause::LoadingPath => self.loading_path(),
            ErrorCause::Kerf => self.kerf(),
            ErrorCause::Thickness => self.thickness(),
            ErrorCause::Tilt => return self.tilt(),
            ErrorCause::Balance => {
                let corners = vec![self.residual?; 4 * self.deployment.sheet.panels.len()];
                let source = "largest movement in the last balance with finite elements of every hinge, which replace networks, mesh and path";
                return Some(Ok((Some(Effect::new(corners, None)), source.into())));
            }
        };
        let last = self.deployment.final_step();
        Some(modes.map(|(modes, source)| {
            let found = deviations(&modes, &self.response, &self.deployment.sheet, last);
            let relative = |(corners, load): (Vec<f64>, Option<f64>)| {
                Effect::new(corners, load.map(|deviation| deviation / self.load.abs()))
            };
            (found.map(relative), source)
        }))
    }

    /// Distances of the corners from the plane; `None` if the panels are held flat.
    fn tilt(&self) -> Option<Sourced<Option<Effect>>> {
        let Self { scene, problem, deployment, .. } = self;
        let heights = match scene.config.posture {
            None => Err("the scene has no posture"),
            Some(posture) if posture.kind == Posture::HeldFlat => return None,
            Some(_) => match out_of_plane(scene, problem, deployment) {
                None => Err(
                    "panels of a film, and of a plate that no clip or clamp holds, leave the plane (docs/results/flatness)",
                ),
                Some(path) => {
                    let configuration = &deployment.final_step().configuration;
                    let heights = path.last()?.heights(&deployment.sheet, configuration);
                    heights.ok_or("the panels leave the plane (docs/results/flatness)")
                }
            },
        };
        Some(heights.map_err(str::to_owned).map(|heights| {
            let source = format!(
                "heights of the corners, if all ligaments have a bump of {} thicknesses on the same side (docs/results/flatness)",
                Regime::Plate.bump()
            );
            (Some(Effect::new(heights.into_iter().map(f64::abs).collect(), None)), source)
        }))
    }

    /// The states of the hinges at full load.
    fn states(&self) -> &[HingeDeformation] {
        &self.deployment.final_step().deformations
    }

    /// (F_a, F_s, M_theta) of every hinge by the hinge law, times a factor.
    fn forces(&self, factor: f64) -> Vec<[f64; 3]> {
        self.energies.iter().map(|energy| energy.forces.map(|force| factor * force)).collect()
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

    /// The states at which the weights were checked, with their mesh and the errors of their forces,
    /// if these are known; an error outside the training domain, where no check was made.
    fn check(&self) -> Result<(String, &str, [f64; 3]), String> {
        if self.deployment.final_step().inside.contains(&false) {
            return Err("hinges are outside the training domain".into());
        }
        // Visited states belong to even sheets.
        let card = self.weights.card();
        let random = card.spot_check.as_ref().map(|check| (check, "random"));
        let check = self.scene.config.cells.as_ref().map_or(random, |_| card.check());
        let (check, states) =
            check.ok_or("no spot check on the card: `surrogate test --record`")?;
        let known = check.tier.as_deref().zip(check.forces);
        let (tier, forces) = known.ok_or(
            "the spot check on the card is without mesh or forces: `surrogate test --record`",
        )?;
        Ok((format!("{} {states} states on `{tier}`", check.inside), tier, forces))
    }

    /// The errors of the weights at these states, with the source.
    fn checked(&self) -> Sourced<Modes> {
        let (states, _, forces) = self.check()?;
        let sizes: Vec<[f64; 3]> =
            (self.norms().into_iter()).map(|norm| forces.map(|error| error * norm)).collect();
        let [f_a, s, m] = forces.map(|error| 100.0 * error);
        let source = format!("{f_a:.1}, {s:.1}, {m:.1} % of the force, {states}");
        Ok((alike(&sizes, &self.designs, self.states()), source))
    }

    /// Whether these states have another mesh than the training rays, so its errors
    /// contain the error of the mesh.
    fn is_checked_on_finer_mesh(&self) -> bool {
        self.check().is_ok_and(|(_, tier, _)| tier != self.weights.card().tier)
    }

    /// `None` if only the spot check knows it, on a finer mesh: it is a part of that row.
    fn networks(&self) -> Option<Sourced<Modes>> {
        let (mut modes, mut sources) = (Modes::new(), Vec::new());
        let networks = self.scene.networks();
        if networks.len() > 1 {
            let forces = networks.iter().map(|network| {
                let prepared = network.prepare(&self.designs);
                let energies = network.evaluate(&prepared, self.states(), Order::Forces);
                energies.iter().map(|energy| energy.forces).collect()
            });
            modes = spread(&forces.collect::<Vec<_>>());
            sources.push(format!("spread of {} networks in these states", networks.len()));
        }
        if !self.is_checked_on_finer_mesh() {
            match self.checked() {
                Ok((errors, source)) => {
                    modes.extend(errors);
                    sources.push(source);
                }
                Err(why) if sources.is_empty() => {
                    return Some(Err(format!("no ensemble; {why}")));
                }
                Err(_) => {}
            }
        }
        (!sources.is_empty()).then(|| Ok((modes, sources.join("; "))))
    }

    fn window_mesh(&self) -> Sourced<Modes> {
        let (_, tier, _) = self.check()?;
        if self.is_checked_on_finer_mesh() {
            self.checked()
        } else {
            Err(format!("the weights were not checked on a finer mesh than `{tier}`"))
        }
    }

    fn material_law(&self) -> Sourced<Modes> {
        let material = &self.scene.material;
        let deviation = material
            .stress_deviation
            .ok_or_else(|| format!("{} has no stress_deviation", material.name))?;
        let source = format!("stress {:.1} %, material file", 100.0 * deviation);
        Ok((common(&self.forces(deviation)), source))
    }

    fn imperfection(&self) -> Sourced<Modes> {
        let thickness = self.scene.material.thickness;
        let mut forces = self.forces(1.0);
        let mut largest = (0.0, "");
        for (force, design) in forces.iter_mut().zip(&self.designs) {
            let ratio = design.w_lig / thickness;
            let measured = &CALIBRATION.of(Regime::of(ratio)).imperfection;
            let change = interpolated(&measured.value, ratio)
                .ok_or_else(|| format!("not measured for ligaments of {ratio:.1} thicknesses"))?;
            *force = force.map(|force| change * force);
            if change > largest.0 {
                largest = (change, measured.source.as_str());
            }
        }
        let (change, page) = largest;
        let percent = 100.0 * change;
        let source = format!("up to {percent:.1} % of the force of a hinge ({page})");
        Ok((along(&forces), source))
    }

    fn loading_path(&self) -> Sourced<Modes> {
        let material = &self.scene.material;
        let yields_at = material.plastic[0][0] / material.young;
        let covered = &CALIBRATION.deviation_yield;
        if yields_at < 0.5 * covered.value {
            return Err(format!(
                "measured for the polyester film; this material yields at {:.2} % ({})",
                100.0 * yields_at,
                covered.source
            ));
        }
        let curvature = self.weights.ray_curvature();
        let mut sizes = self.norms();
        let mut largest = 0.0_f64;
        for (h, (size, design)) in sizes.iter_mut().zip(&self.designs).enumerate() {
            let path = self.deployment.path.iter().map(|step| step.deformations[h]);
            let separation = path_separation(design.w_lig, curvature, &path.collect::<Vec<_>>());
            let regime = material.regime(design.w_lig);
            let deviation = CALIBRATION.path_deviation(regime, curvature > 0.0);
            *size *= f64::min(deviation.slope * separation, deviation.most);
            largest = largest.max(separation);
        }
        let source =
            format!("up to {largest:.3} w_lig from the ray (docs/TRIED.md, docs/results/paths)");
        Ok((isotropic(&sizes, &self.designs), source))
    }

    fn kerf(&self) -> Sourced<Modes> {
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
        Ok((common(&errors), source))
    }

    fn thickness(&self) -> Sourced<Modes> {
        let tolerance = self.scene.config.tolerances.thickness;
        let tolerance = tolerance.ok_or("no tolerances.thickness in the scene")?;
        let relative = (0.5 * tolerance) / self.scene.material.thickness;
        let hinges = self.energies.iter().zip(&self.designs).zip(self.states());
        let errors: Vec<[f64; 3]> = hinges
            .map(|((energy, design), state)| {
                by_thickness(energy, state, design.w_lig).map(|change| relative * change)
            })
            .collect();
        let source = format!("+- {tolerance} mm, two standard deviations");
        Ok((common(&errors), source))
    }
}

/// Value between the points [x, y] of a table, linear in the logarithms; `None` outside.
fn interpolated(table: &[[f64; 2]], x: f64) -> Option<f64> {
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
        let table = &CALIBRATION.of(Regime::Film).imperfection.value;
        for &[x, y] in table {
            assert!((interpolated(table, x).unwrap() - y).abs() < 1e-15);
        }
        let between = interpolated(table, 20.0).unwrap();
        assert!((0.04..0.06).contains(&between), "{between}");
        assert_eq!(interpolated(table, 5.0), None);
        assert_eq!(interpolated(table, 51.0), None);
    }
}
