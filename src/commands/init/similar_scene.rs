//! A scene like another one, for a sheet of another thickness, size or material.

use crate::commands::init::cut_from::CutFrom;
use crate::ui::progress::Progress;
use anyhow::{Context, Result, bail, ensure};
use design::equilibrium::load_step::LoadStep;
use design::objective::target::TargetShape;
use design::scene::run_inputs::scene_file;
use design::scene::{Ratios, Scene, SceneConfig, rounded};
use hinge::SheetMaterial;
use std::path::{Path, PathBuf, absolute};

/// Maximum relative difference of the ratios of widths and of heights.
const SAME_SHAPE: f64 = 0.01;
/// Powers of two between which the factor of the loads is looked for, and the number of times that they are halved.
const POWERS: [f64; 2] = [-6.0, 6.0];
const HALVINGS: usize = 10;

/// The scene that another one is like, and its file.
pub(super) struct Like {
    pub(super) scene: Scene,
    file: PathBuf,
}

impl Like {
    /// The scene of a file or of a run folder.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let file = scene_file(path)?;
        let scene = Scene::read(&file)?;
        Ok(Self { scene, file })
    }

    /// A path that the scene names.
    pub(super) fn beside(&self, path: &Path) -> PathBuf {
        self.file.parent().unwrap_or(Path::new("")).join(path)
    }

    /// The weights of its hinge law.
    pub(super) fn weights(&self) -> Option<PathBuf> {
        let learned = self.scene.config.surrogate.as_ref();
        learned.map(|learned| self.beside(&learned.weights))
    }
}

/// A scene for a new sheet, and the scene that it is like.
pub(super) struct SimilarScene {
    original: Scene,
    config: SceneConfig,
    /// Whether the sheet is that of the original.
    same_sheet: bool,
    /// The weights of the original.
    weights: Option<PathBuf>,
}

impl SimilarScene {
    /// The scene `like` for a sheet of `material`, in its thickness. The width and height (mm) are by default those of
    /// the original in proportion to the thickness, or those of the largest sheet of its shape that is cut from a stock.
    pub(super) fn new(
        like: Like,
        material: &SheetMaterial,
        size: Option<[f64; 2]>,
        cut_from: Option<CutFrom>,
    ) -> Result<Self> {
        let original = &like.scene;
        let mut config = original.config.clone();
        if let Some(cut_from) = cut_from {
            config.cutting = cut_from.set(config.cutting);
        }
        let thickness = material.thickness / original.material.thickness;
        let ratios = Ratios {
            thickness,
            size: match (size, cut_from) {
                (Some(size), _) => proportion(&config, size)?,
                (None, Some(cut_from)) => largest(&config, cut_from)?,
                (None, None) => thickness,
            },
            young: material.young / original.material.young,
        };
        ratios.apply(&mut config);
        match &mut config.target {
            TargetShape::Csv { .. } if ratios.size != 1.0 => bail!(
                "the target of {} is a table of points, which is not scaled: scale its file and name it in the new scene, \
                 or use a target.svg",
                like.file.display()
            ),
            TargetShape::Csv { file } | TargetShape::Svg { file, .. } => {
                *file = absolute(like.beside(file))?;
            }
            _ => {}
        }
        config.title = format!("Like: {}", config.title);
        config.thickness = Some(material.thickness);
        config.output = "design".into();
        if let Some(learned) = &mut config.surrogate {
            for file in learned.ensemble.iter_mut().chain(&mut learned.springback) {
                *file = absolute(like.beside(file))?;
            }
        }
        Ok(Self {
            same_sheet: ratios.size == 1.0 && *material == original.material,
            weights: like.weights().map(absolute).transpose()?,
            original: like.scene,
            config,
        })
    }

