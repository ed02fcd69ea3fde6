//! Trainings at the limits of their data: one ray, one geometry, other units, duplicated rows.

use super::{Checked, kept, one_line};
use anyhow::Result;
use dataset::{Database, DatasetError, Gates, Row, SplitPlan};
use kirigami::ui::progress::Progress;
use std::fmt::Write;
use surrogate::TestErrors;
use train::{Backend, TrainingConfig, train};

/// Factor of all lengths.
const UNITS: f64 = 1e4;

/// What must hold.
#[derive(Clone, Copy)]
enum Promise {
    /// The training ends with finite errors on its test part.
    Trained,
    /// The rows are refused with a reason.
    Refused,
}

struct Extreme {
    name: &'static str,
    promise: Promise,
    rows: Vec<Row>,
}

/// The database with one thing changed at a time.
fn all(database: &Database) -> Vec<Extreme> {
    let rows = database.rows();
    let first = rows.first().map(|row| row.job.clone());
    let edited = |edit: &dyn Fn(&mut Row)| {
        let mut rows = rows.to_vec();
        rows.iter_mut().for_each(edit);
        rows
    };
    let one_ray = rows.iter().filter(|row| Some(&row.job) == first.as_ref());
    let one_ray: Vec<Row> = one_ray.cloned().collect();
    let copies = rows.iter().cloned().chain(rows.iter().map(|row| Row {
        job: format!("copy of {}", row.job),
        ..row.clone()
    }));
    let extreme = |name, promise, rows| Extreme {
        name,
        promise,
        rows,
    };
    vec![
        extreme("the database", Promise::Trained, rows.to_vec()),
        extreme("no row", Promise::Refused, Vec::new()),
        extreme("one ray", Promise::Refused, one_ray),
        extreme(
            "one ligament for all rays",
            Promise::Refused,
            edited(&|row| row.design = rows[0].design),
        ),
        extreme(
            "one width for all rays",
            Promise::Refused,
            edited(&|row| row.design.w_lig = rows[0].design.w_lig),
        ),
        extreme(
            "no shear in any row",
            Promise::Refused,
            edited(&|row| (row.sample.s, row.sample.f_s) = (0.0, 0.0)),
        ),
        extreme(
            "no damage in any row",
            Promise::Refused,
            edited(&|row| {
                row.sample.d = 0.0;
                row.sample.d_peak = row.sample.d_peak.map(|_| 0.0);
            }),
        ),
        extreme(
            "all lengths ten thousand times larger",
            Promise::Refused,
            edited(&|row| enlarge(row, UNITS)),
        ),
        extreme(
            "all lengths ten thousand times smaller",
            Promise::Refused,
            edited(&|row| enlarge(row, 1.0 / UNITS)),
        ),
        extreme(
            "all rows twice, as one ray",
            Promise::Refused,
            rows.iter().chain(rows).cloned().collect(),
        ),
        extreme(
            "all rays twice, under two names",
            Promise::Trained,
            copies.collect(),
        ),
        extreme(
            "numbers that are not finite",
            Promise::Refused,
            edited(&|row| row.sample.w = f64::NAN),
        ),
    ]
}

/// All lengths multiplied by `factor` at equal stress.
fn enlarge(row: &mut Row, factor: f64) {
    let (design, sample) = (&mut row.design, &mut row.sample);
    for length in [
        &mut design.w_lig,
        &mut design.kerf,
        &mut design.r_win,
        &mut sample.a,
        &mut sample.s,
    ] {
        *length *= factor;
    }
    for force in [&mut sample.f_a, &mut sample.f_s] {
        *force *= factor.powi(2);
    }
    for work in [
        &mut sample.m_theta,
        &mut sample.w,
        &mut sample.w_work,
        &mut sample.w_elastic,
    ] {
        *work *= factor.powi(3);
    }
}

/// One row a training.
pub(super) fn table(database: &Database, config: &TrainingConfig) -> Result<Checked> {
    let mut text = format!(
        "# At the extremes: trainings\n\n\
         {} rows of {} rays, {} epochs each, one thing changed at a time. Promised: finite errors on the test part, or, of data from \
         which a network cannot learn and of lengths that no hinge has, a refusal with its reason.\n\n\
         | extreme | rows | outcome | |\n|---|---|---|---|\n",
        database.rows().len(),
        database.manifest().rays,
        config.epochs
    );
    let extremes = all(database);
    let bar = Progress::new(extremes.len(), "trainings");
    let mut broken = 0;
    for (i, extreme) in extremes.iter().enumerate() {
        bar.show(i, None, extreme.name);
        let outcome = trained(&extreme.rows, config);
        let error = outcome
            .as_ref()
            .ok()
            .map(|errors| errors.energy.relative_rmse);
        let promise = match (extreme.promise, error) {
            (Promise::Refused, error) => error.is_none(),
            (Promise::Trained, Some(error)) => error.is_finite(),
            (Promise::Trained, None) => false,
        };
        broken += usize::from(!promise);
        let outcome = match outcome {
            Ok(errors) => format!(
                "errors W {:.2}, M_theta {:.2}, D {:.2} % of {} unseen rows",
                100.0 * errors.energy.relative_rmse,
                100.0 * errors.m_theta.relative_rmse,
                100.0 * errors.damage.relative_rmse,
                errors.rows
            ),
            Err(reason) => one_line(&reason),
        };
        writeln!(
            text,
            "| {} | {} | {outcome} | {} |",
            extreme.name,
            extreme.rows.len(),
            kept(promise)
        )?;
    }
    bar.finish();
    Ok(Checked { text, broken })
}

/// The errors on the test part, or why there are none.
fn trained(rows: &[Row], config: &TrainingConfig) -> Result<TestErrors, String> {
    let collected: Result<Database, DatasetError> =
        Database::collect(rows.to_vec(), &Gates::default(), &SplitPlan::default());
    let database = collected.map_err(|error| error.to_string())?;
    let trained = train(&database, config, Backend::default(), &mut |_| {});
    let trained = trained.map_err(|error| error.to_string())?;
    Ok(trained.test_errors)
}
