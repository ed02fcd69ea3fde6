//! A random sheet with its hinges, supports, loads and drive, its mirror image and its similar
//! sheets.

use design::equilibrium::settings::SolverSettings;
use design::equilibrium::solver::EquilibriumSolver;
use design::equilibrium::supports::{Dof, Load, Support};
use design::hinge_law::{Contact, HingeLaw, LinearLaw, SurrogateLaw};
use design::objective::design_problem::{DesignProblem, Mechanics, Model};
use design::objective::loss::Objective;
use design::objective::shape::ShapeDistance;
use design::pattern::coordinates::PatternCoordinates;
use design::pattern::cut_pattern::Outline;
use design::pattern::design_vector::{DesignVector, WidthChart};
use design::pattern::grid::{Endpoint, Grid};
use design::sheet::cut_sheet::{HingePoint, SheetOptions};
use design::sheet::topology::{HingeSite, Topology};
use hinge::HingeConstants;
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use std::fmt;
use std::path::Path;
use std::sync::{Arc, LazyLock};
use surrogate::Surrogate;

/// Learned laws of two sizes.
static NETWORKS: LazyLock<[Surrogate; 2]> = LazyLock::new(|| {
    ["tests/cases/chi_tiny", "../data/pet-0.5mm/small"].map(|name| {
        let weights = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        Surrogate::load(&weights.with_extension("safetensors")).unwrap()
    })
});

#[derive(Clone, Debug)]
pub enum DrawnLaw {
    /// (k_a, k_s, k_theta) per hinge.
    Linear(Vec<[f64; 3]>),
    /// One of the networks, at a multiple of its thickness.
    Learned(usize, f64),
}

/// Power of ten by which the constants of a linear law differ at most, with the millimetre as unit:
/// constants of sheets, and extreme ones.
const EXPONENTS: [f64; 2] = [2.0, 8.0];

#[derive(Clone, Debug)]
pub struct Drawn {
    pub grid: Grid,
    pub outline: Outline,
    pub pattern: PatternCoordinates,
    pub w_lig: Vec<f64>,
    /// The interval of the widths.
    pub range: [f64; 2],
    pub hinge_point: HingePoint,
    pub process: HingeConstants,
    pub law: DrawnLaw,
    /// Stiffness, and the two angles.
    pub contact: Option<[f64; 3]>,
    pub supports: Vec<Support>,
    pub loads: Vec<Load>,
    /// Weight of a unit of area (N/mm^2).
    pub weight: [f64; 2],
    pub stroke: Option<f64>,
    pub steps: usize,
}

/// The scene in a line, for the list of findings.
impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{} x {}, {} steps", self.grid.m, self.grid.n, self.steps)?;
        match &self.law {
            DrawnLaw::Learned(network, factor) => write!(f, ", network {network} x {factor}")?,
            DrawnLaw::Linear(constants) => {
                let [k_a, k_s, k_theta] = constants[0];
                let [a, s] = [k_a, k_s].map(|k| k * self.w_lig[0].powi(2) / k_theta);
                write!(f, ", k w^2 / k_theta {a:.0e} {s:.0e}")?;
            }
        }
        let kinds = [
            (self.contact.is_some(), "contact"),
            (self.stroke.is_some(), "stroke"),
            (self.weight != [0.0; 2], "weight"),
            (self.supports.iter().any(|support| support.value != 0.0), "moved support"),
        ];
        (kinds.iter().filter(|(has, _)| *has)).try_for_each(|(_, kind)| write!(f, ", {kind}"))
    }
}

struct Dice(ChaCha8Rng);

impl Dice {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    /// A power of ten.
    fn power(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.within(low, high))
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.within(0.0, 1.0) < probability
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.0.random_range(0..choices.len())]
    }
}

