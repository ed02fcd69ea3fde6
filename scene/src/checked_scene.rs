//! A scene that was read and checked, together with the files that it names.

use crate::{
    checks,
    keys::{SceneConfig, folder, resolved},
    level::Level,
    loaded_hinge::LoadedHinge,
    posture::PostureConfig,
    solved_hinges::SolvedHinges,
    springback_file,
    target::{TARGET_POINTS, Target},
};
use design::sheet::{cut_sheet::SheetOptions, topology::Topology};
use hinge::SheetMaterial;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use support::{Fault, Joined, at, relative_path};
use surrogate::{Springback, Surrogate};

/// Version of geometry, mechanics and objective: raised when a change of the code changes the loss
/// of a design, so that a run of an earlier version is not continued.
///
/// 1: O stands half a slit further from the line of the secondary cut. 2: the path is followed in
/// increments of its own, so that a sheet that jumps may end on another branch. 3: where it cannot
/// be followed, it goes on from a minimum that does not depend on the load steps. 4: a hanging
/// sheet has weight; supports and loads act at their points.
const MODEL_VERSION: u32 = 4;

/// What the parts of [`Scene::model_hash`] identify, in their order.
pub(super) const MODEL_PARTS: [&str; 4] = ["version of kirigami", "material", "target", "weights"];

/// What is said of a target with holes whose sheet has all cells.
pub const FILLS_HOLES: &str =
    "a sheet without `cells` fills its holes: `kirigami init --target` writes one with them";

/// A scene with checked values, its material and its sampled target.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The keys of the scene file.
    pub config: SceneConfig,
    /// The panels and hinges of the sheet.
    pub topology: Arc<Topology>,
    /// The material of the sheet, in its thickness.
    pub material: SheetMaterial,
    /// The material in the thickness of its file, at which learned laws were trained.
    pub(crate) measured: SheetMaterial,
    /// The target outline.
    pub target: Target,
    /// The hinge law, with the files that it reads.
    pub hinge: LoadedHinge,
    /// The law of released hinges.
    pub springback: Option<Springback>,
    pub(super) path: PathBuf,
}

impl Scene {
    /// Reads a scene and the files that it names, and checks all values.
    pub fn read(path: &Path) -> Result<Self, Fault> {
        Self::new(support::toml_file::read(path)?, path)
    }

    /// Reads the material, the target and the weights of a scene whose paths are relative to the
    /// file at `path`, and checks all values.
    pub fn new(config: SceneConfig, path: &Path) -> Result<Self, Fault> {
        Self::with_networks(config, path, None)
    }

    /// The scene with other keys, in the same place. Its weights are read again only if the keys
    /// that say how they are read changed.
    pub fn changed(&self, config: SceneConfig) -> Result<Self, Fault> {
        let reads = |config: &SceneConfig| {
            let process = config.process;
            (
                (config.level, config.surrogate.clone(), config.material.clone()),
                (config.thickness, config.ligament.range, process),
            )
        };
        let same = reads(&config) == reads(&self.config);
        let known = same.then_some(&*self.hinge.networks);
        Self::with_networks(config, &self.path, known)
    }

    fn with_networks(
        config: SceneConfig,
        path: &Path,
        known: Option<&[Surrogate]>,
    ) -> Result<Self, Fault> {
        let place = &path.display();
        let checked = checks::keys(&config).and_then(|()| {
            let topology = config.topology()?;
            checks::config(&config, &topology).map(|()| topology)
        });
        let topology = checked.map_err(at(place))?;
        let measured = SheetMaterial::load(&resolved(path, &config.material))?;
        let material = SheetMaterial {
            thickness: config.thickness.unwrap_or(measured.thickness),
            ..measured.clone()
        };
        material.validate().map_err(at(place))?;
        let target = Target::sample(&config.target, folder(path), TARGET_POINTS);
        let mut target = target.map_err(at(place))?;
        if !target.holes.is_empty() && config.cells.is_none() {
            target.notes.push(FILLS_HOLES.to_owned());
        }
        checks::target(&target, &config).map_err(at(place))?;
        let hinge = LoadedHinge::load(&config, &topology, &measured, path, known)?;
        let springback = springback_file::load(&config, &measured, path).map_err(at(place))?;
        let path = path.to_owned();
        Ok(Self { config, topology, material, measured, target, hinge, springback, path })
    }

