//! `kirigami-studies tilt`: the tilt that windows predict about the flat deployment, beside that of whole sheets.

use crate::flatness::{Case, cases};
use anyhow::{Result, anyhow};
use clap::Args;
use design::sheet::cut_sheet::Sheet;
use design::sheet::kinematics::hinge_deformations;
use faer::mat::Mat;
use fe_driver::{
    CalculiX, DeformationPath, HingePath, Lean, SheetState, WindowProblem, WindowSolve,
};
use kirigami::commands::solve_args::{SolveArgs, task_error};
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use mesher::{Imperfection, MeshRecipe, PlaneRecipe, Tier};
use std::path::PathBuf;
use verification::{LeaningHinge, leans, leans_of, out_of_plane};

/// Predict the tilt of sheets that nothing holds flat from their windows
#[derive(Args)]
pub struct TiltStudy {
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Small)]
    tier: Tier,
    #[arg(long, value_name = "N", value_delimiter = ',')]
    only: Vec<usize>,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-flatness")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

const STEPS: usize = 24;

/// (u_x, u_y, phi) of every panel at a fraction.
fn configuration(sheet: &Sheet, states: &[SheetState], fraction: f64) -> Vec<[f64; 3]> {
    let after = states
        .partition_point(|state| state.fraction < fraction)
        .min(states.len() - 1);
    let motion = |state: Option<&SheetState>| -> Vec<[f64; 3]> {
        std::iter::zip(0.., &sheet.panels)
            .map(|(p, panel)| match state {
                None => [0.0; 3],
                Some(state) => {
                    let [x, y, _] = state.panels[p].moved(panel.reference);
                    let [x0, y0] = panel.reference;
                    [x - x0, y - y0, state.panels[p].turn()]
                }
            })
            .collect()
    };
    let before = after.checked_sub(1).map(|i| &states[i]);
    let from = before.map_or(0.0, |state| state.fraction);
    let to = states[after].fraction;
    let share = ((fraction - from) / (to - from)).min(1.0);
    std::iter::zip(motion(before), motion(Some(&states[after])))
        .map(|(p, q)| std::array::from_fn(|i| p[i] + share * (q[i] - p[i])))
        .collect()
}

