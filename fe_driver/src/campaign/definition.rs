//! The definition of a campaign: a material, a mesh tier and a box of rays, from which the list of jobs follows.

use crate::campaign::extra_rays::{ExtraRaysError, read_extra_rays};
use crate::campaign::sampling::RayBox;
use crate::solve::attempts::SolveListError;
use crate::solve::hinge_path::Ray;
use crate::solve::tool_versions::ToolVersions;
use crate::solve::window_solve::{WindowProblem, WindowSolve};
use hinge::{HingeConstants, InvalidDesign, MaterialError, Regime, SheetMaterial};
use mesher::Tier;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::time::Duration;
use support::file_error::FileError;
use support::toml_file::{self, ConfigError};

/// A campaign with its material, from a TOML file of `configs/campaigns/`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// Name of the campaign; it is stored in the results folder.
    pub name: String,
    /// TOML file of the material, relative to this file.
    #[serde(rename = "material")]
    material_file: PathBuf,
    /// The sheet material.
    #[serde(skip)]
    pub material: SheetMaterial,
    /// Mesh of the windows.
    pub tier: Tier,
    /// Number of rays of the box, 1 to 1 000 000, or 0 if `extra_rays` is given.
    pub count: usize,
    /// Seed of the rays; a larger campaign with the same seed begins with the smaller one.
    pub seed: u64,
    /// Time limit of one solve.
    #[serde(skip)]
    pub time_limit: Duration,
    /// CSV file of rays in addition to the sampled ones, relative to this file; written by `kirigami campaign extend`.
    extra_rays: Option<PathBuf>,
    /// Rays in addition to those of the box, solved after them.
    #[serde(skip)]
    pub further: Vec<Ray>,
    /// Constants of all hinges.
    pub design: HingeConstants,
    /// The region of designs and ray ends.
    pub rays: RayBox,
}

/// Why a campaign cannot be read, planned, run or collected.
#[derive(Debug, thiserror::Error)]
#[allow(
    missing_docs,
    reason = "the message of each variant is its documentation"
)]
pub enum CampaignError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("{path}: {reason}", path = .path.display())]
    Invalid { path: PathBuf, reason: String },
    #[error(transparent)]
    Material(#[from] MaterialError),
    #[error(transparent)]
    FurtherRays(#[from] ExtraRaysError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Solve(#[from] SolveListError),
    #[error(
        "{folder} contains the campaign `{found}`, not `{requested}`: choose another folder",
        folder = .folder.display()
    )]
    OtherCampaign {
        folder: PathBuf,
        found: String,
        requested: String,
    },
    #[error(
        "the campaign has changed since it was run in {folder} ({changes}): run it again first",
        folder = .folder.display()
    )]
    Changed { folder: PathBuf, changes: String },
    #[error("{0} contains no campaign: run a campaign there first")]
    NoCampaign(PathBuf),
    #[error("another run has locked {0}: wait until it ends, or stop it")]
    Locked(PathBuf),
    #[error(
        "{host} has {here}, but the campaign is solved with {known}: rows of different versions are not collected \
         together. Use the same versions on every host; or delete {index}, and all rays are solved again with the \
         versions of the next run (no file of a job is lost)",
        index = .index.display()
    )]
    OtherVersions {
        index: PathBuf,
        host: String,
        here: Box<ToolVersions>,
        known: Box<ToolVersions>,
    },
    #[error(
        "none of the jobs belongs to the campaign (the first is {0}): they were solved with other settings, \
         with another version of gmsh or ccx, or for another campaign"
    )]
    Foreign(String),
}

/// Maximum number of rays; a larger number is a typing error.
const MAX_COUNT: usize = 1_000_000;

impl Campaign {
    /// The first defect of the file; `None` if it is valid.
    fn defect(&self) -> Option<String> {
        if self.name.is_empty() || self.name.chars().any(char::is_control) {
            return Some("name is empty or holds a control character".to_owned());
        }
        let minimum = usize::from(self.extra_rays.is_none());
        if !(minimum..=MAX_COUNT).contains(&self.count) {
            let count = self.count;
            return Some(format!(
                "count = {count} violates {minimum} <= count <= {MAX_COUNT}"
            ));
        }
        self.rays.defect().or_else(|| {
            Some(format!(
                "a corner of the box is not a valid design: {}",
                self.impossible_design()?
            ))
        })
    }

    /// What is wrong if the tier is not for all ligaments of the box.
    fn other_regime(&self) -> Option<String> {
        let (regime, material) = (self.tier.regime(), &self.material);
        let other = |w_lig: &f64| material.regime(*w_lig) != regime;
        let w_lig = self.rays.w_lig.into_iter().find(other)?;
        let (tier, thickness) = (self.tier, material.thickness);
        let bound = Regime::WIDEST_PLATE * thickness;
        Some(format!(
            "tier = \"{tier}\" is for ligaments of a {regime}, but rays.w_lig contains {w_lig} mm: ligaments of up to \
             {bound} mm bend in the plane of a sheet of {thickness} mm (tier \"plate\"), wider ones buckle (tier \
             \"default\"), and no energy holds for both"
        ))
    }

