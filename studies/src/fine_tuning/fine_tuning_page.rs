//! The tables of the study of fine-tuning.

use super::{COMPARED, Material, Measured, TEST, VALIDATION, Way};
use crate::charts::Curve;
use ::train::TrainingConfig;
use anyhow::Result;
use std::fmt::Write;
use surrogate::{forces_percent, number_or_dash};

/// Errors against rays for each way.
pub fn curves(material: &Material) -> Vec<Curve> {
    let curve = |way: Way| {
        let measured = || material.measured.iter().filter(move |it| it.way == way);
        let point = |it: &Measured, error: f64| (it.rays as f64, error);
        Curve {
            title: way.to_string(),
            energy: measured().map(|it| point(it, it.test[0])).collect(),
            forces: measured()
                .map(|it| point(it, forces_percent(&it.test)))
                .collect(),
        }
    };
    COMPARED.map(curve).into()
}

pub fn csv(materials: &[Material]) -> Result<String> {
    let mut text =
        "material,way,training_rays,validation_w_percent,validation_forces_percent,w_percent,\
        f_a_percent,f_s_percent,m_theta_percent,d_percent,d_peak_percent,training_s\n"
            .to_owned();
    for material in materials {
        for it in &material.measured {
            let validation = [it.validation[0], forces_percent(&it.validation)];
            write!(text, "{},\"{}\",{}", material.name, it.way, it.rays)?;
            for error in validation.iter().chain(&it.test) {
                write!(text, ",{error:.4}")?;
            }
            writeln!(text, ",{:.1}", it.training_s)?;
        }
    }
    Ok(text)
}

pub fn markdown(
    materials: &[Material],
    [scratch, tuned]: &[TrainingConfig; 2],
    splits: u64,
) -> Result<String> {
    let mut text = format!(
        "# Fine-tuning\n\nRelative root mean square errors (%) on hinge geometries that are in no training and no choice, \
         {:.0} % of all; root mean squares over {splits} splits. Forces: root mean square of the errors of F_a, F_s \
         and M. Validation: the {:.0} % of the geometries by which epochs and recipe are chosen. From scratch: {} epochs, \
         learning rate {}. Fine-tuned: {} epochs, learning rate {}, where no other is given.\n",
        100.0 * TEST,
        100.0 * VALIDATION,
        scratch.epochs,
        scratch.learning_rate,
        tuned.epochs,
        tuned.learning_rate,
    );
    for material in materials {
        write!(
            text,
            "\n## {}, {} rays\n\n| weights | training rays | validation: W | forces | W | F_a | F_s | M | forces | D | \
             D_peak | training |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
            material.name, material.rays
        )?;
        for it in &material.measured {
            let [w, f_a, f_s, m_theta, ..] = it.test;
            let [.., d, d_peak] = it.test.map(|error| number_or_dash(error, 1));
            writeln!(
                text,
                "| {} | {} | {:.2} | {:.1} | {w:.2} | {f_a:.1} | {f_s:.1} | {m_theta:.1} | {:.1} | {d} | {d_peak} | \
                 {:.0} s |",
                it.way,
                it.rays,
                it.validation[0],
                forces_percent(&it.validation),
                forces_percent(&it.test),
                it.training_s
            )?;
        }
        let (name, chart) = (&material.name, material.chart());
        write!(text, "\n![errors against rays, {name}]({chart}.png)\n")?;
    }
    Ok(text)
}
