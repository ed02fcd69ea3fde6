//! The definition of a campaign: a material, meshes and boxes of rays, from which the list of jobs
//! follows.
//!
//! The jobs are the rays on the mesh `tier`, the first rays of every box on the mesh `finer_tier`
//! again, and the rays of the spot check on the finer of the two, on which weights are tested. The
//! spot check is drawn in the region that the rays cover.

use crate::{
    Ray, RayBox, SolveListError, ToolVersions, WindowProblem, WindowSolve, read_extra_rays,
};
use hinge::{HingeConstants, Regime, SheetMaterial};
use mesher::Tier;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Duration;
use support::{Fault, at, ensure, refuse, toml_file};

/// A campaign with its material, from a TOML file of `configs/campaigns/`.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
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
    /// Finer mesh, of the rays that `finer` counts and of the spot check.
    pub finer_tier: Option<Tier>,
    /// Number of rays of the spot check, each with four random states, on which weights are tested.
    /// 0 for none.
    #[serde(default)]
    #[schemars(range(max = 10_000))]
    pub spot_rays: usize,
    /// TOML files of the trainings that `kirigami train` makes of the campaign, relative to this
    /// file.
    #[serde(default)]
    pub training: Vec<PathBuf>,
    /// Weights of another material, relative to this file, from which trainings of networks of the
    /// same sizes begin, by `configs/training/fine-tuning.toml`; the others begin at random.
    #[serde(default)]
    pub pretrained: Vec<PathBuf>,
    /// Time limit of one solve.
    #[serde(skip)]
    pub time_limit: Duration,
    /// CSV file of rays in addition to the sampled ones, relative to this file.
    extra_rays: Option<PathBuf>,
    /// Rays in addition to the rays of the boxes, and solved after them.
    #[serde(skip)]
    pub further: Vec<Ray>,
    /// Constants of all hinges.
    pub design: HingeConstants,
    /// The regions of designs and ray ends.
    #[serde(rename = "rays")]
    pub boxes: Vec<RayBox>,
}

/// What a job of a campaign is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JobPart {
    /// A ray on the mesh of the campaign.
    Ray,
    /// The same ray on the finer mesh.
    Finer,
    /// A ray of the spot check.
    SpotCheck,
}

impl Campaign {
    /// An error if the file has a defect.
    fn check(&self) -> Result<(), Fault> {
        ensure!(
            !self.name.is_empty() && !self.name.chars().any(char::is_control),
            "name is empty or holds a control character"
        );
        ensure!(!self.boxes.is_empty(), "it has no [[rays]]");
        let needs_finer = self.boxes.iter().any(|rays| rays.finer > 0);
        match self.finer_tier {
            None if needs_finer => refuse!("finer needs finer_tier"),
            Some(finer) if finer.regime() != self.tier.regime() || finer <= self.tier => {
                let tier = self.tier;
                refuse!("finer_tier = \"{finer}\" is no finer mesh than tier = \"{tier}\"");
            }
            _ => {}
        }
        // The narrowest or the widest hinge, with the smallest hole: all others lie between them.
        let impossible = |rays: &RayBox| {
            let constants = HingeConstants { fillet_ratio: rays.fillet_ratio[0], ..self.design };
            rays.w_lig.into_iter().find_map(|w_lig| {
                let design = constants.hinge(w_lig, rays.alpha_deg[0].to_radians());
                let error = design.validate().err()?;
                Some(format!("a corner of the box is not a valid design: {error}"))
            })
        };
        let mut boxes = self.boxes.iter();
        let defect = boxes.clone().find_map(RayBox::defect).or_else(|| boxes.find_map(impossible));
        defect.map_or(Ok(()), |defect| Err(defect.into()))
    }

    /// An error if the tier is not for all ligaments of the box.
    fn check_regime(&self) -> Result<(), Fault> {
        let (regime, material) = (self.tier.regime(), &self.material);
        let other = |w_lig: &f64| material.regime(*w_lig) != regime;
        let Some(w_lig) = self.boxes.iter().flat_map(|rays| rays.w_lig).find(other) else {
            return Ok(());
        };
        let (tier, thickness) = (self.tier, material.thickness);
        let bound = Regime::WIDEST_PLATE * thickness;
        refuse!(
            "tier = \"{tier}\" is for ligaments of a {regime}, but rays.w_lig contains {w_lig} mm: ligaments of up to \
             {bound} mm bend in the plane of a sheet of {thickness} mm (tier \"plate\"), wider ones buckle (tier \
             \"default\"), and no energy holds for both"
        )
    }

