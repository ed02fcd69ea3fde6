//! A designed sheet as a finite-element problem.

use crate::finished_panel::FinishedPanel;
use crate::verification_error::VerificationError;
use design::sheet::cut_sheet::{AttachmentPoint, PanelPoint, Sheet};
use design::sheet::hinge_window::HingeWindow;
use design::sheet::topology::PanelCorner;
use fe_driver::{HeldPanel, OutOfPlaneRestraint, Place, Pulled, SheetProblem};
use hinge::{HingeDesign, Regime};
use mesher::{
    Frame, Imperfection, PanelPolygon, Panels, PlacedWindow, PlaneRecipe, SheetMesh, SheetShape,
    Tier,
};
use scene::{Posture, PostureConfig, Scene, SupportKind};
use std::iter::zip;
use support::{Extremes, Fault, ensure, fault, refuse};

/// Size of the elements of panels over r_win.
const ELEMENT_SIZE: f64 = 0.8;
/// The radius at which windows must be apart over that at which they are meshed.
const APART: f64 = 1.04;
/// Factor by which windows become smaller until they are apart.
const SHRINK: f64 = 0.93;
/// Smallest radius of a meshed window over the ligament width; a window has more than 2.5.
const LEAST_RADIUS: f64 = 2.52;
/// Layers of elements through the thickness.
const LAYERS: usize = 2;

/// The tier on which a whole sheet is solved unless another one is named.
pub fn usual_sheet_tier(scene: &Scene) -> Tier {
    match scene.material.regime(scene.config.ligament.range[1]) {
        Regime::Film => Tier::Small,
        Regime::Plate => Tier::Plate,
    }
}

pub(crate) fn no_posture() -> Fault {
    fault!(
        "the scene has no [posture]: state how the sheet is held out of its plane, such as kind = \
         \"held-flat\", or pass --support"
    )
}

/// The scene with another support of its panels, as its model must know it.
pub(crate) fn with_support(scene: &Scene, support: Option<Posture>) -> Result<Scene, Fault> {
    let mut scene = scene.clone();
    match (support, &mut scene.config.posture) {
        (None, None) => return Err(no_posture()),
        // What holds it flat does not change its weight.
        (None | Some(Posture::HeldFlat), Some(_)) => {}
        (Some(Posture::Hanging), posture) if posture.and_then(|posture| posture.down).is_none() => {
            refuse!(
                "the scene does not state in which direction its sheet hangs: set posture.kind = \
                 \"hanging\" and posture.down"
            );
        }
        (Some(kind), Some(posture)) => posture.kind = kind,
        (Some(kind), posture @ None) => {
            *posture = Some(PostureConfig { kind, down: None });
        }
    }
    Ok(scene)
}

/// A sheet of a scene as a finite-element problem, kept in its plane by `support`, with
/// `contact` of the flanks of its cuts or without.
pub(crate) fn sheet_problem(
    scene: &Scene,
    sheet: &Sheet,
    support: Posture,
    tier: Tier,
    panels: Panels,
    contact: bool,
) -> Result<SheetProblem, VerificationError> {
    let (pulled, held) = (pulled(scene, sheet)?, held(scene, sheet)?);
    let down = match support {
        Posture::Lying => Some([0.0, 0.0, -1.0]),
        Posture::HeldFlat | Posture::Mounted | Posture::Hanging | Posture::Free => {
            let [x, y] = scene.weight_by_area();
            let length = x.hypot(y);
            (length > 0.0).then(|| [x / length, y / length, 0.0])
        }
    };
    let restraint = match support {
        Posture::HeldFlat => OutOfPlaneRestraint::HeldFlat,
        Posture::Lying => OutOfPlaneRestraint::Table,
        Posture::Mounted | Posture::Hanging | Posture::Free => OutOfPlaneRestraint::Nothing,
    };
    let mut shape = sheet_shape(sheet, scene.material.thickness, tier, panels)?;
    if restraint == OutOfPlaneRestraint::HeldFlat {
        halve(&mut shape);
    }
    for pulled in &pulled {
        shape.panels[pulled.panel].mark(pulled.at);
    }
    for held in &held {
        let panel = &mut shape.panels[held.panel];
        match held.place {
            Place::Panel => {}
            Place::Point(at) => panel.mark(at),
            Place::Line(ends) => ends.into_iter().for_each(|end| panel.mark(end)),
        }
    }
    Ok(SheetProblem {
        shape,
        tier,
        material: scene.material.as_solved(),
        restraint,
        held,
        pulled,
        stroke: scene.config.drive.map(|drive| drive.stroke),
        down,
        step: SheetProblem::usual_step(restraint, contact),
        contact,
        dynamic: false,
    })
}

