//! `kirigami-studies window`: the influence of the modelling choices of the window solve.

mod convergence;

use crate::charts::{self, StudyPanel};
use crate::window::convergence::{
    Richardson, StudyCase, richardson, study_cases, study_difference, study_state,
};
use anyhow::{Result, ensure};
use clap::Args;
use fe_driver::Solved;
use hinge::{HingeConstants, HingeDesign, Regime, SheetMaterial};
use kirigami::commands::solve_args::{SolveArgs, task_error};
use kirigami::ui::{picture, run_folder};
use mesher::{MeshRecipe, PlaneRecipe, Tier};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Measure the convergence of the window solve: mesh, increments, imperfection, window radius, layers
///
/// Six hinges are rotated by 60 degrees, with one choice varied at a time. Hinges with a cut angle of 120 degrees
/// are not solved: they are the mirror images of those of 60. Solutions are stored in the
/// folder, so the study can be stopped and continued. Writes window.csv, window.md,
/// tradeoff.md and window.svg. Examples: kirigami-studies window --quick; kirigami-studies window --plate
#[derive(Args)]
pub struct WindowStudy {
    /// Solve only the paper's hinge, 18 mm and 90 degrees, without the tiers that take minutes
    #[arg(long)]
    quick: bool,
    /// Hinges of a plate, which turn about their middle, in place of those of a film
    #[arg(long)]
    plate: bool,
    /// Sheet material (TOML) [default: configs/materials/pet-0.5mm.toml; with --plate polypropylene-3mm.toml]
    #[arg(long, value_name = "FILE")]
    material: Option<PathBuf>,
    /// Folder for the tables, the chart and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-window")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// A case with its solution.
type Row = (StudyCase, Solved);

impl WindowStudy {
    pub fn run(&self) -> Result<()> {
        let usual = Path::new("configs/materials").join(match self.regime() {
            Regime::Film => "pet-0.5mm.toml",
            Regime::Plate => "polypropylene-3mm.toml",
        });
        let material = SheetMaterial::load(self.material.as_deref().unwrap_or(&usual))?;
        let _held = run_folder::hold(&self.out)?;
        let hinges = self.hinges().into_iter();
        let windows = self.solve.service(&self.out)?;
        let versions = windows.versions();
        let cases: Vec<_> = hinges
            .flat_map(|design| study_cases(design, self.regime(), &material, &versions, self.quick))
            .collect();
        let solves: Vec<_> = cases.iter().map(|case| case.solve.clone()).collect();
        let solved = windows.solve(&solves);
        let solved = solved.map_err(|error| task_error(error.into()))?;
        let (mut rows, mut failures): (Vec<Row>, _) = (Vec::new(), String::new());
        for (case, window) in cases.into_iter().zip(solved) {
            match window.complete() {
                Err(unsolved) => writeln!(failures, "* {}: {unsolved}", title(&case))?,
                // The ladder ended on a finer mesh: nothing is known of that of the case.
                Ok(_) if window.record.tier != case.solve.problem.tier => {
                    let tier = window.record.tier;
                    writeln!(failures, "* {}: solved only on {tier}", title(&case))?;
                }
                Ok(_) => rows.push((case, window)),
            }
        }
        ensure!(
            !rows.is_empty(),
            "no case was solved; the error of the first: {}",
            failures.lines().next().unwrap_or_default()
        );
        run_folder::write(&self.out, "window.csv", &csv(&rows))?;
        run_folder::write(&self.out, "window.md", &markdown(&rows, &failures)?)?;
        run_folder::write(
            &self.out,
            "tradeoff.md",
            &(tradeoff(&rows)? + &at_equal_error(&rows)?),
        )?;
        let chart = charts::studies(&panels(&rows), "difference in W(45 deg), %")?;
        let pictures = picture::save(&chart, &self.out.join("window"), 1600)?;
        println!("{} solves; {}", rows.len(), pictures[1].display());
        match failures.lines().count() {
            0 => {}
            count => println!("{count} cases were not solved: see window.md"),
        }
        Ok(())
    }

