//! `kirigami-studies flatness`: which sheets stay flat by themselves. Whole sheets by finite elements, kept in their plane in
//! four ways, beside the same sheets held flat.

use anyhow::Result;
use clap::Args;
use design::analysis::localisation::{elasto_gravity_length, gamma};
use design::scene::{Posture, Scene};
use design::sheet::cut_sheet::Sheet;
use fe_driver::{CalculiX, SheetSolve, SheetState, Solved};
use kirigami::commands::solve_args::{SolveArgs, task_error};
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use mesher::Tier;
use std::path::{Path, PathBuf};
use support::statistics::rms_and_maximum;
use support::table::{Cell, Table};
use verification::{Branch, sheet_problem};

/// Solve whole sheets that nothing holds flat, and the same sheets held flat
///
/// Sheets of 2 x 2 to 3 x 4 panels in the paper's film law, from film to plate. The one panel at the top is clamped, and one at
/// the bottom is pulled away from it. Writes flatness.md and flatness.csv. An hour on two processors; a stopped study
/// continues. Example: kirigami-studies flatness --jobs 2
#[derive(Args)]
pub struct FlatnessStudy {
    /// Mesh tier of the windows
    #[arg(long, value_name = "TIER", default_value_t = Tier::Small)]
    tier: Tier,
    /// Solve the first N sheets only
    #[arg(long, value_name = "N")]
    first: Option<usize>,
    /// Folder for the tables and the solutions
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-flatness")]
    out: PathBuf,
    #[command(flatten)]
    solve: SolveArgs,
}

/// A sheet with square panels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Case {
    support: Posture,
    branch: Branch,
    /// [columns, rows]
    panels: [usize; 2],
    /// mm
    side: f64,
    w_lig: f64,
    thickness: f64,
    /// Stroke over the side of a panel.
    stroke: f64,
}

/// Radius of the windows over the ligament width.
const WINDOW: f64 = 20.0 / 3.6;
/// The stroke that opens hinges by 26 degrees, and one that opens them by 65, over the side of a panel.
const USUAL: f64 = 30.0 / 70.0;
const FAR: f64 = 62.0 / 70.0;

/// 2 x 2 panels of 70 mm with ligaments of 3.6 mm, all bumps to one side.
const fn small(support: Posture, thickness: f64) -> Case {
    Case {
        support,
        branch: Branch::OneSide,
        panels: [2, 2],
        side: 70.0,
        w_lig: 3.6,
        thickness,
        stroke: USUAL,
    }
}

/// The sheets, in the order in which they are solved.
fn cases() -> Vec<Case> {
    use Posture::{Free, Hanging, Lying};
    let alternating = |case| Case {
        branch: Branch::Alternating,
        ..case
    };
    let far = |case| Case {
        stroke: FAR,
        ..case
    };
    let of = |panels, case| Case { panels, ..case };
    let scaled = |factor: f64, case: Case| Case {
        side: factor * case.side,
        w_lig: factor * case.w_lig,
        ..case
    };
    let wide = |case| Case {
        side: 140.0,
        ..case
    };
    vec![
        small(Free, 4.0),
        small(Free, 3.0),
        small(Free, 2.0),
        small(Free, 1.0),
        scaled(5.0, small(Lying, 0.5)),
        far(small(Free, 4.0)),
        far(small(Free, 3.0)),
        alternating(small(Free, 4.0)),
        alternating(small(Free, 3.0)),
        far(alternating(small(Free, 3.0))),
        wide(small(Free, 4.0)),
        wide(small(Free, 3.0)),
        small(Hanging, 4.0),
        small(Hanging, 1.0),
        of([3, 3], small(Free, 4.0)),
        of([3, 3], small(Free, 3.0)),
        small(Lying, 0.25),
        small(Lying, 1.0),
        scaled(2.5, small(Lying, 0.25)),
        scaled(12.5, small(Lying, 0.5)),
        of([3, 3], small(Free, 2.0)),
        of([3, 4], small(Free, 4.0)),
        small(Lying, 0.1),
        small(Free, 0.25),
        small(Hanging, 0.1),
        of([3, 3], scaled(5.0, small(Lying, 0.5))),
    ]
}

