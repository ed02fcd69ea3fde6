//! The scene of a sheet that opens onto the target of another: an even pattern laid over the target,
//! fastened at the places of its opening.

use crate::fit::even_pattern::Opening;
use crate::fit::even_sheet::{EvenSheet, QUICK, Search, THOROUGH, growth};
use crate::fit::fasteners::{AT_MOST, Candidates, FIRST, Fastening, HOLES, MIDDLE};
use crate::fit::lost::{Lost, kept_by, lost};
use crate::fit::opening::{free_axial_opening, safe_opening};
use crate::fit::trimmed::{Limits, REACH, TOLERANCE};
use design::geometry::plane::{complex, point};
use design::geometry::polygon::{bounds, distance, size};
use design::geometry::region::{Region, Ring};
use design::geometry::similarity::Similarity;
use design::pattern::grid::Grid;
use design::sheet::topology::Topology;
use faer::c64;
use hinge::Regime;
use scene::{
    At, CellsConfig, Level, Posture, PostureConfig, Scene, SceneConfig, StartConfig, SupportConfig,
    SupportKind, rounded, short,
};
use std::f64::consts::{FRAC_PI_2, SQRT_2};
use support::{Fault, Point, fault, refuse};

/// The largest opening that is planned (rad): 60 degrees.
const MOST: f64 = 1.047;
/// The opening that is planned for a law that predicts no damage (rad): 45 degrees.
const UNKNOWN: f64 = 0.785;
/// Side of a panel over the radius of a window: two windows and a margin.
pub const SIDE: f64 = 2.25;
/// How far the width of the ligaments is from the narrowest to the widest of the scene.
const NARROW: f64 = 0.125;
/// Smallest width of a part of a panel, over the thickness.
const WIDTH: f64 = 2.0;
/// Smallest distance of panels that do not hang together, over the side of a panel: more than what
/// an uneven opening moves them.
const GAP: f64 = 0.05;
/// Sizes that are compared, over the size at which the drawing fills the stock, and over those if
/// none of them fits.
const SIZES: [f64; 6] = [1.04, 1.0, 0.97, 0.94, 0.91, 0.88];
const LARGEST: [f64; 3] = [1.0, 0.82, 0.68];
/// How far a panel without a limb reaches from its middle at most, in its sides.
pub const WITHOUT_LIMB: f64 = SQRT_2 * REACH;
/// Steps of a search: an even pattern needs none (docs/TRIED.md).
const STEPS: usize = 0;

/// A scene of an even sheet, and what is expected of it.
pub struct FittedScene {
    /// Its keys.
    pub config: SceneConfig,
    /// Number of panels.
    pub panels: usize,
    /// Side of a panel (mm).
    pub side: f64,
    /// The smallest side of a panel that has room for the windows of two hinges (mm).
    pub smallest: f64,
    /// The opening of every hinge (rad).
    pub opening: f64,
    /// Intersection over union of what one sees of the opened panels and the target.
    pub seen: f64,
    /// How far the corners of a panel that is trimmed are from its middle at most (sides).
    pub reach: f64,
    /// How its fasteners hold it; `None` if no equilibrium is found.
    pub held: Option<Fastening>,
    /// The parts of the target that are not seen.
    pub lost: Vec<Lost>,
    /// The factor by which the stock has to be longer and wider, or the sheet thinner, to show them;
    /// `None` if no factor up to two does, and if nothing is lost.
    pub kept_by: Option<f64>,
}

/// The even sheet that opens onto the target of a scene, whose sheet stands for the space in its
/// stock; its panels have a side (mm), the smallest one that has room for the windows of two hinges
/// unless a larger one is named.
pub fn fitted(scene: &Scene, side: Option<f64>) -> Result<FittedScene, Fault> {
    let side = side.unwrap_or(smallest_side(scene));
    let sheet = even_sheet(scene, side, THOROUGH)?;
    let mut fit = fastened(scene, &sheet, side)?;
    if !fit.lost.is_empty() {
        let target = scene.target.region();
        fit.kept_by = kept_by(&target, sheet.size(&target), sheet.limits);
    }
    Ok(fit)
}

