//! `kirigami-studies detours`: hinges driven to one end along paths that are built to differ; section 5.2.
//!
//! A detour bulges from the straight ray, x(lambda) = lambda e + A sin(pi lambda) u, in one direction u of
//! (eta_a, eta_s, theta). Paths of deployed sheets stay closer to their rays (`kirigami-studies path`): detours show from
//! which separation on energy, forces and damage are no functions of the state.

use crate::charts::{self, SeparationChart};
use crate::power_law::PowerLaw;
use anyhow::{Result, ensure};
use clap::Args;
use design::analysis::path_separation::PathSeparation;
use fe_driver::{KeptSolution, KeptSolve};
use hinge::{HingeConstants, HingeDeformation, HingeSample, SheetMaterial};
use kirigami::replays::kept_solves::SolveArgs;
use kirigami::replays::routes::HingeRoute;
use kirigami::ui::{picture, run_folder};
use mesher::Tier;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::PathBuf;

/// Measure path dependence on detours: separations up to half a ligament width
///
/// Three hinges are driven to one end each: straight, and along detours of four kinds and four sizes. Writes detours.csv,
/// detours.md and a chart. Example: kirigami-studies detours --tier tiny
#[derive(Args)]
pub struct DetourStudy {
    /// Sheet material (TOML)
    #[arg(
        long,
        value_name = "FILE",
        default_value = "configs/materials/pet-0.5mm.toml"
    )]
    material: PathBuf,
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Default)]
    tier: Tier,
    /// Folder for the tables, the chart and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-detours")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// w_lig (mm), alpha (deg), and the end of the ray: eta_a, eta_s, theta (deg).
const RAYS: [[f64; 5]; 3] = [
    [6.0, 75.0, -0.25, 0.1, 45.0],
    [12.0, 60.0, 0.05, 0.15, 40.0],
    [18.0, 90.0, -0.2, -0.1, 50.0],
];

/// Name and direction (eta_a, eta_s, theta) of the detours. In the last, the translations come first and the hinge
/// rotates late, as before it snaps.
const KINDS: [(&str, [f64; 3]); 4] = [
    ("compressed first", [-1.0, 0.0, 0.0]),
    ("sheared first", [0.0, 1.0, 0.0]),
    ("rotated first", [0.0, 0.0, 1.0]),
    ("rotated last", [0.0, 0.0, -1.0]),
];

/// Sizes A of the detours, in ligament widths or rad.
const SIZES: [f64; 4] = [0.05, 0.12, 0.25, 0.5];

/// Number of states of a detour.
const STATES: usize = 40;

/// Differences at the end: of W, of the forces, of D and of D_peak, and those above which they are called path-dependent.
const QUANTITIES: [(&str, f64); 4] = [("W", 0.01), ("forces", 0.05), ("D", 0.05), ("D_peak", 0.05)];

/// Separations between which the differences are summarised.
const BANDS: [f64; 5] = [0.0, 0.03, 0.08, 0.15, 0.5];

/// A detour with its differences from the ray.
struct Detour {
    ray: usize,
    kind: usize,
    size: f64,
    separation: PathSeparation,
    differences: [f64; 4],
}