impl Drawn {
    pub fn new(seed: u64) -> Self {
        let dice = &mut Dice(ChaCha8Rng::seed_from_u64(seed));
        // Small sheets are more frequent.
        let count =
            |dice: &mut Dice, most: f64| 1 + (most * dice.within(0.0, 1.0).powi(2)) as usize;
        let (m, n) = (1 + count(dice, 6.0), 1 + count(dice, 4.0));
        let grid = Grid { m, n };
        let law = drawn_law(dice, grid);
        let (range, panel) = lengths(dice, &law);
        let outline = drawn_outline(dice, [m as f64 * panel, n as f64 * panel]);
        let spread = dice.one_of(&[0.0, 0.3, 1.0]);
        let logits = |dice: &mut Dice, count: usize| -> Vec<f64> {
            let logit = || spread * dice.within(-1.0, 1.0);
            std::iter::repeat_with(logit).take(count).collect()
        };
        let pattern = PatternCoordinates {
            z: logits(dice, grid.aspect_ratio_count()),
            ell: grid.edge_cut_counts().map(|count| logits(dice, count + 1)),
        };
        let middle = 0.5 * (range[0] + range[1]);
        let width = || middle + 0.45 * (range[1] - range[0]) * dice.within(-1.0, 1.0);
        let widths = std::iter::repeat_with(width);
        let w_lig: Vec<f64> = widths.take(grid.hinge_count()).collect();
        let supports = drawn_supports(dice, grid, panel);
        // The moment that turns a hinge by something like a radian.
        let moment = match &law {
            DrawnLaw::Linear(constants) => constants[0][2],
            DrawnLaw::Learned(network, _) => NETWORKS[*network].energy_scale(),
        } * dice.power(-1.5, 0.5);
        let loads = drawn_loads(dice, grid, &supports, [moment / panel, moment]);
        let driven = dice.chance(0.4) && !loads.is_empty();
        let length = panel * ((m * n) as f64).sqrt();
        let has_force = loads.iter().any(|load| load.dof != Dof::Phi);
        let stroke = if has_force { length } else { 1.0 };
        let weight = if dice.chance(0.15) {
            let area = panel * panel * (m * n) as f64;
            let [x, y] = turned(dice.within(0.0, TAU));
            [x, y].map(|component| 0.3 * moment / panel / area * component)
        } else {
            [0.0; 2]
        };
        let contact = dice.chance(0.8).then(|| {
            let cut = dice.one_of(&[0.0, -0.05]);
            let stiffness = moment * dice.power(-1.0, 2.0);
            [stiffness, cut - dice.power(-1.5, -0.5), cut]
        });
        Self {
            grid,
            outline,
            pattern,
            w_lig,
            range,
            hinge_point: dice.one_of(&[HingePoint::CutTip, HingePoint::Corner]),
            process: HingeConstants {
                kerf: 0.01 * middle,
                r_win: 5.0 * middle,
                ..HingeConstants::PAPER
            },
            law,
            contact,
            supports,
            loads,
            weight,
            stroke: driven.then(|| stroke * dice.power(-2.0, -0.5)),
            steps: dice.one_of(&[1, 5, 10, 20, 40, 60]),
        }
    }

    /// Whether springs differ by more than the springs of sheets do.
    pub fn is_extreme(&self) -> bool {
        let DrawnLaw::Linear(constants) = &self.law else {
            return false;
        };
        let [k_a, k_s, k_theta] = constants[0];
        let ratios = [k_a, k_s].map(|k| (k / k_theta).log10().abs());
        ratios.iter().any(|ratio| *ratio > EXPONENTS[0] + 1.0)
    }

    pub fn design(&self) -> DesignVector {
        let chart = self.chart();
        DesignVector {
            pattern: self.pattern.clone(),
            omega: self.w_lig.iter().map(|w| chart.omega(*w)).collect(),
            opening: None,
        }
    }

    fn chart(&self) -> WidthChart {
        let [w_minus, w_plus] = self.range;
        WidthChart { w_minus, w_plus }
    }

    fn law(&self) -> Arc<dyn HingeLaw> {
        match &self.law {
            DrawnLaw::Linear(stiffness) => Arc::new(LinearLaw { stiffness: stiffness.clone() }),
            DrawnLaw::Learned(network, factor) => {
                Arc::new(SurrogateLaw { surrogate: NETWORKS[*network].clone().scaled(*factor) })
            }
        }
    }

    /// The sheet is to become an ellipse a little wider than itself.
    pub fn problem(&self) -> DesignProblem {
        let settings = SolverSettings::default();
        let solver =
            EquilibriumSolver::new(self.grid, &self.supports, &self.loads, self.steps, settings);
        let solver = solver.unwrap().with_weight(self.weight).unwrap();
        let solver = match self.stroke {
            Some(stroke) => solver.driven(stroke).unwrap(),
            None => solver,
        };
        let contact = self.contact.map(|[k, wall, cut]| Contact::new(k, wall, cut));
        let corners = self.outline.corners;
        let centre = [0, 1].map(|d| 0.25 * corners.iter().map(|corner| corner[d]).sum::<f64>());
        let radii = [0.6, 0.5].map(|ratio| ratio * self.outline.size());
        let target = (0..60).map(|i| {
            let [x, y] = turned(TAU * f64::from(i) / 60.0);
            [centre[0] + radii[0] * x, centre[1] + radii[1] * y]
        });
        DesignProblem {
            topology: self.grid.into(),
            outline: self.outline,
            widths: self.chart(),
            options: SheetOptions { hinge_point: self.hinge_point, process: self.process.into() },
            model: Model::Equilibrium(Box::new(Mechanics {
                law: self.law(),
                contact: contact.map(Result::unwrap),
                solver,
            })),
            objective: Objective {
                shape: ShapeDistance::new(target.collect()),
                functionals: Vec::new(),
                penalties: Vec::new(),
            },
        }
    }