/// The sheet of a scene that was fitted, less the panel at a point of the opened sheet (mm), or with
/// one there.
pub fn toggled(scene: &Scene, at: Point) -> Result<FittedScene, Fault> {
    let (Some(_), Some(corners)) = (&scene.config.cells, scene.config.sheet.corners) else {
        refuse!("panels are added to and taken from a sheet that is fitted to a drawing");
    };
    let topology = &scene.topology;
    let Grid { m, n } = topology.grid;
    let [from, to] = [corners[0], corners[1]].map(complex);
    let back = (to - from) / m as f64;
    let side = back.norm();
    let limits = limits(scene, side);
    let shift = (limits.opening.pitch() - 1.0) * middle(topology) - from / back;
    let place = Similarity { turn: back.inv(), shift };
    let voids = (1..m).flat_map(|i| (1..n).map(move |j| [i, j]));
    let kept = voids.filter(|[i, j]| topology.has_void(*i, *j));
    let loops = kept.map(|void| void.map(|i| i as i32 - 1)).collect();
    let sheet = EvenSheet::toggled(&scene.target.region(), place, limits, loops, at)?;
    fastened(scene, &sheet, side)
}

/// The scene of a sheet with fasteners.
fn fastened(scene: &Scene, sheet: &EvenSheet, side: f64) -> Result<FittedScene, Fault> {
    let topology = sheet.topology();
    let (config, held) = fasten(scene, sheet, &topology, side);
    if config.supports.is_empty() {
        refuse!(
            "no panel of {side:.0} mm has room for a fastener: use smaller panels or a larger sheet"
        );
    }
    let corners = topology.trims.iter().flatten().flat_map(|trim| trim.iter());
    Ok(FittedScene {
        config,
        held,
        reach: corners.map(|at| distance(*at, MIDDLE)).fold(0.0, f64::max),
        lost: lost(sheet),
        kept_by: None,
        panels: topology.panel_count(),
        side,
        smallest: smallest_side(scene),
        opening: sheet.limits.opening.angle,
        seen: sheet.seen,
    })
}

/// The outlines of the opened panels over the target (mm) that a short search finds, and how much of
/// the target one sees.
pub fn cropped(scene: &Scene, side: f64) -> Result<(Vec<Ring>, f64), Fault> {
    let sheet = even_sheet(scene, side, QUICK)?;
    let back = |at: &[f64; 2]| point(sheet.place.back(complex(*at)));
    let panels = sheet.opened(1.0);
    let panels = panels.iter().map(|panel| panel.iter().map(back).collect()).collect();
    Ok((panels, sheet.seen))
}

/// The smallest side of a panel that has room for the windows of two hinges (mm).
fn smallest_side(scene: &Scene) -> f64 {
    SIDE * scene.config.process.r_win
}

/// The sheet of the target of a scene that a search finds.
fn even_sheet(scene: &Scene, side: f64, search: Search) -> Result<EvenSheet, Fault> {
    if scene.config.level == Level::Pin {
        refuse!(
            "the sheet has pins (level = \"pin\"): its search is on pins already; a fit is for a sheet with a hinge law"
        );
    }
    let smallest = smallest_side(scene);
    if side < smallest {
        refuse!(
            "panels of {side} mm are too small: the windows of two hinges, and a margin, need {smallest} mm"
        );
    }
    let limits = limits(scene, side);
    largest(&scene.target.region(), limits, search).ok_or_else(|| {
        fault!(
            "the target is nowhere as wide as two panels of {side:.0} mm: use smaller panels (at least {smallest:.0} mm), a larger sheet (--size, --stock) or a thinner one (--thickness)"
        )
    })
}

/// What bounds panels of a side (mm).
fn limits(scene: &Scene, side: f64) -> Limits {
    let angle = opening(scene);
    let process = scene.config.process;
    let space = bounds(scene.config.sheet.outline().corners);
    Limits {
        stock: size(space).map(|length| length / side),
        opening: Opening { angle, set_back: set_back(scene, angle) / side },
        // The window is about the tip of the cut.
        window: (process.r_win + width(scene) + 0.5 * process.slit_width) / side + TOLERANCE,
        width: WIDTH * scene.material.thickness / side,
        gap: f64::max(GAP, process.slit_width / side),
        slit: process.slit_width / side,
    }
}

/// Width of the ligaments (mm). Narrow ones open more evenly between fasteners: the moment of a
/// ligament falls faster with its width than its axial stiffness.
fn width(scene: &Scene) -> f64 {
    let [narrowest, widest] = scene.config.ligament.range;
    rounded(narrowest + NARROW * (widest - narrowest))
}

