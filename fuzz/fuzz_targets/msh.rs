//! Any bytes give a mesh whose indices are in range, or a typed error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use mesher::{ElementKind, read_msh};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(mesh) = read_msh(bytes, &[ElementKind::Brick]) {
        let edges = mesh.edges.iter().flat_map(|(_, nodes)| nodes);
        let mut indices = mesh.faces.iter().flatten().chain(edges);
        assert!(indices.all(|index| *index < mesh.nodes.len()));
        assert!(mesh.nodes.iter().flatten().all(|x| x.is_finite()));
    }
});
