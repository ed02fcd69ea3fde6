//! Unstructured grids as VTK XML files (.vtu), and collections of such files over time (.pvd), for
//! ParaView and meshio.
//!
//! Numbers are stored inline in binary: base64 of a 64-bit length followed by the values, little
//! endian. They are therefore exact, and may be NaN where a value is unknown.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// A cell type, by its number in VTK.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CellKind {
    /// One point.
    Vertex = 1,
    /// Three corners or more, counter-clockwise.
    Polygon = 7,
    /// 20 nodes: lower corners, upper corners, middles of the lower, the upper and the vertical
    /// edges.
    QuadraticHexahedron = 25,
    /// 15 nodes, in the same order.
    QuadraticWedge = 26,
}

/// Values with a name, one or more numbers for each point or cell.
#[derive(Clone, Debug)]
pub struct Field {
    /// The name, with the unit if the values have one.
    pub name: &'static str,
    /// Numbers for each point or cell.
    pub components: usize,
    /// All numbers.
    pub values: Vec<f64>,
}

/// A grid of cells of one kind.
#[derive(Clone, Debug)]
pub struct UnstructuredGrid {
    /// Positions of the points.
    pub points: Vec<[f64; 3]>,
    /// The kind of all cells.
    pub kind: CellKind,
    /// The points of every cell.
    pub cells: Vec<Vec<usize>>,
    /// Values at the points.
    pub point_data: Vec<Field>,
    /// Values of the cells.
    pub cell_data: Vec<Field>,
}

impl Field {
    /// One number for each point or cell.
    pub fn scalar(name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let values = values.into_iter().collect();
        Self { name, components: 1, values }
    }

    /// N numbers for each point or cell.
    pub fn vector<const N: usize>(
        name: &'static str,
        values: impl IntoIterator<Item = [f64; N]>,
    ) -> Self {
        let values = values.into_iter().flatten().collect();
        Self { name, components: N, values }
    }
}

impl UnstructuredGrid {
    /// The text of the .vtu file.
    pub fn to_vtu(&self) -> String {
        let points = self.points.as_flattened();
        let connectivity = self.cells.iter().flatten().map(|&point| point as i64);
        let ends = self.cells.iter().scan(0, |end, cell| {
            *end += cell.len() as i64;
            Some(*end)
        });
        let kinds = vec![self.kind as u8; self.cells.len()];
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
            self.points.len(),
            self.cells.len()
        );
        text += "<Points>\n";
        array(&mut text, "Float64", "Points", 3, points.iter().flat_map(|x| x.to_le_bytes()));
        text += "</Points>\n<Cells>\n";
        array(&mut text, "Int64", "connectivity", 1, connectivity.flat_map(i64::to_le_bytes));
        array(&mut text, "Int64", "offsets", 1, ends.flat_map(i64::to_le_bytes));
        array(&mut text, "UInt8", "types", 1, kinds);
        text += "</Cells>\n";
        for (part, fields) in [("PointData", &self.point_data), ("CellData", &self.cell_data)] {
            add_line!(text, "<{part}>");
            for Field { name, components, values } in fields {
                let bytes = values.iter().flat_map(|x| x.to_le_bytes());
                array(&mut text, "Float64", name, *components, bytes);
            }
            add_line!(text, "</{part}>");
        }
        text + "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    }
}

fn array(
    text: &mut String,
    number: &str,
    name: &str,
    components: usize,
    bytes: impl IntoIterator<Item = u8>,
) {
    let bytes: Vec<u8> = bytes.into_iter().collect();
    let framed = [&(bytes.len() as u64).to_le_bytes(), &bytes[..]].concat();
    add_line!(
        text,
        "<DataArray type=\"{number}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">{}\
         </DataArray>",
        STANDARD.encode(framed)
    );
}

/// The text of a .pvd file: (time, part, path relative to this file) of each grid.
pub fn collection(grids: &[(f64, usize, String)]) -> String {
    let mut text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n"
            .to_owned();
    for (time, part, file) in grids {
        add_line!(text, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>");
    }
    text + "</Collection>\n</VTKFile>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of an array, found by an XML parser.
    fn read<const N: usize>(text: &str, name: &str) -> Vec<[u8; N]> {
        let document = roxmltree::Document::parse(text).unwrap();
        let mut nodes = document.descendants();
        let array = nodes.find(|node| node.attribute("Name") == Some(name));
        let text = array.unwrap().text().unwrap().trim();
        let bytes = STANDARD.decode(text).unwrap();
        let (length, bytes) = bytes.split_first_chunk::<8>().unwrap();
        assert_eq!(u64::from_le_bytes(*length), bytes.len() as u64);
        let (numbers, rest) = bytes.as_chunks::<N>();
        assert!(rest.is_empty());
        numbers.to_vec()
    }

    #[test]
    fn a_grid_is_read_back_exactly() {
        let grid = UnstructuredGrid {
            points: vec![
                [0.0, 0.1, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, -1.0 / 3.0],
                [0.0, 1.0, 0.0],
                [2.0; 3],
            ],
            kind: CellKind::Polygon,
            cells: vec![vec![0, 1, 2, 3], vec![1, 4, 2, 3]],
            point_data: vec![Field::vector("u (mm)", [[1e-300, -2.5, 3.0]; 5])],
            cell_data: vec![Field::scalar("D", [0.25, f64::NAN])],
        };
        let text = grid.to_vtu();
        let document = roxmltree::Document::parse(&text).unwrap();
        let mut nodes = document.descendants();
        let piece = nodes.find(|node| node.has_tag_name("Piece")).unwrap();
        assert_eq!(piece.attribute("NumberOfPoints"), Some("5"));
        assert_eq!(piece.attribute("NumberOfCells"), Some("2"));
        let numbers = |name| read(&text, name).into_iter().map(f64::from_le_bytes);
        assert!(numbers("Points").eq(grid.points.as_flattened().iter().copied()));
        assert!(numbers("u (mm)").eq(grid.point_data[0].values.iter().copied()));
        let damage: Vec<f64> = numbers("D").collect();
        assert!(damage[0] == 0.25 && damage[1].is_nan());
        let whole = |name| read(&text, name).into_iter().map(i64::from_le_bytes);
        assert!(whole("connectivity").eq([0, 1, 2, 3, 1, 4, 2, 3]));
        assert!(whole("offsets").eq([4, 8]));
        assert_eq!(read::<1>(&text, "types"), [[7], [7]]);
    }

    #[test]
    fn a_collection_names_its_files_over_time() {
        let text = collection(&[(0.0, 0, "a.vtu".into()), (0.5, 1, "b.vtu".into())]);
        let document = roxmltree::Document::parse(&text).unwrap();
        let nodes = document.descendants();
        let sets: Vec<_> = nodes.filter(|node| node.has_tag_name("DataSet")).collect();
        assert_eq!(sets.len(), 2);
        assert_eq!(sets[1].attribute("timestep"), Some("0.5"));
        assert_eq!(sets[1].attribute("file"), Some("b.vtu"));
    }
}
