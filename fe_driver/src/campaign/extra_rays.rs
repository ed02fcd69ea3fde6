//! Rays that a campaign solves in addition to the rays of its box, at states that designs reach
//! outside the data.
//!
//! They are in a CSV file with the columns `w_lig` (mm), `alpha_deg`, `eta_a`, `eta_s`,
//! `theta_deg`, one ray per row, and `fillet_ratio` where hinges have other holes than the hole of
//! the campaign's `[design]`. The campaign's key `extra_rays` is the path of the file. Lines that
//! start with `#` are comments.

use crate::solve::hinge_path::Ray;
use hinge::{HingeConstants, HingeDeformation};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};
use support::file_error::FileError;
use support::{csv_table, regular_file, whole_file};

/// A file that is not a valid list of rays, or that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum ExtraRaysError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(
        "{path} has other columns, or in another order: rays are appended below `{header}`",
        path = .path.display(), header = .header.join(",")
    )]
    Order { path: PathBuf, header: &'static [&'static str] },
    #[error("{path}, ray {row}: {reason}", path = .path.display())]
    Ray { path: PathBuf, row: usize, reason: String },
}

/// The columns in the order in which rays are appended.
const COLUMNS: [&str; 6] = ["w_lig", "alpha_deg", "eta_a", "eta_s", "theta_deg", "fillet_ratio"];

/// One row of the file: a hinge and the end of its ray. Its fields are in the order of [`COLUMNS`].
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    w_lig: f64,
    alpha_deg: f64,
    eta_a: f64,
    eta_s: f64,
    theta_deg: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fillet_ratio: Option<f64>,
}

/// Reads the rays of hinges with the constants `common`.
pub fn read_extra_rays(path: &Path, common: &HingeConstants) -> Result<Vec<Ray>, ExtraRaysError> {
    let mut rays = Vec::new();
    let (_, rows) = csv_table::read::<Row>(path)?;
    for (i, (_, row)) in rows.into_iter().enumerate() {
        let ray = row.ray(common);
        if let Some(reason) = row.defect(&ray) {
            return Err(ExtraRaysError::Ray { path: path.to_owned(), row: i + 1, reason });
        }
        // A ray that occurs twice is one job.
        if !rays.contains(&ray) {
            rays.push(ray);
        }
    }
    Ok(rays)
}

/// Numbers of rays that were added, already known, and refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Added {
    /// Rays that were added.
    pub added: usize,
    /// Rays that the file already contained.
    pub known: usize,
    /// Rays outside the limits of a campaign.
    pub refused: usize,
}

/// Appends rays to the file, which is created if it does not exist. If the hinges of all rays have
/// the same hole, the rays belong to a campaign with this hole; otherwise, and in a file with that
/// column, `fillet_ratio` is written too.
pub fn add_extra_rays(path: &Path, rays: &[Ray]) -> Result<Added, ExtraRaysError> {
    let (header, rows) = if path.exists() { csv_table::read(path)? } else { Default::default() };
    let several = rays.iter().any(|ray| ray.design.fillet_ratio != rays[0].design.fillet_ratio);
    let with_holes = several || header.iter().any(|column| column == COLUMNS[5]);
    let columns = &COLUMNS[..if with_holes { 6 } else { 5 }];
    if !header.is_empty() && !header.iter().eq(columns.iter().copied()) {
        let (path, header) = (path.to_owned(), columns);
        return Err(ExtraRaysError::Order { path, header });
    }
    let mut rows: Vec<Row> = rows.into_iter().map(|(_, row)| row).collect();
    let mut count = Added::default();
    let mut writer =
        csv::WriterBuilder::new().has_headers(header.is_empty()).from_writer(Vec::new());
    for ray in rays {
        let row = Row::from_ray(ray, with_holes);
        if row.defect(ray).is_some() {
            count.refused += 1;
        } else if rows.contains(&row) {
            count.known += 1;
        } else {
            count.added += 1;
            writer.serialize(row).map_err(FileError::at(path))?;
            rows.push(row);
        }
    }
    let mut bytes = if path.exists() {
        regular_file::read(path).map_err(FileError::at(path))?
    } else {
        Vec::new()
    };
    if bytes.last().is_some_and(|last| *last != b'\n') {
        bytes.push(b'\n');
    }
    bytes.extend(writer.into_inner().unwrap_or_default());
    whole_file::write(path, &bytes).map_err(FileError::at(path))?;
    Ok(count)
}

