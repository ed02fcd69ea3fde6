//! Warnings about a design, to be checked before cutting.

use crate::cut_file::{CutLines, FabricationError};
use crate::report::hinge_row::HingeRow;
use design::analysis::localisation::critical_edge;
use design::equilibrium::load_step::Status;
use design::objective::design_problem::Deployment;
use design::objective::target::Target;
use design::scene::Scene;
use design::sheet::hinge_window::Window;
use serde::Serialize;
use std::fmt;

/// A limit of the model or of fabrication that a design exceeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// The subject.
    pub concern: Concern,
    /// The consequence.
    pub severity: Severity,
    /// The hinges concerned; empty if the whole sheet is concerned.
    pub hinges: Vec<usize>,
    /// The limit that is exceeded, in words.
    pub message: String,
}

/// The consequence of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// The model is less accurate than elsewhere.
    Note,
    /// The sheet may not behave as computed: check before cutting.
    Warning,
    /// The sheet will not behave as computed, or cannot be cut: no cut file is written unless forced.
    Error,
}

/// The subject of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Concern {
    /// Windows overlap: the sum of hinge energies counts the common material twice.
    WindowsOverlap,
    /// Panels are too small for the windows of their hinges.
    WindowsLeavePanels,
    /// Gamma < 1 (21): on a surface, the weight of panels does not hold them down.
    GammaBelowOne,
    /// w_lig or alpha is outside the training domain of the hinge law.
    LigamentsOutsideDomain,
    /// The path leaves the training domain of the hinge law.
    StatesOutsideDomain,
    /// The path departs so far from the straight ray to its end that energy and forces depend on it.
    PathDependence,
    /// D_peak of 1 or more: ligaments tear.
    Tearing,
    /// |eta| > 1 at full load: a ligament translates by more than its width.
    Overstrained,
    /// A cut is closer to a hinge's tip than its secondary cut.
    CutsTooClose,
    /// There are no cut lines.
    CannotBeCut,
    /// The equilibrium path is not converged and stable throughout.
    Path,
    /// The search met designs whose corrected path was on another branch than the followed one.
    OtherBranch,
    /// The target outline crosses or touches itself.
    TargetCrosses,
    /// The outline is further from the target than 1 % of the sheet.
    TargetMissed,
    /// What the model of every learned law leaves out: panels that leave the plane, weight and friction.
    NotModelled,
    /// The weight of the sheet is more than a tenth of the load.
    Weight,
    /// The load has a maximum on the path: a dead load of the final size does not open the sheet.
    LoadPeak,
    /// The weights state errors above 10 % in a force, or a spot check that mostly lies outside their domain.
    WeakWeights,
}

/// Separation of a path from its ray, in ligament widths, up to which W differs by less than 1 % (docs/results/detours).
const SAFE_SEPARATION: f64 = 0.15;

impl Concern {
    /// The severity of the concern.
    fn severity(self) -> Severity {
        match self {
            Self::WindowsLeavePanels
            | Self::PathDependence
            | Self::OtherBranch
            | Self::TargetMissed
            | Self::NotModelled => Severity::Note,
            Self::WindowsOverlap
            | Self::GammaBelowOne
            | Self::LigamentsOutsideDomain
            | Self::StatesOutsideDomain
            | Self::Path
            | Self::TargetCrosses
            | Self::Weight
            | Self::LoadPeak
            | Self::WeakWeights => Severity::Warning,
            Self::Tearing | Self::Overstrained | Self::CutsTooClose | Self::CannotBeCut => {
                Severity::Error
            }
        }
    }

