//! `kirigami campaign extend`: new rays for hinge states that the training data does not cover.

use crate::commands::inspect::scene_args::Inspected;
use crate::ui::count::count;
use anyhow::{Context, Result, ensure};
use clap::Args;
use fe_driver::{Added, Ray, add_extra_rays};
use std::path::PathBuf;
use surrogate::Surrogate;
use verification::{
    RecordedPath, doubtful_states, ensemble, rays_on_paths, rays_through, recorded_paths,
};

/// Add rays to a campaign where a design leaves the training domain or the ensemble disagrees
///
/// A hinge is selected if a state on its path lies outside the training domain, or if the forces of
/// an ensemble (train --seeds) deviate there by more than --doubt. A ray is then added through the
/// outermost such state, ending 10 % beyond it. With --anywhere, rays are added through random states of the whole
/// training domain instead, where energies, forces or D of the ensemble deviate most. The rays are appended to a CSV
/// file, which a campaign names as extra_rays. Example: kirigami campaign extend configs/scenes/pet-3x3.toml --design
/// runs/pet-3x3/state.json --rays configs/campaigns/pet-0.5mm-rays.csv
#[derive(Args)]
pub struct ExtendCommand {
    #[command(flatten)]
    inspected: Inspected,
    /// Weights of further networks trained on the same data [default: the ensemble of the scene, none with --weights]
    #[arg(long, value_name = "FILE", num_args = 1..)]
    ensemble: Vec<PathBuf>,
    /// Maximum standard deviation of the ensemble: of its forces, relative to their root mean square; with --anywhere also of
    /// D, likewise, and of its energies, relative to their mean or to a hundredth of the median energy
    #[arg(long, value_name = "FRACTION", default_value_t = 0.05)]
    doubt: f64,
    /// Add at most N rays through states of the training domain, without a design
    #[arg(long, value_name = "N", conflicts_with = "design", value_parser = count::<usize>)]
    anywhere: Option<usize>,
    /// CSV file to append the rays to
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
}

/// Length of a new ray, relative to the state that it passes through.
const BEYOND: f64 = 1.1;

impl ExtendCommand {
    pub fn run(&self) -> Result<()> {
        ensure!(self.doubt >= 0.0, "--doubt must not be negative");
        let (scene, design, _) = self.inspected.read()?;
        let surrogate = scene.surrogate().context(
            "only the data of a surrogate can be extended: set hinge = \"surrogate\" in the scene",
        )?;
        let mut networks = vec![surrogate.clone()];
        networks.extend(ensemble(&scene, surrogate, &self.ensemble)?);
        let (rays, found) = match self.anywhere {
            Some(count) => self.in_the_domain(count, &networks)?,
            None => self.on_paths(&recorded_paths(&scene, &design)?, &networks)?,
        };
        // The campaign solves sheets of the thickness of the material file.
        let of_the_file = |ray: Ray| Ray {
            design: ray.design.scaled(scene.scale().recip()),
            end: ray.end.scaled(scene.scale().recip()),
        };
        let rays: Vec<Ray> = rays.into_iter().map(of_the_file).collect();
        let Added {
            added,
            known,
            refused,
        } = add_extra_rays(&self.rays, &rays)?;
        println!(
            "{found}\n{added} rays added to {}, {known} already in the file, {refused} rejected (beyond |eta| = 1 or -30 to \
             120 deg)\nTo solve the new rays, set extra_rays = \"FILE\" in a campaign (path relative to the campaign file).",
            self.rays.display()
        );
        Ok(())
    }

    /// Rays of the hinges of a sheet, and what was found.
    fn on_paths(
        &self,
        paths: &[RecordedPath],
        networks: &[Surrogate],
    ) -> Result<(Vec<Ray>, String)> {
        ensure!(!paths.is_empty(), "the sheet has no hinges");
        let found = rays_on_paths(paths, networks, self.doubt, BEYOND);
        let text = format!(
            "of {} hinges {} leave the training domain and {} exceed --doubt",
            paths.len(),
            found.outside,
            found.doubted
        );
        Ok((found.rays, text))
    }

    /// Rays through states of the training domain, and what was found.
    fn in_the_domain(&self, count: usize, networks: &[Surrogate]) -> Result<(Vec<Ray>, String)> {
        ensure!(
            networks.len() > 1,
            "--anywhere needs an ensemble: pass further networks with --ensemble, or name them in the scene"
        );
        let states = doubtful_states(networks);
        let doubted = states.iter().filter(|state| state.doubt() > self.doubt);
        let rays = rays_through(doubted, networks[0].domain(), count, BEYOND);
        let mut found = format!(
            "{} networks deviate by more than {:.3} in these parts of the training domain:",
            networks.len(),
            self.doubt
        );
        for (i, quantity) in ["energies", "forces", "D"].into_iter().enumerate() {
            let doubts = || states.iter().map(|state| state.doubts[i]);
            let share = doubts().filter(|doubt| *doubt > self.doubt).count() as f64;
            let percent = 100.0 * share / states.len() as f64;
            let most = doubts().fold(0.0, f64::max);
            found += &format!("\n{quantity:8}  {percent:7.3} %, by {most:.2} at most");
        }
        Ok((rays, found))
    }
}
