//! Meshes that gmsh really makes, over the whole range of designs and at every tier.

use hinge::HingeDesign;
use mesher::tool::ToolError;
use mesher::{
    Boundary, Gmsh, MeshDefect, MeshError, PlaneRecipe, Tier, Window, WindowMesh, mesh_window,
    plane_mesh_svg,
};
use std::io::ErrorKind;
use std::os::unix::fs::PermissionsExt;
use std::process::Command;

fn design(w_lig: f64, alpha_deg: f64) -> HingeDesign {
    HingeDesign {
        w_lig,
        alpha: alpha_deg.to_radians(),
        fillet_ratio: 0.16,
        kerf: 0.2,
        r_win: 100.0,
    }
}

fn mesh(w_lig: f64, alpha_deg: f64, tier: Tier) -> WindowMesh {
    let design = design(w_lig, alpha_deg);
    let scratch = tempfile::tempdir().unwrap();
    let gmsh = Gmsh::find().unwrap();
    mesh_window(&design, 0.5, &tier.recipe(), scratch.path(), &gmsh)
        .unwrap_or_else(|e| panic!("w = {w_lig}, alpha = {alpha_deg}, {tier}: {e}"))
}

/// What a parabola through the ends and the middle of a circular arc leaves out of its segment.
fn parabola_deficit(radius: f64, angle: f64) -> f64 {
    let half = 0.5 * angle;
    radius * radius * (0.5 * (angle - angle.sin()) - 4.0 / 3.0 * half.sin() * (1.0 - half.cos()))
}

/// The area that the quadratic edges of `mesh` enclose: exact but for the parabolas on the arcs.
fn area_inside_parabolas(mesh: &WindowMesh) -> f64 {
    let edges = mesh.plane.edges.iter();
    let lost = edges.map(|(boundary, [from, to, _])| {
        let [p, q] = [from, to].map(|node| mesh.plane.nodes[*node]);
        let chord = (q[0] - p[0]).hypot(q[1] - p[1]);
        match boundary {
            Boundary::Hole => {
                let rho = mesh.design.fillet_radius();
                -parabola_deficit(rho, 2.0 * (0.5 * chord / rho).asin())
            }
            _ => parabola_deficit(100.0, 2.0 * (0.5 * chord / 100.0).asin()),
        }
    });
    Window(&mesh.design).area() - lost.sum::<f64>()
}

#[test]
fn every_tier_covers_the_window_without_a_fold() {
    for tier in Tier::ALL {
        let recipe = tier.recipe();
        for (w, alpha) in [
            (5.0, 25.0),
            (5.0, 150.0),
            (12.0, 60.0),
            (12.0, 120.0),
            (18.0, 90.0),
            (25.0, 25.0),
            (25.0, 150.0),
        ] {
            let mesh = mesh(w, alpha, tier);
            let quality = mesh.quality().unwrap();
            if let PlaneRecipe::Structured(plane) = recipe.plane {
                assert_eq!(mesh.elements.len(), plane.quads() * recipe.layers);
            }
            assert!(
                quality.jacobian_ratio > 0.1,
                "{tier} {w} {alpha}: {quality:?}"
            );
            let expected = area_inside_parabolas(&mesh);
            let error = (quality.area - expected).abs() / expected;
            assert!(error < 1e-9, "{tier} {w} {alpha}: {error:e}, {quality:?}");
        }
    }
}

#[test]
fn arcs_are_on_the_rim_flat_and_on_their_own_side() {
    let mesh = mesh(18.0, 60.0, Tier::Default);
    let normal = Window(&mesh.design).normal();
    for (arc, sign) in [(&mesh.arc_a, -1.0), (&mesh.arc_b, 1.0)] {
        // 7 plane nodes on 5 levels, of which mid-sides skip the two mid-verticals.
        assert_eq!(arc.len(), 7 * 5 - 3 * 2);
        for node in arc {
            let [x, y, z] = mesh.nodes[*node];
            assert!((x.hypot(y) - 100.0).abs() < 1e-9);
            let level = 4.0 * (z / 0.5 + 0.5);
            assert!(
                (level - level.round()).abs() < 1e-9,
                "the rim is lifted: {z}"
            );
            let across = sign * (x * normal[0] + (y + 18.0) * normal[1]);
            assert!(across >= 0.1 - 1e-9, "{across}");
        }
    }
}

#[test]
fn the_bump_is_one_thickness_at_the_origin() {
    let mesh = mesh(18.0, 90.0, Tier::Default);
    let top = mesh.nodes.iter().map(|p| p[2]).fold(f64::MIN, f64::max);
    assert!((top - 0.75).abs() < 1e-12, "{top}");
    let bottom = mesh
        .bottom
        .iter()
        .map(|n| mesh.nodes[*n][2])
        .fold(f64::MAX, f64::min);
    assert!((bottom + 0.25).abs() < 1e-12, "{bottom}");
}