impl Case {
    /// The scene of the sheet. Its hinge law is not used: finite elements judge finite elements.
    fn scene(&self) -> Result<Scene> {
        let [columns, rows] = self.panels;
        let (w, side) = (self.w_lig, self.side);
        let size = [columns as f64 * side, rows as f64 * side];
        let hung = match self.support {
            Posture::Hanging => "kind = \"hanging\"\ndown = [0.0, -1.0]",
            Posture::Lying => "kind = \"lying\"",
            Posture::HeldFlat | Posture::Free => "kind = \"free\"",
        };
        let text = format!(
            "title = \"flatness\"\nmaterial = \"configs/materials/pet-0.5mm.toml\"\nthickness = {:?}\nhinge = \"linear\"\n\
             load_steps = 1\noutput = \"runs/flatness\"\n\
             [sheet]\nsize = {size:?}\npanels = [{columns}, {rows}]\n\
             [ligament]\nstart = {w:?}\nrange = [{:?}, {:?}]\n\
             [process]\nfillet_ratio = 0.16\nkerf = {:?}\nr_win = {:?}\n\
             [linear]\nk_a = 400.0\nk_s = 250.0\nk_theta = 300.0\n\
             [posture]\n{hung}\n\
             [[supports]]\npanel = [{}, {}]\nkind = \"clamp\"\n\
             [[loads]]\npanel = [{}, 0]\nforce = [0.0, -1.0]\n\
             [drive]\nstroke = {:?}\n\
             [target.rectangle]\ncentre = [0.0, 0.0]\nsize = {size:?}\nrotation_deg = 0.0\n\
             [objective]\ncoverage = 1.0\ntarget_points = 10\n\
             [optimiser]\nmethod = \"lbfgs\"\nsteps = 1\nlearning_rate = 0.1\n",
            self.thickness,
            0.5 * w,
            2.0 * w,
            0.1 * w / 3.6,
            WINDOW * w,
            (columns - 1) / 2,
            rows - 1,
            columns / 2,
            self.stroke * side,
        );
        let path = Path::new("flatness.toml");
        Ok(Scene::new(support::toml_file::parse(&text, path)?, path)?)
    }

    fn sheet(&self) -> Result<(Scene, Sheet)> {
        let scene = self.scene()?;
        let (_, sheet) = scene.problem()?.cut(&scene.start())?;
        Ok((scene, sheet))
    }

    /// The sheet as it is, and with its panels held flat.
    fn solves(&self, tier: Tier, calculix: &CalculiX) -> Result<[SheetSolve; 2]> {
        let (scene, sheet) = self.sheet()?;
        let solve = |support, branch| {
            let problem = sheet_problem(&scene, &sheet, support, tier, branch);
            let problem = problem.map_err(task_error)?;
            Ok::<_, anyhow::Error>(SheetSolve::new(problem, &calculix.versions()))
        };
        Ok([
            solve(self.support, self.branch)?,
            solve(Posture::HeldFlat, Branch::OneSide)?,
        ])
    }
}

/// What a sheet does that is not held flat.
struct Row {
    case: Case,
    /// Elasto-gravity length over the radius of its windows.
    weight_length: f64,
    /// Gamma of (21), for the longest edge of a panel.
    gamma: f64,
    /// Fraction of the path that both sheets reached.
    reached: f64,
    /// Mean opening of the hinges there, held flat (deg).
    opening_deg: f64,
    tilt_deg: f64,
    /// Highest point of a panel (mm).
    lift: f64,
    /// Distance of the corners from the sheet held flat (mm): root mean square and maximum.
    corners: [f64; 2],
    /// The former over the longer side of the flat sheet.
    relative: f64,
    /// Load over that of the sheet held flat.
    load: f64,
    dynamic: bool,
    cpu_seconds: f64,
}

impl FlatnessStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let calculix = CalculiX::find()?;
        let mut cases = cases();
        cases.truncate(self.first.unwrap_or(cases.len()));
        let pairs = cases.iter().map(|case| case.solves(self.tier, &calculix));
        let solves = pairs.collect::<Result<Vec<_>>>()?.concat();
        let bar = Progress::new(solves.len(), "solves");
        let show = Box::new(move |done, _| bar.show(done, None, ""));
        let service = self.solve.service_of(calculix, &self.out, show)?;
        let solved = service.solve(&solves);
        let solved = solved.map_err(|error| task_error(error.into()))?;
        let rows = std::iter::zip(cases, solved.chunks(2));
        let rows = rows.map(|(case, pair)| Row::new(case, &pair[0], &pair[1]));
        let rows: Vec<Row> = rows.collect::<Result<_>>()?;
        let table = table();
        run_folder::write(&self.out, "flatness.csv", &table.csv(&rows))?;
        let text = page(&table.markdown(&rows), self.tier);
        run_folder::write(&self.out, "flatness.md", &text)?;
        println!("{text}\nwritten to {}", self.out.display());
        Ok(())
    }
}

