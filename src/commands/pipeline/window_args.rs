//! The hinge design (7) as command line arguments, shared by `mesh` and `solve`.

use anyhow::{Result, ensure};
use clap::Args;
use hinge::HingeDesign;
use std::f64::consts::PI;

/// One hinge; lengths in mm, angles in degrees.
#[derive(Args)]
#[command(next_help_heading = "Hinge design")]
pub(super) struct WindowArgs {
    /// Ligament width: the material left between the tip of the main cut and the secondary cut (mm)
    #[arg(long, value_name = "MM", default_value_t = 18.0)]
    pub w_lig: f64,
    /// Angle between the two cuts, measured into the material (degrees, between 0 and 180)
    #[arg(long, value_name = "DEG", default_value_t = 90.0)]
    pub alpha_deg: f64,
    /// Radius of the hole drilled at the tip, as a multiple of the ligament width
    #[arg(long, value_name = "RATIO", default_value_t = 0.16)]
    pub fillet_ratio: f64,
    /// Width of the kerf, the material removed by the cutting tool (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.2)]
    pub kerf: f64,
    /// Radius of the half-disc of sheet around the hinge (mm)
    #[arg(long, value_name = "MM", default_value_t = 100.0)]
    pub r_win: f64,
}

impl WindowArgs {
    /// The hinge design, or an error if it cannot be cut.
    pub(super) fn design(&self) -> Result<HingeDesign> {
        let design = HingeDesign {
            w_lig: self.w_lig,
            alpha: self.alpha_deg.to_radians(),
            fillet_ratio: self.fillet_ratio,
            kerf: self.kerf,
            r_win: self.r_win,
        };
        design.validate_coupon()?;
        // No hinge has cuts that meet at less than 4 degrees, but every angle in radians is below.
        ensure!(
            self.alpha_deg > PI,
            "--alpha-deg {} is in degrees: did you mean {:.1}?",
            self.alpha_deg,
            self.alpha_deg.to_degrees()
        );
        if let Err(error) = design.validate() {
            eprintln!(
                "note: {error}: a coupon between grips, not a hinge of a sheet; close grips need the mesh tier `paper`"
            );
        }
        Ok(design)
    }
}