    fn regime(&self) -> Regime {
        if self.plate {
            Regime::Plate
        } else {
            Regime::Film
        }
    }

    fn hinges(&self) -> Vec<HingeDesign> {
        let (widths, usual, constants) = match self.regime() {
            Regime::Film => ([5.0, 18.0, 25.0], 18.0, HingeConstants::PAPER),
            Regime::Plate => ([1.0, 2.0, 3.0], 2.0, PLATE),
        };
        let all = widths.map(|w| [60.0, 90.0].map(|alpha| (w, alpha)));
        all.into_iter()
            .flatten()
            .filter(|hinge| !self.quick || *hinge == (usual, 90.0))
            .map(|(w_lig, alpha_deg)| constants.hinge(w_lig, f64::to_radians(alpha_deg)))
            .collect()
    }
}

/// The constants of the hinges of a plate of 3 mm.
const PLATE: HingeConstants = HingeConstants {
    r_win: 12.0,
    ..HingeConstants::PAPER
};

/// The hinge and the value of a case.
fn title(case: &StudyCase) -> String {
    format!(
        "{}, {}, {}",
        hinge_name(&case.solve.problem.hinge.design),
        case.study,
        case.value
    )
}

fn hinge_name(design: &HingeDesign) -> String {
    let alpha_deg = design.alpha.to_degrees();
    format!("{} mm, {alpha_deg:.0} deg", design.w_lig)
}

/// CPU time of the solver (s).
fn cpu_seconds(solution: &Solved) -> f64 {
    solution.record.cpu_seconds
}

/// One row per solve.
fn csv(rows: &[Row]) -> String {
    let mut text = "study,value,w_lig_mm,alpha_deg,elements,cpu_seconds,iterations,\
        w_45deg_n_mm,f_a_45deg_n,m_theta_45deg_n_mm,d_45deg,uz_50deg_mm,\
        difference_w,difference_f_a,difference_m_theta,difference_d\n"
        .to_owned();
    for row @ (case, solution) in rows {
        let [w, f_a, m, d, _] = study_state(solution, 45.0);
        let [.., uz] = study_state(solution, 50.0);
        let [dw, df, dm, dd, _] = difference(row, rows);
        let (design, study, value) = (&case.solve.problem.hinge.design, case.study, &case.value);
        let alpha_deg = design.alpha.to_degrees();
        let (elements, cpu) = (solution.record.elements, cpu_seconds(solution));
        let (w_lig, iterations) = (design.w_lig, solution.record.iterations);
        text += &format!(
            "{study},{value},{w_lig},{alpha_deg:.0},{elements},{cpu:.1},{iterations},\
             {w:.4},{f_a:.4},{m:.4},{d:.6},{uz:.3},{dw:.5},{df:.5},{dm:.5},{dd:.5}\n"
        );
    }
    text
}

/// The difference of a row from its reference; NaN if the reference failed.
fn difference((case, solution): &Row, rows: &[Row]) -> [f64; 5] {
    let against = rows.iter().find(|(other, _)| is_compared(case, other));
    against.map_or([f64::NAN; 5], |(_, other)| {
        study_difference(solution, other)
    })
}

fn markdown(rows: &[Row], failures: &str) -> Result<String> {
    let mut text = "# Convergence of the window solve\n\n\
        Rotations to 60 degrees, of a film about the tip, of a plate about the middle of the ligament. Differences are \
        root mean squares over the ray, relative to the value named in the heading.\n"
        .to_owned();
    let mut heading = String::new();
    for row @ (case, solution) in rows {
        let own = format!(
            "{}: {} against {}",
            hinge_name(&case.solve.problem.hinge.design),
            case.study,
            case.against
        );
        if own != heading {
            write!(
                text,
                "\n## {own}\n\n| value | elements | CPU s | W(45), N mm | u_z(50), mm | W | F_a \
                 | M_theta | D |\n|---|---|---|---|---|---|---|---|---|\n"
            )?;
            heading = own;
        }
        let ([w, ..], [.., uz]) = (study_state(solution, 45.0), study_state(solution, 50.0));
        let [dw, df, dm, dd, _] = difference(row, rows).map(|x| 100.0 * x);
        writeln!(
            text,
            "| {} | {} | {:.1} | {w:.2} | {uz:.2} | {dw:.2} % | {df:.2} % | {dm:.2} % | {dd:.2} % |",
            case.value,
            solution.record.elements,
            cpu_seconds(solution)
        )?;
    }
    text += &extrapolation(rows)?;
    let is_paper = |row: &Row| row.0.solve.problem.material.name == "pet-0.5mm";
    if rows.iter().all(is_paper) {
        text += &paper_comparison(rows)?;
    }
    if !failures.is_empty() {
        write!(text, "\n## Solves that did not reach the end\n\n{failures}")?;
    }
    Ok(text)
}

/// The states at 45 degrees, extrapolated from the three finest meshes.
fn extrapolation(rows: &[Row]) -> Result<String> {
    let mut text = "\n## Richardson estimates of the default tier at 45 degrees\n\n\
        From the three finest tiers, whose elements are similar. The order is the observed one, \
        or 2 (in brackets) if no order is observed.\n\n\
        | hinge | quantity | default | size 0 | order | error of the default |\n\
        |---|---|---|---|---|---|\n"
        .to_owned();
    for hinge in hinges(rows) {
        let ladder = similar_meshes(rows, &hinge);
        let (Some([x, y, z]), Some(default)) = (ladder.last_chunk(), tier(rows, &hinge, "default"))
        else {
            continue;
        };
        let sizes = [x.0, y.0, z.0];
        let states = [x.1, y.1, z.1].map(|solution| study_state(solution, 45.0));
        for (i, name) in ["W, N mm", "F_a, N", "M_theta, N mm", "D"]
            .iter()
            .enumerate()
        {
            let Richardson {
                order,
                observed,
                limit,
            } = richardson(sizes, states.map(|state| state[i]));
            let known = study_state(default, 45.0)[i];
            let error = 100.0 * (known / limit - 1.0);
            let order = if observed {
                format!("{order:.1}")
            } else {
                "(2)".to_owned()
            };
            writeln!(
                text,
                "| {hinge} | {name} | {known:.4} | {limit:.4} | {order} | {error:+.1} % |"
            )?;
        }
    }
    Ok(text)
}

/// The solved two-layer tiers of a hinge with the element size relative to that of the default
/// tier, in descending order of size.
fn similar_meshes<'a>(rows: &'a [Row], hinge: &str) -> Vec<(f64, &'a Solved)> {
    let fold_size = |recipe: MeshRecipe| match recipe.plane {
        PlaneRecipe::Structured(plane) if recipe.layers == 2 => Some(plane.fold_size),
        _ => None,
    };
    let unit = fold_size(Tier::Default.recipe()).unwrap_or(1.0);
    of_tiers(rows, hinge)
        .filter_map(|(case, solution)| Some((fold_size(case.solve.mesh)? / unit, solution)))
        .collect()
}

