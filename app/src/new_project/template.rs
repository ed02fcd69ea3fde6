//! The shipped files that a new project is scaled from, for films and for plates.

use hinge::Regime;

/// The scene and the campaign of a regime, and what scales them.
pub(super) struct Template {
    /// A shipped scene of A4.
    pub scene: &'static str,
    /// What the new scene is, for its head.
    pub description: &'static str,
    /// Thickness of the shipped scene's sheet (mm).
    pub thickness: f64,
    /// Radius of the windows of the shipped scene (mm).
    pub r_win: f64,
    /// Usual side of a panel over the radius of a window.
    pub panel: f64,
    /// A shipped campaign.
    pub campaign: &'static str,
    /// Thickness of the shipped campaign's sheet (mm).
    pub campaign_thickness: f64,
    /// A shipped training.
    pub training: &'static str,
    /// Why a sheet is of this regime.
    pub why: &'static str,
}

const FILM: Template = Template {
    scene: include_str!("../../../configs/scenes/a4-polyester.toml"),
    description: "# The panels are held flat, as between two clear plates that lie: a thin sheet that nothing holds leaves its plane\n\
           # and opens less. Friction on the plates is not modelled.\n",
    thickness: 0.1,
    r_win: 20.0,
    panel: 3.5,
    campaign: include_str!("../../../configs/campaigns/pet-0.5mm.toml"),
    campaign_thickness: 0.5,
    training: include_str!("../../../configs/training/medium.toml"),
    why: "The sheet is large for its thickness: its ligaments are 20 to 50 thicknesses wide, buckle and fold, and its panels must be \
          held flat.",
};

const PLATE: Template = Template {
    scene: include_str!("../../../configs/scenes/a4-plate.toml"),
    description: "# Its ligaments are narrower than the plate is thick: they bend in its plane. Nothing holds its panels there:\n\
           # the report says whether they stay. It hangs from a clip at its upper edge. The clip hangs from a hook and swings: gravity and pull are along the\n\
           # line from clip to clip of the opened sheet, in the frame of the held panel.\n",
    thickness: 3.0,
    r_win: 12.0,
    panel: 5.8,
    campaign: include_str!("../../../configs/campaigns/polypropylene-3mm.toml"),
    campaign_thickness: 3.0,
    training: include_str!("../../../configs/training/plate/medium.toml"),
    why: "The sheet is thick for its size: its ligaments are narrower than it is thick and bend in its plane.",
};

impl Template {
    pub(super) fn of(regime: Regime) -> &'static Self {
        match regime {
            Regime::Film => &FILM,
            Regime::Plate => &PLATE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::SheetMaterial;
    use std::path::Path;
    use toml_edit::DocumentMut;

    #[test]
    fn templates_have_the_lengths_of_their_files() {
        let configs = Path::new("../configs");
        for template in [&FILM, &PLATE] {
            let scene: DocumentMut = template.scene.parse().unwrap();
            let campaign: DocumentMut = template.campaign.parse().unwrap();
            assert_eq!(scene["thickness"].as_float(), Some(template.thickness));
            assert_eq!(scene["process"]["r_win"].as_float(), Some(template.r_win));
            let material = campaign["material"].as_str().unwrap();
            let material = SheetMaterial::load(&configs.join("campaigns").join(material)).unwrap();
            assert_eq!(material.thickness, template.campaign_thickness);
        }
    }
}
