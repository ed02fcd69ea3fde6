//! The error of a deployed sheet, measured by finite elements for its hinges.

use crate::balanced_sheet::{
    BALANCED, BALANCED_FORCES, BalanceEnd, Balanced, Round, movements, size,
};
use analysis::error_budget::{Effect, ErrorBudget, ErrorCause};
use design::hinge_law::DamageMeasure;
use design::objective::design_problem::Deployment;
use mesher::Tier;
use serde::Serialize;
use support::Joined;
use support::document::Document;
use support::statistics::rms_and_maximum;
use support::table::{Cell, Columns, Table};

/// The equilibrium by the hinge law compared with that by finite elements.
#[derive(Debug, Serialize)]
pub struct SheetErrors {
    /// The design that is checked, for a person.
    design: String,
    rounds: Vec<Round>,
    /// Why no further round was made on the finest mesh.
    ended: BalanceEnd,
    /// CPU time of all window solves (s).
    cpu_seconds: f64,
    /// Diagonal of the deployed sheet (mm).
    size: f64,
    /// Load factor at the end of the path by the law.
    load_factor: f64,
    /// The errors of the law by finite elements of each mesh, the finest one last.
    errors: Vec<MeshErrors>,
    /// The cheaper mesh in addition to the finest one, if the sheet was balanced on both.
    between: Option<MeshErrors>,
    /// Standard deviations of the causes in the error budget of the report that finite elements
    /// see, if there is one.
    budget: Option<Effect>,
    /// Hinges that leave the training domain in the sheet by the law or in that by finite elements.
    outside: Vec<usize>,
    hinges: Vec<HingeErrors>,
}

/// One deployment compared with finite elements of one mesh, at full load.
#[derive(Debug, Serialize)]
struct MeshErrors {
    /// Mesh tier of the windows.
    tier: Tier,
    /// Distance of the panel corners (mm): root mean square and maximum.
    corners: [f64; 2],
    /// Difference of the hinge rotations (deg): root mean square and maximum.
    rotations_deg: [f64; 2],
    /// Load factor at the end of the path by these finite elements, and the relative difference of
    /// the other from it; zero under dead loads.
    load_factor: f64,
    load: f64,
}

/// One hinge at full load.
#[derive(Debug, Serialize)]
struct HingeErrors {
    hinge: usize,
    /// Rotation (deg), by the law and by finite elements.
    theta_deg: [f64; 2],
    /// Maximum D_peak, by the law and by finite elements; `None` if not known.
    damage_peak: [Option<f64>; 2],
}

impl SheetErrors {
    /// The errors of a design, which has a name for a person, with their budget.
    pub fn new(found: &Balanced, design: String, budget: Option<&ErrorBudget>) -> Self {
        let (by_law, by_elements) = (found.by_law(), found.by_elements());
        let ends = [by_law, by_elements].map(Deployment::final_step);
        let hinges: Vec<HingeErrors> = (0..found.hinges.len())
            .map(|hinge| HingeErrors {
                hinge,
                theta_deg: ends.map(|end| end.deformations[hinge].theta.to_degrees()),
                damage_peak: [
                    by_law.damage_max(DamageMeasure::Peak, hinge),
                    found.hinges[hinge].and_then(|end| end.d_peak),
                ],
            })
            .collect();
        let leaves = |hinge: &usize| {
            let paths = by_law.path.iter().chain(&by_elements.path);
            paths.into_iter().any(|step| !step.inside[*hinge])
        };
        let meshes = found.by_mesh();
        let errors = meshes.map(|(tier, by_mesh)| MeshErrors::new(by_law, tier, by_mesh));
        let between = found.mesh_error();
        let between =
            between.map(|[(_, draft), (tier, finest)]| MeshErrors::new(draft, tier, finest));
        Self {
            design,
            rounds: found.rounds.clone(),
            ended: found.ended.clone(),
            cpu_seconds: found.cpu_seconds,
            size: size(by_elements),
            load_factor: ends[0].load_factor,
            errors: errors.collect(),
            between,
            budget: budget.map(|budget| budget.sum(ErrorCause::is_seen_by_elements)),
            outside: (0..hinges.len()).filter(leaves).collect(),
            hinges,
        }
    }
}

