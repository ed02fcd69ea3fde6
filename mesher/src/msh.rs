//! Reader of gmsh's .msh files (version 2.2, text): second-order faces with the physical tags of
//! their surfaces, and named boundary curves. Any input gives either a mesh or an error that names
//! the line.

use crate::ElementKind;
use std::collections::HashMap;
use std::str::FromStr;
use support::{Fault, ensure, fault, refuse};

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
#[derive(Clone, Debug, Default)]
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
const LINE_3: u64 = 8;

/// gmsh's element number of the face from which elements of this kind are extruded.
fn face_number(element: ElementKind) -> u64 {
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
        fault!("the mesh file is not a text file: byte {byte} is not UTF-8")
    })?;
    let lines: Vec<_> = (1..).zip(text.lines()).collect();
    let mut positions = HashMap::new();
    for (line, fields) in section(&lines, "Nodes")? {
        let mut fields = fields.split_whitespace();
        let id: u64 = number(fields.next(), line)?;
        let position: [f64; 2] = [number(fields.next(), line)?, number(fields.next(), line)?];
        if !position.iter().all(|x| x.is_finite()) {
            return Err(at_line(line, "a coordinate is not a finite number"));
        }
        if positions.insert(id, position).is_some() {
            return Err(at_line(line, "the node number occurs twice"));
        }
    }
    let mut mesh = PlaneMesh::default();
    let mut indices = HashMap::new();
    let mut edges = Vec::new();
    for (line, fields) in section(&lines, "Elements")? {
        let fields = fields.split_whitespace().map(|field| number(Some(field), line));
        let fields: Vec<u64> = fields.collect::<Result<_, _>>()?;
        // Number, kind, count of tags, the physical tag and others, nodes.
        let (kind, tag, nodes) = match &fields[..] {
            [_, kind, tags @ (1..=9), tag, rest @ ..] if rest.len() as u64 + 1 >= *tags => {
                (*kind, *tag, &rest[*tags as usize - 1..])
            }
            _ => return Err(at_line(line, "the element has no physical tag")),
        };
        let corners = elements.iter().find(|element| face_number(**element) == kind);
        let size = corners.map_or(3, |element| 2 * element.corners());
        let nodes = nodes.get(..size).ok_or_else(|| at_line(line, MALFORMED))?;
        if corners.is_some() {
            let node = |id: &u64| {
                let undefined = || at_line(line, "the element refers to an undefined node");
                let position = positions.get(id).ok_or_else(undefined)?;
                Ok(*indices.entry(*id).or_insert_with(|| {
                    mesh.nodes.push(*position);
                    mesh.nodes.len() - 1
                }))
            };
            mesh.faces.push(nodes.iter().map(node).collect::<Result<_, Fault>>()?);
            mesh.surfaces.push(tag as u32);
        } else if kind == LINE_3 {
            let boundary = Boundary::ALL.into_iter().find(|b| u64::from(b.tag()) == tag);
            let unknown = || at_line(line, "the boundary curve has an unknown physical tag");
            edges.push((boundary.ok_or_else(unknown)?, [nodes[0], nodes[1], nodes[2]], line));
        } else {
            let what = "the element is neither the expected face nor a 3-node line";
            return Err(at_line(line, what));
        }
    }
    ensure!(!mesh.faces.is_empty(), "the mesh file contains no faces");
    for (boundary, ids, line) in edges {
        let [Some(a), Some(b), Some(c)] = ids.map(|id| indices.get(&id).copied()) else {
            return Err(at_line(line, "the boundary edge belongs to no face"));
        };
        mesh.edges.push((boundary, [a, b, c]));
    }
    Ok(mesh)
}

/// The numbered lines of $NAME ... $EndNAME, whose count must equal the number in the first line.
fn section<'t>(
    lines: &[(usize, &'t str)],
    name: &str,
) -> Result<impl Iterator<Item = (usize, &'t str)>, Fault> {
    let find = |marker: String| lines.iter().position(|(_, line)| line.trim() == marker);
    let (start, end) = (find(format!("${name}")), find(format!("$End{name}")));
    let rows = start.zip(end).and_then(|(start, end)| lines.get(start + 1..end)?.split_first());
    let Some(((line, count), rows)) = rows else {
        refuse!("the mesh file has no section ${name}: gmsh did not finish writing it");
    };
    if count.trim().parse() != Ok(rows.len()) {
        return Err(at_line(*line, "the section does not have the announced number of lines"));
    }
    Ok(rows.iter().copied())
}

const MALFORMED: &str = "a number is missing or malformed";

/// The number in a field of a line.
fn number<T: FromStr>(field: Option<&str>, line: usize) -> Result<T, Fault> {
    field.and_then(|field| field.parse().ok()).ok_or_else(|| at_line(line, MALFORMED))
}

fn at_line(line: usize, what: &str) -> Fault {
    fault!("line {line} of the mesh file: {what}")
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
        assert!(error.to_string().starts_with("line 18 of the mesh file:"), "{error}");
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
            let place = format!("line {expected} of the mesh file:");
            assert!(error.to_string().starts_with(&place), "{error}");
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
