//! The levels of a scene: what each takes from it, their derivatives, and the difference to a finer
//! one.

use crate::changed;
use analysis::level_difference::{AtLevel, deployed};
use analysis::refinement::inverse_design;
use design::hinge_law::{MeanLaw, Order};
use design::optimise::outer_loop::{Ended, SearchState, Until, optimise};
use design::optimise::search::SearchMethod;
use design::{DesignProblem, DesignVector, HingeLaw, SurrogateLaw};
use hinge::{HingeDeformation, HingeDesign};
use scene::{Level, Scene};
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use testkit::derivatives::{TaylorRemainders, assert_close};

fn scene(name: &str) -> Scene {
    Scene::read(&crate::shipped(name)).unwrap()
}

#[test]
fn every_level_of_a_plate_deploys_and_nears_the_finest() {
    let plate = scene("a4-plate.toml");
    assert_eq!(plate.learned_levels(), [Level::Draft, Level::Standard, Level::Fine]);
    let design = plate.start();
    let at = |level: Level| {
        let scene = plate.at_level(level).unwrap();
        assert_eq!(scene.config.level, level);
        deployed(&scene, &design).unwrap()
    };
    let compared = |level: Level| {
        let (problem, deployment) = at(level);
        AtLevel::new(level, &problem, &deployment)
    };
    let finest = compared(Level::Fine);
    let opening = Some(at(Level::Fine).1.final_step().mean_opening());
    let pins = plate.at_level(Level::Pin).unwrap();
    let (problem, pins) = deployed(&pins, &DesignVector { opening, ..design.clone() }).unwrap();
    let pins = AtLevel::new(Level::Pin, &problem, &pins);
    let off = |coarse: &AtLevel| coarse.difference(&finest);
    assert_eq!(off(&finest).corners, [0.0; 2]);
    assert_eq!((off(&finest).load, off(&finest).damage), (Some(0.0), Some(0.0)));
    let [draft, standard] = [Level::Draft, Level::Standard].map(|level| off(&compared(level)));
    for learned in [draft, standard] {
        let [rms, largest] = learned.corners;
        assert!(0.0 < rms && rms < largest && largest < 0.05, "{learned:?}");
        assert!(learned.load.unwrap() < 0.02 && learned.damage.unwrap() < 0.02);
    }
    let pins = off(&pins);
    assert!(pins.corners[1] > 5.0 * draft.corners[1] && pins.load.is_none());
    // A spring has no path but its own stiffness at 20 deg.
    let springs = off(&compared(Level::Linear));
    assert!(springs.corners[1] > draft.corners[1] && springs.damage.is_none());
}

/// A coarse search ends when it has converged, and the next level descends faster with its curvature
/// than from nothing.
#[test]
fn a_level_goes_on_with_the_optimiser_of_the_one_before() {
    let plate = scene("a4-plate.toml");
    let [draft, standard] = [Level::Draft, Level::Standard]
        .map(|level| plate.at_level(level).unwrap().problem().unwrap());
    let new = |problem, start: &DesignVector| {
        let evaluation = DesignProblem::evaluate(problem, start).unwrap();
        SearchState::new(problem, start.clone(), &evaluation, SearchMethod::Lbfgs, 0.1)
    };
    let searched = |problem, mut search: SearchState, until: Until| {
        let stop = AtomicBool::new(false);
        let ended = optimise(problem, &mut search, until, &stop, &mut |_| Ok::<_, Infallible>(()));
        assert_eq!(ended, Ok(Ended::Completed));
        search
    };
    let coarse = new(&draft, &plate.start());
    let coarse = searched(&draft, coarse, Until { steps: 100, converged: true });
    assert!((11..60).contains(&coarse.last().step), "{}", coarse.last().step);
    let start = &coarse.best;
    let evaluation = standard.evaluate(start).unwrap();
    let after = SearchState::after(&coarse, &standard, start.clone(), &evaluation);
    let [after, fresh] =
        [after, new(&standard, start)].map(|search| searched(&standard, search, 25.into()));
    let fall = |search: &SearchState| search.history[0].scores.loss - search.last().scores.loss;
    assert!(fall(&after) > 1.5 * fall(&fresh), "{} {}", fall(&after), fall(&fresh));
}