    /// The scene file, in a folder with `material.toml`. With weights for `material`, the loads are those at which the
    /// hinges of the new start rotate as those of the original one.
    pub(super) fn text(mut self, weights: &Path, material: Option<&Path>) -> Result<String> {
        // A law without weights is the same with any.
        let same_law = self.weights.as_deref().is_none_or(|own| own == weights);
        if let Some(learned) = &mut self.config.surrogate {
            learned.weights = weights.to_owned();
            if !same_law {
                learned.ensemble.clear();
                learned.springback = None;
            }
        }
        if let Some(material) = material {
            self.config.material = absolute(material)?;
            if !(self.same_sheet && same_law) {
                self.fit_loads()?;
            }
        }
        self.config.material = "material.toml".into();
        let text = self
            .config
            .to_toml()
            .context("cannot write the scene as TOML")?;
        Ok(format!(
            "# A scene like another one, written by `kirigami init`.\n\
             # Lengths in mm, forces in N, couples in N mm; paths are relative to this file.\n\n{text}"
        ))
    }

    /// Multiplies the loads by the factor at which the root mean square of the rotations at full load is that of the
    /// original scene. Loads of which only the stroke counts are left as they are.
    fn fit_loads(&mut self) -> Result<()> {
        if !self.config.has_loads()
            || self.config.drive.is_some()
            || !self.original.hinge.carries_load()
        {
            return Ok(());
        }
        let Some(meant) = rotation(&self.original)?.filter(|meant| *meant > 0.0) else {
            return Ok(());
        };
        let bar = Progress::new(HALVINGS, "equilibria");
        let [mut low, mut high] = POWERS;
        for done in 0..HALVINGS {
            bar.show(done, None, "first load");
            let middle = 0.5 * (low + high);
            match self.rotation_at(middle.exp2())? {
                Some(found) if found < meant => low = middle,
                _ => high = middle,
            }
        }
        bar.finish();
        ensure!(
            low > POWERS[0] && high < POWERS[1],
            "no load between 1/64 and 64 times the scaled one opens the new sheet as far as that of --like: choose another \
             --size, or another scene"
        );
        self.config.scale_loads((0.5 * (low + high)).exp2());
        for load in &mut self.config.loads {
            load.force = load.force.map(rounded);
            load.couple = rounded(load.couple);
        }
        Ok(())
    }

    /// The rotation under the loads times `factor`.
    fn rotation_at(&self, factor: f64) -> Result<Option<f64>> {
        let mut config = self.config.clone();
        config.scale_loads(factor);
        rotation(&Scene::new(config, &absolute("scene.toml")?)?)
    }
}

/// The opening of the start at full load (rad); `None` if that is not reached.
fn rotation(scene: &Scene) -> Result<Option<f64>> {
    let deployment = scene.problem()?.deploy(&scene.start())?;
    Ok(deployment.at_full_load().ok().map(LoadStep::opening))
}

/// Width and height of the sheet of a scene (mm); an error if it is no rectangle.
fn sides(config: &SceneConfig) -> Result<[f64; 2]> {
    config.sheet.size.context(
        "the sheet of --like is no rectangle: leave out --size and --stock, and it is in proportion to the thickness",
    )
}

/// Ratio of the largest sheet of the same shape that is cut from a stock, in either orientation, to the sheet of a scene.
fn largest(config: &SceneConfig, cut_from: CutFrom) -> Result<f64> {
    let [width, height] = sides(config)?;
    let [across, along] = cut_from.largest_sheet(config.cutting.over_run, config.process.kerf)?;
    let upright = f64::min(across / width, along / height);
    Ok(upright.max(f64::min(along / width, across / height)))
}

/// Ratio of the sizes of two rectangles of one shape.
fn proportion(config: &SceneConfig, size: [f64; 2]) -> Result<f64> {
    let sides = sides(config)?;
    let [across, along] = [size[0] / sides[0], size[1] / sides[1]];
    ensure!(
        (across / along - 1.0).abs() <= SAME_SHAPE,
        "--size {}x{} has another ratio of width to height than the sheet of --like, which is {} x {} mm: use {}x{:.1}",
        size[0],
        size[1],
        sides[0],
        sides[1],
        size[0],
        across * sides[1]
    );
    Ok(across)
}