/// Distance from the corner of a panel to the tip of the cut (mm).
fn to_tip(scene: &Scene) -> f64 {
    width(scene) + 0.5 * scene.config.process.slit_width
}

/// The largest hole for a screw (mm) that leaves the windows of the hinges around the middle of a
/// panel of some side (mm).
fn hole(scene: &Scene, side: f64) -> f64 {
    let r_win = scene.config.process.r_win;
    let half = 0.5 * side;
    let tip = half.hypot(half - to_tip(scene));
    let fits = |hole: &f64| r_win + 0.5 * hole < tip;
    HOLES.into_iter().find(fits).unwrap_or(HOLES[HOLES.len() - 1])
}

/// The opening that the material bears (rad).
fn opening(scene: &Scene) -> f64 {
    scene
        .surrogate()
        .map_or(UNKNOWN, |surrogate| safe_opening(surrogate, width(scene), &[FRAC_PI_2], MOST))
}

/// Distance from the corner of a panel to the point about which its neighbour has turned when the
/// ligament is free (mm).
fn set_back(scene: &Scene, angle: f64) -> f64 {
    let width = width(scene);
    scene.surrogate().map_or(0.0, |surrogate| {
        let eta_a = free_axial_opening(surrogate, width, angle);
        to_tip(scene) - 0.5 * eta_a * width / (0.5 * angle).sin()
    })
}

/// The sheet of a drawing that is as large as its stock allows. What is seen of the drawing comes
/// before the last percents of its size.
fn largest(target: &Region, limits: Limits, search: Search) -> Option<EvenSheet> {
    let size = growth(target.extent(), limits.stock) * target.longer_side();
    let with = |part: f64, search| {
        EvenSheet::new(target, &SIZES.map(|factor| factor * part * size), limits, search)
    };
    let mut best = LARGEST.into_iter().find_map(|part| with(part, search))?;
    // Limbs do not become smaller when the sheet closes: it has to be smaller with them.
    for part in LARGEST {
        if lost(&best).is_empty() {
            break;
        }
        best = with(part, Search { limbs: true, ..search })
            .filter(|it| it.seen > best.seen)
            .unwrap_or(best);
    }
    Some(best)
}

/// The keys of the scene with fasteners, one after the other where panels are farthest from the even
/// opening until they suffice, and how they hold the sheet; if none suffice, with those that hold
/// its panels best.
fn fasten(
    scene: &Scene,
    sheet: &EvenSheet,
    topology: &Topology,
    side: f64,
) -> (SceneConfig, Option<Fastening>) {
    let laid = LaidSheet::new(sheet, topology, side);
    let [flat, even] = [0.0, laid.opened].map(|opened| laid.middles(opened));
    let candidates = Candidates::new(topology);
    let mut fastened = candidates.spread(AT_MOST);
    let most = laid.keys(scene, sheet, &fastened);
    // The sheet with the most fasteners is nearest to its even opening.
    let known = || {
        let scene = scene.changed(most.clone()).ok()?;
        let response = scene.problem().ok()?.response(&scene.start(), None).ok()?;
        Some(response.deployment.warm_start())
    };
    let Some(known) = known() else { return (most, None) };
    fastened.truncate(FIRST);
    let mut best: Option<(SceneConfig, Fastening)> = None;
    loop {
        let config = laid.keys(scene, sheet, &fastened);
        // A sheet that is refused is not balanced: what is seen of its target says more.
        let changed = scene.changed(config.clone()).ok();
        let held = changed.and_then(|scene| Fastening::of(&scene, &flat, &even, &known));
        let (next, suffices) = match &held {
            Some(held) => (candidates.most_off(&held.off), held.suffices()),
            None => (candidates.farthest(&fastened), false),
        };
        let better = |best: &Fastening, held: &Fastening| held.unevenness() < best.unevenness();
        if let Some(held) = held
            && (suffices || best.as_ref().is_none_or(|(_, best)| better(best, &held)))
        {
            best = Some((config, held));
        }
        match next {
            Some(next) if !suffices && fastened.len() < AT_MOST && !fastened.contains(&next) => {
                fastened.push(next)
            }
            _ => break,
        }
    }
    best.map_or((most, None), |(config, held)| (config, Some(held)))
}

