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
        "the hole of hinge {hinge} is {diameter:.3} mm wide, which must exceed the kerf of {kerf} mm: \
         increase the ligament width or the fillet ratio"
    )]
    HoleTooSmall { hinge: usize, diameter: f64, kerf: f64 },
    #[error(
        "the slits are {slit} mm wide, which must exceed the kerf of the tool, {tool_kerf} mm: increase process.kerf of the scene, \
         the width of the slits, or use a machine that cuts lines"
    )]
    SlitTooNarrow { slit: f64, tool_kerf: f64 },
    #[error(
        "a hole of {diameter:.3} mm is not wider than the kerf of the tool, {kerf} mm: use a finer tool (tool_kerf), or wider \
         ligaments or a larger hole (process.fillet_ratio or hole_diameter) in the scene"
    )]
    HoleBelowTool { diameter: f64, kerf: f64 },
    #[error(
        "the cuts at the hinges {} and {} leave {gap:.3} mm between them, less than the kerf of {least} mm: move them \
         apart (objective.panel_shape) or narrow the ligaments",
        .hinges[0], .hinges[1]
    )]
    CutsMeet { hinges: [usize; 2], gap: f64, least: f64 },
    #[error(
        "the hole of hinge {hinge} leaves {gap:.3} mm to the outline, less than the kerf of {least} mm: move the cut \
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
