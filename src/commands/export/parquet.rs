//! The hinges and the equilibrium path of a deployed sheet as Parquet tables.

use anyhow::{Context, Result};
use dataset::{Values, parquet_table};
use design::equilibrium::load_step::LoadStep;
use design::objective::design_problem::Deployment;
use output::hinge_states::{HingeState, hinge_states};
use std::path::Path;

/// Writes `hinges.parquet` and `path.parquet`.
pub(super) fn write(deployment: &Deployment, folder: &Path) -> Result<()> {
    let hinges = hinge_states(deployment);
    for (name, columns, rows) in [
        ("hinges.parquet", hinge_columns(&hinges), hinges.len()),
        (
            "path.parquet",
            path_columns(&deployment.path),
            deployment.path.len(),
        ),
    ] {
        let path = folder.join(name);
        support::whole_file::write(&path, &parquet_table(&columns)?)
            .with_context(|| format!("cannot write {}", path.display()))?;
        println!("{rows} rows in {}", path.display());
    }
    Ok(())
}

fn hinge_columns(states: &[HingeState]) -> Vec<(&'static str, Values)> {
    let numbers =
        |value: fn(&HingeState) -> Option<f64>| Values::Numbers(states.iter().map(value).collect());
    let counts = |value: fn(&HingeState) -> usize| {
        Values::Counts(states.iter().map(|state| value(state) as u32).collect())
    };
    vec![
        ("step", counts(|it| it.step)),
        ("load_factor", numbers(|it| Some(it.load_factor))),
        ("hinge", counts(|it| it.hinge)),
        ("panel_a", counts(|it| it.panels[0])),
        ("panel_b", counts(|it| it.panels[1])),
        ("w_lig", numbers(|it| Some(it.w_lig))),
        ("alpha", numbers(|it| Some(it.alpha))),
        ("a", numbers(|it| Some(it.deformation[0]))),
        ("s", numbers(|it| Some(it.deformation[1]))),
        ("theta", numbers(|it| Some(it.deformation[2]))),
        ("eta_a", numbers(|it| Some(it.eta[0]))),
        ("eta_s", numbers(|it| Some(it.eta[1]))),
        ("W", numbers(|it| Some(it.energy))),
        ("D", numbers(|it| it.damage[0])),
        ("D_peak", numbers(|it| it.damage[1])),
        (
            "inside",
            Values::Flags(states.iter().map(|it| it.inside).collect()),
        ),
    ]
}

fn path_columns(path: &[LoadStep]) -> Vec<(&'static str, Values)> {
    let numbers = |value: fn(&LoadStep) -> f64| {
        Values::Numbers(path.iter().map(|it| Some(value(it))).collect())
    };
    let status = path.iter().map(|it| {
        // The name in which a step is listed as JSON.
        let name = serde_json::to_value(it.status).unwrap_or_default();
        name.as_str().unwrap_or_default().to_owned()
    });
    vec![
        ("step", Values::Counts((1..=path.len() as u32).collect())),
        ("load_factor", numbers(|it| it.load_factor)),
        ("weight", numbers(|it| it.weight)),
        ("status", Values::Texts(status.collect())),
        ("U", numbers(|it| it.energies.iter().sum())),
        ("Pi", numbers(|it| it.potential)),
        ("residual", numbers(|it| it.residual)),
        (
            "iterations",
            Values::Counts(path.iter().map(|it| it.effort.iterations as u32).collect()),
        ),
        (
            "theta_mean",
            numbers(|it| {
                it.deformations.iter().map(|hinge| hinge.theta).sum::<f64>()
                    / it.deformations.len() as f64
            }),
        ),
        (
            "theta_max",
            numbers(|it| {
                it.deformations
                    .iter()
                    .map(|hinge| hinge.theta)
                    .fold(f64::NEG_INFINITY, f64::max)
            }),
        ),
        (
            "inside",
            numbers(|it| {
                it.inside.iter().filter(|inside| **inside).count() as f64 / it.inside.len() as f64
            }),
        ),
    ]
}
