//! The page of a whole sheet by finite elements.

use crate::sheet_check::{SheetCheck, StateCheck};
use std::fmt;

/// Number of rows of a path on the page.
const ROWS: usize = 12;

impl fmt::Display for SheetCheck {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let ([panels, hinges], [least, most]) = (self.counts, self.slenderness);
        writeln!(
            f,
            "# The whole sheet, by finite elements\n\n\
             The {}, {}: {panels} panels, {hinges} hinges, windows of tier {}, ligaments {least:.2} to {most:.2} times as wide as the \
             sheet is thick. Every window and every panel is meshed, and nothing is rigid. By law: the equilibrium with the \
             scene's hinge law, whose panels are rigid and stay in the plane; between its load steps it is interpolated.\n",
            self.design,
            self.support.in_words(),
            self.tier,
        )?;
        if self.is_patch {
            writeln!(
                f,
                "A patch of a larger sheet: the panels around it move as the hinge law predicts.\n"
            )?;
        }
        let [meshed, of_law] = self.radius;
        if meshed < of_law {
            writeln!(
                f,
                "The windows of {of_law} mm of the hinge law have no room between each other: the windows of the mesh have {meshed:.1} mm and more, and \
                 the energies of hinges below lack what is outside of that.\n"
            )?;
        }
        for finding in &self.findings {
            writeln!(f, "* {finding}")?;
        }
        writeln!(
            f,
            "\n{} {} unknowns, {:.0} CPU s{}.",
            if self.contact {
                "The flanks of a cut touch if its ligament is at most twice as wide as the sheet is thick. Not modelled here: friction, creep."
            } else {
                "Not modelled here: contact of the flanks of the cuts, friction, creep."
            },
            self.unknowns,
            self.cpu_seconds,
            if self.dynamic { ", dynamic" } else { "" },
        )?;
        match self.last() {
            Some(last) => self.write_path(f, last),
            None => Ok(()),
        }
    }
}

/// Two numbers that may not be known.
fn known(pair: Option<[f64; 2]>, decimals: usize) -> [String; 2] {
    match pair {
        Some(pair) => pair.map(|value| format!("{value:.decimals$}")),
        None => ["-", "-"].map(str::to_owned),
    }
}

impl SheetCheck {
    fn write_path(&self, f: &mut fmt::Formatter, last: &StateCheck) -> fmt::Result {
        writeln!(
            f,
            "\n## Along the path\n\n\
             Corners: distance in space between the rigid motion that the nodes of a panel follow best and its place by law; at the end \
             {:.3} % of the longer side of the flat sheet, {:.0} mm, in the root mean square. Panels bend by {:.3} mm at most. \
             Tilt by law is by the bumps of ligaments. Margin: below 1 the panels leave their plane, by law, of its next load step.\n\n\
             | path, % | stroke, mm | by law | load, N | by law | mean opening, deg | by law | corners, mm | max | tilt, deg | by law | lift, mm | margin |\n\
             |---|---|---|---|---|---|---|---|---|---|---|---|---|",
            100.0 * last.corners[0] / self.size,
            self.size,
            last.bending
        )?;
        let stride = self.path.len().div_ceil(ROWS).max(1);
        let kept = (self.path.iter().enumerate())
            .filter(|(i, _)| (self.path.len() - 1 - i).is_multiple_of(stride));
        for (_, state) in kept {
            let StateCheck {
                fraction,
                stroke,
                load,
                opening_deg: [opening, opened],
                corners: [rms, most],
                tilt_deg,
                z: [_, high],
                tilt_by_law_deg,
                margin,
                ..
            } = state;
            let ([stroke, moved], [load, found]) = (known(*stroke, 3), known(*load, 4));
            let [margin, tilt] = [margin, tilt_by_law_deg]
                .map(|value| value.map_or("-".into(), |value| format!("{value:.2}")));
            writeln!(
                f,
                "| {:.1} | {moved} | {stroke} | {found} | {load} | {opened:.2} | {opening:.2} | {rms:.3} | {most:.3} | {tilt_deg:.2} | {tilt} | {high:.2} | {margin} |",
                100.0 * fraction,
            )?;
        }
        writeln!(
            f,
            "\nPanels outside of the windows hold {:.2} % of the energy.\n\n\
             | hinge | w_lig, mm | theta, deg | by law | W, N mm | by law | D_peak | by law |\n|---|---|---|---|---|---|---|---|",
            100.0 * self.panel_energy
        )?;
        for hinge in &self.hinges {
            let ([theta, opened], [energy, found]) = (hinge.theta_deg, hinge.energy);
            let [peak, found_peak] = hinge
                .d_peak
                .map(|peak| peak.map_or("?".into(), |peak| format!("{peak:.3}")));
            writeln!(
                f,
                "| {} | {:.2} | {opened:.2} | {theta:.2} | {found:.4} | {energy:.4} | {found_peak} | {peak} |",
                hinge.hinge, hinge.w_lig
            )?;
        }
        writeln!(
            f,
            "\n| panel | tilt, deg | corner furthest off, mm | lowest, mm | highest, mm | bending, mm |\n|---|---|---|---|---|---|"
        )?;
        for panel in &self.panels {
            let [low, high] = panel.z;
            writeln!(
                f,
                "| {} | {:.2} | {:.3} | {low:.2} | {high:.2} | {:.3} |",
                panel.panel, panel.tilt_deg, panel.off, panel.bending
            )?;
        }
        Ok(())
    }
}
