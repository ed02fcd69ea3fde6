//! `kirigami doctor`: the external programs that are found, and how to install the missing ones.

use anyhow::{Result, bail};
use clap::Args;
use fe_driver::CCX;
use mesher::GMSH;
use support::program::Tool;

/// Check that gmsh and CalculiX are found, and print how to install them
///
/// Needed by the commands that solve windows: `mesh`, `solve`, `campaign`, `verify`, `surrogate
/// release` and `demo`. Training and design run without them.
#[derive(Args)]
pub struct DoctorCommand {}

impl DoctorCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let mut missing = 0;
        for kind in [&GMSH, &CCX] {
            let name = kind.name;
            match Tool::find(kind) {
                Ok(tool) => println!("{name:6} {:8} {}", tool.version, tool.program.display()),
                Err(error) => {
                    missing += 1;
                    println!("{name:6} {error}");
                }
            }
        }
        if missing > 0 {
            bail!("{missing} of the programs that solve hinge windows cannot be used");
        }
        Ok(())
    }
}
