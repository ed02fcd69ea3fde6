//! Solved windows as rays of a database.

use crate::verification_error::VerificationError;
use dataset::{
    COMPARED, ComparedState, Database, SolvedRay, SplitPlan, reference_rms, relative_rms,
};
use fe_driver::{
    Campaign, DrawnStates, JobPart, SolveService, Solved, SpotPath, WindowProblem, WindowSolve,
    finished_windows, random_paths,
};
use hinge::{HingeDeformation, HingeDesign, HingeSample, SheetMaterial};
use mesher::Tier;
use std::collections::HashMap;
use std::path::Path;
use support::Fault;
use support::table::Table;

/// The database of the finished rays of the campaign that was last run in a folder.
pub fn collected(folder: &Path) -> Result<Database, VerificationError> {
    let ray = |window: Solved| SolvedRay::new(&window, window.samples.clone());
    let rays = finished_windows(folder)?.map(|window| window.map(ray));
    Ok(Database::collect(rays.collect::<Result<_, _>>()?, &SplitPlan::default())?)
}

// Windows on random rays, solved by finite elements.

/// The states on paths that the solver followed to their end.
#[derive(Debug, Default)]
pub struct SpotStates {
    /// The rays, each with the states on its path.
    pub rays: Vec<SolvedRay>,
    /// The windows of the other paths.
    pub unsolved: Vec<Fault>,
    /// Number of states on the other paths, at which nothing is known.
    pub unknown_states: usize,
}

/// Solves the windows of the paths.
pub fn spot_check(
    windows: &SolveService,
    paths: &[SpotPath],
    material: &SheetMaterial,
    tier: Tier,
) -> Result<SpotStates, VerificationError> {
    let versions = windows.versions();
    let problem = |path: &SpotPath| WindowProblem::new(path.hinge.clone(), material, tier);
    let solves: Vec<WindowSolve> =
        (paths.iter()).map(|path| WindowSolve::new(problem(path), &versions)).collect();
    let solved = windows.solve(&solves)?;
    let mut check = SpotStates::default();
    for (path, window) in paths.iter().zip(&solved) {
        check.add(path, window);
    }
    Ok(check)
}

impl SpotStates {
    /// The spot check of a campaign, as far as its rays are solved in `folder`; `parts` are the
    /// jobs there.
    pub fn collected(
        campaign: &Campaign,
        parts: &HashMap<String, JobPart>,
        folder: &Path,
    ) -> Result<Self, VerificationError> {
        let windows = finished_windows(folder)?;
        let windows = windows.filter(|window| {
            let is_spot = |window: &Solved| parts.get(&window.id) == Some(&JobPart::SpotCheck);
            window.as_ref().map_or(true, is_spot)
        });
        let windows = windows.collect::<Result<Vec<Solved>, _>>()?;
        let mut check = Self::default();
        for path in campaign.spot_paths() {
            let of_path = |window: &&Solved| window.solve.problem.hinge == path.hinge;
            match windows.iter().find(of_path) {
                Some(window) => check.add(&path, window),
                None => check.unknown_states += path.fractions.len(),
            }
        }
        Ok(check)
    }

    /// Adds the states on a path.
    fn add(&mut self, path: &SpotPath, window: &Solved) {
        match window.complete() {
            Ok(samples) => {
                let states = path.fractions.iter();
                let states = states.filter_map(|fraction| HingeSample::at(samples, *fraction));
                self.rays.push(SolvedRay::new(window, states.collect()));
            }
            Err(unsolved) => {
                self.unknown_states += path.fractions.len();
                self.unsolved.push(unsolved);
            }
        }
    }
}

// Random states at which one network learns from several.

/// Number of states of the distillation. With 10 000 the errors of steel at two spot checks are a
/// tenth to a third larger.
const DISTILLATION_STATES: usize = 20_000;

