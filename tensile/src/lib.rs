//! Tensile tests: from the files of a testing machine to the hardening table of a material; section
//! 4.1.
//!
//! | step | file |
//! |---|---|
//! | text, specimens, columns, units, dimensions | `number_table`, `name`, `quantity`, `record` |
//! | unloading, break, shaking strains | `cleaning`, `regression` |
//! | Young's modulus and toe (ISO 527-1, ASTM D638) | `linear_part` |
//! | yield, plateau, natural draw ratio, necking | `landmarks` |
//! | one specimen, its local curve | `specimen`, `local_curve` |
//! | mean over the specimens, table, fracture strain, file of the material | `fit` |
//!
//! ```
//! use tensile::{FitOptions, MaterialFit, RecordOptions, SpecimenOptions};
//!
//! # let records = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/tensile");
//! let dimensions = RecordOptions {
//!     width: Some(10.0),
//!     thickness: Some(0.5),
//!     gauge_length: Some(50.0),
//!     ..RecordOptions::default()
//! };
//! let options =
//!     FitOptions { specimen: SpecimenOptions::default(), fracture_strain: None, rows: 30 };
//! let fit = MaterialFit::new(&[(records.join("strip-1.csv"), dimensions)], &options)?;
//! assert!((fit.young.mean - 3000.0).abs() < 10.0); // MPa
//! # Ok::<_, Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod cleaning;
mod fit;
mod landmarks;
mod linear_part;
mod local_curve;
mod name;
mod number_table;
mod quantity;
mod record;
mod regression;
mod specimen;

pub use fit::{
    FitOptions, FractureSource, HardeningRow, MaterialFit, Origin, Statistic, material_file,
};
pub use landmarks::{Draw, SpecimenEnd};
pub use linear_part::LinearPart;
pub use number_table::StatedDimension;
pub use quantity::Quantity;
pub use record::{Exclusion, ReadColumn, RecordOptions, RecordRow};
pub use specimen::{Softening, Specimen, SpecimenOptions};

use std::path::Path;
use support::{Fault, fault};

/// Puts the file before what is wrong with it.
fn in_file(path: &Path) -> impl Fn(String) -> Fault + Copy {
    move |what| fault!("{} {what}", path.display())
}
