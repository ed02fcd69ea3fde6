//! Warnings about a design, to be checked before cutting.

use serde::Serialize;
use std::fmt;
use support::severity::Severity;

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

/// The subject of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Concern {
    /// Panels lie over each other, or the cuts are closed further than in the flat sheet.
    PanelsOverlap,
    /// Windows overlap: the sum of hinge energies counts the common material twice.
    WindowsOverlap,
    /// Panels are too small for the windows of their hinges.
    WindowsLeavePanels,
    /// w_lig or alpha is outside the training domain of the hinge law.
    LigamentsOutsideDomain,
    /// The effect of the slit on the hinge energy is not known.
    SlitUnknown,
    /// The path leaves the training domain of the hinge law.
    StatesOutsideDomain,
    /// The path departs so far from the straight ray to its end that energy and forces depend on
    /// it.
    PathDependence,
    /// The flanks of a cut are pushed into each other: contact between them is not modelled.
    FlanksTouch,
    /// D_peak of 1 or more: ligaments tear.
    Tearing,
    /// |eta| > 1 at full load: a ligament translates by more than its width.
    Overstrained,
    /// A cut is closer to a hinge's tip than its secondary cut.
    CutsTooClose,
    /// There are no cut lines.
    CannotBeCut,
    /// The cuts do not fit on the stock that the scene names.
    StockTooSmall,
    /// The equilibrium path is not converged and stable throughout.
    Path,
    /// The search met designs whose corrected path was on another branch than the followed one.
    OtherBranch,
    /// The target outline crosses or touches itself.
    TargetCrosses,
    /// The drawing of the target is open, or was not read in full.
    TargetDrawing,
    /// The outline is further from the target than 1 % of the sheet (a warning from 3 %, an error
    /// from 20 %), or than twice what the model does not know of its corners.
    TargetMissed,
    /// Effects that are not modelled for the given out-of-plane restraint.
    NotModelled,
    /// Whether the panels of a sheet that is not held flat stay in the plane, and what follows if
    /// not.
    LeavesPlane,
    /// What finite elements of the whole sheet found.
    WholeSheet,
    /// The weight of the sheet acts in its plane, is more than a twentieth of the load and not
    /// modelled.
    Weight,
    /// Friction is more than a twentieth of the load.
    Friction,
    /// The weights that hang from the sheet have more than fifty times its mass.
    HungWeight,
    /// A panel is held or pulled at a point outside of it.
    PointOutside,
    /// The load has a maximum on the path: a dead load of the final size does not open the sheet.
    LoadPeak,
    /// The weights state errors above 10 % in a force at their spot check, else at unseen rays, or
    /// a spot check that mostly lies outside their domain.
    WeakWeights,
}

impl Concern {
    fn severity(self) -> Severity {
        match self {
            Self::WindowsLeavePanels
            | Self::PathDependence
            | Self::OtherBranch
            | Self::TargetMissed
            | Self::NotModelled
            | Self::WholeSheet => Severity::Note,
            Self::WindowsOverlap
            | Self::LigamentsOutsideDomain
            | Self::SlitUnknown
            | Self::StockTooSmall
            | Self::StatesOutsideDomain
            | Self::FlanksTouch
            | Self::Path
            | Self::TargetCrosses
            | Self::TargetDrawing
            | Self::LeavesPlane
            | Self::Weight
            | Self::Friction
            | Self::HungWeight
            | Self::LoadPeak
            | Self::WeakWeights => Severity::Warning,
            Self::PanelsOverlap
            | Self::Tearing
            | Self::Overstrained
            | Self::CutsTooClose
            | Self::CannotBeCut
            | Self::PointOutside => Severity::Error,
        }
    }

    pub(super) fn of_sheet(self, message: String) -> Warning {
        Warning { concern: self, severity: self.severity(), hinges: Vec::new(), message }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        const NAMED: usize = 12;
        write!(f, "{}: {}", self.severity, self.message)?;
        let named: Vec<String> = self.hinges.iter().take(NAMED).map(usize::to_string).collect();
        match self.hinges.len() {
            0 => Ok(()),
            1 => write!(f, " (hinge {})", named[0]),
            2..=NAMED => write!(f, " (hinges {})", named.join(", ")),
            all => write!(f, " (hinges {} and {} more)", named.join(", "), all - NAMED),
        }
    }
}