/// The forces of the scene.
fn pulled(scene: &Scene, sheet: &Sheet) -> Result<Vec<Pulled>, VerificationError> {
    let mut loads = vec![[0.0; 3]; sheet.panels.len()];
    for load in scene.actuation().boundary_loads() {
        loads[load.panel][load.dof.index()] += load.value;
    }
    ensure!(
        loads.iter().all(|[.., couple]| *couple == 0.0),
        "couples on panels have no counterpart in a whole sheet of finite elements, whose \
             panels bend: pull panels by forces"
    );
    let forces = loads.into_iter().enumerate();
    let forces = forces.filter(|(_, [x, y, _])| x.hypot(*y) > 0.0);
    let pulled = forces.map(|(panel, [x, y, _])| Pulled {
        panel,
        at: FinishedPanel::new(sheet, panel).nearest(sheet.panels[panel].reference),
        force: [x, y],
    });
    Ok(pulled.collect())
}

/// The supports of the scene.
fn held(scene: &Scene, sheet: &Sheet) -> Result<Vec<HeldPanel>, VerificationError> {
    let attachments = scene.actuation().attachments;
    let supports = zip(&scene.config.supports, &attachments);
    let held = supports.map(|(support, attachment)| {
        ensure!(
            support.rotation_deg == 0.0,
            "{}: a support that turns has no counterpart in a whole sheet of finite elements",
            attachment.name
        );
        let holds = support.kind.holds();
        Ok(HeldPanel {
            panel: attachment.panel,
            place: place(sheet, attachment, support.kind),
            motion: [0, 1].map(|axis| holds[axis].then_some(support.displacement[axis])),
        })
    });
    held.collect()
}

/// The part of a panel that a support holds: its clip, the whole panel of a clamp without one, or a
/// point.
fn place(sheet: &Sheet, attachment: &AttachmentPoint, kind: SupportKind) -> Place {
    let panel = &sheet.panels[attachment.panel];
    let finished = FinishedPanel::new(sheet, attachment.panel);
    match (attachment.clip, attachment.point, kind) {
        (Some(width), PanelPoint::Middle([from, to]), _) => {
            let [p, q] = [from, to].map(|corner| panel.corners[corner]);
            let length = f64::hypot(q[0] - p[0], q[1] - p[1]);
            let middle = panel.position(attachment.point);
            let end = |sign: f64| {
                let half = 0.5 * sign * width / length;
                let at = [0, 1].map(|i| middle[i] + half * (q[i] - p[i]));
                finished.nearest(at)
            };
            Place::Line([end(-1.0), end(1.0)])
        }
        (_, _, SupportKind::Clamp) => Place::Panel,
        (_, point, _) => Place::Point(finished.nearest(panel.position(point))),
    }
}

/// The radius of each window in the mesh (mm): r_win, or as much less as the windows need to be
/// apart. The mesh of a smaller window is a part of the mesh of a larger window.
pub(crate) fn meshed_radii(sheet: &Sheet) -> Result<Vec<f64>, VerificationError> {
    let r_win = sheet.options.process.r_win;
    let widths = || sheet.hinges.iter().map(|hinge| hinge.w_lig);
    let mut ratio = r_win / widths().smallest();
    loop {
        let radii: Vec<f64> = widths().map(|w_lig| r_win.min(ratio * w_lig)).collect();
        let windows: Vec<HingeWindow> = zip(HingeWindow::of_sheet(sheet), &radii)
            .map(|(window, radius)| HingeWindow { radius: APART * radius, ..window })
            .collect();
        let apart = (windows.iter().enumerate())
            .all(|(h, one)| windows[..h].iter().all(|other| !one.overlaps(other)));
        let inside = zip(&windows, &sheet.hinges).all(|(window, hinge)| {
            let [a, b] = hinge.panels().map(|k| &sheet.panels[k]);
            window.within(a, b)
        });
        if apart && inside {
            return Ok(radii);
        }
        ensure!(
            ratio > LEAST_RADIUS,
            "the panels are too small for windows of {:.1} mm radius, the smallest that are \
                 meshed: use larger panels or narrower ligaments",
            radii.into_iter().smallest()
        );
        ratio = (SHRINK * ratio).max(LEAST_RADIUS);
    }
}

