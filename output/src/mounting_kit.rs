//! The mounting kit of a sheet: the board behind it at 1:1, and a picture of every step.

mod board;
mod pages;
mod step_pictures;

pub(crate) use board::board;
pub(crate) use pages::kit_pdf;
pub(crate) use step_pictures::steps_svg;