/// The rows of the mesh study of one hinge.
fn of_tiers<'a>(rows: &'a [Row], hinge: &str) -> impl Iterator<Item = &'a Row> {
    rows.iter().filter(move |(case, _)| {
        case.study == "mesh" && hinge_name(&case.solve.problem.hinge.design) == hinge
    })
}

fn tier<'a>(rows: &'a [Row], hinge: &str, name: &str) -> Option<&'a Solved> {
    let mut found = of_tiers(rows, hinge).filter(|(case, _)| case.value == name);
    found.next().map(|(_, solution)| solution)
}

/// Names of the hinges, without duplicates, in the order of the study.
fn hinges(rows: &[Row]) -> Vec<String> {
    let mut names: Vec<_> = rows
        .iter()
        .map(|(case, _)| hinge_name(&case.solve.problem.hinge.design))
        .collect();
    names.dedup();
    names
}

/// One row per tier: its cost, and its largest difference from the finest tier over the hinges.
fn tradeoff(rows: &[Row]) -> Result<String> {
    let mesh = rows.iter().find(|(case, _)| case.study == "mesh");
    let against = mesh.map_or("none", |(case, _)| &case.against);
    let mut text = format!(
        "## Window tier\n\n\
        Rotations to 60 degrees. CPU time (mean over the hinges) and memory (maximum over the hinges) are those \
        of CalculiX. Differences from the tier `{against}` are root mean squares over the ray, the maximum over the \
        hinges. Driver is the fraction of the time from the mesh to the samples in which CalculiX does not run \
        (median). Two cores solve two rays at a time. `kirigami-studies window`.\n\n\
        | tier | hinges | elements | CPU s per ray | CPU s per row | rays per hour, 2 cores | memory, MiB \
        | driver | W | F_a | M_theta | D |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n"
    );
    for name in Tier::ALL.map(Tier::name) {
        let solved: Vec<_> = rows
            .iter()
            .filter(|(case, _)| case.study == "mesh" && case.value == name)
            .collect();
        let Some((_, first)) = solved.first() else {
            continue;
        };
        let sum = |of: fn(&Solved) -> f64| solved.iter().map(|(_, s)| of(s)).sum::<f64>();
        let cpu = sum(cpu_seconds);
        let ray = cpu / solved.len() as f64;
        let row = cpu / sum(|s| s.samples.len() as f64);
        let memory = solved.iter().filter_map(|(_, s)| s.record.peak_memory_mib);
        let memory = memory.fold(0.0, f64::max);
        let mut overheads: Vec<_> = solved.iter().map(|(_, s)| 100.0 * s.overhead()).collect();
        overheads.sort_by(f64::total_cmp);
        let overhead = overheads[overheads.len() / 2];
        let mut worst = [f64::NEG_INFINITY; 5];
        for row in &solved {
            let differences = difference(row, rows);
            // A difference without a reference stays NaN.
            worst = std::array::from_fn(|i| {
                if differences[i].is_nan() {
                    f64::NAN
                } else {
                    (100.0 * differences[i]).max(worst[i])
                }
            });
        }
        let [w, f_a, m, d, _] = worst;
        writeln!(
            text,
            "| {name} | {} | {} | {ray:.1} | {row:.2} | {:.0} | {memory:.0} | {overhead:.1} % \
             | {w:.1} % | {f_a:.1} % | {m:.1} % | {d:.1} % |",
            solved.len(),
            first.record.elements,
            7200.0 / ray,
        )?;
    }
    Ok(text)
}

