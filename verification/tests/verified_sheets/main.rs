//! Sheets, weights and rays checked by finite elements, of a fake solver and of CalculiX.

mod fake_windows;
mod sheet_checks;