    /// A warning about the whole sheet.
    pub(super) fn of_sheet(self, message: String) -> Warning {
        Warning {
            concern: self,
            severity: self.severity(),
            hinges: Vec::new(),
            message,
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const NAMED: usize = 12;
        write!(f, "{}: {}", self.severity, self.message)?;
        let named: Vec<String> = self
            .hinges
            .iter()
            .take(NAMED)
            .map(usize::to_string)
            .collect();
        match self.hinges.len() {
            0 => Ok(()),
            1 => write!(f, " (hinge {})", named[0]),
            2..=NAMED => write!(f, " (hinges {})", named.join(", ")),
            all => write!(f, " (hinges {} and {} more)", named.join(", "), all - NAMED),
        }
    }
}

/// All warnings of a deployed design; `cuts` are its cut lines, `hinges` the rows of its report.
pub(super) fn all(
    scene: &Scene,
    deployment: &Deployment,
    cuts: &Result<CutLines, FabricationError>,
    hinges: &[HingeRow],
) -> Vec<Warning> {
    let mut warnings = windows(deployment);
    warnings.extend(cutting(deployment, cuts));
    warnings.extend(tilting(scene, hinges));
    warnings.extend(domain(scene, hinges));
    warnings.extend(path_dependence(scene, hinges));
    warnings.extend(tearing(hinges));
    warnings.extend(overstrained(hinges));
    warnings.extend(path(deployment));
    warnings.extend(target(&scene.target));
    warnings.sort_by_key(|warning| std::cmp::Reverse(warning.severity));
    warnings
}

/// A warning about the hinges, if there are any.
fn about(concern: Concern, hinges: Vec<usize>, message: String) -> Option<Warning> {
    (!hinges.is_empty()).then(|| Warning {
        hinges,
        ..concern.of_sheet(message)
    })
}

/// The hinges whose rows `overstep`.
fn those(hinges: &[HingeRow], overstep: impl Fn(&HingeRow) -> bool) -> Vec<usize> {
    hinges
        .iter()
        .filter(|row| overstep(row))
        .map(|row| row.hinge)
        .collect()
}

fn windows(deployment: &Deployment) -> Vec<Warning> {
    let sheet = &deployment.sheet;
    let windows = Window::of_sheet(sheet);
    let r_win = sheet.options.process.r_win;
    let overlapping = (0..windows.len())
        .filter(|&h| {
            let others = windows.iter().enumerate();
            others
                .filter(|(other, _)| *other != h)
                .any(|(_, other)| windows[h].overlaps(other))
        })
        .collect();
    let leaving = (0..windows.len())
        .filter(|&h| {
            let hinge = &sheet.hinges[h];
            let [a, b] = [hinge.panel_a(), hinge.panel_b()].map(|panel| &sheet.panels[panel]);
            !windows[h].within(a, b)
        })
        .collect();
    let overlap = format!(
        "windows of {r_win} mm radius overlap: their ligaments are not independent, and the sum of \
         hinge energies is not exact"
    );
    let leave = format!("panels are too small for the {r_win} mm windows of their hinges");
    [
        about(Concern::WindowsOverlap, overlapping, overlap),
        about(Concern::WindowsLeavePanels, leaving, leave),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn cutting(deployment: &Deployment, cuts: &Result<CutLines, FabricationError>) -> Option<Warning> {
    let cuts = match cuts {
        Ok(cuts) => cuts,
        Err(error) => {
            return Some(Concern::CannotBeCut.of_sheet(error.to_string()));
        }
    };
    const ROUNDING: f64 = 1e-6;
    let close = deployment
        .sheet
        .hinges
        .iter()
        .enumerate()
        .filter(|(h, hinge)| cuts.clearance(*h) < hinge.w_lig - ROUNDING)
        .map(|(h, _)| h)
        .collect();
    let message = "another cut is closer to the tip than w_lig".into();
    about(Concern::CutsTooClose, close, message)
}

fn tilting(scene: &Scene, hinges: &[HingeRow]) -> Option<Warning> {
    let tilting = those(hinges, |row| row.gamma < 1.0);
    let edge = tilting
        .iter()
        .map(|&h| critical_edge(&scene.material, hinges[h].w_lig))
        .fold(0.0, f64::max);
    let message = format!(
        "panel edges are shorter than the critical length of {edge:.0} mm: Gamma < 1, also on a surface the weight of the \
         panels does not hold them down against their ligaments"
    );
    about(Concern::GammaBelowOne, tilting, message)
}

fn domain(scene: &Scene, hinges: &[HingeRow]) -> Vec<Warning> {
    let Some(domain) = scene.surrogate().map(|surrogate| surrogate.domain()) else {
        return Vec::new();
    };
    let outside = |[min, max]: [f64; 2], value: f64| !(min..=max).contains(&value);
    let alpha_deg = domain.alpha.map(f64::to_degrees);
    let ligaments = those(hinges, |row| {
        outside(domain.w_lig, row.w_lig) || outside(alpha_deg, row.alpha_deg)
    });
    let states = those(hinges, |row| !row.inside);
    let trained = format!(
        "ligaments are outside the training domain of the hinge law, w_lig {:.1} to {:.1} mm and alpha \
         {:.0} to {:.0} deg",
        domain.w_lig[0], domain.w_lig[1], alpha_deg[0], alpha_deg[1]
    );
    let left = "deformations leave the training domain of the hinge law along the path: energy and forces of these \
                hinges are extrapolated, and their damage is not known"
        .into();
    [
        about(Concern::LigamentsOutsideDomain, ligaments, trained),
        about(Concern::StatesOutsideDomain, states, left),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// A learned law was measured along straight rays.
fn path_dependence(scene: &Scene, hinges: &[HingeRow]) -> Option<Warning> {
    scene.surrogate()?;
    let bent = those(hinges, |row| row.path_separation > SAFE_SEPARATION);
    let message = format!(
        "paths depart by more than {SAFE_SEPARATION} ligament widths from the straight rays of the hinge law: energy, forces \
         and damage depend on the path there (docs/results/detours); check by `kirigami verify`"
    );
    about(Concern::PathDependence, bent, message)
}

fn tearing(hinges: &[HingeRow]) -> Option<Warning> {
    // The mean reaches 1 later than the peak; weights without D_peak predict the mean only.
    let torn = those(hinges, |row| {
        row.damage_peak
            .or(row.damage)
            .is_some_and(|damage| damage >= 1.0)
    });
    let message = "predicted peak damage of 1 or more: the ligament tears".into();
    about(Concern::Tearing, torn, message)
}

fn overstrained(hinges: &[HingeRow]) -> Option<Warning> {
    let beyond = those(hinges, |row| row.eta_a.abs().max(row.eta_s.abs()) > 1.0);
    let message =
        "ligaments translate by more than their width at full load, where no hinge law is valid: \
                   reduce the load or the size of the target"
            .into();
    about(Concern::Overstrained, beyond, message)
}

fn path(deployment: &Deployment) -> Option<Warning> {
    let steps: Vec<String> = deployment
        .path
        .iter()
        .filter_map(|step| {
            let what = match step.status {
                Status::Converged | Status::LeftDomain => return None,
                Status::Almost => format!("residual {:.0e}", step.residual),
                Status::LimitPoint => "a jump past a limit point".into(),
                Status::Diverged => {
                    let end = step.descent_end.map(|end| format!(": {end}"));
                    let beyond = format!("beyond load factor {:.3}", step.load_factor);
                    return Some(format!(
                        "no equilibrium was found {beyond}{}",
                        end.unwrap_or_default()
                    ));
                }
            };
            Some(format!("{what} at load factor {:.3}", step.load_factor))
        })
        .collect();
    (!steps.is_empty()).then(|| {
        let message = format!(
            "the equilibrium path is not smooth and stable: {}",
            steps.join(", ")
        );
        match deployment.final_step().status {
            Status::Diverged => Warning {
                severity: Severity::Error,
                ..Concern::Path.of_sheet(message)
            },
            _ => Concern::Path.of_sheet(message),
        }
    })
}

fn target(target: &Target) -> Option<Warning> {
    target.crossing().map(|[x, y]| {
        Concern::TargetCrosses.of_sheet(format!(
            "the target outline crosses or touches itself near ({x:.1}, {y:.1}) mm: its inside is not defined; order \
             its vertices around the outline"
        ))
    })
}