    /// Reads a campaign, its material and its further rays.
    pub fn load(path: &Path) -> Result<Self, SolveListError> {
        let mut campaign: Self = toml_file::read(path)?;
        campaign.check().map_err(at(path.display()))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        campaign.material = SheetMaterial::load(&folder.join(&campaign.material_file))?;
        campaign.time_limit = campaign.tier_of(JobPart::Finer).time_limit();
        campaign.check_regime().map_err(at(path.display()))?;
        let named = campaign.training.iter_mut();
        for file in named.chain(&mut campaign.pretrained) {
            *file = folder.join(&*file);
        }
        if let Some(rays) = &campaign.extra_rays {
            campaign.further = read_extra_rays(&folder.join(rays), &campaign.design)?;
        }
        Ok(campaign)
    }

    /// Number of rays on the mesh of the campaign.
    pub fn rays(&self) -> usize {
        self.boxes.iter().map(|rays| rays.count).sum::<usize>() + self.further.len()
    }

    /// Number of jobs.
    pub fn size(&self) -> usize {
        self.rays() + self.boxes.iter().map(|rays| rays.finer).sum::<usize>() + self.spot_rays
    }

    /// The campaign of its first `count` rays alone.
    pub fn first_rays(&self, count: usize) -> Self {
        let mut first = self.clone();
        let mut left = count;
        for rays in &mut first.boxes {
            rays.count = rays.count.min(left);
            rays.finer = 0;
            left -= rays.count;
        }
        first.further.truncate(left);
        first.spot_rays = 0;
        first
    }

    /// The jobs in the order in which they are run. Any prefix of them gives a usable database.
    pub fn jobs(&self, tools: &ToolVersions) -> Vec<(JobPart, WindowSolve)> {
        let regime = self.tier.regime();
        let driven = |ray: Ray| ray.driven(regime);
        let of_box = |rays: &RayBox, count| rays.rays(&self.design, regime, count);
        let rays = self.boxes.iter().flat_map(|rays| of_box(rays, rays.count));
        let finer = self.boxes.iter().flat_map(|rays| of_box(rays, rays.finer));
        let spot = self.spot_paths().into_iter().map(|path| path.hinge);
        let all = [
            (JobPart::Ray, rays.chain(self.further.iter().copied()).map(driven).collect()),
            (JobPart::Finer, finer.map(driven).collect()),
            (JobPart::SpotCheck, spot.collect::<Vec<_>>()),
        ];
        let jobs = all.into_iter().flat_map(|(part, hinges)| {
            let tier = self.tier_of(part);
            let solve = move |hinge| {
                let problem = WindowProblem::new(hinge, &self.material, tier);
                (part, WindowSolve::new(problem, tools))
            };
            hinges.into_iter().map(solve)
        });
        jobs.collect()
    }

    /// The windows of [`jobs`](Self::jobs).
    pub fn solves(&self, tools: &ToolVersions) -> impl Iterator<Item = WindowSolve> {
        self.jobs(tools).into_iter().map(|(_, solve)| solve)
    }

