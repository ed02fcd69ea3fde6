//! Sections of a scene that no shipped scene uses: each is equivalent to simpler input.

use super::*;
use design::equilibrium::load_step::LoadStep;

fn path(scene: &Scene) -> Vec<LoadStep> {
    let problem = scene.problem().unwrap();
    problem.deploy(&scene.start()).unwrap().path
}

/// Asserts that both texts, inserted instead of the pull, give the same equilibria.
fn assert_alike(one: &str, other: &str) {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = [one, other].map(|text| path(&read(folder.path(), &with(&[(PULL, text)]))));
    for (one, other) in std::iter::zip(one, other) {
        assert_ne!(one.configuration[5], [0.0; 3]);
        let pairs = std::iter::zip(&one.configuration, &other.configuration);
        for (x, y) in pairs.flat_map(|(one, other)| std::iter::zip(one, other)) {
            assert_close(*x, *y, 1e-9);
        }
    }
}

#[test]
fn edge_loads_are_divided_among_the_panels_of_the_edge() {
    let panels = (0..3).map(|row| format!("[[loads]]\npanel = [2, {row}]\nforce = [1.2, -0.4]\n"));
    let edge = "[[edge_loads]]\nedge = \"right\"\ntraction = [0.003, -0.001]";
    assert_alike(edge, &panels.collect::<String>());
}

#[test]
fn opening_couples_open_a_hinge() {
    // [1, 1] is an even panel, A of the hinge; [2, 1] is B.
    assert_alike(
        "[[opening_couples]]\npanels = [[2, 1], [1, 1]]\ncouple = 150.0",
        "[[loads]]\npanel = [1, 1]\ncouple = -150.0\n[[loads]]\npanel = [2, 1]\ncouple = 150.0",
    );
    let folder = tempfile::tempdir().unwrap();
    let everywhere = with(&[(PULL, "[[opening_couples]]\ncouple = 60.0")]);
    let opened = path(&read(folder.path(), &everywhere));
    // Self-equilibrated couples open every hinge by M / k_theta.
    for deformation in &opened[3].deformations {
        assert_close(deformation.theta, 60.0 / 300.0, 1e-8);
    }
}

#[test]
fn a_start_is_given_by_values() {
    let folder = tempfile::tempdir().unwrap();
    let start = |section: &str| {
        let changes = [("start_noise = 0.05\n", ""), ("[process]", section)];
        read(folder.path(), &with(&changes)).start()
    };
    let values = start(
        "[start]\nr = [0.3, 0.5, 0.6, 0.9]\ntau = [[0.2, 0.6], [0.3, 0.7], [0.5, 0.6], [0.1, 0.2]]\n\
         w_lig = [12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0, 21.0, 22.0, 23.0]\n[process]",
    );
    let logits = [0.3_f64, 0.5, 0.6, 0.9].map(|r| (r / (1.0 - r)).ln());
    let ell = [[0.2, 0.4, 0.4], [0.3, 0.4, 0.3], [0.5, 0.1, 0.4], [0.1, 0.1, 0.8]];
    let ell = ell.as_flattened().iter().map(|length: &f64| length.ln());
    let pattern = &values.pattern;
    let found = pattern.z.iter().chain(pattern.ell.iter().flatten());
    for (logit, expected) in found.zip(logits.into_iter().chain(ell)) {
        assert_close(*logit, expected, 1e-12);
    }
    // Widths increase with the hinge index; omitted values are uniform.
    assert!(values.omega.windows(2).all(|pair| pair[0] < pair[1]));
    let uniform = start("[process]");
    assert!(uniform.omega.windows(2).all(|pair| pair[0] == pair[1]));
    let refused = with(&[("[process]", "[start]\nr = [0.3, 0.5, 1.6, 0.9]\n[process]")]);
    assert_says(&refusal(folder.path(), &refused), "r[2] = 1.6 violates");
}

#[test]
fn a_target_is_drawn_in_an_svg_file() {
    let folder = tempfile::tempdir().unwrap();
    let svg = "<svg><path d=\"M 0 0 H 40 V 20 H 0 Z\"/></svg>";
    std::fs::write(folder.path().join("outline.svg"), svg).unwrap();
    let drawn = "[target.svg]\nfile = \"outline.svg\"\ncentre = [700.0, 550.0]\nheight = 900.0";
    let scene = read(folder.path(), &with(&[(TARGET, drawn)]));
    assert_close(scene.target.length, 2.0 * (1800.0 + 900.0), 1e-9);
    for [x, y] in &scene.target.points {
        let (x, y) = ((x - 700.0).abs() / 900.0, (y - 550.0).abs() / 450.0);
        assert_close(x.max(y), 1.0, 1e-9);
    }
    std::fs::write(folder.path().join("outline.svg"), svg.replace(" Z", "")).unwrap();
    let open = read(folder.path(), &with(&[(TARGET, drawn)]));
    assert!(open.target.notes[0].contains("of 900.00 mm was added"), "{:?}", open.target.notes);

    // A triangle of 90 x 60 cm.
    let dxf = "0 SECTION 2 HEADER 9 $INSUNITS 70 5 0 ENDSEC 0 SECTION 2 ENTITIES 0 LWPOLYLINE 70 1 \
               10 0 20 0 10 90 20 0 10 90 20 60 0 ENDSEC 0 EOF";
    std::fs::write(folder.path().join("outline.dxf"), dxf.replace(' ', "\n")).unwrap();
    let drawn = "[target.svg]\nfile = \"outline.dxf#1\"\ncentre = [700.0, 550.0]";
    let scene = read(folder.path(), &with(&[(TARGET, drawn)]));
    let length = 900.0 + 600.0 + f64::hypot(900.0, 600.0);
    assert_close(scene.target.length, length, 1e-9);
}
