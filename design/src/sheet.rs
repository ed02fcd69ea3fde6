//! The flat sheet cut by a pattern: rigid panels, hinges, their kinematics; equations (6) to (8).

pub mod attachment;
pub mod cut_sheet;
pub mod cutting_process;
pub mod hinge_window;
pub mod ideal_deployment;
pub mod kinematics;
pub mod panel;
pub mod topology;
pub mod validity;