impl TiltStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let calculix = CalculiX::find()?;
        let all = cases();
        let mut text = String::from(HEAD);
        for n in &self.only {
            text += &self.case(&all[*n], &calculix)?;
        }
        run_folder::write(&self.out, "tilt.md", &text)?;
        println!("{text}");
        Ok(())
    }

    fn case(&self, case: &Case, calculix: &CalculiX) -> Result<String> {
        let solves = case.solves(self.tier, calculix)?;
        let bar = Progress::new(2, "solves");
        let show = Box::new(move |done, _| bar.show(done, None, ""));
        let service = self.solve.service_of(calculix.clone(), &self.out, show)?;
        let solved = service.solve(&solves).map_err(|e| task_error(e.into()))?;
        let (free, flat) = (&solved[0].samples.states, &solved[1].samples.states);
        let (scene, sheet) = case.sheet()?;
        let fractions: Vec<f64> = (1..=STEPS).map(|i| i as f64 / STEPS as f64).collect();
        let path: Vec<_> = fractions
            .iter()
            .map(|f| configuration(&sheet, flat, *f))
            .collect();
        let deformations: Vec<_> = path.iter().map(|c| hinge_deformations(&sheet, c)).collect();
        let shape = &solves[0].problem.shape;
        let mut windows = Vec::new();
        for (h, window) in shape.windows.iter().enumerate() {
            let states: Vec<_> = deformations.iter().map(|d| d[h]).collect();
            let hinge = HingePath {
                design: window.design,
                path: DeformationPath::through(&states).ok_or(anyhow!("no states"))?,
            };
            for lean in [Lean::default()]
                .into_iter()
                .chain(leans(window.design.w_lig))
            {
                let problem = WindowProblem {
                    lean: Some(lean),
                    ..WindowProblem::new(hinge.clone(), &scene.material, self.tier)
                };
                windows.push(WindowSolve {
                    mesh: MeshRecipe {
                        plane: PlaneRecipe::Structured(shape.plane),
                        layers: shape.layers,
                        imperfection: Imperfection {
                            amplitude: window.bump.abs(),
                            ..self.tier.recipe().imperfection
                        },
                    },
                    ..WindowSolve::new(problem, &calculix.versions())
                });
            }
        }
        let bar = Progress::new(windows.len(), "windows");
        let show = Box::new(move |done, _| bar.show(done, None, ""));
        let service = self.solve.service_of(calculix.clone(), &self.out, show)?;
        let solved_windows = service.solve(&windows).map_err(|e| task_error(e.into()))?;
        for window in &solved_windows {
            if let Err(failed) = window.complete() {
                println!("FAILED {failed}");
            }
        }
        let held: Vec<bool> = (0..sheet.panels.len())
            .map(|p| solves[0].problem.held.iter().any(|held| held.panel == p))
            .collect();
        let cpu: f64 = solved_windows.iter().map(|w| w.record.cpu_seconds).sum();
        // (fraction, tilt by secant stiffness, tilt by increments) and where the secant stiffness is first negative.
        let mut series = vec![[0.0; 3]];
        let mut unstable = None;
        let mut memory: Vec<([f64; 3], [f64; 3])> = vec![([0.0; 3], [0.0; 3]); shape.windows.len()];
        let mut first: Vec<[[f64; 3]; 3]> = Vec::new();
        let mut last: Vec<LeaningHinge> = Vec::new();
        for (step, fraction) in fractions.iter().enumerate() {
            let hinges: Option<Vec<LeaningHinge>> = (0..shape.windows.len())
                .map(|h| {
                    let of = |i: usize| &solved_windows[4 * h + i].samples[..];
                    LeaningHinge::at(
                        [of(0), of(1), of(2), of(3)],
                        leans(shape.windows[h].design.w_lig),
                        shape.windows[h].bump.signum(),
                        *fraction,
                    )
                })
                .collect();
            let Some(hinges) = hinges else { break };
            let mut hinges = hinges;
            balance(&sheet, &path[step], &mut hinges, &held);
            let Some(found) = out_of_plane(&sheet, &path[step], &hinges, &held) else {
                println!("{fraction:.3} none");
                continue;
            };
            let elastic: Vec<_> = if step == 0 {
                first = hinges.iter().map(|h| h.stiffness).collect();
                first.clone()
            } else {
                first.clone()
            };
            let lambda = *fraction;
            let before = lambda - 1.0 / STEPS as f64;
            let mut marched = hinges.clone();
            let mut relaxed = Vec::new();
            for (h, hinge) in marched.iter_mut().enumerate() {
                let old = if step == 0 {
                    [[0.0; 3]; 3]
                } else {
                    last[h].stiffness.map(|c| c.map(|x| x * before))
                };
                let now = hinge.stiffness.map(|c| c.map(|x| x * lambda));
                let ke = elastic[h];
                let trial = Mat::from_fn(3, 3, |i, j| old[j][i] + ke[j][i] / STEPS as f64);
                let now = Mat::from_fn(3, 3, |i, j| now[j][i]);
                // A trial = now
                let at = faer::prelude::Solve::solve(
                    &trial.transpose().full_piv_lu(),
                    &now.transpose().to_owned(),
                );
                let a = at.transpose().to_owned();
                let ke = Mat::from_fn(3, 3, |i, j| ke[j][i]);
                let k = &a * &ke;
                let (q, m) = memory[h];
                let rest = Mat::from_fn(3, 1, |i, _| {
                    m[i] - (0..3).map(|j| ke[(i, j)] * q[j]).sum::<f64>()
                });
                let carried = &a * &rest;
                for i in 0..3 {
                    hinge.forces[i] += carried[(i, 0)];
                    for j in 0..3 {
                        hinge.stiffness[j][i] = k[(i, j)];
                    }
                }
                relaxed.push((carried, k));
            }
            let march = out_of_plane(&sheet, &path[step], &marched, &held).unwrap();
            let q = leans_of(&sheet, &path[step], &marched, &march.panels);
            for (h, q) in q.into_iter().enumerate() {
                let (carried, k) = &relaxed[h];
                let m = std::array::from_fn(|i| {
                    carried[(i, 0)] + (0..3).map(|j| k[(i, j)] * q[j]).sum::<f64>()
                });
                memory[h] = (q, m);
            }
            last = hinges.clone();
            if found.stiffness < 0.0 && unstable.is_none() {
                unstable = Some(*fraction);
            }
            series.push([
                *fraction,
                found.tilt().to_degrees(),
                march.tilt().to_degrees(),
            ]);
        }
        let by_elements: Vec<[f64; 2]> = free
            .iter()
            .map(|s| [s.fraction, s.tilt().to_degrees()])
            .collect();
        let marched: Vec<[f64; 2]> = series.iter().map(|[f, _, m]| [*f, *m]).collect();
        let at = |limit: f64| [onset(&by_elements, limit), onset(&marched, limit)].map(percent);
        let (half, one) = (at(0.5), at(1.0));
        let last = series.last().unwrap();
        Ok(format!(
            "| {:.2} | {} | {:.0} | {:.2} | {:.2} | {} | {} | {} | {} | {} | {:.0} | {:.0} |\n",
            case.w_lig / case.thickness,
            if case.branch == verification::Branch::OneSide {
                "one side"
            } else {
                "alternating"
            },
            case.stroke * case.side,
            by_elements.last().unwrap()[1],
            last[2],
            percent(unstable),
            half[0],
            half[1],
            one[0],
            one[1],
            solved[0].record.cpu_seconds,
            cpu,
        ))
    }
}

