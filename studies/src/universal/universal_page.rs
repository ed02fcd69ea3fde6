//! The tables of the study of the family of laws.

use crate::charts::Curve;
use crate::universal::cases::{Case, HELD_OUT, Material, Measured, Network, Way};
use crate::universal::family_table::SolvedRay;
use crate::universal::judgement::Errors;
use crate::universal::law::Law;
use std::fmt::{Display, Formatter, Result as FmtResult, Write};

pub fn csv(measured: &Measured) -> String {
    let mut text =
        "target,energy,laws,own_rays,splits,w_percent,f_a_percent,f_s_percent,m_theta_percent,\
                    factor_minus_one_percent,w_with_factor_percent\n"
            .to_owned();
    for (case, errors) in measured {
        let count = errors.len();
        let Errors {
            w,
            forces: [f_a, f_s, m_theta],
            w_with_factor,
            factor,
        } = Errors::averaged(errors);
        let Case {
            target,
            way,
            laws,
            own_rays,
        } = case;
        text += &format!(
            "{target},\"{way}\",{laws},{own_rays},{count},{w:.4},{f_a:.4},{f_s:.4},{m_theta:.4},{factor:.4},\
             {w_with_factor:.4}\n"
        );
    }
    text
}

/// Errors on the laws held out against the number of laws, for each network.
pub fn curves(measured: &Measured) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for (case, errors) in measured.iter().filter(|(case, _)| case.target == HELD_OUT) {
        let title = case.way.to_string();
        let errors = Errors::averaged(errors);
        if curves.last().is_none_or(|curve| curve.title != title) {
            let title = title.clone();
            curves.push(Curve {
                title,
                ..Curve::default()
            });
        }
        if let Some(curve) = curves.last_mut() {
            let laws = case.laws as f64;
            curve.energy.push((laws, errors.w));
            curve.forces.push((laws, errors.all_forces()));
        }
    }
    curves
}

pub fn markdown(
    rays: &[SolvedRay],
    materials: &[Material],
    measured: &Measured,
    splits: u64,
) -> String {
    let states: usize = rays.iter().map(|ray| ray.states.len()).sum();
    let cpu_minutes = rays.iter().map(|ray| ray.cpu_seconds).sum::<f64>() / 60.0;
    let mut text = format!(
        "# Universal hinge\n\n{} rays, one law each, {states} states, {cpu_minutes:.0} CPU minutes. Root mean squares of the \
         errors over those of the quantity, in per cent, over {splits} splits of the laws and of the geometries. Forces: root mean \
         square of the errors of F_a, F_s and M. Factor: the one factor of all energies that is best at these states, minus \
         one; W with it.\n\n## Laws of the materials\n\n| material | nu | yield strain | plateau | hardening | rays | states |\n\
         |---|---|---|---|---|---|---|\n",
        rays.len()
    );
    let mut line = |row: String| text += &format!("| {row} |\n");
    for material in materials {
        let Law {
            poisson,
            yield_strain,
            plateau,
            hardening,
        } = Law::of_material(&material.sheet);
        let rays = material.database.manifest().rays;
        line(format!(
            "{} | {poisson} | {yield_strain:.5} | {plateau:.3} | {hardening:.5} | {rays} | {}",
            material.sheet.name,
            material.states.len()
        ));
    }
    text += "\n## Without a ray of the material\n\n| tested on | energy | laws | W | F_a | F_s | M | forces | factor | \
             W with factor |\n|---|---|---|---|---|---|---|---|---|---|\n";
    let without = |case: &Case| case.own_rays == 0 && !matches!(case.way, Way::FamilyTuned(_));
    for (case, errors) in measured.iter().filter(|(case, _)| without(case)) {
        let errors = Errors::averaged(errors);
        let [f_a, f_s, m_theta] = errors.forces;
        let laws = match case.laws {
            0 => "-".to_owned(),
            laws => laws.to_string(),
        };
        writeln!(
            text,
            "| {} | {} | {laws} | {:.2} | {f_a:.1} | {f_s:.1} | {m_theta:.1} | {:.1} | {:+.1} | {:.2} |",
            case.target,
            case.way,
            errors.w,
            errors.all_forces(),
            errors.factor,
            errors.w_with_factor
        )
        .expect("writing to a string does not fail");
    }
    text += "\n## With rays of the material\n\nOn a fifth of its geometries.\n\n| material | energy | rays | W | F_a | F_s | M | \
             forces |\n|---|---|---|---|---|---|---|---|\n";
    let with = |case: &Case| case.laws == 0 && case.way != Way::Film;
    for (case, errors) in measured.iter().filter(|(case, _)| with(case)) {
        let errors = Errors::averaged(errors);
        let [f_a, f_s, m_theta] = errors.forces;
        writeln!(
            text,
            "| {} | {} | {} | {:.2} | {f_a:.1} | {f_s:.1} | {m_theta:.1} | {:.1} |",
            case.target,
            case.way,
            case.own_rays,
            errors.w,
            errors.all_forces()
        )
        .expect("writing to a string does not fail");
    }
    text += "\n![errors on laws held out against the number of laws](universal.png)\n";
    text
}

impl Display for Way {
    fn fmt(&self, f: &mut Formatter) -> FmtResult {
        match self {
            Self::Film => write!(f, "film"),
            Self::Family(network) => write!(f, "{network}"),
            Self::MeanOfWorks => write!(f, "mean of the networks of works"),
            Self::FilmTimes => write!(f, "film times factor"),
            Self::FamilyTimes(network) => write!(f, "{network}, times factor"),
            Self::FamilyTuned(network) => write!(f, "{network}, fine-tuned"),
            Self::FilmTuned => write!(f, "film, fine-tuned"),
        }
    }
}

impl Display for Network {
    fn fmt(&self, f: &mut Formatter) -> FmtResult {
        f.write_str(match self {
            Self::Numbers => "numbers",
            Self::TimesFilm => "numbers times film",
            Self::Works => "works",
            Self::WorksOfAll => "works and numbers, other materials",
            Self::WorksAndNumbers => "works and numbers",
            Self::WorksTimesFilm => "works times film",
            Self::WorksAndNumbersTimesFilm => "works and numbers times film",
        })
    }
}
