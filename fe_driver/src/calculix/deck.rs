//! The CalculiX input deck of one window solve.
//!
//! Two control nodes without elements carry the four amplitudes of the prescribed motion; linear constraint
//! equations couple arc B to them. All output is printed in every increment, because CalculiX accumulates the
//! total internal energy between *printed* increments and it would otherwise be wrong.

use crate::calculix::cards::{
    real, write_amplitude, write_element, write_increments, write_material, write_nodes, write_set,
};
use crate::calculix::model::WindowModel;
use crate::calculix::panel_motion::PanelMotion;
use crate::solve::deformation_path::DeformationPath;
use mesher::WindowMesh;
use std::fmt::{self, Write};

/// Number of intervals of the amplitude tables. Between entries the motion is linear: the chord shortens
/// the lever arm of arc B by r dtheta^2 / 8. Intervals of 0.1 deg keep the energy error below 3e-4.
const AMPLITUDE_INTERVALS: usize = 720;

/// The deck that drives the window along its path.
pub fn deck(model: &WindowModel) -> String {
    let mut text = String::new();
    write_deck(&mut text, model).expect("writing to a string cannot fail");
    text
}

fn write_deck(d: &mut String, model: &WindowModel) -> fmt::Result {
    let mesh = model.mesh;
    let turner = mesh.nodes.len() + 1;
    let mover = turner + 1;
    write_nodes(d, &mesh.nodes)?;
    writeln!(d, "*NODE,NSET=CONTROL\n{turner},0.,0.,0.\n{mover},0.,0.,0.")?;
    let kind = mesh.recipe.element().name();
    writeln!(d, "*ELEMENT,TYPE={kind},ELSET=EALL")?;
    for (element, nodes) in mesh.elements.iter().enumerate() {
        write_element(d, element, nodes)?;
    }
    write_set(d, "NSET", "ARCA", &mesh.arc_a)?;
    write_set(d, "NSET", "ARCB", &mesh.arc_b)?;
    write_set(d, "NSET", "BOTTOM", &mesh.bottom)?;
    write_material(d, model.material)?;
    writeln!(d, "*SOLID SECTION,ELSET=EALL,MATERIAL=SHEET")?;
    write_equations(d, mesh, turner, mover)?;
    write_amplitudes(d, model.path)?;
    writeln!(d, "*STEP,NLGEOM,INC={}\n*STATIC", model.step.max_increments)?;
    write_increments(d, model.step, 1.0)?;
    writeln!(d, "*BOUNDARY\nARCA,1,3,0.\nARCB,3,3,0.\nCONTROL,3,3,0.")?;
    let freedoms = [(turner, 1), (turner, 2), (mover, 1), (mover, 2)];
    for (i, (node, freedom)) in freedoms.into_iter().enumerate() {
        writeln!(d, "*BOUNDARY,AMPLITUDE=Q{}", i + 1)?;
        writeln!(d, "{node},{freedom},{freedom},1.")?;
    }
    writeln!(d, "*NODE PRINT,NSET=ARCB,FREQUENCY=1\nRF")?;
    let displaced = if model.print_all { "NALL" } else { "BOTTOM" };
    writeln!(d, "*NODE PRINT,NSET={displaced},FREQUENCY=1\nU")?;
    writeln!(d, "*EL PRINT,ELSET=EALL,TOTALS=ONLY,FREQUENCY=1\nELSE")?;
    writeln!(d, "*EL PRINT,ELSET=EALL,FREQUENCY=1\nPEEQ,S\n*END STEP")
}

/// The two constraint equations of every node of arc B; (x, y) is its position relative to O.
fn write_equations(d: &mut String, mesh: &WindowMesh, turner: usize, mover: usize) -> fmt::Result {
    let tip = mesh.design.tip();
    writeln!(d, "*EQUATION")?;
    for index in &mesh.arc_b {
        let node = index + 1;
        let [x, y] = [0, 1].map(|i| mesh.nodes[*index][i] - tip[i]);
        for (freedom, by_q1, by_q2) in [(1, -x, y), (2, -y, -x)] {
            let (by_q1, by_q2) = (real(by_q1), real(by_q2));
            writeln!(
                d,
                "4\n{node},{freedom},1.,{turner},1,{by_q1},{turner},2,{by_q2},{mover},{freedom},-1."
            )?;
        }
    }
    Ok(())
}

fn write_amplitudes(d: &mut String, path: &DeformationPath) -> fmt::Result {
    let even = (0..=AMPLITUDE_INTERVALS).map(|i| i as f64 / AMPLITUDE_INTERVALS as f64);
    let mut lambdas: Vec<_> = even.chain(path.corners()).collect();
    lambdas.sort_unstable_by(f64::total_cmp);
    // Entries closer than the written precision would give one time with two values.
    lambdas.dedup_by(|next, kept| *next - *kept < 1e-9);
    for i in 0..4 {
        let pairs = lambdas.iter().map(|lambda| {
            let q = PanelMotion::new(&path.at(*lambda)).amplitudes()[i];
            [*lambda, q]
        });
        write_amplitude(d, &format!("Q{}", i + 1), pairs)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use hinge::HingeDeformation;

    #[test]
    fn amplitudes_start_at_zero_and_end_at_the_end_of_the_path() {
        let end = HingeDeformation {
            a: -1.0,
            s: 2.0,
            theta: 1.2,
        };
        let mut text = String::new();
        write_amplitudes(&mut text, &DeformationPath::straight(end)).unwrap();
        let tables: Vec<Vec<f64>> = text
            .split("*AMPLITUDE,NAME=Q")
            .skip(1)
            .map(|table| {
                let (_, numbers) = table.split_once('\n').unwrap();
                let fields = numbers.split([',', '\n']).filter(|field| !field.is_empty());
                fields.map(|field| field.parse().unwrap()).collect()
            })
            .collect();
        let end = PanelMotion::new(&end).amplitudes();
        assert_eq!(tables.len(), 4);
        for (table, end) in tables.iter().zip(end) {
            assert_eq!(table.len(), 2 * (AMPLITUDE_INTERVALS + 1));
            assert_eq!(table[..2], [0.0, 0.0]);
            assert_eq!(table[table.len() - 2], 1.0);
            assert!((table[table.len() - 1] - end).abs() < 1e-10);
        }
    }
}
