//! `kirigami-studies localisation`: weight of a panel against the moment of its ligaments; section 5.1, Table 2.

use anyhow::Result;
use clap::Args;
use design::analysis::localisation::{critical_edge, gamma};
use hinge::SheetMaterial;
use kirigami::ui::run_folder;
use std::path::PathBuf;
use support::table::{Cell, Table};

/// Compute Gamma and the critical panel edge of sheet materials, for sheets that lie on a surface
///
/// Writes localisation.md. Example: kirigami-studies localisation
#[derive(Args)]
pub struct LocalisationStudy {
    /// Material files (TOML)
    #[arg(value_name = "MATERIAL", default_values = MATERIALS)]
    materials: Vec<PathBuf>,
    /// Ligament width (mm)
    #[arg(long, value_name = "MM", default_value_t = 18.0)]
    w_lig: f64,
    /// Panel edge (mm)
    #[arg(long, value_name = "MM", default_value_t = 406.4)]
    edge: f64,
    /// Folder for the table
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-localisation")]
    out: PathBuf,
}

/// The rows of Table 2.
const MATERIALS: [&str; 5] = [
    "configs/materials/paper-0.2mm.toml",
    "configs/materials/pet-0.5mm.toml",
    "configs/materials/polypropylene-0.8mm.toml",
    "configs/materials/aluminium-1.0mm.toml",
    "configs/materials/s235-1.5mm.toml",
];

impl LocalisationStudy {
    pub fn run(&self) -> Result<()> {
        anyhow::ensure!(
            self.w_lig > 0.0 && self.w_lig.is_finite() && self.edge > 0.0 && self.edge.is_finite(),
            "--w-lig and --edge must be positive (mm)"
        );
        let _held = run_folder::hold(&self.out)?;
        let materials: Vec<SheetMaterial> = (self.materials.iter())
            .map(|path| SheetMaterial::load(path))
            .collect::<Result<_, _>>()?;
        let table = Table::new()
            .column("material", |material: &SheetMaterial| {
                Cell::text(&material.name)
            })
            .column("E, GPa", |material| Cell::text(material.young / 1e3))
            .column("density, kg/m^3", |material| {
                Cell::text(material.density_kg_m3)
            })
            .column("t, mm", |material| Cell::text(material.thickness))
            .column("L*, cm", |material| {
                Cell::fixed(critical_edge(material, self.w_lig) / 10.0, 1)
            })
            .column("Gamma", |material| {
                Cell::fixed(gamma(material, self.w_lig, self.edge), 2)
            })
            .column("paper's L*, cm", |material| {
                let printed = PAPER
                    .iter()
                    .find(|(name, _)| material.name.starts_with(name));
                Cell::known(printed.map(|(_, edge)| Cell::fixed(*edge, 1)), "-")
            });
        let text = format!(
            "# Range of validity of the model\n\n\
             Panels of {} mm with ligaments of {} mm, in a sheet that lies on a surface: Gamma = (L/L*)^3, (21)-(22), is \
             the moment of gravity on a panel over that of its folded ligament. For Gamma > 1 the paper expects coplanar \
             panels; finite elements of whole sheets show panels that lift off a table also where Gamma is above 10. The \
             report of a design lists Gamma for each hinge. The last column is L* of Table 2 of the paper, for 18 mm. \
             `kirigami-studies localisation`.\n\n{}",
            self.edge,
            self.w_lig,
            table.markdown(&materials)
        );
        run_folder::write(&self.out, "localisation.md", &text)?;
        println!("{text}\nwritten to {}", self.out.display());
        Ok(())
    }
}

/// L* (cm) of Table 2, by the prefix of the material's name.
const PAPER: [(&str, f64); 5] = [
    ("paper", 3.0),
    ("pet", 6.3),
    ("polypropylene", 9.3),
    ("aluminium", 29.0),
    ("s235", 44.0),
];
