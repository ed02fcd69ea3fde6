//! Data of a known law: a database becomes a surrogate, and predictions.
//!
//! ```text
//! W = w (20 u^2 + 10 v^2 + 3 t^2 + 4 u t),   D = t^2 / 100,   u = a / w,  v = s / w,  t = theta
//! ```

use crate::common::Workplace;
use dataset::{Database, SolvedRay, SplitPlan, Subset};
use hinge::{HingeConstants, HingeSample};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::fmt::Write;
use std::process::Stdio;
use std::time::{Duration, Instant};

const DATABASE: &str = "own.parquet";
const WEIGHTS: &str = "runs/own.safetensors";

/// Thirty rays of ten states, their energy, forces and damage times `stiffness`.
fn database(stiffness: f64) -> Database {
    let rays = (0..30).map(|ray| {
        let spread = |step: f64| (step * f64::from(ray + 1)).fract();
        let (w_lig, alpha) = (8.0 + 12.0 * spread(0.7549), 60.0 + 30.0 * spread(0.5698));
        let end = [spread(0.4142) - 0.5, 0.5 * spread(0.732) - 0.25, 1.0];
        let sample = |k| {
            let lambda = 0.1 * f64::from(k);
            let [u, v, t] = end.map(|value| lambda * value);
            let energy = w_lig * (20.0 * u * u + 10.0 * v * v + 3.0 * t * t + 4.0 * u * t);
            HingeSample {
                lambda,
                a: u * w_lig,
                s: v * w_lig,
                theta: t,
                w: stiffness * energy,
                f_a: stiffness * (40.0 * u + 4.0 * t),
                f_s: stiffness * 20.0 * v,
                m_theta: stiffness * w_lig * (6.0 * t + 4.0 * u),
                d: stiffness * 0.01 * t * t,
                ..HingeSample::default()
            }
        };
        SolvedRay {
            job: ray.to_string(),
            design: HingeConstants::PAPER.hinge(w_lig, alpha.to_radians()),
            samples: (1..=10).map(sample).collect(),
            material: "PET film 0.5 mm".into(),
            ..SolvedRay::default()
        }
    });
    Database::collect(rays.collect(), &SplitPlan::default()).unwrap()
}

fn workplace() -> Workplace {
    let work = Workplace::new();
    database(1.0).write(&work.path(DATABASE), false).unwrap();
    work.edit(
        "configs/training/tiny.toml",
        &[
            ("[64, 64, 32]", "[24, 24, 12]"),
            ("epochs = 300", "epochs = 150"),
            ("batch_size = 64", "batch_size = 32"),
        ],
    );
    work
}

#[test]
fn a_database_becomes_weights_that_predict_it() {
    let work = workplace();
    let summary = work.output(&format!("dataset summary {DATABASE}"));
    assert!(summary.contains("300 rows of 30 rays"), "{summary}");
    assert!(summary.contains("split by geometry"), "{summary}");

    let train = format!("train {DATABASE} --config configs/training/tiny.toml");
    let output = work.output(&format!("{train} --seeds 2 --out {WEIGHTS}"));
    for expected in ["chosen", "moment M_theta (N mm)"] {
        assert!(output.contains(expected), "{output}");
    }
    // The rows have no D_peak.
    let card = work.output(&format!("surrogate card {WEIGHTS}"));
    let damage = card.lines().find(|line| line.contains("damage D_peak")).unwrap();
    assert!(damage.trim_end().ends_with('-') && !damage.contains('%'), "{damage}");
    for name in ["own-last.safetensors", "own-seed-1.json", "own-parity.png"] {
        assert!(work.path("runs").join(name).exists(), "{name}");
    }
    assert!(!work.path("runs/own.state").exists());

    let tested = work.output(&format!("surrogate test {WEIGHTS} {DATABASE}"));
    let energy =
        tested.lines().find(|line| line.contains("W, relative to its root mean square")).unwrap();
    let percent: f64 = energy.split_whitespace().find_map(|word| word.parse().ok()).unwrap();
    assert!(
        tested.contains("30 rays") && tested.contains("of 300 states inside") && percent < 20.0,
        "{tested}"
    );

    work.prints(&format!("surrogate card {WEIGHTS}"), &["PET film 0.5 mm", "training domain"]);

    let tuned = format!("{train} --from {WEIGHTS} --out runs/tuned.safetensors");
    work.output(&tuned);
    work.prints("surrogate card runs/tuned.safetensors", &["fine-tuned"]);
}

