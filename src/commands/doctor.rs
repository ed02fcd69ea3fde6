//! `kirigami doctor`: the external programs that are found, and how to install the missing ones.

use anyhow::{Result, bail};
use clap::Args;

/// Check that gmsh and CalculiX are found, and print how to install them
///
/// Needed by the commands that solve windows: `mesh`, `solve`, `campaign`, `verify`, `surrogate spot-check` and
/// `demo`. Training and design run without them.
#[derive(Args)]
pub struct DoctorCommand {}

impl DoctorCommand {
    pub(crate) fn run(&self) -> Result<()> {
        let mut missing = 0;
        for diagnosis in fe_driver::doctor() {
            match diagnosis.tool {
                Ok(tool) => println!(
                    "{:6} {:8} {}",
                    diagnosis.name,
                    tool.version,
                    tool.program.display()
                ),
                Err(error) => {
                    missing += 1;
                    println!("{:6} {error}", diagnosis.name);
                }
            }
        }
        if missing > 0 {
            bail!("{missing} of the programs that solve hinge windows cannot be used");
        }
        Ok(())
    }
}
