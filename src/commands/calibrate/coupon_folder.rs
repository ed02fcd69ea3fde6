//! The folder of a coupon: the scenes of its specimens, and the file that lists them.

use anyhow::{Context, Error, Result, ensure};
use design::scene::Scene;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use support::regular_file;

/// The file that lists the specimens.
const FILE: &str = "coupon.json";
/// The table of the readings, which is filled in.
pub(super) const READINGS: &str = "readings.csv";

/// What a coupon is of.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Contents {
    /// The scene of the sheet that is cut from the same plate.
    scene: PathBuf,
    /// The names of the specimens; the scene of each is `NAME.toml`.
    specimens: Vec<String>,
}

/// A coupon that was written.
pub(super) struct CouponFolder {
    /// The sheet that is cut from the same plate.
    pub scene: Scene,
    /// The names of the specimens.
    pub names: Vec<String>,
    folder: PathBuf,
}

/// The text of the file of a coupon for the scene at a path.
pub(super) fn contents(scene: &Path, specimens: Vec<String>) -> Result<(&'static str, String)> {
    let scene = std::path::absolute(scene)?;
    let text = serde_json::to_string_pretty(&Contents { scene, specimens })?;
    Ok((FILE, text))
}

/// Whether a path is the folder of a coupon.
pub(super) fn is_coupon(path: &Path) -> bool {
    path.join(FILE).is_file()
}

impl CouponFolder {
    pub fn read(folder: &Path) -> Result<Self> {
        let file = folder.join(FILE);
        let text = regular_file::read_to_string(&file);
        let contents: Contents = (text.map_err(Error::from))
            .and_then(|text| Ok(serde_json::from_str(&text)?))
            .with_context(|| format!("{} is not the list of a coupon", file.display()))?;
        Ok(Self {
            scene: Scene::read(&contents.scene)
                .with_context(|| format!("the coupon in {}", folder.display()))?,
            names: contents.specimens,
            folder: folder.to_owned(),
        })
    }

    /// The table of its readings.
    pub fn readings(&self) -> PathBuf {
        self.folder.join(READINGS)
    }

    /// The scene of a specimen; an error if it is for another sheet than the scene of the coupon is now.
    pub fn specimen(&self, name: &str) -> Result<Scene> {
        let scene = Scene::read(&self.folder.join(format!("{name}.toml")))?;
        let of = |scene: &Scene| {
            (
                scene.material.law_hash(),
                scene.config.process,
                scene.weights().map(|weights| weights.hash()),
            )
        };
        ensure!(
            of(&scene) == of(&self.scene),
            "material, thickness, [process] or weights of the scene have changed since the coupon in {} was written: change them back; \
             what you measured by itself is said with --known",
            self.folder.display()
        );
        Ok(scene)
    }
}
