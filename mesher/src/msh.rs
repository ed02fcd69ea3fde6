//! Reader of gmsh's .msh files (version 2.2, text): second-order faces with the physical tags of
//! their surfaces, and named boundary curves. Any input gives either a mesh or an error that names
//! the line.

use crate::ElementKind;
use std::collections::HashMap;
use support::fault::{Fault, fault};

/// The named boundary curves of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Boundary {
    /// The window's arc on panel A, which is fixed.
    ArcA,
    /// The window's arc on panel B, which is driven.
    ArcB,
    /// The hole about the tip O.
    Hole,
}

impl Boundary {
    const ALL: [Self; 3] = [Self::ArcA, Self::ArcB, Self::Hole];

    /// The physical tag of the curve in gmsh's files.
    pub(crate) fn tag(self) -> u32 {
        match self {
            Self::ArcA => 1,
            Self::ArcB => 2,
            Self::Hole => 3,
        }
    }
}

/// A second-order mesh of a window or a sheet in its plane; indices count from 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaneMesh {
    /// Node positions (mm); the positions of a window are in the hinge frame.
    pub nodes: Vec<[f64; 2]>,
    /// Corner nodes counter-clockwise, then the same number of mid-side nodes: of edge 01, 12, and
    /// so on.
    pub faces: Vec<Vec<usize>>,
    /// The physical tag of the surface of each face.
    pub surfaces: Vec<u32>,
    /// Edges of the named boundaries: two end nodes, then the mid-side node.
    pub edges: Vec<(Boundary, [usize; 3])>,
}

impl PlaneMesh {
    /// The nodes of one boundary, sorted and without duplicates.
    pub fn nodes_on(&self, boundary: Boundary) -> Vec<usize> {
        let mut nodes: Vec<_> = self
            .edges
            .iter()
            .filter(|(of, _)| *of == boundary)
            .flat_map(|(_, nodes)| *nodes)
            .collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

/// The sides of a face: two end nodes, then the mid-side node.
pub(crate) fn sides(face: &[usize]) -> impl Iterator<Item = [usize; 3]> + Clone {
    let corners = face.len() / 2;
    (0..corners).map(move |i| [face[i], face[(i + 1) % corners], face[corners + i]])
}

/// gmsh's element number of the 3-node line.
const LINE_3: u32 = 8;

/// gmsh's element number of the face from which elements of this kind are extruded.
fn face_number(element: ElementKind) -> u32 {
    match element {
        ElementKind::Brick => 16,
        ElementKind::Wedge => 9,
    }
}

/// Reads the bytes of a .msh file with faces for `elements`; nodes that belong to no face are
/// dropped.
pub fn read_msh(bytes: &[u8], elements: &[ElementKind]) -> Result<PlaneMesh, Fault> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let byte = error.valid_up_to();
        fault("", format!("the mesh file is not a text file: byte {byte} is not UTF-8"), "")
    })?;
    let lines: Vec<_> = text.lines().enumerate().collect();
    let mut positions = HashMap::new();
    for (number, line) in section(&lines, "Nodes")? {
        let mut fields = Fields::new(*number, line);
        let id: u64 = fields.next()?;
        let position: [f64; 2] = [fields.next()?, fields.next()?];
        if !position.iter().all(|x| x.is_finite()) {
            return Err(fields.error("a coordinate is not a finite number"));
        }
        if positions.insert(id, position).is_some() {
            return Err(fields.error("the node number occurs twice"));
        }
    }
    let mut mesh = PlaneMesh::default();
    let mut indices = HashMap::new();
    let mut edges = Vec::new();
    for (number, line) in section(&lines, "Elements")? {
        let mut fields = Fields::new(*number, line);
        let _id: u64 = fields.next()?;
        let kind: u32 = fields.next()?;
        let tags: u32 = fields.next()?;
        if tags < 1 {
            return Err(fields.error("the element has no physical tag"));
        }
        let physical: u32 = fields.next()?;
        for _ in 1..tags {
            fields.next::<u64>()?;
        }
        let element = elements.iter().find(|element| kind == face_number(**element));
        if let Some(element) = element {
            let mut face = vec![0; 2 * element.corners()];
            for node in &mut face {
                let id: u64 = fields.next()?;
                let Some(position) = positions.get(&id) else {
                    return Err(fields.error("the element refers to an undefined node"));
                };
                *node = *indices.entry(id).or_insert_with(|| {
                    mesh.nodes.push(*position);
                    mesh.nodes.len() - 1
                });
            }
            mesh.faces.push(face);
            mesh.surfaces.push(physical);
        } else if kind == LINE_3 {
            let Some(boundary) = Boundary::ALL.into_iter().find(|b| b.tag() == physical) else {
                return Err(fields.error("the boundary curve has an unknown physical tag"));
            };
            let ids: [u64; 3] = [fields.next()?, fields.next()?, fields.next()?];
            edges.push((boundary, ids, fields.line));
        } else {
            return Err(fields.error("the element is neither the expected face nor a 3-node line"));
        }
    }
    if mesh.faces.is_empty() {
        return Err(fault("", "the mesh file contains no faces", ""));
    }
    for (boundary, ids, line) in edges {
        let [Some(a), Some(b), Some(c)] = ids.map(|id| indices.get(&id).copied()) else {
            return Err(at_line(line, "the boundary edge belongs to no face"));
        };
        mesh.edges.push((boundary, [a, b, c]));
    }
    Ok(mesh)
}

