//! What finite elements found of a whole sheet, compared with the deployment that the hinge law
//! predicts.

use analysis::design_checks::WholeSheet;
use analysis::flatness::Flatness;
use fe_driver::SheetSurface;
use mesher::{Panels, Tier};
use scene::Posture;
use serde::Serialize;
use support::Extremes;
use support::severity::{Finding, Severity};

/// Difference of the loads over the load by finite elements above which a finding names it.
const OTHER_LOAD: f64 = 0.05;
/// Kinetic over internal energy up to which a dynamic path is nearly at rest.
const AT_REST: f64 = 0.02;
/// Overlap of flanks from which a finding names it (mm).
const FLANKS_TOUCH: f64 = 0.1;

/// The result of a task.
#[derive(Debug, Serialize)]
pub struct SheetCheck {
    /// The design that is checked, for a person.
    pub design: String,
    /// What keeps the panels in their plane.
    pub support: Posture,
    /// Mesh tier of the windows.
    pub tier: Tier,
    /// How its panels were modelled.
    pub model: Panels,
    /// Numbers of panels and of hinges.
    pub counts: [usize; 2],
    /// Whether flanks of cuts touch.
    pub contact: bool,
    /// Longer side of the flat sheet (mm).
    pub size: f64,
    /// Smallest radius of a window in the mesh, and the radius of the windows of the hinge law
    /// (mm).
    pub radius: [f64; 2],
    /// Smallest and largest ligament width over the thickness.
    pub slenderness: [f64; 2],
    /// The hinges that leave the training domain of the law on its path.
    pub outside: Vec<usize>,
    /// Whether the stroke is prescribed; otherwise loads are.
    pub driven: bool,
    /// What a person should know.
    pub findings: Vec<Finding>,
    /// Why the path was not followed to its end; `None` if it was.
    pub stopped: Option<String>,
    /// Whether inertia was needed to follow it.
    pub dynamic: bool,
    /// Number of unknowns of the mesh.
    pub unknowns: usize,
    /// CPU time of all attempts (s).
    pub cpu_seconds: f64,
    /// Memory of the solver (MiB), if it is known.
    pub memory_mib: Option<f64>,
    /// The states along the path.
    pub path: Vec<StateCheck>,
    /// The hinges at its end.
    pub hinges: Vec<HingeCheck>,
    /// The panels at its end.
    pub panels: Vec<PanelCheck>,
    /// Reactions of the supports of the scene in the plane at its end (N), by the hinge law and by
    /// finite elements; none by the law if the path ends early.
    pub supports: [Vec<f64>; 2],
    /// How much of the target is seen at its end, by the hinge law and by finite elements; `None`
    /// if there is no state.
    pub seen: Option<[f64; 2]>,
    /// Internal energy of the panels outside of the windows over the whole internal energy (1) at
    /// its end.
    pub panel_energy: f64,
    /// The middle surface at its end.
    #[serde(skip)]
    pub surface: SheetSurface,
}

/// A state of a path. Pairs are by the hinge law and by finite elements.
#[derive(Debug, Serialize)]
pub struct StateCheck {
    /// Fraction of the stroke or of the loads.
    pub fraction: f64,
    /// Stroke of the loads (mm); `None` without loads.
    pub stroke: Option<[f64; 2]>,
    /// Load (N); `None` without loads.
    pub load: Option<[f64; 2]>,
    /// Distance of the panel corners in space (mm): root mean square and maximum.
    pub corners: [f64; 2],
    /// Mean rotation of the hinges (deg).
    pub opening_deg: [f64; 2],
    /// Largest tilt of a panel (deg).
    pub tilt_deg: f64,
    /// The largest tilt by the hinge law and the bumps of the ligaments; `None` where there is no
    /// margin, and from a margin of 1 on.
    pub tilt_by_law_deg: Option<f64>,
    /// Lowest and highest point of the panels (mm).
    pub z: [f64; 2],
    /// Largest bending of a panel (mm).
    pub bending: f64,
    /// Kinetic over internal energy; zero on a static path.
    pub kinetic: f64,
    /// Distance of the flanks of a cut where they come nearest (mm), negative where they pass
    /// through each other; `None` where panels tilt, whose flanks pass each other in space.
    pub flank_gap: Option<f64>,
    /// The margin against leaving the plane by the hinge law, at its next load step; `None` if the
    /// law has none.
    pub margin: Option<f64>,
}

