//! The rays of the family, one law each, and their table.

use crate::universal::law::Law;
use fe_driver::{Campaign, DeformationPath, KeptSolve, Ray};
use hinge::SheetMaterial;

use kirigami::replays::routes::window;
use mesher::Tier;

/// Seed of the rays: not that of the campaigns of the materials, whose ligaments therefore are unseen ones.
const SEED: u64 = 16;

/// A ray with its law.
#[derive(Clone, Copy, Debug)]
pub struct FamilyRay {
    /// Index of the ray, and of its law, in the family.
    pub index: usize,
    pub law: Law,
    pub ray: Ray,
}

/// The first `count` rays of a campaign's region, each with another law of the family. Any first part of them fills the
/// region and the family.
pub fn family_rays(campaign: &Campaign, count: usize) -> Vec<FamilyRay> {
    let rays = campaign.rays.rays(&campaign.design, count, SEED);
    let with_law = |(index, ray)| FamilyRay {
        index,
        law: Law::of_family(index),
        ray,
    };
    rays.into_iter().enumerate().map(with_law).collect()
}

/// The sheet of the family: E and thickness of the campaign's material.
pub fn family_sheet(campaign: &Campaign) -> SheetMaterial {
    SheetMaterial {
        name: "universal".into(),
        fracture_strain: 1.0,
        ..campaign.material.clone()
    }
}

impl FamilyRay {
    /// The window of the ray.
    pub fn window(&self, material: &SheetMaterial, tier: Tier) -> KeptSolve {
        let path = DeformationPath::straight(self.ray.end);
        window(self.ray.design, path, material, tier)
    }
}
