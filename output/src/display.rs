//! The display list: every drawing of a sheet is a list of shapes (mm), which SVG, PDF and DXF
//! write.
//!
//! A picture is a [`Canvas`]: shapes with a [`Style`]. A cut file has shapes on layers instead,
//! which its writers give a style ([`crate::cut_file::CutDrawing`]).

mod canvas;
pub(crate) mod pdf;
mod shape;
mod style;

pub use canvas::Canvas;
pub(crate) use canvas::{document, group, text_of_element, trimmed};
pub(crate) use shape::rectangle;
pub use shape::{Anchor, Shape, Text};
pub use style::{Colour, Style};