/// A hinge at the end of a path. Pairs are by the hinge law and by finite elements.
#[derive(Debug, Serialize)]
pub struct HingeCheck {
    /// Number of the hinge.
    pub hinge: usize,
    /// Ligament width (mm).
    pub w_lig: f64,
    /// Rotation (deg).
    pub theta_deg: [f64; 2],
    /// Energy (N mm).
    pub energy: [f64; 2],
    /// D_peak; by the law `None` if unknown.
    pub d_peak: [Option<f64>; 2],
}

/// A panel at the end of a path.
#[derive(Debug, Serialize)]
pub struct PanelCheck {
    /// Number of the panel.
    pub panel: usize,
    /// Tilt (deg).
    pub tilt_deg: f64,
    /// Largest distance of a corner from its position by the law (mm).
    pub off: f64,
    /// Lowest and highest point (mm).
    pub z: [f64; 2],
    /// Largest bending (mm).
    pub bending: f64,
}

impl SheetCheck {
    /// What a run keeps of it; `None` if there is no state.
    pub fn summary(&self) -> Option<WholeSheet> {
        let last = self.last()?;
        let tilts = self.path.iter().map(|state| state.tilt_deg);
        Some(WholeSheet {
            support: self.support,
            tilt_deg: tilts.fold(0.0, f64::max),
            corners: last.corners,
            load: last.load,
            findings: self.findings.clone(),
        })
    }

    /// The last state of the path.
    pub fn last(&self) -> Option<&StateCheck> {
        self.path.last()
    }
}

/// All findings, the most severe first.
pub(crate) fn findings(check: &SheetCheck) -> Vec<Finding> {
    let Some(last) = check.last() else {
        let reason = check.stopped.as_deref();
        let reason = reason.unwrap_or("no increment converged");
        let message = format!("the sheet was not solved: {reason}");
        let unsolved = Severity::Error.finding(message);
        return std::iter::once(unsolved).chain(outside_domain(check)).collect();
    };
    let stopped = check.stopped.as_ref().map(|reason| {
        Severity::Error.finding(format!(
            "the path was followed to {:.1} % only; what happens beyond is not known: {reason}",
            100.0 * last.fraction
        ))
    });
    let found = [
        stopped,
        flatness(check.support, check.size, &check.path),
        flanks_pass(&check.path),
        other_load(check, last),
        tearing(check),
        still_moving(last),
        outside_domain(check),
    ];
    let mut found: Vec<Finding> = found.into_iter().flatten().collect();
    found.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    found
}

/// Whether a sheet of a size (mm) is flat, by the rule of a design, where it is least so: on the
/// way or at the end.
fn flatness(support: Posture, size: f64, path: &[StateCheck]) -> Option<Finding> {
    let most = |value: fn(&StateCheck) -> f64| path.iter().largest_by(|state| value(state));
    let tilted = most(|state| state.tilt_deg)?;
    let off = most(|state| state.corners[0])?;
    let [rms, largest] = off.corners;
    let (error, tilt) = (rms / size, tilted.tilt_deg);
    let [as_predicted, otherwise] = match support {
        Posture::HeldFlat => ["agrees with the hinge law", "opens otherwise than predicted"],
        _ => ["stays flat", "does not stay flat"],
    };
    let (severity, what) = match Flatness::of(error, tilt) {
        Flatness::Flat => (Severity::Note, as_predicted),
        Flatness::Tilts => (Severity::Warning, otherwise),
        Flatness::Falls => (Severity::Error, otherwise),
    };
    let at = |state: &StateCheck| format!("at {:.0} % of the path", 100.0 * state.fraction);
    Some(severity.finding(format!(
            "the sheet {what}: the panels tilt by up to {tilt:.1} deg, {}, and the corners are {rms:.2} mm (root mean square) from where \
             the hinge law has them, {largest:.2} mm at most, {}: {:.2} % of the sheet",
            at(tilted),
            at(off),
            100.0 * error
        ),
    ))
}