/// The numbered lines of $NAME ... $EndNAME, whose count must equal the number in the first line.
fn section<'a, 't>(
    lines: &'a [(usize, &'t str)],
    name: &'static str,
) -> Result<&'a [(usize, &'t str)], Fault> {
    let missing = || {
        let what = format!("the mesh file has no section ${name}");
        fault("", what, "gmsh did not finish writing it")
    };
    let find = |marker: String| lines.iter().position(|(_, line)| line.trim() == marker);
    let (Some(start), Some(end)) = (find(format!("${name}")), find(format!("$End{name}"))) else {
        return Err(missing());
    };
    let [(number, count), rows @ ..] = lines.get(start + 1..end).unwrap_or_default() else {
        return Err(missing());
    };
    if count.trim().parse() != Ok(rows.len()) {
        return Err(at_line(number + 1, "the section does not have the announced number of lines"));
    }
    Ok(rows)
}

/// The fields of one line.
struct Fields<'t> {
    line: usize,
    fields: std::str::SplitWhitespace<'t>,
}

impl<'t> Fields<'t> {
    fn new(number: usize, line: &'t str) -> Self {
        Self { line: number + 1, fields: line.split_whitespace() }
    }

    fn next<T: std::str::FromStr>(&mut self) -> Result<T, Fault> {
        let field = self.fields.next().and_then(|field| field.parse().ok());
        field.ok_or_else(|| self.error("a number is missing or malformed"))
    }

    fn error(&self, what: &str) -> Fault {
        at_line(self.line, what)
    }
}

fn at_line(line: usize, what: &str) -> Fault {
    fault(format!("line {line} of the mesh file"), what, "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SQUARE: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n\
        1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 .5 0 0\n6 1 .5 0\n7 .5 1 0\n8 0 .5 0\n$EndNodes\n\
        $Elements\n2\n1 8 2 2 7 2 3 6\n2 16 2 100 1 1 2 3 4 5 6 7 8\n$EndElements\n";

    fn read(bytes: &[u8]) -> Result<PlaneMesh, Fault> {
        read_msh(bytes, &[ElementKind::Brick])
    }

    #[test]
    fn a_triangle_is_read_where_one_is_expected() {
        let triangle = SQUARE.replace("2 16 2 100 1 1 2 3 4 5 6 7 8", "2 9 2 100 1 1 2 3 5 6 8");
        let mesh = read_msh(triangle.as_bytes(), &[ElementKind::Wedge]).unwrap();
        assert_eq!(mesh.faces, [[0, 1, 2, 3, 4, 5]]);
        let error = read_msh(SQUARE.as_bytes(), &[ElementKind::Wedge]).unwrap_err();
        assert_eq!(error.place, "line 18 of the mesh file", "{error}");
    }

    #[test]
    fn a_square_is_read() {
        let mesh = read(SQUARE.as_bytes()).unwrap();
        assert_eq!(mesh.faces, [[0, 1, 2, 3, 4, 5, 6, 7]]);
        assert_eq!(mesh.nodes[2], [1.0, 1.0]);
        assert_eq!(mesh.nodes_on(Boundary::ArcB), [1, 2, 5]);
        assert!(mesh.nodes_on(Boundary::ArcA).is_empty());
    }

    #[test]
    fn errors_name_their_line() {
        let cases = [
            ("\n8 0 .5 0", "\n8 0 NaN 0", 13),
            ("\n8 0 .5 0", "\n7 0 .5 0", 13),
            ("4 5 6 7 8\n", "4 5 6 7 9\n", 18),
            ("4 5 6 7 8\n", "4 5 6\n", 18),
            ("2 7 2 3 6", "5 7 2 3 6", 17),
        ];
        for (old, new, expected) in cases {
            let error = read(SQUARE.replace(old, new).as_bytes()).unwrap_err();
            assert_eq!(error.place, format!("line {expected} of the mesh file"), "{error}");
        }
    }

    proptest! {
        /// Lines that may occur in a mesh file, in any order and number.
        #[test]
        fn shuffled_lines_give_a_consistent_mesh_or_an_error(
            order in proptest::collection::vec(any::<prop::sample::Index>(), 0..40)
        ) {
            let lines: Vec<_> = SQUARE.split_inclusive('\n').collect();
            let shuffled: String = order.iter().map(|index| *index.get(&lines)).collect();
            if let Ok(mesh) = read_msh(shuffled.as_bytes(), &[ElementKind::Brick]) {
                prop_assert!(mesh.faces.iter().flatten().all(|index| *index < mesh.nodes.len()));
            }
        }

        #[test]
        fn any_bytes_give_a_mesh_or_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            // A mesh needs section markers, which random bytes do not contain.
            prop_assert!(read_msh(&bytes, &[ElementKind::Brick]).is_err());
        }

        #[test]
        fn truncated_and_corrupted_bytes_never_panic(
            cut in 0..SQUARE.len(), at in 0..SQUARE.len(), byte in any::<u8>()
        ) {
            // The file is still complete without its last newline.
            let whole = cut == SQUARE.len() - 1;
            prop_assert_eq!(read(&SQUARE.as_bytes()[..cut]).is_ok(), whole);
            let mut bytes = SQUARE.as_bytes().to_vec();
            bytes[at] = byte;
            let _ = read(&bytes);
        }
    }
}
