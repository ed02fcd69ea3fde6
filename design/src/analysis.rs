//! Analyses of a deployed sheet beyond its shape: forces, capacity, voids, tilting panels; section 3.2.

pub mod degeneration;
pub mod force_transmission;
pub mod further_load;
pub mod localisation;
pub mod solution_set;
pub mod taylor;
pub mod tension_routes;
pub mod threshold;
pub mod void_families;
