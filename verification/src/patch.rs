//! A part of a sheet that is too large to be solved as a whole: 3 x 3 panels, joined to panels that
//! move as the hinge law predicts.

use crate::verification_error::{VerificationError, refused};
use design::objective::design_problem::Deployment;
use design::pattern::grid::Grid;
use design::sheet::cut_sheet::Sheet;
use fe_driver::{DrivenRim, Held, OutOfPlaneRestraint, Pulled, SheetProblem};
use mesher::{PlacedWindow, Side};

/// Panels and hinges of a sheet, by their indices, in increasing order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SheetPart {
    pub panels: Vec<usize>,
    pub hinges: Vec<usize>,
}

impl SheetPart {
    /// All of a sheet.
    pub(crate) fn whole(sheet: &Sheet) -> Self {
        Self {
            panels: (0..sheet.panels.len()).collect(),
            hinges: (0..sheet.hinges.len()).collect(),
        }
    }

    /// The panel [column, row] with those around it, and all their hinges.
    pub(crate) fn around(
        sheet: &Sheet,
        [column, row]: [usize; 2],
    ) -> Result<Self, VerificationError> {
        if sheet.topology.panel(column, row).is_none() {
            let Grid { m, n } = sheet.topology.grid;
            return Err(refused(format!(
                "there is no panel [{column}, {row}]: the sheet has {m} columns and {n} rows, \
                 counted from 0"
            )));
        }
        let near = |panel: &usize| {
            let [p, q] = sheet.topology.places[*panel];
            p.abs_diff(column) <= 1 && q.abs_diff(row) <= 1
        };
        let panels: Vec<usize> = (0..sheet.panels.len()).filter(near).collect();
        let hinges = (0..sheet.hinges.len()).filter(|h| {
            let hinge = &sheet.hinges[*h];
            near(&hinge.panel_a()) || near(&hinge.panel_b())
        });
        Ok(Self { hinges: hinges.collect(), panels })
    }

    /// This part of the whole sheet `whole`; the panels around it move as in the deployment.
    pub(crate) fn of(
        &self,
        whole: SheetProblem,
        deployment: &Deployment,
    ) -> Result<SheetProblem, VerificationError> {
        if self.panels.len() == whole.shape.panels.len() {
            return Ok(whole);
        }
        if whole.restraint == OutOfPlaneRestraint::Nothing && whole.down.is_some() {
            return Err(refused(
                "a patch of a hanging sheet must be held flat: its weight comes on before the \
                 loads. Use --support held-flat",
            ));
        }
        let place = |panel: usize| self.panels.binary_search(&panel).ok();
        let mut part = whole.clone();
        part.held = (whole.held.iter())
            .filter_map(|held| place(held.panel).map(|panel| Held { panel, ..*held }))
            .collect();
        part.pulled = (whole.pulled.iter())
            .filter_map(|pulled| place(pulled.panel).map(|panel| Pulled { panel, ..*pulled }))
            .collect();
        if part.stroke.take().is_some() && !part.pulled.is_empty() {
            return Err(refused(
                "the patch contains a panel that is pulled by a prescribed stroke, whose load it \
                 does not know: choose another patch",
            ));
        }
        part.shape.panels =
            (self.panels.iter()).map(|panel| whole.shape.panels[*panel].clone()).collect();
        part.shape.windows.clear();
        for (number, hinge) in self.hinges.iter().enumerate() {
            let window = whole.shape.windows[*hinge];
            let sides = std::iter::zip(window.panels, Side::BOTH);
            for (joined, side) in sides {
                let outside = joined.filter(|(panel, _)| place(*panel).is_none());
                if let Some((panel, _)) = outside {
                    part.rims.push(DrivenRim {
                        window: number,
                        side,
                        about: deployment.sheet.panels[panel].reference,
                        path: motion(deployment, panel, &whole),
                    });
                }
            }
            part.shape.windows.push(PlacedWindow {
                panels: window.panels.map(|joined| {
                    let (panel, corner) = joined?;
                    Some((place(panel)?, corner))
                }),
                ..window
            });
        }
        Ok(part)
    }
}

/// (lambda, u_x, u_y, phi) of a panel by the hinge law.
fn motion(deployment: &Deployment, panel: usize, whole: &SheetProblem) -> Vec<[f64; 4]> {
    let history = whole.history();
    let weighed = deployment.weight_steps();
    let loaded = &deployment.path[weighed.len()..];
    let before = weighed.iter().map(|step| (step.weight, 0.0, step));
    let steps = loaded.iter().enumerate().map(|(i, step)| {
        let fraction = (i + 1) as f64 / loaded.len() as f64;
        (1.0, fraction, step)
    });
    let mut path = vec![[0.0; 4]];
    path.extend(before.chain(steps).map(|(weight, loads, step)| {
        let [u_x, u_y, phi] = step.configuration[panel];
        [history.lambda_of(weight, loads), u_x, u_y, phi]
    }));
    path
}
