//! `kirigami campaign extend`: new rays for hinge states that the training data does not cover.

use crate::commands::inspect::scene_args::Inspected;
use anyhow::{Context, Result, ensure};
use clap::Args;
use fe_driver::{Added, Ray, add_extra_rays};
use std::path::PathBuf;
use verification::{rays_on_paths, recorded_paths};

/// Add rays to a campaign where a design leaves the training domain
///
/// A ray is added for each hinge with a state outside of the training domain on its path, through
/// the outermost such state, ending 10 % beyond it. The rays are appended to a CSV file, which a
/// campaign names as extra_rays. Example: kirigami campaign extend runs/pet-3x3 --rays
/// configs/campaigns/pet-0.5mm-rays.csv
#[derive(Args)]
pub struct ExtendCommand {
    #[command(flatten)]
    inspected: Inspected,
    /// CSV file to append the rays to
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
}

/// Length of a new ray, relative to the state that it passes through.
const BEYOND: f64 = 1.1;

impl ExtendCommand {
    pub fn run(&self) -> Result<()> {
        let (scene, design, _) = self.inspected.read()?;
        let surrogate = scene.surrogate().context(
            "only the data of a surrogate can be extended: set level = \"standard\" in the scene",
        )?;
        let paths = recorded_paths(&scene, &design)?;
        ensure!(!paths.is_empty(), "the sheet has no hinges");
        let rays = rays_on_paths(&paths, surrogate.domain(), BEYOND);
        // The campaign solves sheets of the thickness of the material file.
        let of_the_file = |ray: &Ray| Ray {
            design: ray.design.scaled(scene.scale().recip()),
            end: ray.end.scaled(scene.scale().recip()),
        };
        let rays: Vec<Ray> = rays.iter().map(of_the_file).collect();
        let Added { added, known, refused } = add_extra_rays(&self.rays, &rays)?;
        println!(
            "{} of {} hinges leave the training domain\n{added} rays added to {}, {known} already in the file, {refused} \
             rejected (beyond |eta| = 1 or -30 to 120 deg)\nTo solve the new rays, set extra_rays = \"FILE\" in a campaign (path \
             relative to the campaign file).",
            rays.len(),
            paths.len(),
            self.rays.display()
        );
        Ok(())
    }
}
