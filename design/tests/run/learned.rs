//! Runs with the learned hinge law, of random weights: they are bound to their hinge, every term of
//! the objective counts, and the report knows the training domain.

use super::{FILM, read, run, with};
use design::inverse_design::forget;
use design::report::{Concern, Report};
use design::results::write_results;
use design::scene::Scene;
use std::path::Path;

/// Puts the random weights and their card, changed, beside the scene.
fn weights(folder: &Path, changes: &[(&str, &str)]) {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases");
    std::fs::copy(
        cases.join("chi_tiny.safetensors"),
        folder.join("tiny.safetensors"),
    )
    .unwrap();
    let card = std::fs::read_to_string(cases.join("chi_tiny.json")).unwrap();
    let changes = [("random weights", "film")].iter().chain(changes);
    let card = changes.fold(card, |card, (from, to)| {
        assert!(card.contains(from), "{from}");
        card.replace(from, to)
    });
    std::fs::write(folder.join("tiny.json"), card).unwrap();
}

fn learned(changes: &[(&str, &str)]) -> String {
    let law = [
        ("hinge = \"linear\"", "hinge = \"surrogate\""),
        (
            "[linear]\nk_a = 400.0\nk_s = 250.0\nk_theta = 300.0",
            "[surrogate]\nweights = \"tiny.safetensors\"",
        ),
        (
            "compression = 0.01",
            "compression = 0.2\nshear = 0.1\ndamage = 0.2",
        ),
        ("steps = 25", "steps = 6"),
    ];
    with(&[&law, changes].concat())
}

fn refusal(card: &[(&str, &str)], scene: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), card);
    std::fs::write(folder.path().join("film.toml"), FILM).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, learned(scene)).unwrap();
    Scene::read(&path).unwrap_err().to_string()
}

#[test]
fn weights_of_another_hinge_or_material_are_refused() {
    let message = refusal(&[("film", "steel")], &[]);
    assert!(
        message.contains("the material `steel`, the scene's is `film`"),
        "{message}"
    );
    let changed = (
        "\"tier\"",
        "\"material_hash\": \"0123456789abcdef\", \"tier\"",
    );
    let message = refusal(&[changed], &[]);
    assert!(
        message.contains("another law of the material `film`"),
        "{message}"
    );
    let message = refusal(&[], &[("kerf = 0.2", "kerf = 0.3")]);
    assert!(
        message.contains("kerf = 0.2, the scene has process.kerf = 0.3"),
        "{message}"
    );
}

#[test]
fn every_term_counts_and_the_report_names_hinges_outside_the_domain() {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    // Ligaments may be wider than the 25 mm that the card was trained to.
    let scene = read(folder.path(), &learned(&[("start = 18.0", "start = 25.9")]));
    let designed = run(&scene, None).unwrap();
    assert_eq!(designed.history.len(), 7);
    let (start, best) = (&designed.start, &designed.best);
    assert!(best.loss < start.loss, "{} {}", best.loss, start.loss);
    let (path, area) = (&start.terms.path, 160e3);
    let loss = start.terms.chamfer
        + area * (0.2 * path.damage + 0.2 * path.compression + 0.1 * path.shear);
    assert!((start.loss / loss - 1.0).abs() < 1e-12);

    let report = write_results(&scene, &designed).unwrap();
    assert!(
        report
            .hinges
            .iter()
            .all(|row| row.damage.is_some_and(|damage| damage > 0.0))
    );
    let ligaments = warned(&report, Concern::LigamentsOutsideDomain);
    let wide = report
        .hinges
        .iter()
        .filter(|row| row.w_lig > 25.0)
        .map(|row| row.hinge);
    assert!(wide.clone().count() > 0);
    assert!(wide.into_iter().all(|hinge| ligaments.contains(&hinge)));
    let left: Vec<usize> = report
        .hinges
        .iter()
        .filter(|row| !row.inside)
        .map(|row| row.hinge)
        .collect();
    assert_eq!(left, warned(&report, Concern::StatesOutsideDomain));
}

fn warned(report: &Report, concern: Concern) -> Vec<usize> {
    let of_concern = report
        .warnings
        .iter()
        .filter(|warning| warning.concern == concern);
    of_concern
        .flat_map(|warning| warning.hinges.clone())
        .collect()
}

#[test]
fn a_run_is_not_continued_with_another_model() {
    let folder = tempfile::tempdir().unwrap();
    let run_with = |card: &[(&str, &str)]| {
        weights(folder.path(), card);
        run(
            &read(folder.path(), &learned(&[("steps = 6", "steps = 1")])),
            None,
        )
    };
    run_with(&[]).unwrap();
    // A narrower training domain: its barrier holds the hinges back.
    let error = run_with(&[("\"theta\": [0.0, 1.25]", "\"theta\": [0.0, 0.01]")])
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("other weights"), "{error}");
    let scene = read(folder.path(), &learned(&[("steps = 6", "steps = 1")]));
    forget(&scene).unwrap();
    assert_eq!(run(&scene, None).unwrap().history.len(), 2);
}
