//! Runs with a learned hinge law of random weights: weights of another hinge are refused, every
//! term of the objective counts, and the report shows the training domain.

use super::*;
use design::objective::design_problem::Deployment;
use output::cut_file::CutLines;
use output::report::warnings;
use output::run_results::remove_run;
use scene::target::TargetShape;
use support::sealed_json;
use support::severity::Severity;
use surrogate::Surrogate;

/// Writes the random weights and their card, with changes, next to the scene.
pub fn weights(folder: &Path, changes: &[(&str, &str)]) {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../design/tests/cases");
    let random = cases.join("chi_tiny.safetensors");
    std::fs::copy(random, folder.join("tiny.safetensors")).unwrap();
    let card = std::fs::read_to_string(cases.join("chi_tiny.json")).unwrap();
    let changes = [("random weights", "film")].iter().chain(changes);
    let card = changes.fold(card, |card, (from, to)| {
        assert!(card.contains(from), "{from}");
        card.replace(from, to)
    });
    let card: serde_json::Value = serde_json::from_str(&card).unwrap();
    let card = sealed_json::to_vec(&card).unwrap();
    std::fs::write(folder.join("tiny.json"), card).unwrap();
}

pub fn learned(changes: &[(&str, &str)]) -> String {
    let posture = "[posture]\nkind = \"held-flat\"";
    let weights = format!("[surrogate]\nweights = \"tiny.safetensors\"\n\n{posture}");
    let terms = "compression = 0.2\nshear = 0.1\ndamage = 0.2";
    let law = [
        ("level = \"linear\"", "level = \"standard\""),
        (LAW, &weights),
        ("compression = 0.01", terms),
        ("steps = 25", "steps = 6"),
    ];
    with(&[&law, changes].concat())
}

#[test]
fn weights_of_another_hinge_or_material_are_refused() {
    let hash = "\"material_hash\": \"0123456789abcdef\", \"tier\"";
    let other_law = ("\"tier\"", hash);
    let large_hole = ("fillet_ratio = 0.16", "fillet_ratio = 0.2");
    // A sheet of a fifth of the thickness has windows of a fifth of the radius.
    let thin = ("load_steps = 4", "load_steps = 4\nthickness = 0.1");
    let windows = "windows of r_win = 20 mm in a sheet of this thickness, but the scene has process.r_win = 100";
    let cases: [(&[_], &[_], &str); 4] = [
        (&[("film", "steel")], &[], "`steel`, the scene's is `film`"),
        (&[other_law], &[], "another material law"),
        (&[], &[large_hole], "0.16 w_lig, but the scene has 0.2"),
        (&[], &[thin], windows),
    ];
    for (card, scene, expected) in cases {
        let folder = tempfile::tempdir().unwrap();
        weights(folder.path(), card);
        assert_says(&refusal(folder.path(), &learned(scene)), expected);
    }
}

/// The same scene at a fifth of every length, with a twenty-fifth of every force, deploys to the
/// same shape.
#[test]
fn a_similar_sheet_of_another_thickness_deploys_to_a_similar_shape() {
    const FACTOR: f64 = 0.2;
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    let thick = read(folder.path(), &learned(&[]));
    let mut config = thick.config.clone();
    config.thickness = Some(FACTOR * thick.material.thickness);
    config.sheet.size = config.sheet.size.map(|size| size.map(|side| FACTOR * side));
    config.ligament.start *= FACTOR;
    config.ligament.range = config.ligament.range.map(|width| FACTOR * width);
    config.process.slit_width *= FACTOR;
    config.process.r_win *= FACTOR;
    config.loads[0].force = config.loads[0].force.map(|x| FACTOR.powi(2) * x);
    if let TargetShape::Circle { centre, radius } = &mut config.target {
        *centre = centre.map(|x| FACTOR * x);
        *radius *= FACTOR;
    }
    let thin = Scene::new(config, &folder.path().join("scene.toml")).unwrap();
    let [thick, thin] = [thick, thin].map(|scene| {
        let deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
        deployment.path.last().unwrap().clone()
    });
    assert_close(thin.potential / thick.potential / FACTOR.powi(3), 1.0, 1e-9);
    for (thin, thick) in std::iter::zip(&thin.configuration, &thick.configuration) {
        let expected = [FACTOR * thick[0], FACTOR * thick[1], thick[2]];
        for (found, expected) in std::iter::zip(thin, expected) {
            assert_close(*found, expected, 1e-6);
        }
    }
}