    /// The learned hinge law, if the scene uses one.
    pub fn surrogate(&self) -> Option<&Surrogate> {
        self.networks().first()
    }

    /// The learned hinge law and the other networks of its ensemble; empty if the scene uses none.
    pub fn networks(&self) -> &[Surrogate] {
        self.hinge.predictors()
    }

    /// The keys of the scene for a file in another folder: its paths are absolute.
    pub fn located(&self) -> std::io::Result<SceneConfig> {
        self.config.clone().with_paths(|path| self.absolute(path))
    }

    /// The scene for another folder: its paths are relative to this folder.
    pub fn moved_to(&self, folder: &Path) -> std::io::Result<SceneConfig> {
        let moved = |path: &Path| relative_path::from_folder(folder, &self.file(path));
        self.config.clone().with_paths(moved)
    }

    /// The absolute path of a file that the scene names.
    fn absolute(&self, path: &Path) -> std::io::Result<PathBuf> {
        let file = self.file(path);
        (file.canonicalize()).or_else(|_| std::path::absolute(&file))
    }

    /// A path that the scene names.
    pub(crate) fn file(&self, path: &Path) -> PathBuf {
        resolved(&self.path, path)
    }

    /// Thickness of the sheet over the thickness of the material file, at which learned laws were
    /// trained.
    pub fn scale(&self) -> f64 {
        self.config.scale(&self.measured)
    }

    /// The weights of the learned law.
    pub fn weights(&self) -> Option<&Surrogate> {
        self.hinge.networks.first()
    }

    /// BLAKE3 hash of the keys of the scene without title and paths: neither the title nor the
    /// place of a file changes a design.
    pub fn hash(&self) -> String {
        let keys = SceneConfig { title: String::new(), ..self.config.without_paths() };
        let keys = serde_json::to_vec(&keys).expect("a run writes the same keys to its state");
        blake3::hash(&keys).to_hex().to_string()
    }

    /// Identifies what a run depends on besides the keys of the scene: the version of the model,
    /// the material law, the target's points and the weights. It is the same on every machine,
    /// whereas the loss differs in its last digits.
    pub fn model_hash(&self) -> String {
        let read = match self.config.level {
            Level::Fine => usize::MAX,
            _ => 1,
        };
        let weights = self.hinge.networks.iter().take(read);
        let weights = weights.map(Surrogate::hash);
        let solved = self.hinge.solved.iter().map(SolvedHinges::hash);
        let weights = weights.chain(solved).joined("/");
        let target = self.target.hash();
        let material = if self.weight_by_area() == [0.0; 2] {
            self.material.law_hash()
        } else {
            format!("{}/{}", self.material.law_hash(), self.material.density_kg_m3)
        };
        format!("{MODEL_VERSION}-{material}-{target}-{weights}")
    }

    /// The weight of a unit of area in the plane of the sheet (N/mm^2); zero unless it hangs and
    /// its weight is modelled.
    pub fn weight_by_area(&self) -> [f64; 2] {
        let posture = self.config.posture.filter(PostureConfig::is_heavy);
        let down = posture.and_then(|posture| posture.down());
        let weight = self.material.weight_by_area();
        down.map_or([0.0; 2], |down| down.map(|component| weight * component))
    }

    /// The options that turn a pattern into the sheet of this scene.
    pub fn sheet_options(&self) -> SheetOptions {
        SheetOptions { hinge_point: self.hinge.hinge_point, process: self.config.process }
    }

    /// The run folder.
    pub fn output(&self) -> PathBuf {
        resolved(&self.path, &self.config.output)
    }
}