/// For each hinge, the paper's element and the cheapest tier whose error of W is not larger.
fn at_equal_error(rows: &[Row]) -> Result<String> {
    let mut text = "\nThe paper's element (15-node wedges, one layer) and the cheapest tier whose error of W is not \
        larger:\n\n| hinge | paper, CPU s | W | tier | CPU s | W | ratio |\n|---|---|---|---|---|---|---|\n"
        .to_owned();
    let is_paper = |row: &Row| row.0.study == "mesh" && row.0.value == Tier::Paper.name();
    for paper in rows.iter().filter(|row| is_paper(row)) {
        let hinge = hinge_name(&paper.0.solve.problem.hinge.design);
        let off = |row: &Row| difference(row, rows)[0];
        let others = of_tiers(rows, &hinge).filter(|row| !is_paper(row) && off(row) <= off(paper));
        let cheapest = others.min_by(|x, y| cpu_seconds(&x.1).total_cmp(&cpu_seconds(&y.1)));
        if let Some(cheapest) = cheapest {
            let ([slow, quick], [much, little]) = (
                [paper, cheapest].map(|row| cpu_seconds(&row.1)),
                [paper, cheapest].map(|row| 100.0 * off(row)),
            );
            writeln!(
                text,
                "| {hinge} | {slow:.0} | {much:.1} % | {} | {quick:.1} | {little:.1} % | {:.0} |",
                cheapest.0.value,
                slow / quick
            )?;
        }
    }
    Ok(text)
}