impl DetourStudy {
    pub fn run(&self) -> Result<()> {
        let material = SheetMaterial::load(&self.material)?;
        let _held = run_folder::hold(&self.out)?;
        let routes = routes();
        let straight: Vec<KeptSolve> = (RAYS.iter().enumerate())
            .filter_map(|(i, _)| routes.iter().find(|route| route.ray == i))
            .map(|route| route.route.straight(&material, self.tier))
            .collect();
        let bulging: Vec<KeptSolve> = (routes.iter())
            .map(|route| route.route.recorded(&material, self.tier))
            .collect::<Result<_>>()?;
        let solves: Vec<&KeptSolve> = straight.iter().chain(&bulging).collect();
        let outcomes = self.solve.solve(&solves, &self.out)?;
        let (straight, bulging) = outcomes.split_at(straight.len());
        let (mut detours, mut failures) = (Vec::new(), String::new());
        for (route, outcome) in routes.iter().zip(bulging) {
            match (&straight[route.ray], outcome) {
                (Ok(ray), Ok(detour)) => {
                    let [ray, detour] = [ray, detour].map(end);
                    detours.push(route.detour(&detour, &ray));
                }
                (Err(reason), _) | (_, Err(reason)) => {
                    // Only the first line: the rest quotes the end of the solver's log.
                    let reason = reason.lines().next().unwrap_or_default();
                    writeln!(failures, "* {}: {reason}", route.name())?;
                }
            }
        }
        ensure!(!detours.is_empty(), "no detour was solved:\n{failures}");
        let page = page(&detours, self.tier, &failures)?;
        run_folder::write(&self.out, "detours.md", &page)?;
        run_folder::write(&self.out, "detours.csv", &csv(&detours))?;
        let points: [Vec<_>; 4] = std::array::from_fn(|i| points(&detours, None, i));
        let charts: Vec<_> = std::iter::zip(QUANTITIES, &points)
            .map(|((quantity, _), pairs)| SeparationChart {
                pairs,
                fit: PowerLaw::fit(pairs.iter().copied()),
                all: &[],
                quantity,
            })
            .collect();
        picture::save(
            &charts::separations(&charts)?,
            &self.out.join("detours"),
            1600,
        )?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }
}

/// A detour to be solved.
struct Route {
    ray: usize,
    kind: usize,
    size: f64,
    route: HingeRoute,
}

/// All detours, those of a ray together.
fn routes() -> Vec<Route> {
    let mut routes = Vec::new();
    for (ray, [w_lig, alpha_deg, eta_a, eta_s, theta_deg]) in RAYS.into_iter().enumerate() {
        let end = [eta_a, eta_s, theta_deg.to_radians()];
        for (kind, (_, direction)) in KINDS.into_iter().enumerate() {
            for size in SIZES {
                let state = |k: usize| {
                    let lambda = k as f64 / STATES as f64;
                    let bulge = size * (PI * lambda).sin();
                    let [a, s, theta] =
                        std::array::from_fn(|i| lambda * end[i] + bulge * direction[i]);
                    HingeDeformation::from_eta(a, s, theta, w_lig)
                };
                let route = HingeRoute {
                    hinge: routes.len(),
                    design: HingeConstants::PAPER.hinge(w_lig, alpha_deg.to_radians()),
                    states: (1..=STATES).map(state).collect(),
                };
                routes.push(Route {
                    ray,
                    kind,
                    size,
                    route,
                });
            }
        }
    }
    routes
}

impl Route {
    fn name(&self) -> String {
        let [w_lig, ..] = RAYS[self.ray];
        format!("{w_lig} mm, {}, {}", KINDS[self.kind].0, self.size)
    }

    fn detour(&self, detour: &HingeSample, ray: &HingeSample) -> Detour {
        let w_lig = self.route.design.w_lig;
        let force = |x: &HingeSample| [x.f_a, x.f_s, x.m_theta / w_lig];
        let norm = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [f, g] = [detour, ray].map(force);
        let relative = |x: f64, y: f64| (x - y).abs() / y.abs().max(f64::MIN_POSITIVE);
        let peak = |x: &HingeSample| x.d_peak.unwrap_or(f64::NAN);
        Detour {
            ray: self.ray,
            kind: self.kind,
            size: self.size,
            separation: self.route.separation(),
            differences: [
                relative(detour.w, ray.w),
                norm(std::array::from_fn(|i| f[i] - g[i])) / norm(g),
                relative(detour.d, ray.d),
                relative(peak(detour), peak(ray)),
            ],
        }
    }
}

/// The last state of a solution, which is the end of its path.
fn end(solution: &KeptSolution) -> HingeSample {
    solution.samples.last().copied().unwrap_or_default()
}

/// (separation, difference of a quantity) of the detours of one kind, or of all.
fn points(detours: &[Detour], kind: Option<usize>, quantity: usize) -> Vec<(f64, f64)> {
    let chosen = detours
        .iter()
        .filter(|it| kind.is_none_or(|kind| it.kind == kind));
    chosen
        .map(|it| (it.separation.whole, it.differences[quantity]))
        .collect()
}

