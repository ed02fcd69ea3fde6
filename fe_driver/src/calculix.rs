//! CalculiX: input deck, process, readers of its output, samples.

pub(crate) mod calculix_solver;
pub(crate) mod cards;
pub(crate) mod dat;
pub(crate) mod deck;
pub(crate) mod deck_run;
pub(crate) mod response;