/// Comparison with the numbers of the paper's sections 2.4 and 4: bins of 5 to 9 and of 21 to 25 mm, whose
/// centres lie on power laws through the hinges of the study.
fn paper_comparison(rows: &[Row]) -> Result<String> {
    let at = |w_lig: f64| {
        let found = rows.iter().find(|(case, _)| {
            case.study == "mesh"
                && case.value == "default"
                && case.solve.problem.hinge.design.w_lig == w_lig
                && (case.solve.problem.hinge.design.alpha.to_degrees() - 90.0).abs() < 1e-9
        });
        found.map(|(_, solution)| (study_state(solution, 45.0), study_state(solution, 50.0)[4]))
    };
    let mut text = "\n## Comparison with the paper (90 deg, default tier)\n\n\
        | quantity | here | paper |\n|---|---|---|\n"
        .to_owned();
    if let Some((_, uz)) = at(18.0) {
        writeln!(
            text,
            "| u_z(50 deg), 18 mm | {uz:.1} mm | 25 mm, measured 25.5 |"
        )?;
    }
    let thickness = rows
        .first()
        .map_or(f64::NAN, |(case, _)| case.solve.problem.material.thickness);
    if let (Some((narrow, uz_narrow)), Some((wide, uz_wide))) = (at(5.0), at(25.0)) {
        let middle = |from: f64, to: f64, w_lig: f64| {
            from * (to / from).powf((w_lig / 5.0).ln() / 5.0_f64.ln())
        };
        let [w7, w23] = [7.0, 23.0].map(|w_lig| middle(narrow[0], wide[0], w_lig));
        let [d7, d23] = [7.0, 23.0].map(|w_lig| middle(narrow[3], wide[3], w_lig));
        let [u7, u23] = [7.0, 23.0].map(|w_lig| middle(uz_narrow, uz_wide, w_lig) / thickness);
        writeln!(
            text,
            "| W(45 deg), 7 mm | {w7:.1} N mm | 36.4 (5 to 9 mm) |"
        )?;
        writeln!(
            text,
            "| W(45 deg), 23 mm | {w23:.1} N mm | 113.7 (21 to 25 mm) |"
        )?;
        writeln!(text, "| D(45 deg), 7 mm / 23 mm | {:.1} | 17 |", d7 / d23)?;
        writeln!(text, "| u_z(50 deg) / t, 7 mm | {u7:.1} | 20.9 |")?;
        writeln!(text, "| u_z(50 deg) / t, 23 mm | {u23:.1} | 53.8 |")?;
    }
    Ok(text)
}

/// One panel per study, one line per hinge: difference of W(45) from the reference in percent.
fn panels(rows: &[Row]) -> Vec<StudyPanel> {
    let mut panels: BTreeMap<&str, StudyPanel> = BTreeMap::new();
    for (case, solution) in rows {
        let against = rows.iter().find(|(other, _)| is_compared(case, other));
        let Some((_, against)) = against else {
            continue;
        };
        let panel = panels.entry(case.study).or_default();
        panel.title = case.study;
        let value = panel.values.iter().position(|known| *known == case.value);
        let value = value.unwrap_or_else(|| {
            panel.values.push(case.value.clone());
            panel.values.len() - 1
        });
        let percent =
            100.0 * (study_state(solution, 45.0)[0] / study_state(against, 45.0)[0] - 1.0);
        let line = panel
            .lines
            .entry(hinge_name(&case.solve.problem.hinge.design))
            .or_default();
        line.push((value as f64, percent));
    }
    panels.into_values().collect()
}

/// Whether `other` is the reference of `case`.
fn is_compared(case: &StudyCase, other: &StudyCase) -> bool {
    other.study == case.study
        && other.value == case.against
        && hinge_name(&other.solve.problem.hinge.design)
            == hinge_name(&case.solve.problem.hinge.design)
}