/// The states at which one network learns the median of several, drawn uniformly inside the region.
/// If they lie only on rays of the campaign, the network is free in the corners that no ray
/// passes: the moment of one such network of steel was wrong by 27 times the root mean square
/// there, although the moments of the several networks were not (docs/TRIED.md). Some states lie
/// outside the training domain of the solved rays: the networks extrapolate there, and the one
/// network follows their median.
pub fn distillation_states(drawn: DrawnStates) -> Vec<(HingeDesign, HingeDeformation)> {
    // Other states than the states of a spot check, whose seeds are small by habit.
    const SEED: u64 = u64::MAX;
    let paths = random_paths(drawn, DISTILLATION_STATES, 1, SEED);
    let state = |path: &SpotPath| (path.hinge.design, path.hinge.path.at(1.0));
    paths.iter().map(state).collect()
}

// Differences of values from finer reference values, group by group: a table of their
// distribution.

/// Lower bound of the scale of a group's difference, relative to the reference of all groups.
const MIN_SCALE: f64 = 0.1;

/// The definition of the scale of the differences, for the text of pages.
pub const SCALE: &str = "for all states together and for each group alone, the latter relative to at \
                         least a tenth of the value over all";

/// The difference of each group, relative to its own reference or to a tenth of the reference of
/// all groups, if larger.
fn each_relative(groups: &[&[ComparedState]]) -> Vec<[f64; 6]> {
    let min_scale = reference_rms(groups.iter().copied().flatten()).map(|rms| MIN_SCALE * rms);
    groups.iter().map(|states| relative_rms(states, min_scale)).collect()
}

/// One row per quantity: the difference over all states, and its distribution over the groups.
pub fn spread_table(groups: &[&[ComparedState]], group: &str) -> Table {
    let mut table = Table::new([
        "quantity".to_owned(),
        "all states".to_owned(),
        format!("median {group}"),
        format!("90 % of {group}s"),
        format!("worst {group}"),
    ]);
    let all = relative_rms(&groups.concat(), [0.0; 6]);
    let each = each_relative(groups);
    for (i, name) in COMPARED.iter().enumerate() {
        let known = std::iter::zip(groups, &each)
            .filter(|(states, _)| states.iter().any(|state| state.is_known(i)));
        let mut sorted: Vec<_> = known.map(|(_, rms)| rms[i]).collect();
        sorted.sort_by(f64::total_cmp);
        let Some(last) = sorted.len().checked_sub(1) else {
            table.row([name, "not known", "", "", ""]);
            continue;
        };
        let quantile = |fraction: f64| sorted[(fraction * last as f64).round() as usize];
        let [median, most, worst] = [0.5, 0.9, 1.0].map(|fraction| percent(quantile(fraction)));
        table.row([(*name).to_owned(), percent(all[i]), median, most, worst]);
    }
    table
}

/// Cuts off at 1000 %: if the reference is almost zero (damage of hinges that do not yield), the
/// ratio is meaningless.
fn percent(relative: f64) -> String {
    if relative < 10.0 { format!("{:.2} %", 100.0 * relative) } else { "over 1000 %".into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fe_driver::Campaign;
    use std::path::Path;

    #[test]
    fn the_states_of_a_distillation_fill_the_region() {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/campaigns/pet-0.5mm.toml");
        let campaign = Campaign::load(&file).unwrap();
        let region = campaign.region().unwrap();
        let states = distillation_states(DrawnStates {
            domain: &region,
            constants: &campaign.design,
            regime: campaign.tier.regime(),
        });
        assert_eq!(states.len(), DISTILLATION_STATES);
        assert!(states.iter().all(|(design, state)| region.contains(design, state)));
        // Uniform in three dimensions: half of the states are in the outer fifth of their rays.
        let outer = |(design, state): &&(HingeDesign, HingeDeformation)| {
            !region.contains(design, &state.at(0.5f64.cbrt().recip()))
        };
        let outer = states.iter().filter(outer).count();
        let deviation = outer.abs_diff(states.len() / 2);
        assert!(deviation < states.len() / 50, "{outer}");
    }
}

#[cfg(test)]
mod compared_states_tests {
    use super::*;

    #[test]
    fn ratios_to_an_almost_zero_reference_are_cut_off() {
        assert_eq!(percent(0.01234), "1.23 %");
        assert_eq!(percent(5e286), "over 1000 %");
        assert_eq!(percent(f64::NAN), "over 1000 %");
    }
}
