//! Rays that a campaign solves in addition to the rays of its box, at states that designs reach
//! outside the data.
//!
//! They are in a CSV file with the columns `w_lig` (mm), `alpha_deg`, `eta_a`, `eta_s`,
//! `theta_deg`, one ray per row, and `fillet_ratio` where hinges have other holes than the hole of
//! the campaign's `[design]`. The campaign's key `extra_rays` is the path of the file. Lines that
//! start with `#` are comments.

use crate::Ray;
use hinge::{HingeConstants, HingeDeformation};
use serde::Deserialize;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use support::{Fault, csv_table, refuse};

/// One row of the file: a hinge and the end of its ray.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RayRow {
    w_lig: f64,
    alpha_deg: f64,
    eta_a: f64,
    eta_s: f64,
    theta_deg: f64,
    fillet_ratio: Option<f64>,
}

/// Reads the rays of hinges with the constants `common`.
pub(crate) fn read_extra_rays(path: &Path, common: &HingeConstants) -> Result<Vec<Ray>, Fault> {
    let mut rays = Vec::new();
    let (_, rows) = csv_table::read::<RayRow>(path)?;
    for (i, (_, row)) in rows.into_iter().enumerate() {
        let ray = row.ray(common);
        if let Some(reason) = row.defect(&ray) {
            refuse!("{}, ray {}: {reason}", path.display(), i + 1);
        }
        // A ray that occurs twice is one job.
        if !rays.contains(&ray) {
            rays.push(ray);
        }
    }
    Ok(rays)
}

impl RayRow {
    fn ray(&self, common: &HingeConstants) -> Ray {
        let theta = self.theta_deg.to_radians();
        let constants = HingeConstants {
            fillet_ratio: self.fillet_ratio.unwrap_or(common.fillet_ratio),
            ..*common
        };
        acute(Ray {
            design: constants.hinge(self.w_lig, self.alpha_deg.to_radians()),
            end: HingeDeformation::from_eta(self.eta_a, self.eta_s, theta, self.w_lig),
        })
    }

    /// The defect of the ray; `None` if it is valid.
    fn defect(&self, ray: &Ray) -> Option<String> {
        let end = [self.eta_a, self.eta_s, self.theta_deg];
        if !end.iter().all(|x| x.is_finite()) {
            return Some("a number is not finite".to_owned());
        }
        if end == [0.0; 3] {
            return Some("it ends at the undeformed state, where it begins".to_owned());
        }
        if !(-1.0 < self.eta_a && self.eta_a < 1.0 && self.eta_s.abs() < 1.0) {
            return Some(
                "violates |eta_a| < 1, |eta_s| < 1 (fractions of w_lig, not mm)".to_owned(),
            );
        }
        if !(-30.0..=120.0).contains(&self.theta_deg) {
            return Some("violates -30 <= theta_deg <= 120".to_owned());
        }
        ray.design.validate().err().map(|error| error.to_string())
    }
}

/// The ray or its mirror image, whichever has the acute cut angle.
fn acute(ray: Ray) -> Ray {
    if ray.design.alpha > FRAC_PI_2 { ray.mirrored() } else { ray }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMMON: HingeConstants = HingeConstants::PAPER;

    #[test]
    fn a_ray_has_the_hole_of_its_row_or_of_the_campaign() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        let header = "w_lig,alpha_deg,eta_a,eta_s,theta_deg,fillet_ratio";
        let text = format!("# of a design\n{header}\n18,80,-0.3,0.1,20,\n18,70,-0.3,0.1,20,0.3\n");
        std::fs::write(&path, text).unwrap();
        let rays = read_extra_rays(&path, &COMMON).unwrap();
        let holes: Vec<f64> = rays.iter().map(|ray| ray.design.fillet_ratio).collect();
        assert_eq!(holes, [COMMON.fillet_ratio, 0.3]);
    }

    #[test]
    fn duplicate_rays_are_merged_and_obtuse_ones_are_mirrored() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        let header = "w_lig,alpha_deg,eta_a,eta_s,theta_deg";
        let text = format!("{header}\n18,80,-0.3,0.1,20\n18,80,-0.3,0.1,20\n18,120,0,0.1,20\n");
        std::fs::write(&path, text).unwrap();
        let rays = read_extra_rays(&path, &COMMON).unwrap();
        assert_eq!(rays.len(), 2);
        assert!((rays[1].design.alpha.to_degrees() - 60.0).abs() < 1e-9);
        assert!(rays[1].end.s < 0.0);
    }

    #[test]
    fn invalid_rays_are_rejected() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        let header = "w_lig,alpha_deg,eta_a,eta_s,theta_deg";
        for (text, expected) in [
            ("w_lig,alpha\n1,2\n".to_owned(), "unknown field"),
            (format!("{header}\n18,90,-5.4,0,20\n"), "|eta_a| < 1"),
            (format!("{header}\n18,90,0,0,-40\n"), "-30 <= theta_deg"),
            (format!("{header}\n18,90,0,0,2000\n"), "theta_deg <= 120"),
            (
                format!("{header}\n18,90,0,0,20\n18,90,0,0,0\n"),
                "ray 2: it ends at the undeformed state",
            ),
            (format!("{header}\n60,90,0,0,20\n"), "r_win"),
            (format!("{header}\n18,90,0,x,20\n"), "rays.csv"),
        ] {
            std::fs::write(&path, text).unwrap();
            let message = read_extra_rays(&path, &COMMON).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
