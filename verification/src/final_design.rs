//! A design searched for with finite elements for its hinges: the level `final`.
//!
//! The search runs at `standard`. The sheet it finds is balanced with finite elements for every
//! hinge ([`balanced`]), the movement of its panel corners by that is the error of the
//! search, and the law that is corrected to the solved hinges takes the place of the learned one.
//! The search goes on with it, until a further balance moves the corners by less than [`BALANCED`],
//! or all rounds are made.

use crate::balanced_sheet::{BALANCED, Balanced, DRAFT_ROUNDS, balanced};
use crate::element_windows::ElementWindows;
use crate::verification_error::VerificationError;
use analysis::level_difference::AtLevel;
use design::optimise::outer_loop::Ended;
use hinge::SheetMaterial;
use mesher::Tier;
use scene::design_run::{BegunRun, Designed, Earlier, LEVELS, OnStep};
use scene::{Level, Scene, SolvedHinge, SolvedHinges};
use std::sync::atomic::AtomicBool;
use support::FileError;

/// Maximum number of searches, each followed by a balance.
const SEARCHES: usize = 3;
/// Maximum number of rounds of a balance on the mesh of the windows.
const ROUNDS: usize = 3;
/// The file of solved hinges, in the folder of the search that found them.
const SOLVED_HINGES: &str = "solved-hinges.json";

/// The CPU time of the solves of a sheet with `hinges` hinges (s), at most, at the usual time of
/// the meshes.
pub fn most_cpu_seconds(tier: Tier, material: &SheetMaterial, hinges: usize) -> f64 {
    let rounds = |tier: Tier, count: usize| tier.usual_cpu_seconds(material) * count as f64;
    let draft = tier.draft().map_or(0.0, |draft| rounds(draft, DRAFT_ROUNDS));
    (draft + rounds(tier, ROUNDS)) * (SEARCHES * hinges) as f64
}

/// Designs a scene with finite elements for its hinges. Its searches are runs in folders of its run
/// folder. A search that is stopped ends it: its design is the one that is returned. Solved windows
/// are kept by the service, and not solved again.
pub fn final_design(
    scene: &Scene,
    windows: &ElementWindows,
    stop: &AtomicBool,
    progress: OnStep,
) -> Result<Designed, VerificationError> {
    let [folder, levels] = [scene.config.output.clone(), scene.config.output.join(LEVELS)];
    let mut at = scene.at_level(Level::Standard)?;
    at.config.output = levels.join(Level::Standard.name());
    let tolerance = BALANCED * scene.config.sheet.outline().size();
    let mut earlier = Earlier::default();
    for searched in 1..=SEARCHES {
        let level = at.config.level;
        let steps = at.config.optimiser.steps.into();
        let designed = BegunRun::new(at, None)?.search(&earlier, Some(steps), stop, progress)?;
        if designed.ended == Ended::Stopped {
            return Ok(designed);
        }
        let (found, corrected) = balanced(&designed.scene, &designed.search.best, windows, ROUNDS)?;
        let file = designed.scene.output().join(SOLVED_HINGES);
        let file = std::path::absolute(&file).map_err(FileError::at(&file))?;
        solved_hinges(&found).write(&file)?;
        let own = AtLevel::new(level, &designed.problem, found.by_law());
        let finer = AtLevel::new(Level::Final, &corrected, found.by_elements());
        let coarse = own.coarse_search(&designed.search, &finer, Some(tolerance), 0.0);
        let is_last = coarse.suffices() || searched == SEARCHES;
        let mut config = designed.scene.config.clone();
        earlier.searches.push(coarse);
        earlier.last = Some(designed.search);
        config.level = Level::Final;
        if let Some(files) = &mut config.surrogate {
            files.solved_hinges = Some(file);
        }
        if is_last {
            config.output.clone_from(&folder);
            config.optimiser.steps = 0;
        } else {
            config.output = levels.join(format!("{}-{searched}", Level::Final));
        }
        at = designed.scene.changed(config)?;
        if is_last {
            break;
        }
    }
    Ok(BegunRun::new(at, None)?.search(&earlier, None, stop, progress)?)
}

/// The last states of the hinges by finite elements.
fn solved_hinges(found: &Balanced) -> SolvedHinges {
    let designs = found.by_law().sheet.designs();
    let hinges = std::iter::zip(designs, &found.hinges);
    let solved = hinges.map(|(design, end)| {
        end.map(|end| SolvedHinge { design, state: end.deformation(), forces: end.forces() })
    });
    SolvedHinges { hinges: solved.collect() }
}
