//! The scene of a calibrated sheet, with the files that it reads: designs of it are for the thickness, the kerf and the stresses of the
//! sheet that was measured.
//!
//! | file | contents |
//! |---|---|
//! | `scene.toml` | the keys of the scene with the thickness and the kerf that were found; its paths name the files below |
//! | `sheet/material.toml` | the material with the stresses that were found |
//! | `sheet/target.csv`, `.svg` | the target, if the scene names a file |
//! | `sheet/weights-N.safetensors`, `.json` | the weights and their ensemble, from 0, with energies in proportion to the stresses |

use crate::scene::Scene;
use crate::scene::run_inputs::{SCENE_FILE, read, toml, write_to};
use crate::sheet::deviation::Deviation;
use std::path::{Path, PathBuf};
use support::file_error::FileError;
use support::whole_file;
use surrogate::{Surrogate, WeightsError};

const FOLDER: &str = "sheet";

/// Why the scene of a calibrated sheet cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum CalibratedSceneError {
    #[error("cannot use {0}")]
    File(#[from] FileError),
    #[error(transparent)]
    Weights(#[from] WeightsError),
}

/// Writes the scene of a calibrated sheet to a folder: `comment` is its head, and that of its material. Returns its path.
pub fn write_calibrated(
    scene: &Scene,
    sheet: &Deviation,
    folder: &Path,
    comment: &str,
) -> Result<PathBuf, CalibratedSceneError> {
    let inputs = folder.join(FOLDER);
    whole_file::create_folder(&inputs).map_err(FileError::at(&inputs))?;
    let mut config = scene.config.without_unread_weights();
    let thickness = scene.material.thickness + sheet.thickness;
    config.process.r_win *= thickness / scene.material.thickness;
    config.process.kerf += sheet.kerf;
    config.thickness = Some(thickness);
    config.output = "run".into();
    let material = scene.measured.stressed(1.0 + sheet.stress);
    let material_file = format!("{FOLDER}/material.toml");
    let commented = |toml: Vec<u8>| [comment.as_bytes(), &toml].concat();
    write_to(folder, &material_file, &commented(toml(&material, folder)?))?;
    config.material = material_file.into();
    if let Some((file, kind)) = config.target.file_mut() {
        let name = format!("{FOLDER}/target.{kind}");
        write_to(folder, &name, &read(&scene.file(file))?)?;
        *file = name.into();
    }
    for (i, weights) in config.weights_files_mut().into_iter().enumerate() {
        let name = format!("{FOLDER}/weights-{i}.safetensors");
        let trained = Surrogate::load(&scene.file(weights))?;
        let own = trained.stressed(1.0 + sheet.stress, Some(&material));
        own.save(&folder.join(&name))?;
        *weights = name.into();
    }
    if let Some(learned) = &mut config.surrogate {
        // That law is for the stresses of the scene's material.
        learned.springback = None;
    }
    write_to(folder, SCENE_FILE, &commented(toml(&config, folder)?))?;
    Ok(folder.join(SCENE_FILE))
}