#[test]
fn every_term_counts_and_the_report_names_hinges_outside_the_domain() {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    // Ligaments may be wider than the maximum of 25 mm in the card.
    let run = Finished::within(folder, &learned(&[("start = 18.0", "start = 25.9")]));
    let (designed, report) = (&run.designed, &run.report);
    assert_eq!(designed.search.history.len(), 7);
    let (start, best) = (&designed.start, &designed.best);
    assert!(best.loss < start.loss, "{} {}", best.loss, start.loss);
    let (terms, area) = (&start.terms, 160e3);
    let loss = terms["chamfer"]
        + area * (0.2 * terms["damage"] + 0.2 * terms["compression"] + 0.1 * terms["shear"]);
    assert_close(start.loss / loss, 1.0, 1e-12);

    // Damage outside the domain of the law is unknown.
    for row in &report.hinges {
        assert_eq!(row.damage.is_some_and(|damage| damage > 0.0), row.inside);
    }
    let ligaments = warned(report, "ligaments-outside-domain");
    let rows = report.hinges.iter();
    let wide = rows.filter(|row| row.w_lig > 25.0).map(|row| row.hinge);
    let wide: Vec<usize> = wide.collect();
    assert!(!wide.is_empty() && wide.iter().all(|hinge| ligaments.contains(hinge)));
    let rows = report.hinges.iter();
    let left = rows.filter(|row| !row.inside).map(|row| row.hinge);
    let outside = warned(report, "states-outside-domain");
    assert_eq!(left.collect::<Vec<_>>(), outside);
    assert!(warned(report, "path-dependence").is_empty());
}

#[test]
fn a_path_that_departs_from_its_ray_is_named() {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    let scene = read(folder.path(), &learned(&[]));
    let mut deployment = scene.problem().unwrap().deploy(&scene.start()).unwrap();
    let w_lig = deployment.sheet.hinges[3].w_lig;
    let middle = deployment.path.len() / 2;
    let named = |deployment: &Deployment| {
        let cuts = CutLines::of(&scene, deployment);
        let warnings = warnings(&scene, deployment, &cuts);
        let mut warnings = warnings.iter();
        let bent = warnings.find(|warning| warning.concern == "path-dependence");
        bent.map(|warning| (warning.severity, warning.hinges.clone()))
    };
    assert_eq!(named(&deployment), None);
    deployment.path[middle].deformations[3].s += 0.5 * w_lig;
    assert_eq!(named(&deployment), Some((Severity::Note, vec![3])));
}

/// Writes weights next to the scene that predict D_peak in proportion to `peak_scale`.
pub fn brittle(folder: &Path, peak_scale: f64) {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../surrogate/tests/cases");
    let random = Surrogate::load(&cases.join("chi_domain.safetensors")).unwrap();
    let mut card = random.card().clone();
    card.material = "film".into();
    card.material_hash = None;
    card.peak_scale = Some(peak_scale);
    let weights = Surrogate::from_parts(random.layers(), card).unwrap();
    weights.save(&folder.join("tiny.safetensors")).unwrap();
}

/// Weights that predict ten times the peak strain at fracture.
#[test]
fn a_ligament_that_tears_is_reported_before_the_cut_file_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let scene = learned(&[("damage = 0.2", "damage = 0.2\ndamage_measure = \"peak\"")]);
    let report = |peak_scale: f64| {
        brittle(folder.path(), peak_scale);
        let scene = read(folder.path(), &scene);
        remove_run(&scene).unwrap();
        let designed = run(&scene, None).unwrap();
        // The report is written even if the cut file cannot be.
        std::fs::remove_file(scene.output().join("cut.dxf")).ok();
        std::fs::create_dir(scene.output().join("cut.dxf")).unwrap();
        let failed = write_results(&scene, &designed, false).unwrap_err();
        assert_says(&failed.to_string(), "cut.dxf");
        let text = std::fs::read_to_string(scene.output().join("report.txt")).unwrap();
        std::fs::remove_dir(scene.output().join("cut.dxf")).unwrap();
        (write_results(&scene, &designed, false).unwrap(), text)
    };
    let (torn, text) = report(1e3);
    let named = warned(&torn, "tearing");
    let rows = torn.hinges.iter();
    let over = rows.filter(|row| row.damage_peak.is_some_and(|peak| peak >= 1.0));
    assert_eq!(named, over.map(|row| row.hinge).collect::<Vec<_>>());
    assert!(!named.is_empty());
    assert_says(&text, "the ligament tears");
    assert!(!torn.cut_file && text.contains("NO CUT FILE"), "{text}");
    let (whole, text) = report(1e-3);
    assert!(warned(&whole, "tearing").is_empty() && !text.contains("tears (hinge"));
}

