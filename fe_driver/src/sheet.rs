//! Whole sheets by finite elements: every window, and panels that are rigid or meshed.

pub(crate) mod sheet_deck;
pub(crate) mod sheet_nodes;
pub(crate) mod sheet_output;
pub(crate) mod sheet_problem;
pub(crate) mod sheet_response;
pub(crate) mod sheet_solver;
pub(crate) mod sheet_states;
