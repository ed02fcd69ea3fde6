//! Hinges of designed sheets along their paths, at which the errors of weights count most: a sheet
//! settles where the energy is flat, and there its forces are a fraction of the forces at random
//! states.

use design::objective::design_problem::Deployment;
use fe_driver::{DeformationPath, HingePath, SpotPath};
use hinge::HingeDesign;
use support::{Fault, fault};

/// Number of hinges, unless that is less than one of every sheet.
const HINGES: usize = 12;

/// Twelve hinges of deployed sheets, or one of each of more, with five states on each path.
pub fn visited_paths(sheets: &[&Deployment]) -> Result<Vec<SpotPath>, Fault> {
    let mut paths = Vec::new();
    for (i, deployment) in sheets.iter().enumerate() {
        let designs = deployment.sheet.designs();
        let count = designs.len();
        let each = HINGES.div_ceil(sheets.len()).min(count);
        // Multiples of the golden ratio, modulo one, fill the unit interval evenly.
        let first = ((i as f64 * 0.618_033_988_749_895).fract() * count as f64) as usize;
        for k in 0..each {
            let hinge = (first + k * count / each) % count;
            let hinge = hinge_path(deployment, hinge, designs[hinge])?;
            paths.push(SpotPath { hinge, fractions: vec![0.2, 0.4, 0.6, 0.8, 1.0] });
        }
    }
    Ok(paths)
}

/// A hinge with its path in a sheet.
pub(crate) fn hinge_path(
    deployment: &Deployment,
    hinge: usize,
    design: HingeDesign,
) -> Result<HingePath, Fault> {
    let states: Vec<_> = deployment.path.iter().map(|step| step.deformations[hinge]).collect();
    let path = DeformationPath::through(&states);
    let path = path.ok_or_else(|| fault!("hinge {hinge} has no states"))?;
    Ok(HingePath { design, path })
}
