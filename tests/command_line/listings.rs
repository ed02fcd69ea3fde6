//! The output of `inspect` `equilibrium` and `gradient` with `--json` for a reference case. The
//! panels of the case are 1 x 1; here they are 100 mm wide, with the constants of (11) that give the
//! same shape.

use crate::common::Workplace;
use serde_json::Value;
use std::path::Path;

/// Size of a panel (mm).
const SIZE: f64 = 100.0;

fn case(name: &str) -> Value {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("design/tests/cases");
    let text = std::fs::read_to_string(cases.join(format!("{name}.json"))).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The output of a command for a scene with the given sections.
fn printed(work: &Workplace, command: &str, sections: &str, options: &str) -> Value {
    let scene = format!(
        "title = \"Case\"\nmaterial = \"configs/materials/pet-0.5mm.toml\"\noutput = \"run\"\n{sections}\n\
         [process]\nfillet_ratio = 0.16\nslit_width = 0.2\nr_win = 100.0\n\
         [ligament]\nstart = 15.0\nrange = [5.0, 25.0]\n\
         [optimiser]\nsteps = 1\nlearning_rate = 0.1\n"
    );
    work.write("case.toml", scene);
    let text = work.output(&format!("inspect {command} case.toml {options}"));
    serde_json::from_str(&text).unwrap()
}

fn sheet(case: &Value, start: &Value) -> String {
    let corners = case["outline_corners"].as_array().unwrap().iter();
    let corners: Vec<[f64; 2]> =
        corners.map(|corner| [0, 1].map(|axis| SIZE * corner[axis].as_f64().unwrap())).collect();
    let (m, n) = (&case["M"], &case["N"]);
    let numbers = |value: &Value| -> Vec<f64> { serde_json::from_value(value.clone()).unwrap() };
    let r: Vec<f64> = (numbers(&start["z"]).iter()).map(|z| 1.0 / (1.0 + (-z).exp())).collect();
    let edges = start["ell"].as_array().unwrap().iter();
    let tau: Vec<Vec<f64>> = edges.map(|ell| positions(&numbers(ell))).collect();
    format!(
        "[sheet]\ncorners = {corners:?}\npanels = [{m}, {n}]\n[start]\nr = {r:?}\ntau = {tau:?}"
    )
}

/// The positions of the cuts on an edge from the logits of their intervals; (5).
fn positions(ell: &[f64]) -> Vec<f64> {
    let total: f64 = ell.iter().map(|logit| logit.exp()).sum();
    let sums = ell.iter().scan(0.0, |sum, logit| {
        *sum += logit.exp() / total;
        Some(*sum)
    });
    sums.take(ell.len() - 1).collect()
}

/// That they agree with an independent implementation is tested in `design`, without contact, as
/// the implementation has none.
#[test]
fn equilibria_objective_and_gradient() {
    let work = Workplace::new();
    let case = case("g0_3x3_linear_path");
    let theta = &case["theta"];
    let widths = case["w_lig"].as_array().unwrap().iter();
    let widths: Vec<f64> = widths.map(|w| SIZE * w.as_f64().unwrap()).collect();
    let sections = format!(
        "level = \"linear\"\nload_steps = 5\n{}\nw_lig = {widths:?}\n\
         [linear]\nk_a = 1.0\nk_s = 0.6\nk_theta = 100.0\n\
         [[supports]]\npanel = [0, 1]\nkind = \"clamp\"\n\
         [[loads]]\npanel = [2, 1]\nforce = [1.2, 0.0]\n\
         [target.circle]\ncentre = [170.0, 150.0]\nradius = 220.0\n\
         [objective]\ncompression = 0.3\nshear = 0.2\n",
        sheet(&case, theta)
    );
    let equilibrium = printed(&work, "equilibrium", &sections, "");
    let steps = equilibrium["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 5);
    assert!(steps.iter().all(|step| step["status"] == "converged"));
    let gradient = printed(&work, "gradient", &sections, "");
    work.edit("case.toml", &[("force = [1.2, 0.0]", "force = [1.2, nan]")]);
    assert!(work.error("inspect gradient case.toml").contains("loads[0].force"));
    let number = |of: &Value| of.as_f64().unwrap();
    let terms = gradient["terms"].as_object().unwrap().iter();
    let sum: f64 =
        terms.map(|(name, value)| number(value) * number(&gradient["weights"][name])).sum();
    assert!((sum / number(&gradient["loss"]) - 1.0).abs() < 1e-12);
    for key in ["compression", "shear"] {
        assert!(number(&gradient["terms"][key]) > 0.0, "{key}");
    }
    let omega = gradient["grad"]["omega"].as_array().unwrap();
    assert!(omega.len() == 12 && omega.iter().all(|slope| number(slope) != 0.0));
}
