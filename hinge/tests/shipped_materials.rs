//! Every material in `configs/materials` is read and valid. The materials of the paper's Table 2
//! have its Young's modulus, density and thickness; the others are plates.

use hinge::SheetMaterial;
use std::path::Path;

/// (file, E in MPa, density in kg/m^3, thickness in mm); Table 2.
const TABLE_2: [(&str, f64, f64, f64); 5] = [
    ("paper-0.2mm", 3e3, 800.0, 0.2),
    ("pet-0.5mm", 3e3, 1390.0, 0.5),
    ("polypropylene-0.8mm", 1.5e3, 910.0, 0.8),
    ("aluminium-1.0mm", 70e3, 2700.0, 1.0),
    ("s235-1.5mm", 210e3, 7850.0, 1.5),
];

#[test]
fn every_shipped_material_is_valid_and_those_of_table_2_agree_with_it() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/materials");
    let mut read = 0;
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        let material = SheetMaterial::load(&path).unwrap();
        assert_eq!(Some(material.name.as_str()), path.file_stem().unwrap().to_str());
        match TABLE_2.iter().find(|row| material.name.starts_with(row.0)) {
            Some(row) => {
                let found = (material.young, material.density_kg_m3, material.thickness);
                assert_eq!(found, (row.1, row.2, row.3), "{}", material.name);
                read += 1;
            }
            None => assert!(material.thickness >= 1.0, "{}", material.name),
        }
        let [_, last] = material.plastic[material.plastic.len() - 1];
        assert!(last <= material.fracture_strain, "{}", material.name);
    }
    assert_eq!(read, TABLE_2.len() + 1);
}