    /// The defect of the narrowest or the widest hinge of the box, with the smallest hole; all others lie between them.
    fn impossible_design(&self) -> Option<InvalidDesign> {
        let smallest = self.rays.fillet_ratio.map(|[smallest, _]| smallest);
        let constants = HingeConstants {
            fillet_ratio: smallest.unwrap_or(self.design.fillet_ratio),
            ..self.design
        };
        self.rays.w_lig.into_iter().find_map(|w_lig| {
            let design = constants.hinge(w_lig, self.rays.alpha_deg[0].to_radians());
            design.validate().err()
        })
    }

    /// Reads a campaign, its material and its further rays.
    pub fn load(path: &Path) -> Result<Self, CampaignError> {
        let mut campaign: Self = toml_file::read(path)?;
        let invalid = |reason| CampaignError::Invalid {
            path: path.to_owned(),
            reason,
        };
        if let Some(reason) = campaign.defect() {
            return Err(invalid(reason));
        }
        let folder = path.parent().unwrap_or(Path::new(""));
        campaign.material = SheetMaterial::load(&folder.join(&campaign.material_file))?;
        campaign.time_limit = campaign.tier.time_limit();
        if let Some(reason) = campaign.other_regime() {
            return Err(invalid(reason));
        }
        if let Some(rays) = &campaign.extra_rays {
            campaign.further = read_extra_rays(&folder.join(rays), &campaign.design)?;
        }
        Ok(campaign)
    }

    /// Number of jobs.
    pub fn size(&self) -> usize {
        self.count + self.further.len()
    }

    /// The solves in the order in which they are run. Any prefix of them gives a usable database.
    pub fn solves(&self, tools: &ToolVersions) -> impl Iterator<Item = WindowSolve> {
        let boxed = self.rays.rays(&self.design, self.count, self.seed);
        let further = self.further.iter().copied();
        boxed.into_iter().chain(further).map(move |ray| {
            WindowSolve::new(WindowProblem::new(ray, &self.material, self.tier), tools)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::problem::Solve;

    fn shipped(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../configs/campaigns")
            .join(name)
    }

    fn versions() -> ToolVersions {
        ToolVersions {
            gmsh: "4.8.4".into(),
            ccx: "2.20".into(),
        }
    }

    #[test]
    fn the_shipped_campaigns_are_read() {
        for (name, count) in [
            ("demo.toml", 40),
            ("pet-0.5mm.toml", 1500),
            ("polypropylene-3mm.toml", 320),
            ("polypropylene-3mm-reference.toml", 18),
            ("petg-3mm.toml", 240),
            ("aluminium-2mm.toml", 160),
        ] {
            let campaign = Campaign::load(&shipped(name)).unwrap();
            let jobs: Vec<_> = campaign.solves(&versions()).collect();
            assert_eq!(jobs.len(), count);
            let mut ids: Vec<_> = jobs.iter().map(WindowSolve::id).collect();
            ids.sort_unstable();
            ids.dedup();
            assert_eq!(ids.len(), count);
            assert!(
                jobs.iter()
                    .all(|job| job.problem.hinge.design.validate().is_ok())
            );
        }
    }

    #[test]
    fn an_id_changes_with_every_input_of_the_result() {
        let mut campaign = Campaign::load(&shipped("demo.toml")).unwrap();
        campaign.count = 1;
        let first =
            |campaign: &Campaign, tools: &ToolVersions| campaign.solves(tools).next().unwrap();
        let job = first(&campaign, &versions());
        assert_eq!(job.id(), job.clone().id());
        let newer = ToolVersions {
            ccx: "2.21".into(),
            ..versions()
        };
        assert_ne!(first(&campaign, &newer).id(), job.id());
        assert_eq!(
            first(&campaign, &newer).differences(&job),
            ["tool versions"]
        );
        campaign.material.plastic[1][0] += 1e-9;
        campaign.tier = Tier::Small;
        let other = first(&campaign, &versions());
        assert_ne!(other.id(), job.id());
        assert_eq!(other.differences(&job), ["material", "mesh tier"]);
    }

    #[test]
    fn errors_name_the_file_and_the_rule() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let material = shipped("../materials/pet-0.5mm.toml");
        let demo = std::fs::read_to_string(shipped("demo.toml"))
            .unwrap()
            .replace("../materials/pet-0.5mm.toml", material.to_str().unwrap());
        let message = |old: &str, new: &str| {
            assert!(demo.contains(old), "{old}");
            std::fs::write(&path, demo.replace(old, new)).unwrap();
            Campaign::load(&path).unwrap_err().to_string()
        };
        assert!(message("count = 40", "count = 0").contains("mine.toml: count = 0"));
        assert!(message("kerf =", "kerv =").contains("did you mean `kerf`"));
        assert!(message("r_win = 100.0", "r_win = 50.0").contains("r_win > 2.5 w_lig"));
        assert!(message("tier = \"tiny\"", "tier = \"huge\"").contains("huge"));
        let plate = message("tier = \"tiny\"", "tier = \"plate\"");
        assert!(plate.contains("ligaments of up to 0.5 mm"), "{plate}");
    }
}