/// The finished sheet with its windows, whose bumps are all on one side.
fn sheet_shape(
    sheet: &Sheet,
    thickness: f64,
    tier: Tier,
    model: Panels,
) -> Result<SheetShape, VerificationError> {
    let PlaneRecipe::Structured(plane) = tier.recipe().plane else {
        refuse!(
            "the tier {tier} has no structured mesh: whole sheets are meshed with tiny, small, \
             default, fine or reference"
        );
    };
    let radii = meshed_radii(sheet)?;
    let smallest = radii.iter().copied().smallest();
    let windows = zip(HingeWindow::of_sheet(sheet), &radii);
    let finished: Vec<_> =
        (0..sheet.panels.len()).map(|panel| FinishedPanel::new(sheet, panel)).collect();
    let placed = (sheet.hinges.iter().zip(sheet.designs())).zip(windows).map(
        |((hinge, design), (window, radius))| {
            let joined = |(panel, corner): PanelCorner| {
                let cut_off = || {
    fault!(
        "panel {panel}: its corner {corner}, where it has a hinge, is trimmed: choose another shape in [cells]"
    )
};
                let number = finished[panel].number_of(corner).ok_or_else(cut_off)?;
                Ok::<_, VerificationError>((panel, number))
            };
            let regime = if SheetShape::bends_in_plane(design.w_lig, thickness) {
                Regime::Plate
            } else {
                Regime::Film
            };
            Ok(PlacedWindow {
                design: HingeDesign { r_win: *radius, ..design },
                frame: Frame { origin: window.foot, e_x: window.e_sec },
                panels: [joined(hinge.site.a)?, joined(hinge.site.b)?],
                bump: Imperfection::of(regime).amplitude,
            })
        },
    );
    Ok(SheetShape {
        thickness,
        model,
        windows: placed.collect::<Result<_, VerificationError>>()?,
        panels: (finished.into_iter())
            .map(|panel| PanelPolygon { corners: panel.corners(), marks: Vec::new() })
            .collect(),
        plane,
        layers: LAYERS,
        half: false,
        element_size: ELEMENT_SIZE * smallest,
    })
}

/// Leaves the lower half to symmetry where panels are rigid and stay in the plane, and ligaments
/// bend in it.
fn halve(shape: &mut SheetShape) {
    let bends =
        |window: &PlacedWindow| SheetShape::bends_in_plane(window.design.w_lig, shape.thickness);
    if shape.model == Panels::Rigid && shape.windows.iter().all(bends) {
        (shape.half, shape.layers) = (true, LAYERS / 2);
        shape.windows.iter_mut().for_each(|window| window.bump = 0.0);
    }
}

/// Estimates from sheets of 13 000 and 51 000 unknowns on one core of a busy machine.
#[derive(Clone, Copy, Debug)]
pub struct SheetCost {
    /// Unknown displacements.
    pub unknowns: usize,
    /// CPU time of a path without a snap (s).
    pub cpu_seconds: f64,
    /// Memory of the solver (MiB).
    pub memory_mib: f64,
}

/// Unknowns of the sheet from which the estimates are scaled, its CPU time (s) and memory (MiB)
/// with panels held flat.
const REFERENCE: [f64; 3] = [13_000.0, 34.0, 53.0];
/// The power of the number of unknowns with which the time grows.
const GROWTH: f64 = 1.4;
/// Time of a sheet that may leave its plane over the time of a sheet that is held flat.
const NOT_HELD: f64 = 3.5;

impl SheetCost {
    /// The cost of a meshed sheet.
    pub fn of(mesh: &SheetMesh, restraint: OutOfPlaneRestraint) -> Self {
        let unknowns = 3 * mesh.nodes.len();
        let [reference, seconds, memory] = REFERENCE;
        let ratio = unknowns as f64 / reference;
        let paths = match restraint {
            OutOfPlaneRestraint::HeldFlat => 1.0,
            OutOfPlaneRestraint::Table | OutOfPlaneRestraint::Nothing => NOT_HELD,
        };
        Self {
            unknowns,
            cpu_seconds: paths * seconds * ratio.powf(GROWTH),
            memory_mib: memory * ratio,
        }
    }
}