/// The middle of all panels from the corner of the grid (sides of a panel).
fn middle(topology: &Topology) -> c64 {
    topology.places.iter().map(centre).sum::<c64>() / topology.panel_count() as f64
}

/// The middle of the cell at a place from the corner of the grid (sides of a panel).
fn centre(place: &[usize; 2]) -> c64 {
    complex(place.map(|i| i as f64 + 0.5))
}

/// An even sheet in the coordinates of its scene: turned back, so that the drawing stands upright,
/// in mm, its lower left corner at the origin.
struct LaidSheet<'a> {
    topology: &'a Topology,
    /// Side of a panel (mm).
    side: f64,
    grid: Grid,
    /// The first cell of the grid.
    first: c64,
    /// The map from sides of a panel to mm, turned back.
    back: c64,
    /// Lower left corner before it is at the origin (mm).
    low: c64,
    /// The middle of all panels, which stays (sides of a panel).
    middle: c64,
    /// The growth of the distances of panels, relative to them.
    opened: f64,
}

impl<'a> LaidSheet<'a> {
    fn new(sheet: &EvenSheet, topology: &'a Topology, side: f64) -> Self {
        let (grid, first) = sheet.cells();
        let back = side * c64::cis(-sheet.place.rotation());
        let flat = sheet.opened(0.0);
        let first = complex(first.map(f64::from));
        let turned = |at: &[f64; 2]| point(back * (complex(*at) - first));
        let low = complex(bounds(flat.iter().flatten().map(turned))[0]);
        let opened = sheet.limits.opening.pitch() - 1.0;
        let middle = first + middle(topology);
        Self { topology, side, grid, first, back, low, middle, opened }
    }

    /// The middle of the cell of a panel (sides of a panel).
    fn centre(&self, panel: usize) -> c64 {
        self.first + centre(&self.topology.places[panel])
    }

    /// A point of the pattern in the sheet (mm).
    fn in_sheet(&self, at: c64) -> [f64; 2] {
        point(self.back * (at - self.first) - self.low)
    }

    /// The middles of all panels when their distances have grown by `opened` (mm).
    fn middles(&self, opened: f64) -> Vec<[f64; 2]> {
        let moved = |panel| {
            let centre = self.centre(panel);
            self.in_sheet(centre + opened * (centre - self.middle))
        };
        (0..self.topology.panel_count()).map(moved).collect()
    }

    /// The keys of the scene with the sheet, fasteners at panels, and the place of its target.
    fn keys(&self, scene: &Scene, sheet: &EvenSheet, fastened: &[usize]) -> SceneConfig {
        let (m, n) = (self.grid.m as f64, self.grid.n as f64);
        let corners = [[0.0, 0.0], [m, 0.0], [m, n], [0.0, n]];
        let mut config = scene.config.clone();
        config.sheet.size = None;
        config.sheet.corners =
            Some(corners.map(|at| self.in_sheet(self.first + complex(at)).map(short)));
        config.sheet.panels = [self.grid.m, self.grid.n];
        config.cells = Some(CellsConfig::from(self.topology));
        let kind = match scene.material.regime(width(scene)) {
            Regime::Film => Posture::HeldFlat,
            Regime::Plate => Posture::Mounted,
        };
        config.posture = Some(PostureConfig { kind, down: None });
        config.ligament.start = width(scene);
        config.start = StartConfig::default();
        config.clear_actuation();
        let [flat, even] = [0.0, self.opened].map(|opened| self.middles(opened));
        let hole = Some(hole(scene, self.side));
        let fastener = |panel: &usize| {
            let at = flat[*panel].map(rounded);
            SupportConfig {
                at: At::Point(at),
                hole,
                displacement: [0, 1].map(|axis| rounded(even[*panel][axis] - at[axis])),
                ..SupportConfig::at_centroid(self.topology.places[*panel], SupportKind::Pin)
            }
        };
        config.supports = fastened.iter().map(fastener).collect();
        config.objective = Default::default();
        config.optimiser.steps = STEPS;
        // From the target to the opened sheet whose middle stays.
        let turn = self.back * sheet.place.turn;
        let shift = self.back * (sheet.place.shift - self.opened * self.middle - self.first);
        let place = Similarity { turn, shift: shift - self.low };
        config.target = config.target.placed(&place, &scene.target.points);
        config
    }
}