/// A design begins at `draft` and ends at its own level, no farther from its target; a run that was
/// stopped at `draft` goes on there, to the same end.
#[test]
fn a_design_begins_at_the_cheapest_level_and_is_the_same_after_a_stop() {
    let folder = tempfile::tempdir().unwrap();
    let designed = |name: &str, stop_at: usize| {
        let plate = changed("a4-plate.toml", |config| {
            config.output = folder.path().join(name);
            config.optimiser.steps = 12;
        });
        let (stop, mut levels) = (AtomicBool::new(false), Vec::new());
        let designed = inverse_design(&plate, &stop, &mut |level, search| {
            levels.push(level);
            stop.fetch_or(search.last().step == stop_at, Ordering::Relaxed);
        });
        levels.dedup();
        (designed.unwrap(), levels)
    };
    let (whole, levels) = designed("whole", usize::MAX);
    assert_eq!(levels, [Level::Draft, Level::Standard]);
    assert_eq!((&whole.ended, whole.scene.config.level), (&Ended::Completed, Level::Standard));
    assert_eq!(whole.coarse_searches[0].steps(), 12);
    assert!(whole.best.loss < whole.start.loss);
    let (stopped, _) = designed("stopped", 5);
    assert_eq!((stopped.coarse_searches[0].steps(), stopped.ended), (5, Ended::Stopped));
    let (continued, levels) = designed("stopped", usize::MAX);
    assert_eq!(levels, [Level::Draft, Level::Standard]);
    assert_eq!(continued.search.best, whole.search.best);
}

#[test]
fn the_gradient_of_every_learned_level_is_that_of_its_loss() {
    let plate = scene("a4-plate.toml");
    for level in [Level::Standard, Level::Fine] {
        let scene = plate.at_level(level).unwrap();
        let problem = scene.problem().unwrap();
        let start = scene.start();
        let gradient = problem.evaluate(&start).unwrap().gradient.to_flat();
        let x = start.to_flat();
        let direction: Vec<f64> = (0..x.len()).map(|i| (1.7 * i as f64).sin()).collect();
        let loss = |x: &[f64]| problem.loss(&start.with_flat(x));
        let remainders = TaylorRemainders::new(loss, &x, &gradient, &direction, 1e-3, 3);
        remainders.unwrap().assert_orders(1.8..2.2);
    }
}

#[test]
fn the_mean_law_is_the_mean_of_its_laws_in_every_derivative() {
    let plate = scene("a4-plate.toml");
    let laws: Vec<Arc<dyn HingeLaw>> = (plate.networks().iter())
        .map(|surrogate| -> Arc<dyn HingeLaw> {
            let surrogate = surrogate.clone();
            Arc::new(SurrogateLaw { surrogate })
        })
        .collect();
    let designs = plate.problem().unwrap().cut(&plate.start()).unwrap().1.designs();
    let designs: Vec<HingeDesign> = designs[..2].to_vec();
    let states = [[0.02, 0.01, 0.2], [0.1, -0.02, 0.4]].map(HingeDeformation::from);
    let all = |law: &dyn HingeLaw| {
        let law = law.prepare(&designs);
        (law.energies(&states, Order::Design), law.damage(&states, true))
    };
    let each: Vec<_> = laws.iter().map(|law| all(&**law)).collect();
    let (energies, damage) = all(&MeanLaw { laws });
    let mean = |of: &dyn Fn(usize) -> f64| (0..each.len()).map(of).sum::<f64>() / each.len() as f64;
    for h in 0..2 {
        let close = |found: f64, of: &dyn Fn(usize) -> f64| {
            let expected = mean(of);
            assert_close(found, expected, 1e-12 * (1.0 + expected.abs()));
        };
        close(energies[h].w, &|k| each[k].0[h].w);
        close(energies[h].forces[1], &|k| each[k].0[h].forces[1]);
        close(energies[h].tangent[0][2], &|k| each[k].0[h].tangent[0][2]);
        close(energies[h].design.hole, &|k| each[k].0[h].design.hole);
        close(energies[h].mixed[2].w_lig, &|k| each[k].0[h].mixed[2].w_lig);
        close(damage[h].d, &|k| each[k].1[h].d);
        close(damage[h].gradient.design.w_lig, &|k| each[k].1[h].gradient.design.w_lig);
        close(damage[h].d_peak.unwrap(), &|k| each[k].1[h].d_peak.unwrap());
        close(damage[h].peak_gradient.state[2], &|k| each[k].1[h].peak_gradient.state[2]);
    }
}

#[test]
fn a_level_without_its_networks_names_the_next_best() {
    let missing = |level: Level, scene: &Scene| scene.at_level(level).unwrap_err().to_string();
    let mut alone = scene("a4-plate.toml");
    let networks = alone.config.surrogate.as_mut().unwrap();
    networks.draft = None;
    networks.ensemble.clear();
    assert_eq!(alone.learned_levels(), [Level::Standard]);
    for level in [Level::Draft, Level::Fine] {
        let message = missing(level, &alone);
        assert!(message.contains("level = \"standard\""), "{message}");
    }
    let springs = scene("linear-7x7.toml");
    assert!(missing(Level::Standard, &springs).contains("[surrogate]"));
    assert!(missing(Level::Linear, &scene("pin-7x7.toml")).contains("supports"));
}
