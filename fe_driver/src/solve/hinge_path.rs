//! One hinge design with the path along which its window is driven.

use crate::DeformationPath;
use hinge::{HingeDeformation, HingeDesign, Regime};
use serde::{Deserialize, Serialize};

/// One design driven from the undeformed state to `end`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ray {
    /// The hinge design.
    pub design: HingeDesign,
    /// The deformation at lambda = 1.
    pub end: HingeDeformation,
}

impl Ray {
    /// The ray with its path: see [`DeformationPath::ray`].
    pub fn driven(self, regime: Regime) -> HingePath {
        let Self { design, end } = self;
        let path = DeformationPath::ray(end, regime, design.w_lig);
        HingePath { design, path }
    }

    /// The ray of the mirrored design; see [`HingeDeformation::mirrored`].
    pub fn mirrored(&self) -> Self {
        Self { design: self.design.mirrored(), end: self.end.mirrored() }
    }
}

/// One design driven along a path. In a file, a straight path is its `end` alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "InFile", into = "InFile")]
pub struct HingePath {
    /// The hinge design.
    pub design: HingeDesign,
    /// The path of its deformation.
    pub path: DeformationPath,
}

/// A hinge with its path in a file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum InFile {
    Ray(Ray),
    Path { design: HingeDesign, path: DeformationPath },
}

impl From<InFile> for HingePath {
    fn from(file: InFile) -> Self {
        match file {
            InFile::Ray(ray) => ray.driven(Regime::Film),
            InFile::Path { design, path } => Self { design, path },
        }
    }
}

impl From<HingePath> for InFile {
    fn from(HingePath { design, path }: HingePath) -> Self {
        let end = path.at(1.0);
        if path == DeformationPath::straight(end) {
            Self::Ray(Ray { design, end })
        } else {
            Self::Path { design, path }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeConstants;

    #[test]
    fn a_path_is_read_back_and_a_straight_one_is_written_as_its_end() {
        let design = HingeConstants::PAPER.hinge(18.0, 1.5);
        let [middle, end] =
            [0.2, 0.6].map(|theta| HingeDeformation::from_eta(-0.1, 0.3 * theta, theta, 18.0));
        let ray = Ray { design, end }.driven(Regime::Film);
        let bent =
            HingePath { path: DeformationPath::through(&[middle, end]).unwrap(), ..ray.clone() };
        let text = serde_json::to_string(&ray).unwrap();
        assert_eq!(text, serde_json::to_string(&Ray { design, end }).unwrap());
        for hinge in [ray, bent] {
            let text = serde_json::to_string(&hinge).unwrap();
            assert_eq!(serde_json::from_str::<HingePath>(&text).unwrap(), hinge);
        }
        let empty = text.split("\"end\"").next().unwrap().to_owned() + "\"path\":[]}";
        assert!(serde_json::from_str::<HingePath>(&empty).is_err());
    }
}