#[test]
fn the_report_states_how_far_the_networks_of_an_ensemble_disagree() {
    let folder = tempfile::tempdir().unwrap();
    weights(folder.path(), &[]);
    let first = Surrogate::load(&folder.path().join("tiny.safetensors")).unwrap();
    let save = |scale: f64, dataset_hash: &str| {
        // The energy is proportional to the square of the scale of the embedding.
        let mut layers = first.layers();
        let last = layers.chi.last_mut().unwrap();
        let values = last.weight.values.iter_mut();
        values.for_each(|weight| *weight *= scale);
        let mut card = first.card().clone();
        card.dataset_hash = dataset_hash.into();
        let other = Surrogate::from_parts(layers, card).unwrap();
        let path = folder.path().join("other.safetensors");
        other.save(&path).unwrap();
    };
    let ensemble = "weights = \"tiny.safetensors\"\nensemble = [\"other.safetensors\"]";
    let scene = learned(&[("weights = \"tiny.safetensors\"", ensemble)]);
    save(1.0, &first.card().dataset_hash);
    assert_says(&refusal(folder.path(), &scene), "are the same network");
    save(1.1, "other data");
    assert_says(&refusal(folder.path(), &scene), "surrogate.ensemble");
    save(1.1, &first.card().dataset_hash);
    let run = Finished::within(folder, &scene);
    let report = &run.report;
    let estimate = value(report, "ensemble");
    // Forces with the factors 1 and 1.21: a deviation of 0.21 / sqrt(2) about a mean of 1.105.
    let expected = 0.21 / 2f64.sqrt() / 1.105;
    assert_eq!(estimate["networks"], 2);
    assert_close(estimate["forces"].as_f64().unwrap(), expected, 1e-9);
    assert_says(&report.document().to_string(), "2 networks, whose forces differ by");
    let table = report.budget.as_ref().unwrap().table();
    let budget: Vec<_> = table.rows().collect();
    let row = |cause: &str| budget.iter().find(|row| row[0] == cause).unwrap();
    assert!(row("network")[1].parse::<f64>().unwrap() > 0.0);
    assert_eq!(row("network")[3], "prescribed");
    // The card has no spot check, and the scene no tolerance.
    for unknown in ["window mesh", "kerf", "thickness"] {
        assert_eq!(row(unknown)[1], "not known");
    }
    // So the sum is a lower bound, with which no miss is compared.
    assert!(row("at least")[1].parse::<f64>().unwrap() > 0.0);
    let mut warnings = report.warnings.iter();
    assert!(warnings.all(|it| !it.message.contains("by which the known causes")));
    let text = run.file("report.txt");
    for cells in &budget {
        assert!(cells.iter().all(|cell| text.contains(cell)), "{cells:?}");
    }
    assert!(text.contains("not in the budget: ") && text.contains("creep"));
    // Neither creep nor springback of the film is known.
    assert_says(&text, "the material file has no figure ([creep])");
    assert_says(&text, "names no law of released hinges (surrogate.springback)");
}

fn warned(report: &Report, concern: &str) -> Vec<usize> {
    let found = found(report, concern).into_iter();
    found.flat_map(|warning| warning.hinges.clone()).collect()
}

#[test]
fn a_run_is_not_continued_with_another_model() {
    let folder = tempfile::tempdir().unwrap();
    let read = || read(folder.path(), &learned(&[("steps = 6", "steps = 1")]));
    weights(folder.path(), &[]);
    run(&read(), None).unwrap();
    // A narrower training domain: its penalty energy keeps the hinges from opening.
    let narrower = [(", 0.625]", ", 0.005]")];
    weights(folder.path(), &narrower);
    let error = run(&read(), None).err().unwrap();
    assert_says(&error.to_string(), "the weights changed since");
    remove_run(&read()).unwrap();
    assert_eq!(run(&read(), None).unwrap().search.history.len(), 2);
}
