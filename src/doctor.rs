//! `kirigami doctor`: which external programs are found, and how to get the others.

use anyhow::{Result, bail};
use clap::Args;

/// Check that gmsh and CalculiX are found, and say how to get them
///
/// Only `mesh`, `solve` and `database` need them: training and design run without.
#[derive(Args)]
pub struct DoctorCommand {}

impl DoctorCommand {
    pub fn run(&self) -> Result<()> {
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
            bail!("{missing} of the programs that regenerate the hinge database cannot be used");
        }
        Ok(())
    }
}