    /// The mesh of a part.
    fn tier_of(&self, part: JobPart) -> Tier {
        match part {
            JobPart::Ray => self.tier,
            JobPart::Finer | JobPart::SpotCheck => self.finer_tier.unwrap_or(self.tier),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::solve::solver::Solve;

    fn shipped(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/campaigns").join(name)
    }

    fn versions() -> ToolVersions {
        ToolVersions { gmsh: "4.8.4".into(), ccx: "2.20".into() }
    }

    #[test]
    fn the_shipped_campaigns_are_read() {
        let files = std::fs::read_dir(shipped("")).unwrap();
        let files = files.map(|file| file.unwrap().path());
        let files: Vec<_> =
            files.filter(|file| file.extension().is_some_and(|it| it == "toml")).collect();
        assert!(files.len() > 5);
        for file in files {
            let campaign = Campaign::load(&file).unwrap();
            let jobs = campaign.jobs(&versions());
            let is = |part| jobs.iter().filter(|(of, _)| *of == part).count();
            let all = |of: fn(&RayBox) -> usize| campaign.boxes.iter().map(of).sum::<usize>();
            let rays = all(|rays| rays.count) + campaign.further.len();
            assert_eq!(is(JobPart::Ray), rays, "{file:?}");
            assert_eq!(is(JobPart::Finer), all(|rays| rays.finer), "{file:?}");
            assert_eq!(is(JobPart::SpotCheck), campaign.spot_rays, "{file:?}");
            let mut ids: Vec<_> = jobs.iter().map(|(_, job)| job.id()).collect();
            ids.sort_unstable();
            ids.dedup();
            assert_eq!((ids.len(), campaign.size()), (jobs.len(), jobs.len()));
            assert!(jobs.iter().all(|(_, job)| job.problem.hinge.design.validate().is_ok()));
            let named = campaign.training.iter().chain(&campaign.pretrained);
            assert!(named.into_iter().all(|file| file.is_file()));
        }
        let tiny = Campaign::load(&shipped("tiny.toml")).unwrap();
        assert_eq!((tiny.rays(), tiny.size()), (40, 43));
    }

    /// Two boxes and a further ray, three rays on a finer mesh, and a spot check of two.
    pub fn of_two_boxes() -> Campaign {
        let mut campaign = Campaign::load(&shipped("tiny.toml")).unwrap();
        let first = RayBox { count: 5, finer: 2, ..campaign.boxes[0] };
        let second = RayBox {
            count: 3,
            seed: 2,
            finer: 1,
            theta_deg: [-5.0, 10.0],
            median_deg: 3.0,
            ..first
        };
        campaign.boxes = vec![first, second];
        campaign.further = first.rays(&campaign.design, Regime::Film, 6).split_off(5);
        campaign.finer_tier = Some(Tier::Small);
        campaign.spot_rays = 2;
        campaign
    }

    /// The parts of the jobs with their meshes, in runs of equal ones.
    fn parts(jobs: &[(JobPart, WindowSolve)]) -> Vec<(JobPart, Tier, usize)> {
        let kind = |(part, solve): &(JobPart, WindowSolve)| (*part, solve.tier());
        jobs.chunk_by(|a, b| kind(a) == kind(b))
            .map(|run| (run[0].0, run[0].1.tier(), run.len()))
            .collect()
    }

    fn hinges(jobs: &[(JobPart, WindowSolve)]) -> Vec<&crate::HingePath> {
        jobs.iter().map(|(_, solve)| &solve.problem.hinge).collect()
    }

    #[test]
    fn the_jobs_are_the_rays_then_the_first_of_each_box_on_the_finer_mesh_then_the_spot_check() {
        let campaign = of_two_boxes();
        let jobs = campaign.jobs(&versions());
        assert_eq!((campaign.rays(), campaign.size()), (9, jobs.len()));
        let finer = (JobPart::Finer, Tier::Small, 3);
        assert_eq!(
            parts(&jobs),
            [(JobPart::Ray, Tier::Tiny, 9), finer, (JobPart::SpotCheck, Tier::Small, 2)]
        );
        let all = hinges(&jobs);
        assert_eq!(all[9..12], [all[0], all[1], all[5]]);
        let solves: Vec<WindowSolve> = campaign.solves(&versions()).collect();
        assert!(solves.iter().eq(jobs.iter().map(|(_, solve)| solve)));

        let region = campaign.region().unwrap();
        let spot = campaign.spot_paths();
        assert_eq!(spot.iter().map(|path| &path.hinge).collect::<Vec<_>>(), all[12..]);
        for path in &spot {
            assert_eq!(path.fractions.len(), crate::campaign::spot_paths::STATES_PER_RAY);
            let mut states = path.fractions.iter().map(|at| path.hinge.path.at(*at));
            assert!(states.all(|state| region.contains(&path.hinge.design, &state)));
        }
        // Neither more rays nor another mesh change the states of the spot check.
        let mut larger = campaign.clone();
        larger.boxes[0].count = 50;
        larger.boxes[1].finer = 0;
        larger.finer_tier = None;
        larger.boxes[0].finer = 0;
        larger.further.clear();
        assert_eq!(larger.spot_paths(), spot);
        assert_eq!(
            parts(&larger.jobs(&versions())),
            [(JobPart::Ray, Tier::Tiny, 53), (JobPart::SpotCheck, Tier::Tiny, 2)]
        );
    }

    #[test]
    fn the_first_rays_are_those_of_the_campaign_alone() {
        let campaign = of_two_boxes();
        let all = campaign.jobs(&versions());
        for count in [0, 3, 5, 6, 8, 9, 100] {
            let first = campaign.first_rays(count);
            let rays = count.min(9);
            assert_eq!((first.rays(), first.size()), (rays, rays));
            assert_eq!(first.jobs(&versions()), all[..rays]);
            assert_eq!(first.region(), campaign.region());
        }
    }

    #[test]
    fn an_id_changes_with_every_input_of_the_result() {
        let mut campaign = Campaign::load(&shipped("tiny.toml")).unwrap();
        campaign.boxes[0].count = 1;
        let first =
            |campaign: &Campaign, tools: &ToolVersions| campaign.solves(tools).next().unwrap();
        let job = first(&campaign, &versions());
        assert_eq!(job.id(), job.clone().id());
        let newer = ToolVersions { ccx: "2.21".into(), ..versions() };
        assert_ne!(first(&campaign, &newer).id(), job.id());
        assert_eq!(first(&campaign, &newer).differences(&job), ["tool versions"]);
        campaign.material.plastic[1][0] += 1e-9;
        campaign.tier = Tier::Small;
        let other = first(&campaign, &versions());
        assert_ne!(other.id(), job.id());
        assert_eq!(other.differences(&job), ["material", "mesh tier"]);
    }

    /// The message about a copy of it with changed texts.
    fn message(changes: &[(&str, &str)]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let material = shipped("../materials/pet-0.5mm.toml");
        let mut text = std::fs::read_to_string(shipped("tiny.toml"))
            .unwrap()
            .replace("../materials/pet-0.5mm.toml", material.to_str().unwrap());
        for (old, new) in changes {
            assert!(text.contains(old), "{old}");
            text = text.replace(old, new);
        }
        std::fs::write(&path, text).unwrap();
        Campaign::load(&path).unwrap_err().to_string()
    }

    #[test]
    fn errors_name_the_file_and_the_rule() {
        let none = message(&[("count = 40", "count = 0")]);
        assert!(none.contains("mine.toml: [[rays]] violates 1 <= count"), "{none}");
        assert!(message(&[("kerf =", "kerv =")]).contains("did you mean `kerf`"));
        assert!(message(&[("r_win = 100.0", "r_win = 50.0")]).contains("r_win > 2.5 w_lig"));
        assert!(message(&[("tier = \"tiny\"", "tier = \"huge\"")]).contains("huge"));
        let plate = message(&[("tier = \"tiny\"", "tier = \"plate\"")]);
        assert!(plate.contains("ligaments of up to 0.5 mm"), "{plate}");
    }

    #[test]
    fn a_mesh_that_is_not_finer_and_rays_that_are_missing_are_named() {
        let finer = ("seed = 1", "seed = 1\nfiner = 41");
        let lone = message(&[finer]);
        assert!(lone.contains("mine.toml: finer needs finer_tier"), "{lone}");
        for (tier, finer) in [("tiny", "tiny"), ("small", "tiny"), ("tiny", "plate-reference")] {
            let tiers = format!("tier = \"{tier}\"\nfiner_tier = \"{finer}\"");
            let message = message(&[("tier = \"tiny\"", &tiers)]);
            let expected =
                format!("finer_tier = \"{finer}\" is no finer mesh than tier = \"{tier}\"");
            assert!(message.contains(&expected), "{message}");
        }
        let small = ("tier = \"tiny\"", "tier = \"tiny\"\nfiner_tier = \"small\"");
        let many = message(&[finer, small]);
        assert!(many.contains("[[rays]] violates finer <= count"), "{many}");

        let tiny = std::fs::read_to_string(shipped("tiny.toml")).unwrap();
        let (_, rays) = tiny.split_once("[[rays]]").unwrap();
        let rays = format!("[[rays]]{rays}");
        let none = message(&[(&rays, "")]);
        assert!(none.contains("missing field `rays`"), "{none}");
        let none = message(&[(&rays, ""), ("[design]", "rays = []\n[design]")]);
        assert!(none.contains("mine.toml: it has no [[rays]]"), "{none}");
    }
}