impl SheetErrors {
    /// The page of the comparison.
    pub fn document(&self) -> Document {
        let mut page = Document::default();
        page.heading(1, "The deployed sheet, by finite elements");
        page.text(format!(
            "Equilibrium of the {} with finite elements for all {} hinges, panels held flat. Every round solves the hinges along \
             their paths, corrects the hinge law to their forces and deploys the sheet again; {:.0} CPU minutes in all.",
            self.design,
            self.hinges.len(),
            self.cpu_seconds / 60.0,
        ));
        let mut rounds =
            Table::new(["round", "mesh of the windows", "force error", "movement\nmm"]);
        for (i, round) in self.rounds.iter().enumerate() {
            rounds.row([
                Cell::text(i + 1),
                Cell::text(round.tier),
                Cell::percent(round.force_error, 2),
                Cell::fixed(round.movement, 3),
            ]);
        }
        page.table(rounds);
        let ended = match self.ended.warning() {
            None => "The panels stay where they are within".into(),
            Some(warning) => format!(
                "NOT BALANCED: {warning}. The equilibrium by finite elements is not known within {:.1} mm, the movement of the \
                 last round, and neither are the errors below. The limit is",
                self.rounds.last().map_or(f64::NAN, |round| round.movement)
            ),
        };
        page.text(format!(
            "Force error: finite elements against the law of the round, root mean square over all hinges. Movement: of the \
             panel corner that moves furthest. {ended} {:.3} mm ({BALANCED:.0e} of the sheet), forces within {:.0} %.",
            BALANCED * self.size,
            100.0 * BALANCED_FORCES,
        ));
        self.add_errors(&mut page);
        self.add_unsolved(&mut page);
        if !self.outside.is_empty() {
            let hinges = self.outside.iter().map(usize::to_string).joined(", ");
            page.text(format!(
                "Outside the training domain: hinge {hinges}. The law has a return force there that finite elements do not have."
            ));
        }
        let degrees = |i: usize| move |hinge: &HingeErrors| Cell::fixed(hinge.theta_deg[i], 2);
        let peak = |i: usize| {
            move |hinge: &HingeErrors| {
                Cell::known(hinge.damage_peak[i].map(|peak| Cell::fixed(peak, 3)), "?")
            }
        };
        let hinges = Columns::new()
            .column("hinge", |hinge: &HingeErrors| hinge.hinge)
            .column("theta\ndeg", degrees(0))
            .column("by FE", degrees(1))
            .column("D_peak", peak(0))
            .column("by FE", peak(1));
        page.table(hinges.table(&self.hinges));
        page
    }

    /// The errors by each mesh, the difference between the meshes, and the budget.
    fn add_errors(&self, page: &mut Document) {
        let mut table = Table::new([
            "at full load, panels held flat",
            "deployed corners, root mean square",
            "maximum",
            "rotation of the hinges, root mean square",
            "maximum",
            "load",
        ]);
        for errors in &self.errors {
            let of = format!("error of the hinge law, by `{}`", errors.tier);
            table.row(errors.cells(of, self.size));
        }
        if let Some(between) = &self.between {
            let draft = self.errors[self.errors.len() - 2].tier;
            let of = format!("error of `{draft}`, by `{}`", between.tier);
            table.row(between.cells(of, self.size));
        }
        if let Some(Effect { corners: [rms, maximum], load, at_least, .. }) = &self.budget {
            let bound = if *at_least { "at least " } else { "" };
            table.row([
                "error budget of the report: standard deviation of what finite elements see".into(),
                format!("{bound}{rms:.3} mm"),
                format!("{maximum:.3} mm"),
                "-".into(),
                "-".into(),
                load.map_or("-".into(), |load| format!("{:.2} %", 100.0 * load)),
            ]);
        }
        page.table(table);
        let factors = self.errors.iter();
        let factors = factors
            .map(|errors| format!("{:.4} by `{}`", errors.load_factor, errors.tier))
            .joined(", ");
        page.text(format!("Load factor {:.4} by the law, {factors}.", self.load_factor));
    }

    /// The hinges that were not solved, round by round, and what is not known for it.
    fn add_unsolved(&self, page: &mut Document) {
        let rounds = self.rounds.iter().enumerate();
        let unsolved: Vec<String> = rounds
            .flat_map(|(i, round)| {
                let hinges = round.unsolved.iter();
                hinges.map(move |hinge| format!("round {}, {hinge}", i + 1))
            })
            .collect();
        if !unsolved.is_empty() {
            page.text(
                "NOT SOLVED: in these rounds the hinge law, as corrected in the rounds before, stands for the hinge. The force \
                 error leaves it out, and what finite elements would change there is not known.",
            );
        }
        page.list(unsolved);
    }
}

impl MeshErrors {
    /// A deployment compared with the deployment by finite elements.
    fn new(deployed: &Deployment, tier: Tier, by_elements: &Deployment) -> Self {
        let [own, other] = [deployed, by_elements].map(Deployment::final_step);
        let turned = std::iter::zip(&own.deformations, &other.deformations)
            .map(|(own, other)| (own.theta - other.theta).to_degrees());
        Self {
            tier,
            corners: rms_and_maximum(movements(deployed, by_elements)),
            rotations_deg: rms_and_maximum(turned),
            load_factor: other.load_factor,
            load: own.load_factor / other.load_factor - 1.0,
        }
    }

    fn cells(&self, of: String, size: f64) -> [String; 6] {
        let [rms, maximum] = self.corners;
        let percent = |length: f64| 100.0 * length / size;
        let [turned, most_turned] = self.rotations_deg;
        [
            of,
            format!("{rms:.3} mm, {:.3} % of the sheet", percent(rms)),
            format!("{maximum:.3} mm, {:.3} %", percent(maximum)),
            format!("{turned:.3} deg"),
            format!("{most_turned:.3} deg"),
            format!("{:+.2} %", 100.0 * self.load),
        ]
    }
}