    /// All lengths times `factor`, the thickness of learned hinges included; forces so that the
    /// sheet opens alike.
    pub fn similar(&self, factor: f64) -> Self {
        let mut other = self.clone();
        let energy = match &mut other.law {
            // The translational constants of a spring do not change.
            DrawnLaw::Linear(stiffness) => {
                stiffness.iter_mut().for_each(|k| k[2] *= factor * factor);
                factor.powi(2)
            }
            DrawnLaw::Learned(_, thickness) => {
                *thickness *= factor;
                factor.powi(3)
            }
        };
        let corners = self.outline.corners;
        other.outline.corners = corners.map(|corner| corner.map(|x| factor * x));
        other.w_lig.iter_mut().for_each(|w| *w *= factor);
        other.range = self.range.map(|w| factor * w);
        other.process.kerf *= factor;
        other.process.r_win *= factor;
        other.contact = self.contact.map(|[k, wall, cut]| [energy * k, wall, cut]);
        for support in &mut other.supports {
            support.value *= if support.dof == Dof::Phi { 1.0 } else { factor };
        }
        for load in &mut other.loads {
            let way = if load.dof == Dof::Phi { 1.0 } else { factor };
            load.value *= energy / way;
        }
        other.weight = self.weight.map(|it| energy / factor.powi(3) * it);
        if self.loads.iter().any(|load| load.dof != Dof::Phi) {
            other.stroke = self.stroke.map(|stroke| factor * stroke);
        }
        other
    }

    /// The image of (x, y) -> (-x, y), and for each of its panels the panel of this sheet. `None`
    /// if horizontal cuts become vertical, and for learned laws, which have the symmetry by
    /// training alone.
    pub fn mirrored(&self) -> Option<(Self, Vec<usize>)> {
        let Grid { m, n } = self.grid;
        if m % 2 == 1 || matches!(self.law, DrawnLaw::Learned(..)) {
            return None;
        }
        let mut other = self.clone();
        let panels: Vec<usize> = (0..m * n).map(|k| k / m * m + m - 1 - k % m).collect();
        let [sw, se, ne, nw] = self.outline.corners.map(|[x, y]| [-x, y]);
        other.outline.corners = [se, sw, nw, ne];
        let reversed = |values: &[f64]| values.iter().rev().copied().collect::<Vec<f64>>();
        let [bottom, right, top, left] = &self.pattern.ell;
        // The sides of every cut are exchanged: r becomes 1 - r.
        other.pattern.z =
            (self.pattern.z.chunks(m - 1)).flat_map(|row| row.iter().rev().map(|z| -z)).collect();
        other.pattern.ell = [reversed(bottom), left.clone(), reversed(top), right.clone()];
        let sites = &Arc::<Topology>::from(self.grid).sites;
        let hinges = sites.iter().map(|site| {
            let [i, j] = site.vertex;
            let endpoint = match ((i + j) % 2 == 0, site.endpoint) {
                (true, endpoint) => endpoint,
                (false, Endpoint::X) => Endpoint::XPrime,
                (false, Endpoint::XPrime) => Endpoint::X,
            };
            let same = |site: &HingeSite| site.vertex == [m - i, j] && site.endpoint == endpoint;
            sites.iter().position(same).unwrap()
        });
        let hinges: Vec<usize> = hinges.collect();
        other.w_lig = hinges.iter().map(|&h| self.w_lig[h]).collect();
        if let DrawnLaw::Linear(stiffness) = &self.law {
            other.law = DrawnLaw::Linear(hinges.iter().map(|&h| stiffness[h]).collect());
        }
        for Support { panel, dof, value } in &mut other.supports {
            *panel = panels[*panel];
            *value *= if *dof == Dof::UY { 1.0 } else { -1.0 };
        }
        for Load { panel, dof, value } in &mut other.loads {
            *panel = panels[*panel];
            *value *= if *dof == Dof::UY { 1.0 } else { -1.0 };
        }
        other.weight[0] *= -1.0;
        Some((other, panels))
    }
}