const HEAD: &str = "| w_lig / t | bumps | stroke, mm | tilt at the end, deg: sheet | windows | secant stiffness lost at, % | 0.5 deg at, %: sheet | windows | 1 deg at, %: sheet | windows | CPU s: sheet | windows |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";

/// Where a tilt is first exceeded, by straight lines between the states.
fn onset(series: &[[f64; 2]], limit: f64) -> Option<f64> {
    let pair = series.windows(2).find(|pair| pair[1][1] > limit)?;
    let [[f, m], [g, n]] = [pair[0], pair[1]];
    Some(f + (limit - m) / (n - m) * (g - f))
}

fn percent(fraction: Option<f64>) -> String {
    fraction.map_or("-".into(), |fraction| format!("{:.0}", 100.0 * fraction))
}

/// In-plane forces of least norm that are in equilibrium with the moments, a load of unknown size at the references.
fn balance(sheet: &Sheet, configuration: &[[f64; 3]], hinges: &mut [LeaningHinge], held: &[bool]) {
    use design::sheet::kinematics::deployed;
    use faer::mat::Mat;
    let n = hinges.len();
    let free: Vec<usize> = (0..held.len()).filter(|p| !held[*p]).collect();
    // Loaded panel: [columns / 2, 0].
    let loaded = sheet.grid.m / 2;
    let mut a = Mat::<f64>::zeros(3 * free.len(), 2 * n + 1);
    let mut b = Mat::<f64>::zeros(3 * free.len(), 1);
    for (k, p) in free.iter().enumerate() {
        let panel = &sheet.panels[*p];
        let at = deployed(panel, configuration[*p], panel.reference);
        for (h, hinge) in sheet.hinges.iter().enumerate() {
            let sign = if hinge.panel_b() == *p {
                1.0
            } else if hinge.panel_a() == *p {
                -1.0
            } else {
                continue;
            };
            let b_panel = hinge.panel_b();
            let tip = deployed(&sheet.panels[b_panel], configuration[b_panel], hinge.tip);
            let r = [tip[0] - at[0], tip[1] - at[1]];
            a[(3 * k, 2 * h)] = sign;
            a[(3 * k + 1, 2 * h + 1)] = sign;
            a[(3 * k + 2, 2 * h)] = -sign * r[1];
            a[(3 * k + 2, 2 * h + 1)] = sign * r[0];
            b[(3 * k + 2, 0)] -= sign * hinges[h].sample.m_theta;
        }
        if *p == loaded {
            a[(3 * k + 1, 2 * n)] = 1.0;
        }
    }
    // Least norm: x = A^T (A A^T)^-1 b.
    let gram = &a * a.transpose();
    let y = gram.full_piv_lu();
    let y = faer::prelude::Solve::solve(&y, &b);
    let x = a.transpose() * &y;
    for (h, hinge) in sheet.hinges.iter().enumerate() {
        let f = [x[(2 * h, 0)], x[(2 * h + 1, 0)]];
        let angle = hinge.e_sec[1].atan2(hinge.e_sec[0])
            + 0.5 * (configuration[hinge.panel_a()][2] + configuration[hinge.panel_b()][2]);
        let (sin, cos) = (-angle).sin_cos();
        let s = &mut hinges[h].sample;
        s.f_a = cos * f[0] - sin * f[1];
        s.f_s = sin * f[0] + cos * f[1];
        s.a = 0.0;
        s.s = 0.0;
    }
}
