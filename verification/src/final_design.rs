//! A design searched for with finite elements for its hinges: the level `final`.
//!
//! The search runs at `standard`. The sheet it finds is balanced with finite elements for every
//! hinge ([`balanced`]), by how much that moves the corners of its panels is the error of the
//! search, and the law that is corrected to the solved hinges takes the place of the learned one.
//! The search goes on with it, until a further balance moves the corners by less than [`BALANCED`],
//! or all rounds are made.

use crate::balanced_sheet::{BALANCED, Balanced, DRAFT_ROUNDS, balanced};
use crate::replay::ElementWindows;
use crate::verification_error::VerificationError;
use design::optimise::outer_loop::{Ended, SearchState};
use mesher::Tier;
use scene::analysis::ladder::Climbed;
use scene::analysis::level_difference::AtLevel;
use scene::design_run::{design_after, inverse_design};
use scene::{Level, Scene, SolvedHinge, SolvedHinges};
use std::sync::atomic::AtomicBool;
use support::file_error::FileError;

/// Most searches, each of which is followed by a balance.
const SEARCHES: usize = 3;
/// Most rounds of a balance on the mesh of the windows.
const ROUNDS: usize = 3;
/// The file of solved hinges, in the folder of the search that found them.
const SOLVED_HINGES: &str = "solved-hinges.json";

/// The CPU time of the solves of a sheet with `hinges` hinges (s), at most, at the usual time of
/// the meshes.
pub fn most_cpu_seconds(tier: Tier, hinges: usize) -> f64 {
    let rounds = |tier: Tier, count: usize| tier.usual_cpu_seconds() * count as f64;
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
    progress: &mut dyn FnMut(Level, &SearchState),
) -> Result<Climbed, VerificationError> {
    let folder = &scene.config.output;
    let mut at = scene.at_level(Level::Standard)?;
    at.config.output = folder.join(Level::Standard.name());
    let asked = BALANCED * scene.config.sheet.outline().size();
    let mut rungs = Vec::new();
    for searched in 1..=SEARCHES {
        let level = at.config.level;
        let designed = inverse_design(&at, stop, &mut |state| progress(level, state))?;
        if designed.ended == Ended::Stopped {
            let scene = at;
            return Ok(Climbed { scene, designed });
        }
        let (found, corrected) = balanced(&at, &designed.design, windows, ROUNDS)?;
        let file = at.output().join(SOLVED_HINGES);
        let file = std::path::absolute(&file).map_err(FileError::at(&file))?;
        solved_hinges(&found).write(&file)?;
        let own = AtLevel { level, problem: designed.problem, deployment: found.by_law().clone() };
        let finer = AtLevel {
            level: Level::Final,
            problem: corrected,
            deployment: found.by_elements().clone(),
        };
        let rung = own.rung(&designed.history, &finer, asked);
        let is_last = rung.suffices() || searched == SEARCHES;
        rungs.push(rung);
        let mut config = at.starting_at(&designed.design);
        config.level = Level::Final;
        if let Some(files) = &mut config.surrogate {
            files.solved_hinges = Some(file);
        }
        config.output.clone_from(folder);
        if is_last {
            config.optimiser.steps = 0;
        } else {
            config.output.push(format!("{}-{searched}", Level::Final));
        }
        at = at.changed(config)?;
        if is_last {
            break;
        }
    }
    let designed = design_after(rungs, &at, stop, &mut |state| progress(Level::Final, state))?;
    let scene = at;
    Ok(Climbed { scene, designed })
}

/// The last states of the hinges by finite elements.
fn solved_hinges(found: &Balanced) -> SolvedHinges {
    let designs = found.by_law().sheet.designs();
    let hinges = std::iter::zip(designs, &found.hinges);
    let solved = hinges.map(|(design, end)| {
        end.map(|end| SolvedHinge {
            design,
            state: end.deformation(),
            forces: end.forces().to_array(),
        })
    });
    SolvedHinges { hinges: solved.collect() }
}