/// Flanks that pass through each other, as flanks of a cut sheet cannot.
fn flanks_pass(path: &[StateCheck]) -> Option<Finding> {
    let gap = |state: &&StateCheck| state.flank_gap.is_some_and(|gap| gap < -FLANKS_TOUCH);
    let first = path.iter().find(gap)?;
    let deepest = path.iter().filter_map(|state| state.flank_gap).fold(0.0, f64::min);
    Some(Severity::Warning.finding(format!(
            "flanks of cuts pass through each other, by up to {:.2} mm, from {:.0} % of the path on: the sheet may go another way. Pull other \
             panels, or more of them; with --contact the flanks of a plate touch, in several times the time",
            -deepest,
            100.0 * first.fraction
        ),
    ))
}

fn other_load(check: &SheetCheck, last: &StateCheck) -> Option<Finding> {
    let [by_law, by_elements] = last.load.filter(|_| check.driven)?;
    let differs = (by_law - by_elements).abs() > OTHER_LOAD * by_elements.abs();
    differs.then(|| {
        Severity::Warning.finding(format!(
            "the load is {by_elements:.4} N by finite elements and {by_law:.4} N by the hinge law"
        ))
    })
}

fn tearing(check: &SheetCheck) -> Option<Finding> {
    let tears = |hinge: &&HingeCheck| hinge.d_peak[1].is_some_and(|peak| peak >= 1.0);
    let torn = numbers(check.hinges.iter().filter(tears).map(|hinge| hinge.hinge))?;
    let message = format!("ligaments tear: D_peak is 1 or more (hinges {torn})");
    Some(Severity::Error.finding(message))
}

fn still_moving(last: &StateCheck) -> Option<Finding> {
    (last.kinetic > AT_REST).then(|| {
        Severity::Warning.finding(format!(
            "the sheet still moves at the end of its dynamic path: kinetic energy is {:.1} % of the internal energy",
            100.0 * last.kinetic
        ))
    })
}

fn outside_domain(check: &SheetCheck) -> Option<Finding> {
    let hinges = numbers(check.outside.iter().copied())?;
    Some(Severity::Warning.finding(format!(
        "the hinge law is outside of its training domain at hinges {hinges}: what it predicts there is extrapolated, and the \
         difference to finite elements is not one of flatness"
    )))
}

/// Numbers as a list; `None` without any.
fn numbers(numbers: impl Iterator<Item = usize>) -> Option<String> {
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    (!numbers.is_empty()).then(|| numbers.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flat at the end is not flat on the way.
    #[test]
    fn the_verdict_is_of_the_whole_path() {
        let state = |fraction: f64, tilt_deg: f64, rms: f64| StateCheck {
            fraction,
            stroke: None,
            load: None,
            corners: [rms, 2.0 * rms],
            opening_deg: [20.0; 2],
            tilt_deg,
            z: [0.0; 2],
            bending: 0.0,
            kinetic: 0.0,
            flank_gap: None,
            margin: None,
            tilt_by_law_deg: None,
        };
        let found = |on_the_way: [f64; 2], support| {
            let path = [state(0.4, on_the_way[0], on_the_way[1]), state(1.0, 0.4, 0.3)];
            flatness(support, 200.0, &path).unwrap()
        };
        // 0.3 and 5 % of the sheet are 0.6 and 10 mm.
        for (on_the_way, severity, what) in [
            ([0.9, 0.59], Severity::Note, "stays flat"),
            ([2.3, 0.3], Severity::Warning, "does not stay flat"),
            ([0.3, 0.61], Severity::Warning, "does not stay flat"),
            ([5.1, 0.3], Severity::Error, "does not stay flat"),
            ([0.3, 10.1], Severity::Error, "does not stay flat"),
        ] {
            let found = found(on_the_way, Posture::Free);
            assert_eq!(found.severity, severity, "{found:?}");
            assert!(found.message.contains(&format!("the sheet {what}: ")), "{found:?}");
            let largest = on_the_way[0].max(0.4);
            let tilt = format!("tilt by up to {largest:.1} deg");
            assert!(found.message.contains(&tilt), "{found:?}");
        }
        let held = found([0.3, 1.0], Posture::HeldFlat);
        for part in ["opens otherwise than predicted", "2.00 mm at most, at 40 % of the path"] {
            assert!(held.message.contains(part), "{held:?}");
        }
        assert_eq!(flatness(Posture::Free, 200.0, &[]), None);
    }
}