#[test]
fn a_training_that_was_killed_before_it_saved_a_state_starts_again() {
    let work = workplace();
    let train = format!("train {DATABASE} --config configs/training/tiny.toml --out {WEIGHTS}");
    let mut killed = work.program(&train).spawn().unwrap();
    let lock = work.path("runs/own.lock");
    while !lock.exists() {
        assert!(killed.try_wait().unwrap().is_none(), "it ended early");
        std::thread::sleep(Duration::from_millis(5));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(!work.path("runs/own.state").exists());
    work.output(&train);
    // A training that is complete is not made again.
    let trained = std::fs::read(work.path(WEIGHTS)).unwrap();
    work.refuses(&train, &["own.safetensors exists"]);
    assert_eq!(std::fs::read(work.path(WEIGHTS)).unwrap(), trained);
}

#[test]
fn input_that_cannot_be_evaluated_gives_an_error() {
    let work = workplace();
    work.write("own.csv", "job,W\n0,1.5\n");
    work.refuses("dataset summary own.csv", &["own.csv is no Parquet file"]);
    let absolute = work.path("own.safetensors").display().to_string();
    for out in ["./own.safetensors", "runs/../own.safetensors", &absolute] {
        work.refuses(
            &format!("train {DATABASE} --out {out} --replace"),
            &["replace the database's manifest"],
        );
    }
    work.refuses(&format!("train {DATABASE} --out own.safetensors --replace"), &["manifest"]);
}

/// A database, and one of the same rays whose energies and forces are 5 % higher.
#[test]
fn a_database_is_compared_with_another_of_the_same_rays() {
    let work = workplace();
    database(1.05).write(&work.path("stiff.parquet"), false).unwrap();
    work.prints(
        &format!("dataset compare stiff.parquet {DATABASE} --out results/tiers"),
        &["300 states of 30 rays"],
    );
    let page = work.read("results/tiers/compare.md");
    let row = "| F_s | 5.00 % | 5.00 % | 5.00 % | 5.00 % |";
    assert!(page.contains(row), "{page}");
}

/// The tensile curve of a testing machine becomes the material of a solve.
#[test]
fn a_measured_curve_is_a_material() {
    let work = Workplace::new();
    let mut curve = "engineering_strain,engineering_stress_mpa\n0,0\n".to_owned();
    for i in 1..=400 {
        let strain = 5e-4 * f64::from(i);
        let stress = (210e3 * strain).min(235.0 + 900.0 * strain / (1.0 + 3.0 * strain));
        writeln!(curve, "{strain},{stress}").unwrap();
    }
    work.write("curve.csv", curve);
    let fit =
        "material fit curve.csv --name steel --thickness 1.5 --density-kg-m3 7850 --young 210000";
    work.output(fit);
    let solve = "solve --material runs/material/steel.toml --tier tiny --theta-deg 3";
    let solved = work.json(&format!("{solve} --json"));
    let yields = solved["material"]["plastic"][0][0].as_f64().unwrap();
    assert!((235.0..245.0).contains(&yields), "{yields}");

    let text = work.read("runs/material/steel.toml");
    let (head, _) = text.split_once("plastic = [").unwrap();
    work.write("runs/material/steel.toml", head);
    work.refuses(solve, &["plastic"]);
}

/// The corrected rays of the default mesh have about half the error in W of the uncorrected ones.
#[test]
fn a_database_is_corrected_by_some_rays_of_a_finer_mesh() {
    const SHIPPED: &str = "data/pet-0.5mm/hinges.parquet";
    let work = Workplace::new();
    let compared = work.output(&format!("dataset compare {SHIPPED} --out compared"));
    let [before, after] = differences(&compared, "W");
    // The fit weighs the forces too: alone, W would be halved.
    assert!(after < 0.6 * before, "{compared}");
    for quantity in ["F_a", "F_s", "M_theta", "D_peak"] {
        let [before, after] = differences(&compared, quantity);
        assert!(after < before, "{quantity}: {compared}");
    }
    assert!(compared.contains("does not reduce the differences: D."));
    // A training corrects the rays by itself, and leaves the rays of the finer mesh out.
    work.edit(
        "configs/training/tiny.toml",
        &[
            ("[64, 64, 32]", "[8, 8, 4]"),
            ("epochs = 300", "epochs = 1"),
            ("batch_size = 64", "batch_size = 1024"),
        ],
    );
    let trained = work.output(&format!(
        "train {SHIPPED} --config configs/training/tiny.toml --out runs/corrected.safetensors"
    ));
    assert_eq!(differences(&trained, "W"), [after], "{trained}");
    let card = work.read("runs/corrected.json");
    let card: serde_json::Value = serde_json::from_str(&card).unwrap();
    assert_eq!(card["tier"], "default corrected to reference");
    let database = Database::read(&work.path(SHIPPED)).unwrap();
    assert_eq!(card["dataset_hash"], database.manifest().hash);
    let training = database.manifest().split.jobs(Subset::Training);
    assert_eq!(card["training_rays"], training.len());
}

/// The differences of a quantity over all states (%), in each table of a text.
pub(crate) fn differences<const TABLES: usize>(text: &str, quantity: &str) -> [f64; TABLES] {
    let row = format!(" {quantity} ");
    let rows = (text.lines()).filter(|line| line.starts_with(&row) && line.contains(" % "));
    let first = |row: &str| row.split(' ').find_map(|word| word.parse().ok());
    let found: Vec<f64> = rows.map(|row| first(row).unwrap()).collect();
    found.try_into().unwrap_or_else(|_| panic!("{text}"))
}

/// The rows of the comparison of the seeds, without the last column, the names of the weights.
fn compared(work: &Workplace, name: &str) -> Vec<String> {
    let text = work.read(&format!("runs/{name}-seeds.csv"));
    let rows = text.lines().map(|line| line.rsplit_once(',').unwrap().0);
    rows.map(str::to_owned).collect()
}

#[test]
fn seeds_that_are_stopped_continue_and_one_is_chosen() {
    let work = workplace();
    work.edit("configs/training/tiny.toml", &[("epochs = 150", "epochs = 40")]);
    let train = format!("train {DATABASE} --config configs/training/tiny.toml");
    work.output(&format!("{train} --seeds 3 --out runs/whole.safetensors"));

    // Stopped in the first training.
    let seeds = format!("{train} --seeds 3 --out runs/array.safetensors");
    let mut stopped = work.program(&seeds).stdout(Stdio::null()).spawn().unwrap();
    let deadline = Instant::now() + Duration::from_secs(60);
    while !work.path("runs/array-seed-0.lock").exists() {
        assert!(Instant::now() < deadline, "no training begins");
        std::thread::sleep(Duration::from_millis(1));
    }
    kill(Pid::from_raw(stopped.id() as i32), Signal::SIGTERM).unwrap();
    assert_eq!(stopped.wait().unwrap().code(), Some(75));
    assert!(work.path("runs/array-seed-0.state").exists());
    assert!(!work.path("runs/array-seed-0.safetensors").exists());
    work.output(&seeds);
    let table = compared(&work, "array");
    assert_eq!(table, compared(&work, "whole"));
    let chosen: Vec<&String> = table.iter().filter(|row| row.contains(",yes,")).collect();
    assert!(table.len() == 4 && chosen.len() == 1, "{table:?}");
    let seed = chosen[0].split(',').next().unwrap();
    let read = |name: &str| std::fs::read(work.path(&format!("runs/{name}"))).unwrap();
    let best = read(&format!("array-seed-{seed}.safetensors"));
    assert!(best == read("array.safetensors"));
    for name in ["array-seeds.md", "array-parity.png", "array-last.safetensors"] {
        assert!(work.path("runs").join(name).exists(), "{name}");
    }

    // The same command trains nothing again; a seed whose files are lost is trained again.
    let files = ["array-seed-0.state", "array-seed-2.safetensors", "array.safetensors"];
    let before = files.map(read);
    work.output(&seeds);
    assert!(files.map(read) == before);
    std::fs::remove_file(work.path("runs/array-seed-1.safetensors")).unwrap();
    std::fs::remove_file(work.path("runs/array-seed-1.state")).unwrap();
    work.output(&seeds);
    assert_eq!(compared(&work, "array"), table);

    // Weights of another training are replaced on request only.
    work.edit("configs/training/tiny.toml", &[("epochs = 40", "epochs = 20")]);
    assert!(work.error(&seeds).contains("exists"));
    work.output(&format!("{seeds} --replace"));
    assert_ne!(compared(&work, "array"), table);
}