fn page(detours: &[Detour], tier: Tier, failures: &str) -> Result<String> {
    let mut page = format!(
        "# Path dependence on detours\n\n{} detours of {} hinges on tier {tier}: x(lambda) = lambda e + A sin(pi lambda) u. \
         Separation: maximum distance from the straight ray at equal fractions of the lengths, in ligament widths, of (eta_a, \
         eta_s, theta) and, as in the paper, of (eta_a, eta_s) alone. Differences at the end from the straight ray; forces: \
         Euclidean norm of (F_a, F_s, M_theta / w_lig). Exponent: of the power law through the pairs, with its standard \
         error.\n\n{}| detour | quantity | exponent | separation at which the law reaches a limit | largest difference |\n\
         |---|---|---|---|---|\n",
        detours.len(),
        RAYS.len(),
        by_separation(detours)
    );
    let kinds = KINDS.iter().enumerate();
    let kinds = kinds.map(|(kind, (name, _))| (Some(kind), *name));
    for (kind, name) in kinds.chain([(None, "all")]) {
        for (i, (quantity, limit)) in QUANTITIES.into_iter().enumerate() {
            let points = points(detours, kind, i);
            let largest = points.iter().map(|(_, y)| 100.0 * y).fold(0.0, f64::max);
            let (exponent, reached) = match PowerLaw::fit(points) {
                Some(law) => {
                    let reached = law.reaches(limit);
                    let solved = BANDS[BANDS.len() - 1];
                    let reached = match reached <= solved {
                        true => format!("{reached:.2}"),
                        false => format!("over {solved}"),
                    };
                    (law.to_string(), reached)
                }
                None => ("-".to_owned(), "-".to_owned()),
            };
            writeln!(
                page,
                "| {name} | {quantity} | {exponent} | {reached} ({:.0} %) | {largest:.1} % |",
                100.0 * limit
            )?;
        }
    }
    page += "\n| hinge | detour | A | separation | of the translation | W | forces | D | D_peak |\n\
             |---|---|---|---|---|---|---|---|---|\n";
    for it in detours {
        let [w_lig, ..] = RAYS[it.ray];
        let PathSeparation { whole, translation } = it.separation;
        let differences = it.differences.map(|x| format!("{:.2} %", 100.0 * x));
        writeln!(
            page,
            "| {w_lig} mm | {} | {} | {whole:.3} | {translation:.3} | {} |",
            KINDS[it.kind].0,
            it.size,
            differences.join(" | ")
        )?;
    }
    if !failures.is_empty() {
        write!(page, "\nNot solved:\n\n{failures}")?;
    }
    Ok(page)
}

/// Median and maximum difference of each quantity between two separations.
fn by_separation(detours: &[Detour]) -> String {
    let names = QUANTITIES.map(|(name, _)| format!("{name}, median | {name}, maximum"));
    let mut text = format!(
        "| separation | detours | {} |\n|---|---|{}\n",
        names.join(" | "),
        "---|---|".repeat(QUANTITIES.len())
    );
    for band in BANDS.windows(2) {
        let within = |it: &&Detour| band[0] < it.separation.whole && it.separation.whole <= band[1];
        let chosen: Vec<_> = detours.iter().filter(within).collect();
        let cells = (0..QUANTITIES.len()).map(|i| {
            let mut values: Vec<f64> = chosen.iter().map(|it| it.differences[i]).collect();
            values.sort_by(f64::total_cmp);
            match values.last() {
                Some(last) => format!(
                    "{:.2} % | {:.2} %",
                    100.0 * values[values.len() / 2],
                    100.0 * last
                ),
                None => "- | -".to_owned(),
            }
        });
        let cells: Vec<String> = cells.collect();
        let count = chosen.len();
        text += &format!(
            "| {} to {} | {count} | {} |\n",
            band[0],
            band[1],
            cells.join(" | ")
        );
    }
    text + "\n"
}

fn csv(detours: &[Detour]) -> String {
    let mut text =
        "w_lig_mm,detour,size,separation,separation_of_translation,w,forces,d,d_peak\n".to_owned();
    for it in detours {
        let [w_lig, ..] = RAYS[it.ray];
        let PathSeparation { whole, translation } = it.separation;
        let [w, forces, d, d_peak] = it.differences;
        text += &format!(
            "{w_lig},{},{},{whole:.5},{translation:.5},{w:.6},{forces:.6},{d:.6},{d_peak:.6}\n",
            KINDS[it.kind].0, it.size
        );
    }
    text
}
