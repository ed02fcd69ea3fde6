use hinge::*;
use std::path::Path;
fn main() {
    for file in std::env::args().skip(1) {
        let parquet = Path::new(&file);
        let json = parquet.with_extension("json");
        let mut value: serde_json::Value =
            serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
        value.as_object_mut().unwrap().shift_remove("holes");
        value["domain"]
            .as_object_mut()
            .unwrap()
            .shift_remove("hole");
        std::fs::write(&json, support::sealed_json::to_vec(&value).unwrap()).unwrap();
        let db = dataset::Database::read(parquet).unwrap();
        let domain =
            TrainingDomain::covering(db.rows().iter().map(|r| (r.design, r.sample.deformation())))
                .unwrap();
        value["domain"] = serde_json::to_value(&domain).unwrap();
        std::fs::write(&json, support::sealed_json::to_vec(&value).unwrap()).unwrap();
        dataset::Database::read(parquet).unwrap();
    }
}