fn turned(angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

fn drawn_law(dice: &mut Dice, grid: Grid) -> DrawnLaw {
    if dice.chance(0.4) {
        return DrawnLaw::Learned(dice.one_of(&[0, 1]), dice.one_of(&[1.0, 1.0, 0.3, 4.0]));
    }
    let exponent = EXPONENTS[usize::from(dice.chance(0.2))];
    let k_theta = dice.power(-4.0, 5.0);
    let translations = [(); 2].map(|()| k_theta * dice.power(-exponent, exponent));
    let spread = dice.one_of(&[0.0, 0.5, 2.0]);
    let constants = |dice: &mut Dice| {
        let [k_a, k_s] = translations;
        [k_a, k_s, k_theta].map(|k| k * dice.power(-1e-9, 1e-9 + spread))
    };
    DrawnLaw::Linear((0..grid.hinge_count()).map(|_| constants(dice)).collect())
}

/// The interval of the ligament widths and the size of a panel (mm).
fn lengths(dice: &mut Dice, law: &DrawnLaw) -> ([f64; 2], f64) {
    let range = match law {
        DrawnLaw::Linear(_) => {
            let w = dice.power(-1.0, 1.5);
            [0.4 * w, 1.6 * w]
        }
        DrawnLaw::Learned(network, factor) => {
            let [low, high] = NETWORKS[*network].domain().w_lig;
            [low, high].map(|w| factor * w)
        }
    };
    (range, 0.5 * (range[0] + range[1]) * dice.power(0.8, 1.6))
}

/// A rectangle, or a quadrilateral near it.
fn drawn_outline(dice: &mut Dice, [width, height]: [f64; 2]) -> Outline {
    let mut outline = Outline::rectangle(width, height);
    if dice.chance(0.3) {
        for [x, y] in &mut outline.corners {
            *x += 0.15 * width * dice.within(-1.0, 1.0);
            *y += 0.15 * height * dice.within(-1.0, 1.0);
        }
    }
    outline
}

/// A clamp, a pin and a roller, or two pins of which one may move.
fn drawn_supports(dice: &mut Dice, grid: Grid, panel: f64) -> Vec<Support> {
    let first = dice.0.random_range(0..grid.panel_count());
    let second = (first + dice.0.random_range(1..grid.panel_count())) % grid.panel_count();
    let on = |panel, dofs: &[Dof]| -> Vec<Support> {
        let value = 0.0;
        let support = |&dof| Support { panel, dof, value };
        dofs.iter().map(support).collect()
    };
    let pin = [Dof::UX, Dof::UY];
    match dice.0.random_range(0..4) {
        0 | 1 => on(first, &Dof::ALL),
        2 => [on(first, &Dof::ALL), on(second, &[dice.one_of(&pin)])].concat(),
        _ => {
            let mut supports = [on(first, &pin), on(second, &pin)].concat();
            if dice.chance(0.5) {
                let way = 0.3 * panel;
                supports[2].value = way * dice.within(-1.0, 1.0);
                supports[3].value = way * dice.within(-1.0, 1.0);
            }
            supports
        }
    }
}

/// Forces and couples on some panels, a traction on an edge, and couples that open all panels.
fn drawn_loads(
    dice: &mut Dice,
    grid: Grid,
    supports: &[Support],
    [force, couple]: [f64; 2],
) -> Vec<Load> {
    let mut loads = Vec::new();
    let push = |panel, [x, y, m]: [f64; 3], loads: &mut Vec<Load>| {
        for (dof, value) in std::iter::zip(Dof::ALL, [x, y, m]) {
            let held = |support: &Support| support.panel == panel && support.dof == dof;
            if value != 0.0 && !supports.iter().any(held) {
                loads.push(Load { panel, dof, value });
            }
        }
    };
    for _ in 0..dice.0.random_range(0..4) {
        let panel = dice.0.random_range(0..grid.panel_count());
        let [x, y] = turned(dice.within(0.0, TAU)).map(|component| force * component);
        let turned = dice.chance(0.3).then(|| couple * dice.within(-1.0, 1.0));
        let couple = turned.unwrap_or(0.0);
        push(panel, [x, y, couple], &mut loads);
    }
    if dice.chance(0.4) {
        let top = grid.panel(0, grid.n - 1);
        let along = force * dice.within(-0.5, 0.5);
        (top..top + grid.m).for_each(|panel| push(panel, [along, force, 0.0], &mut loads));
    }
    if dice.chance(0.4) {
        for panel in 0..grid.panel_count() {
            let even = (panel % grid.m + panel / grid.m).is_multiple_of(2);
            let couple = if even { -couple } else { couple };
            push(panel, [0.0, 0.0, couple], &mut loads);
        }
    }
    loads
}