/// A mesh that moved by jumps would make every derivative in w_lig noise.
#[test]
fn nodes_move_smoothly_with_the_design() {
    let at = |w: f64| mesh(w, 80.0, Tier::Small).plane.nodes;
    let (before, here, after) = (at(17.99), at(18.0), at(18.01));
    for ((p, q), r) in before.iter().zip(&here).zip(&after) {
        for i in 0..2 {
            assert!((r[i] - p[i]).abs() < 0.1);
            assert!((p[i] - 2.0 * q[i] + r[i]).abs() < 1e-4);
        }
    }
}

#[test]
fn a_mesh_that_a_solver_should_not_see_is_refused() {
    let good = mesh(18.0, 90.0, Tier::Tiny);
    let mut folded = good.clone();
    folded.gauss_volumes[7][3] = -1e-9;
    let defect = folded.quality().unwrap_err();
    assert!(
        matches!(defect, MeshDefect::Folded { element: 7, .. }),
        "{defect}"
    );

    let mut sliver = good.clone();
    let (from, to) = (sliver.plane.faces[5][0], sliver.plane.faces[5][1]);
    sliver.plane.nodes[to] = sliver.plane.nodes[from].map(|x| x + 1e-3);
    let defect = sliver.quality().unwrap_err();
    assert!(matches!(defect, MeshDefect::Sliver { .. }), "{defect}");

    let mut hole = good.clone();
    hole.gauss_volumes.pop();
    hole.elements.pop();
    let defect = hole.quality().unwrap_err();
    assert!(matches!(defect, MeshDefect::Area { .. }), "{defect}");

    let mut loose = good;
    loose.plane.edges.retain(|(of, _)| *of != Boundary::ArcB);
    let defect = loose.quality().unwrap_err();
    assert_eq!(defect, MeshDefect::NoBoundary(Boundary::ArcB));
}

/// Why a gmsh that answers its version and then does `body` gives no mesh.
fn with_fake_gmsh(body: &str) -> MeshError {
    let scratch = tempfile::tempdir().unwrap();
    let path = scratch.path().join("fake-gmsh");
    let script =
        format!("#!/bin/sh\nif [ \"$1\" = --version ]; then echo 4.8.4; exit; fi\n{body}\n");
    std::fs::write(&path, script).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    // A child that another test has just forked may hold the script open for writing.
    while let Err(error) = Command::new(&path).arg("--version").output() {
        assert_eq!(error.kind(), ErrorKind::ExecutableFileBusy, "{error}");
    }
    let gmsh = Gmsh::at(&path).unwrap();
    mesh_window(
        &design(18.0, 90.0),
        0.5,
        &Tier::Tiny.recipe(),
        scratch.path(),
        &gmsh,
    )
    .unwrap_err()
}

#[test]
fn a_gmsh_that_fails_or_writes_nothing_is_told() {
    let failed = with_fake_gmsh("echo 'Error : no licence'; exit 1");
    assert!(matches!(failed, MeshError::Gmsh(ToolError::Failed { .. })));
    assert!(failed.to_string().contains("no licence"), "{failed}");
    assert!(matches!(with_fake_gmsh("exit 0"), MeshError::Read(_)));
    assert!(matches!(
        with_fake_gmsh("head -c 900 /dev/zero > window.msh"),
        MeshError::Read(_)
    ));
}

#[test]
fn the_picture_shows_every_element_and_the_named_boundaries() {
    let mesh = mesh(18.0, 90.0, Tier::Tiny);
    let svg = plane_mesh_svg(&mesh);
    let strokes = |colour: &str| {
        let line = svg.lines().find(|line| line.contains(colour)).unwrap();
        line.matches('Q').count()
    };
    assert_eq!(strokes("#888"), 4 * mesh.plane.faces.len());
    let on = |b| mesh.plane.edges.iter().filter(|(of, _)| *of == b).count();
    assert_eq!(strokes("#1f5fbf"), on(Boundary::ArcA));
    assert_eq!(strokes("#2e8b57"), on(Boundary::Hole));
    assert_eq!(on(Boundary::Hole), 12);
}

#[test]
fn a_design_that_cannot_be_cut_is_refused_before_gmsh() {
    let design = design(0.018, 57.3);
    let scratch = tempfile::tempdir().unwrap();
    let error = mesh_window(
        &design,
        0.5,
        &Tier::Tiny.recipe(),
        scratch.path(),
        &Gmsh::find().unwrap(),
    );
    assert!(matches!(error, Err(MeshError::Design(_))));
    assert_eq!(scratch.path().read_dir().unwrap().count(), 0);
}