impl Row {
    fn new(case: Case, own: &Solved<SheetSolve>, flat: &Solved<SheetSolve>) -> Result<Self> {
        let (scene, sheet) = case.sheet()?;
        let material = &scene.material;
        let edge = sheet.panels.iter().flat_map(|panel| {
            let corners = panel.corners;
            (0..4).map(move |k| {
                let [p, q] = [corners[k], corners[(k + 1) % 4]];
                f64::hypot(q[0] - p[0], q[1] - p[1])
            })
        });
        let longest = edge.fold(0.0, f64::max);
        let mut row = Self {
            case,
            weight_length: elasto_gravity_length(material) / scene.config.process.r_win,
            gamma: gamma(material, case.w_lig, longest),
            reached: 0.0,
            opening_deg: f64::NAN,
            tilt_deg: f64::NAN,
            lift: f64::NAN,
            corners: [f64::NAN; 2],
            relative: f64::NAN,
            load: f64::NAN,
            dynamic: false,
            cpu_seconds: own.record.cpu_seconds,
        };
        let Some(last) = own.samples.states.last() else {
            return Ok(row);
        };
        let Some(beside) = at(&flat.samples.states, last.fraction) else {
            return Ok(row);
        };
        let errors = std::iter::zip(&sheet.panels, std::iter::zip(&last.panels, &beside.panels));
        let errors: Vec<f64> = errors
            .flat_map(|(panel, (own, flat))| {
                panel.corners.map(|corner| {
                    let [p, q] = [own.moved(corner), flat.moved(corner)];
                    let square = (0..3).map(|i| (p[i] - q[i]).powi(2));
                    square.sum::<f64>().sqrt()
                })
            })
            .collect();
        let openings = sheet.hinges.iter().map(|hinge| {
            let [a, b] = [hinge.panel_a(), hinge.panel_b()];
            beside.panels[b].turn() - beside.panels[a].turn()
        });
        row.reached = last.fraction;
        row.opening_deg = (openings.sum::<f64>() / sheet.hinges.len() as f64).to_degrees();
        row.tilt_deg = last.tilt().to_degrees();
        row.lift = last.z()[1].max(0.0);
        row.corners = rms_and_maximum(errors);
        row.relative = row.corners[0] / sheet.outline.size();
        row.load = last.load_factor / beside.load_factor;
        row.dynamic = last.kinetic_energy != 0.0;
        Ok(row)
    }
}

/// The state at a fraction of the stroke: the increment nearest to it; `None` if the path ends before.
fn at(states: &[SheetState], fraction: f64) -> Option<&SheetState> {
    /// Largest difference of the fractions at which two states are compared.
    const NEAR: f64 = 0.025;
    let nearest = states.iter().min_by(|one, other| {
        let off = |state: &SheetState| (state.fraction - fraction).abs();
        off(one).total_cmp(&off(other))
    })?;
    ((nearest.fraction - fraction).abs() < NEAR).then_some(nearest)
}

fn table() -> Table<'static, Row> {
    let support = |row: &Row| {
        Cell::text(match row.case.support {
            Posture::HeldFlat => "held flat",
            Posture::Lying => "lying",
            Posture::Hanging => "hanging",
            Posture::Free => "free",
        })
    };
    let bumps = |row: &Row| {
        Cell::text(match row.case.branch {
            Branch::OneSide => "one side",
            _ => "alternating",
        })
    };
    Table::new()
        .column("support", support)
        .column("panels", |row: &Row| {
            let [m, n] = row.case.panels;
            Cell::text(format!("{m} x {n}"))
        })
        .column("side, mm", |row| Cell::fixed(row.case.side, 0))
        .column("t, mm", |row| Cell::fixed(row.case.thickness, 2))
        .column("w_lig / t", |row| {
            Cell::fixed(row.case.w_lig / row.case.thickness, 2)
        })
        .column("l_eg / r_win", |row| Cell::fixed(row.weight_length, 2))
        .column("Gamma", |row| Cell::fixed(row.gamma, 2))
        .column("bumps", bumps)
        .column("reached, %", |row| Cell::fixed(100.0 * row.reached, 0))
        .column("opening, deg", |row| Cell::fixed(row.opening_deg, 1))
        .column("tilt, deg", |row| Cell::fixed(row.tilt_deg, 2))
        .column("lift, mm", |row| Cell::fixed(row.lift, 2))
        .column("corners, mm", |row| Cell::fixed(row.corners[0], 3))
        .column("max, mm", |row| Cell::fixed(row.corners[1], 3))
        .column("%", |row| Cell::fixed(100.0 * row.relative, 3))
        .column("load, free / held", |row| Cell::fixed(row.load, 4))
        .column("path", |row| {
            Cell::text(if row.dynamic { "dynamic" } else { "static" })
        })
        .column("CPU s", |row| Cell::fixed(row.cpu_seconds, 0))
}

fn page(table: &str, tier: Tier) -> String {
    format!(
        "# Which sheets stay flat\n\n\
         Whole sheets by finite elements (`kirigami-studies flatness --tier {tier}`), in the law of the paper's film, beside the same \
         sheets with their panels held flat. One panel is clamped as a whole, one is pulled at its centroid. Opening: mean of the \
         hinges of the sheet held flat. Corners: distance in space from the sheet held flat, at the fraction of the stroke that was \
         reached; per cent of the longer side of the flat sheet. l_eg: elasto-gravity length, (E t^2 / (12 (1 - nu^2) rho g))^(1/3). Gamma: (21) for the \
         longest edge of a panel. Bumps of ligaments up to twice as wide as the sheet is thick: 0.02 t, others: t.\n\n{table}"
    )
}