impl Row {
    /// The row of a ray. Numbers are rounded to four decimals, which is accurate enough and keeps
    /// the file readable.
    fn from_ray(ray: &Ray, with_hole: bool) -> Self {
        let ray = acute(*ray);
        let [eta_a, eta_s] = ray.end.eta(ray.design.w_lig);
        let round = |x: f64| (1e4 * x).round() / 1e4;
        Self {
            w_lig: round(ray.design.w_lig),
            alpha_deg: round(ray.design.alpha.to_degrees()),
            eta_a: round(eta_a),
            eta_s: round(eta_s),
            theta_deg: round(ray.end.theta.to_degrees()),
            fillet_ratio: with_hole.then(|| round(ray.design.fillet_ratio)),
        }
    }

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

    fn ray(alpha_deg: f64) -> Ray {
        Ray {
            design: COMMON.hinge(17.123_456, f64::to_radians(alpha_deg)),
            end: HingeDeformation::from_eta(-0.3, 0.1, 0.5, 17.123_456),
        }
    }

    #[test]
    fn rays_are_added_once_mirrored_to_acute_angles_and_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        let added = add_extra_rays(&path, &[ray(80.0), ray(100.0)]).unwrap();
        assert_eq!((added.added, added.known, added.refused), (2, 0, 0));
        let text = format!("# of a design\n{}# by hand", std::fs::read_to_string(&path).unwrap());
        std::fs::write(&path, text).unwrap();
        let mut closing = ray(60.0);
        closing.end.theta = -0.6;
        let added = add_extra_rays(&path, &[ray(80.0), ray(70.0), closing]).unwrap();
        assert_eq!((added.added, added.known, added.refused), (1, 1, 1));
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains("# of a design") && text.contains("# by hand"), "{text}");
        let rays = read_extra_rays(&path, &COMMON).unwrap();
        assert_eq!(rays.len(), 3);
        assert!((rays[0].design.w_lig - 17.1235).abs() < 1e-12);
        assert!((rays[1].design.alpha.to_degrees() - 80.0).abs() < 1e-9);
        assert!((rays[1].end.s + rays[0].end.s).abs() < 1e-9);
    }

    #[test]
    fn rays_with_holes_of_several_radii_keep_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        let mut wide = ray(70.0);
        wide.design.fillet_ratio = 0.3;
        add_extra_rays(&path, &[ray(80.0), wide]).unwrap();
        // A file with the column keeps it.
        add_extra_rays(&path, &[ray(60.0)]).unwrap();
        let holes = |path: &Path| -> Vec<f64> {
            let rays = read_extra_rays(path, &COMMON).unwrap();
            rays.iter().map(|ray| ray.design.fillet_ratio).collect()
        };
        assert_eq!(holes(&path), [0.16, 0.3, 0.16]);
        let without = folder.path().join("one.csv");
        add_extra_rays(&without, &[ray(80.0)]).unwrap();
        let error = add_extra_rays(&without, &[ray(60.0), wide]).unwrap_err();
        assert!(error.to_string().contains("theta_deg,fillet_ratio"), "{error}");
        assert_eq!(holes(&without), [0.16]);
    }

    #[test]
    fn rays_are_appended_below_a_header_of_their_order_only() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        let other = "alpha_deg,w_lig,eta_a,eta_s,theta_deg\n80,18,-0.3,0.1,20\n";
        std::fs::write(&path, other).unwrap();
        let message = add_extra_rays(&path, &[ray(70.0)]).unwrap_err().to_string();
        assert!(message.contains("w_lig,alpha_deg,eta_a"), "{message}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), other);

        let header = "w_lig,alpha_deg,eta_a,eta_s,theta_deg";
        for before in ["# of a design", &format!("# of a design\n{header}\n")] {
            std::fs::write(&path, before).unwrap();
            add_extra_rays(&path, &[ray(70.0)]).unwrap();
            let text = std::fs::read_to_string(&path).unwrap();
            let lines: Vec<&str> = text.lines().collect();
            assert_eq!(lines[..2], ["# of a design", header], "{text}");
            assert_eq!(read_extra_rays(&path, &COMMON).unwrap().len(), 1, "{text}");
        }
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
