//! What the shells offer, as functions: the command line, the studio and the demo call them.
//!
//! ```
//! let refused = app::new_project::NewProject::default().create();
//! assert!(refused.is_err());
//! ```

#![cfg_attr(not(test), warn(unreachable_pub))]

mod animation;
pub mod charts;
pub mod chosen;
pub mod cut;
pub mod design;
pub mod design_checks;
pub mod design_runs;
pub mod failure;
pub mod fit_report;
pub mod fitting;
pub mod input_file;
pub mod measured;
pub mod new_project;
pub mod output_file;
pub mod own_drawing;
pub mod picture;
#[cfg(feature = "pipeline")]
mod pipeline;
pub mod progress;
pub mod run_folder;
pub mod shell_word;

#[cfg(feature = "pipeline")]
pub use pipeline::*;

/// Whether the commands from a material to weights are in this build, and finite elements.
pub const WHOLE_BUILD: bool = cfg!(feature = "pipeline");
