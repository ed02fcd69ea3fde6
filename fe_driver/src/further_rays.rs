//! Rays that a campaign solves besides those of its box: where designs went and the data did not.
//!
//! A CSV file with the columns `w_lig` (mm), `alpha_deg`, `eta_a`, `eta_s`, `theta_deg`, one ray a
//! row, named by the campaign's key `further_rays`; lines that start with `#` are comments.

use crate::ray::Ray;
use crate::sampling::CommonDesign;
use hinge::HingeDeformation;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

/// A file that is no list of rays, or cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum FurtherRaysError {
    #[error("{path}: {source}", path = .path.display())]
    Csv { path: PathBuf, source: csv::Error },
    #[error("{path}, ray {row}: {reason}", path = .path.display())]
    Ray {
        path: PathBuf,
        row: usize,
        reason: String,
    },
    #[error("cannot write {path}: {source}", path = .path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// One row of the file: a hinge and where its ray ends.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    w_lig: f64,
    alpha_deg: f64,
    eta_a: f64,
    eta_s: f64,
    theta_deg: f64,
}

/// Reads the rays of hinges that have `common` in common.
pub fn read_further_rays(path: &Path, common: &CommonDesign) -> Result<Vec<Ray>, FurtherRaysError> {
    let mut rays = Vec::new();
    for row in read_rows(path)? {
        let ray = row.ray(common);
        if let Some(reason) = row.defect(&ray) {
            return Err(FurtherRaysError::Ray {
                path: path.to_owned(),
                row: rays.len() + 1,
                reason,
            });
        }
        rays.push(ray);
    }
    Ok(rays)
}

/// Adds rays to the file, which is made if it is not there; rays with a cut angle over 90 degrees
/// are mirrored. Returns how many were not in it.
pub fn add_further_rays(path: &Path, rays: &[Ray]) -> Result<usize, FurtherRaysError> {
    let mut rows = match path.exists() {
        true => read_rows(path)?,
        false => Vec::new(),
    };
    let before = rows.len();
    for row in rays.iter().map(Row::of) {
        if !rows.contains(&row) {
            rows.push(row);
        }
    }
    let unwritable = |source| FurtherRaysError::Csv {
        path: path.to_owned(),
        source,
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in &rows {
        writer.serialize(row).map_err(unwritable)?;
    }
    let bytes = writer.into_inner().unwrap_or_default();
    hinge::files::write(path, &bytes).map_err(|source| FurtherRaysError::Write {
        path: path.to_owned(),
        source,
    })?;
    Ok(rows.len() - before)
}

fn read_rows(path: &Path) -> Result<Vec<Row>, FurtherRaysError> {
    let rows = || -> Result<Vec<Row>, csv::Error> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_path(path)?;
        reader.deserialize().collect()
    };
    rows().map_err(|source| FurtherRaysError::Csv {
        path: path.to_owned(),
        source,
    })
}

impl Row {
    /// Four digits are enough to say where to go, and make the file fit to be read.
    fn of(ray: &Ray) -> Self {
        let ray = match ray.design.alpha > FRAC_PI_2 {
            true => ray.mirrored(),
            false => *ray,
        };
        let [eta_a, eta_s] = ray.end.eta(ray.design.w_lig);
        let round = |x: f64| (1e4 * x).round() / 1e4;
        Self {
            w_lig: round(ray.design.w_lig),
            alpha_deg: round(ray.design.alpha.to_degrees()),
            eta_a: round(eta_a),
            eta_s: round(eta_s),
            theta_deg: round(ray.end.theta.to_degrees()),
        }
    }

    fn ray(&self, common: &CommonDesign) -> Ray {
        let theta = self.theta_deg.to_radians();
        Ray {
            design: common.hinge(self.w_lig, self.alpha_deg.to_radians()),
            end: HingeDeformation::from_eta(self.eta_a, self.eta_s, theta, self.w_lig),
        }
    }

    /// What is wrong with the ray, if anything.
    fn defect(&self, ray: &Ray) -> Option<String> {
        let end = [self.eta_a, self.eta_s, self.theta_deg];
        if !end.iter().all(|x| x.is_finite()) {
            return Some("a number is not finite".to_owned());
        }
        if end == [0.0; 3] {
            return Some("it ends where it begins".to_owned());
        }
        if !(-1.0 < self.eta_a && self.eta_a < 1.0 && self.eta_s.abs() < 1.0) {
            return Some("violates |eta_a| < 1, |eta_s| < 1 (over w_lig, not mm)".to_owned());
        }
        ray.design.validate().err().map(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMMON: CommonDesign = CommonDesign {
        fillet_ratio: 0.16,
        kerf: 0.2,
        r_win: 100.0,
    };

    fn ray(alpha_deg: f64) -> Ray {
        Ray {
            design: COMMON.hinge(17.123_456, f64::to_radians(alpha_deg)),
            end: HingeDeformation::from_eta(-0.3, 0.1, 0.5, 17.123_456),
        }
    }

    #[test]
    fn rays_are_added_once_mirrored_and_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        assert_eq!(
            add_further_rays(&path, &[ray(80.0), ray(100.0)]).unwrap(),
            2
        );
        assert_eq!(add_further_rays(&path, &[ray(80.0), ray(70.0)]).unwrap(), 1);
        let rays = read_further_rays(&path, &COMMON).unwrap();
        assert_eq!(rays.len(), 3);
        assert!((rays[0].design.w_lig - 17.1235).abs() < 1e-12);
        assert!((rays[1].design.alpha.to_degrees() - 80.0).abs() < 1e-9);
        assert!((rays[1].end.s + rays[0].end.s).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_ray_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rays.csv");
        let header = "w_lig,alpha_deg,eta_a,eta_s,theta_deg";
        for (text, expected) in [
            ("w_lig,alpha\n1,2\n".to_owned(), "unknown field"),
            (format!("{header}\n18,90,-5.4,0,20\n"), "|eta_a| < 1"),
            (
                format!("{header}\n18,90,0,0,20\n18,90,0,0,0\n"),
                "ray 2: it ends where",
            ),
            (format!("{header}\n60,90,0,0,20\n"), "r_win"),
            (format!("{header}\n18,90,0,x,20\n"), "rays.csv"),
        ] {
            std::fs::write(&path, text).unwrap();
            let message = read_further_rays(&path, &COMMON).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
