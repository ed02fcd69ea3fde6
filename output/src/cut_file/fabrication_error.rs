//! Errors of cut files.

/// A sheet that cannot be cut, or a file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the message of a variant is its documentation")]
pub enum FabricationError {
    #[error(
        "the slit at hinge {hinge} would be {length:.3} mm long, but the holes at its ends take \
         {drilled:.3} mm: narrow the ligament or lengthen the cut"
    )]
    SlitVanishes { hinge: usize, length: f64, drilled: f64 },
    #[error(
        "the hole of hinge {hinge} is {diameter:.3} mm wide, which must exceed the slit of {slit} mm: \
         increase the ligament width or the fillet ratio"
    )]
    HoleTooSmall { hinge: usize, diameter: f64, slit: f64 },
    #[error(
        "the slits are {slit} mm wide (process.slit_width), and the tool cuts lines of {kerf} mm: use a machine that cuts \
         around slits, or design slits as wide as the tool cuts (cutting.kerf)"
    )]
    SlitTooWide { slit: f64, kerf: f64 },
    #[error(
        "the paths of this machine allow for the width that its tool removes, which is not known: set cutting.kerf (mm) in the \
         scene"
    )]
    NoKerf,
    #[error(
        "the cuts at the hinges {} and {} leave {gap:.3} mm between them, less than a slit of {least} mm: move them \
         apart (objective.panel_shape) or narrow the ligaments",
        .hinges[0], .hinges[1]
    )]
    CutsMeet { hinges: [usize; 2], gap: f64, least: f64 },
    #[error(
        "the hole of hinge {hinge} leaves {gap:.3} mm to the outline, less than a slit of {least} mm: move the cut \
         (objective.panel_shape) or reduce the fillet ratio"
    )]
    CutMeetsOutline { hinge: usize, gap: f64, least: f64 },
    #[error(
        "the {part} of {name} is {distance:.1} mm from {what}, and needs {least:.1} mm: move its `at` away from there, or make \
         it smaller"
    )]
    TooNear { part: &'static str, name: String, what: String, distance: f64, least: f64 },
    #[error("the clip of {name} is {width} mm wide, its edge {room:.1} mm: use a narrower clip")]
    ClipTooWide { name: String, width: f64, room: f64 },
    #[error(
        "the cut opposite hinge {hinge} ends before its ligament, which is {width:.3} mm wide there and {modelled:.3} mm in \
         the model: narrow the ligaments at the ends of that cut, or keep the panels larger (objective.panel_shape, \
         objective.min_panel_width)"
    )]
    CutEndsBeforeLigament { hinge: usize, width: f64, modelled: f64 },
    #[error(
        "an edge of panel {panel} is not cut: the ligaments at its ends are longer than the edge: narrow them, or keep the \
         panels larger (objective.panel_shape, objective.min_panel_width)"
    )]
    EdgeNotCut { panel: usize },
    #[error("the drawing takes {pages} pages, more than {limit}: choose a larger paper")]
    TooManyPages { pages: usize, limit: usize },
}
