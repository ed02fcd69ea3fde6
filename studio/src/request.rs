//! What a page asks of the engine.

use scene::{Level, SceneConfig, Stock};
use serde::Deserialize;
use std::path::PathBuf;

/// A request, in JSON: `{"do": "undo"}`.
#[derive(Debug, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Request {
    /// Begin a new sheet.
    New(Box<NewSheet>),
    /// The scene has other keys.
    Change(Change),
    /// The sheet has another number of panels, and is uniform again.
    Panels {
        /// Columns and rows.
        panels: [usize; 2],
    },
    /// The target is this drawing, to which the sheet is fitted.
    Drawing(Drawing),
    /// Show which panels another side would give the sheet of a drawing.
    Crop {
        /// Side of the panels (mm).
        panel_side: f64,
    },
    /// The panel at a point is taken out, or one is added there.
    Cell {
        /// The point on the opened sheet (mm).
        at: [f64; 2],
    },
    /// How much of the hinges is modelled is other than before.
    Level {
        /// The level.
        level: Level,
    },
    /// Measure what every level costs for the sheet that is shown, and how far it is from the
    /// finest.
    Levels,
    /// Open a copy of a shipped scene.
    Open {
        /// Its file.
        scene: PathBuf,
    },
    /// Search from the sheet that is shown, or go on with its search.
    Design,
    /// Pause the search at the end of its step.
    Pause,
    /// Go back to the scene before the last change.
    Undo,
    /// Take back an undo.
    Redo,
    /// Write the files of the sheet that is shown.
    Write(Files),
}

/// A new sheet; what is not given is as usual for its material.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NewSheet {
    /// Its name, from which the name of its folder is made.
    pub name: String,
    /// The material file.
    pub material: Option<PathBuf>,
    /// Thickness (mm).
    pub thickness: Option<f64>,
    /// Width and height (mm), unless there is a stock.
    pub size: Option<[f64; 2]>,
    /// The stock that it is cut from, and its border that cannot be cut (mm).
    pub stock: Option<Stock>,
    /// See `stock`.
    pub margin: Option<f64>,
    /// Width that the tool removes, and the slits have (mm).
    pub kerf: Option<f64>,
    /// The service that cuts it.
    pub service: Option<String>,
    /// What it opens onto, instead of the opened rectangle.
    pub drawing: Option<Drawing>,
}

/// A drawing.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drawing {
    /// The name of its file.
    pub name: String,
    /// The SVG, DXF, PNG or JPEG file in base64.
    pub file: String,
    /// Which of its pieces, if it has several.
    pub piece: Option<usize>,
    /// The difference from the ground at which a picture is traced, relative to the largest one.
    pub threshold: Option<f64>,
    /// Side of the panels (mm), or else the smallest one.
    pub panel_side: Option<f64>,
}

/// Other keys of the scene.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// All keys.
    pub scene: Box<SceneConfig>,
    /// The page that changed them, and how many changes it has made.
    pub by: (String, u64),
}

/// Files besides the files of every run.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Files {
    /// Tiles for this paper.
    pub paper: Option<String>,
    /// The file of this machine.
    pub machine: Option<String>,
}
