//! The rules of a report: each finds one concern about a design, or nothing.

use crate::cut_file::{CutLines, FabricationError, fits};
use crate::display::Shape;
use crate::report::fact_sheet::{FactSheet, miss};
use crate::report::hinge_row::HingeRow;
use crate::report::numbers::rounded;
use crate::report::self_weight::of_the_load;
use crate::report::warning::{Concern, Warning};
use design::equilibrium::load_step::{LoadStep, Status};
use design::geometry::polygon::contains;
use design::hinge_law::{DamageMeasure, HingeDamage};
use design::objective::design_problem::Deployment;
use design::objective::scores::Scores;
use design::sheet::cut_sheet::PanelPoint;
use design::sheet::hinge_window::Window;
use design::sheet::validity::{OVERLAP, overlap};
use hinge::Regime;
use scene::analysis::design_checks::{DesignChecks, WholeSheet};
use scene::analysis::flatness::{Flatness, error_on_table};
use scene::analysis::out_of_plane::{MOST, Stability};
use scene::design_run::Designed;
use scene::{FRICTION, Posture, Scene};
use support::severity::Severity;

/// Weight or friction over load from which a sheet opens otherwise than without it.
const HEAVY: f64 = 0.05;
/// Ratio of the mass of hung weights to the mass of the sheet from which the weights are probably
/// given in another unit.
const HUNG: f64 = 50.0;
/// Mean opening of the hinges (rad) that is rounding.
const SHUT: f64 = -1e-6;
/// Distance of the outline from the target over the longer side of the flat sheet from which it is
/// a note, a warning and an error.
const MISSED: [f64; 3] = [0.01, 0.03, 0.2];
/// Slit over ligament width for which another slit than the weights' was measured, in a
/// film (data/pet-0.5mm) and in a plate (data/polypropylene-3mm).
const MEASURED_SLIT_OF_FILM: [f64; 2] = [0.002, 0.15];
const MEASURED_SLIT_OF_PLATE: [f64; 2] = [0.05, 0.64];
/// Relative difference of two slits that is rounding.
const SAME_SLIT: f64 = 1e-6;
/// Relative error of a force (%) above which a law is inaccurate.
const INACCURATE: f64 = 10.0;
/// Separation of a path from its ray, in ligament widths: in a film W differs by less than 1 % up
/// to there (docs/TRIED.md), in a plate the forces by less than 10 % (docs/results/plates).
const SAFE_SEPARATION_OF_FILM: f64 = 0.15;
const SAFE_SEPARATION_OF_PLATE: f64 = 0.03;
const SAFE_SEPARATION_OF_BENT_RAYS: f64 = 0.06;
/// Ligament width over thickness from which the corners of a film that nothing holds are more than
/// 5 % of the sheet off (docs/results/flatness).
const FALLS: f64 = 2.6;
/// Rounding of lengths (mm).
const ROUNDING: f64 = 1e-6;

pub(super) struct RuleInput<'a> {
    pub scene: &'a Scene,
    pub deployment: &'a Deployment,
    /// The cut lines of the sheet.
    pub cuts: &'a Result<CutLines, FabricationError>,
    /// All hinges.
    pub hinges: &'a [HingeRow],
    /// The run whose best design is input; `None` for a design alone.
    pub run: Option<RunContext<'a>>,
}

pub(super) struct RunContext<'a> {
    pub designed: &'a Designed,
    pub facts: &'a FactSheet,
    /// The scores of the best design.
    pub after: &'a Scores,
    /// What was measured of it.
    pub checks: &'a DesignChecks,
}

type Rule = fn(&RuleInput) -> Option<Warning>;

/// First how well a run meets its target, then those about its design, then those about the run as
/// a whole: what its model leaves out, how accurate its weights are.
const RULES: [Rule; 25] = [
    missed,
    panels_overlap,
    windows_overlap,
    windows_leave_panels,
    cutting,
    stock,
    ligaments_outside,
    slit_width,
    states_outside,
    path_dependence,
    flanks_touch,
    tearing,
    overstrained,
    path,
    target,
    point_outside,
    not_modelled,
    leaves_plane,
    weightless,
    friction,
    hung_weight,
    load_peak,
    inaccurate,
    outside,
    other_branch,
];

/// All that the rules find, the most severe first.
pub(super) fn warnings(input: &RuleInput) -> Vec<Warning> {
    let mut found: Vec<Warning> = RULES.iter().filter_map(|rule| rule(input)).collect();
    found.extend(by_elements(input));
    found.sort_by_key(|warning| std::cmp::Reverse(warning.severity));
    found
}

/// The findings of the whole sheet by finite elements, if it was solved.
fn by_elements(input: &RuleInput) -> impl Iterator<Item = Warning> {
    let findings = input.whole_sheet().map(|sheet| &sheet.findings);
    findings.into_iter().flatten().map(|finding| Warning {
        severity: finding.severity,
        ..Concern::WholeSheet.of_sheet(format!("by finite elements, {}", finding.message))
    })
}

impl RuleInput<'_> {
    fn whole_sheet(&self) -> Option<&WholeSheet> {
        self.run.as_ref()?.checks.whole_sheet.as_ref()
    }

    /// The hinges whose rows `overstep`.
    fn hinges_where(&self, overstep: impl Fn(&HingeRow) -> bool) -> Vec<usize> {
        let rows = self.hinges.iter().filter(|row| overstep(row));
        rows.map(|row| row.hinge).collect()
    }
}

/// A warning about the hinges, if there are any.
fn about(concern: Concern, hinges: Vec<usize>, message: String) -> Option<Warning> {
    (!hinges.is_empty()).then(|| Warning { hinges, ..concern.of_sheet(message) })
}

/// Panels cannot lie over each other, whatever the hinge law. On the way the edges of closed cuts,
/// which are softer in the model than in the sheet, may let them by a little.
fn panels_overlap(input: &RuleInput) -> Option<Warning> {
    let deployment = input.deployment;
    let of = |step: &LoadStep| overlap(&deployment.sheet, &step.configuration);
    let at_the_end = of(deployment.final_step());
    let openings = input.hinges.iter().map(|row| row.theta_deg.to_radians());
    let mean = openings.sum::<f64>() / input.hinges.len() as f64;
    let lie = |most: f64| {
        let most = rounded(100.0 * most, 2);
        format!("panels lie over each other, by up to {most} % of the area of a panel")
    };
    let mut found = Vec::new();
    if mean < SHUT {
        let mean = rounded(mean.to_degrees(), 3);
        found.push(format!(
            "the cuts are closed further than in the flat sheet, by a mean opening of {mean} deg"
        ));
    }
    if at_the_end > OVERLAP {
        found.push(lie(at_the_end));
    }
    if !found.is_empty() {
        return Some(Concern::PanelsOverlap.of_sheet(format!(
            "{}: no sheet moves like that; use a larger target, or loads that open the cuts",
            found.join(", and ")
        )));
    }
    let most = deployment.path.iter().map(of).fold(0.0, f64::max);
    (most > OVERLAP).then(|| Warning {
        severity: Severity::Warning,
        ..Concern::PanelsOverlap.of_sheet(format!(
            "on the way, {}: the edges of a closed cut press against each other in the sheet, and its load is larger there; pull at \
             more panels",
            lie(most)
        ))
    })
}

fn windows_overlap(input: &RuleInput) -> Option<Warning> {
    let sheet = &input.deployment.sheet;
    let windows = Window::of_sheet(sheet);
    let overlapping = |h: &usize| {
        let mut others = windows.iter().enumerate().filter(|(other, _)| other != h);
        others.any(|(_, other)| windows[*h].overlaps(other))
    };
    let hinges = (0..windows.len()).filter(overlapping).collect();
    let message = format!(
        "windows of {} mm radius overlap: their ligaments are not independent, and the sum of \
         hinge energies is not exact",
        sheet.options.process.r_win
    );
    about(Concern::WindowsOverlap, hinges, message)
}

fn windows_leave_panels(input: &RuleInput) -> Option<Warning> {
    let sheet = &input.deployment.sheet;
    let windows = Window::of_sheet(sheet).into_iter().zip(&sheet.hinges);
    let leaving = windows.enumerate().filter(|(_, (window, hinge))| {
        let [a, b] = [hinge.panel_a(), hinge.panel_b()].map(|panel| &sheet.panels[panel]);
        !window.within(a, b)
    });
    let r_win = sheet.options.process.r_win;
    let message = format!("panels are too small for the {r_win} mm windows of their hinges");
    about(Concern::WindowsLeavePanels, leaving.map(|(h, _)| h).collect(), message)
}

fn cutting(input: &RuleInput) -> Option<Warning> {
    let cuts = match input.cuts {
        Ok(cuts) => cuts,
        Err(error) => return Some(Concern::CannotBeCut.of_sheet(error.to_string())),
    };
    let hinges = input.deployment.sheet.hinges.iter().enumerate();
    let close = hinges.filter(|(h, hinge)| cuts.clearance(*h) < hinge.w_lig - ROUNDING);
    let message = "another cut is closer to the tip than w_lig".into();
    about(Concern::CutsTooClose, close.map(|(h, _)| h).collect(), message)
}

/// The cuts of a sheet are within the stock that it is cut from.
fn stock(input: &RuleInput) -> Option<Warning> {
    let cuts = input.cuts.as_ref().ok()?;
    let stock = cuts.cutting.stock?.size();
    let [low, high] = Shape::extent(cuts.drawing().cuts());
    let taken = [0, 1].map(|axis| high[axis] - low[axis]);
    let room = stock.map(|side| (side - 2.0 * cuts.cutting.margin).max(0.0));
    (!fits(taken, room.map(|side| side + ROUNDING))).then(|| {
        Concern::StockTooSmall.of_sheet(format!(
            "the cuts take {:.1} x {:.1} mm with kerf and over-run, but the stock has {:.1} x {:.1} mm inside its margin: use a smaller \
             sheet.size",
            taken[0], taken[1], room[0], room[1]
        ))
    })
}

fn ligaments_outside(input: &RuleInput) -> Option<Warning> {
    let domain = input.scene.surrogate()?.domain();
    let outside = |[min, max]: [f64; 2], value: f64| !(min..=max).contains(&value);
    let alpha_deg = domain.alpha.map(f64::to_degrees);
    let hinges = input
        .hinges_where(|row| outside(domain.w_lig, row.w_lig) || outside(alpha_deg, row.alpha_deg));
    let message = format!(
        "ligaments are outside the training domain of the hinge law, w_lig {:.1} to {:.1} mm and alpha \
         {:.0} to {:.0} deg",
        domain.w_lig[0], domain.w_lig[1], alpha_deg[0], alpha_deg[1]
    );
    about(Concern::LigamentsOutsideDomain, hinges, message)
}

fn states_outside(input: &RuleInput) -> Option<Warning> {
    input.scene.surrogate()?;
    let message = "deformations leave the training domain of the hinge law along the path: energy and forces of these \
                   hinges are extrapolated, and their damage is not known";
    let hinges = input.hinges_where(|row| !row.inside);
    about(Concern::StatesOutsideDomain, hinges, message.into())
}

/// A learned law was measured along rays.
fn path_dependence(input: &RuleInput) -> Option<Warning> {
    let law = input.scene.surrogate()?;
    let widest = input.scene.config.ligament.range[1];
    let (safe, page) = match input.scene.material.regime(widest) {
        Regime::Film => (SAFE_SEPARATION_OF_FILM, "docs/TRIED.md"),
        Regime::Plate if law.card().bent_rays => {
            (SAFE_SEPARATION_OF_BENT_RAYS, "docs/results/plates")
        }
        Regime::Plate => (SAFE_SEPARATION_OF_PLATE, "docs/results/plates"),
    };
    let bent = input.hinges_where(|row| row.path_separation > safe);
    let message = format!(
        "paths depart by more than {safe} ligament widths from the rays of the hinge law: energy, forces and damage depend on the \
         path there ({page}); check by `kirigami verify --equilibrium`"
    );
    about(Concern::PathDependence, bent, message)
}

/// Windows have no contact.
fn flanks_touch(input: &RuleInput) -> Option<Warning> {
    input.scene.surrogate()?;
    let touching = input.hinges_where(|row| row.flank_gap < 0.0);
    let gaps = input.hinges.iter().map(|row| row.flank_gap);
    let most = -gaps.fold(f64::INFINITY, f64::min);
    let message = format!(
        "the flanks of their cuts are pushed into each other, by up to {} mm: contact between them is not modelled, and the load is \
         larger than stated (docs/TRIED.md)",
        rounded(most, 2)
    );
    about(Concern::FlanksTouch, touching, message)
}

fn tearing(input: &RuleInput) -> Option<Warning> {
    // The mean reaches 1 later than the peak; weights without D_peak predict the mean only.
    let torn = input
        .hinges_where(|row| row.damage_peak.or(row.damage).is_some_and(|damage| damage >= 1.0));
    let tears = |damage: &HingeDamage| {
        let peak = DamageMeasure::Peak.known(damage);
        peak.unwrap_or(damage.d) >= 1.0
    };
    let mut weighed = input.deployment.weight_steps().iter();
    let cause = if weighed.any(|step| step.damage.iter().any(tears)) {
        ", under the weight of the sheet alone: hang it from more points, or use wider ligaments"
    } else {
        ""
    };
    let message = format!("predicted peak damage of 1 or more: the ligament tears{cause}");
    about(Concern::Tearing, torn, message)
}

fn overstrained(input: &RuleInput) -> Option<Warning> {
    let beyond = input.hinges_where(|row| row.eta_a.abs().max(row.eta_s.abs()) > 1.0);
    let message =
        "ligaments translate by more than their width at full load, where no hinge law is valid: \
                   reduce the load or the size of the target"
            .into();
    about(Concern::Overstrained, beyond, message)
}

fn path(input: &RuleInput) -> Option<Warning> {
    let weighed = input.deployment.weight_steps().len();
    // Under a prescribed stroke or motion a jump is no maximum of the load.
    let dead = input.scene.config.has_loads() && input.scene.config.drive.is_none();
    let mut before = "the beginning".to_owned();
    let mut found = Vec::new();
    for (i, step) in input.deployment.path.iter().enumerate() {
        let by_weight = i < weighed;
        let place = match (by_weight, step.weight == 1.0) {
            (true, true) => "the whole weight".to_owned(),
            (true, false) => format!("{} of the weight", rounded(step.weight, 2)),
            (false, _) => format!("load factor {:.3}", step.load_factor),
        };
        let peaks = if by_weight || !dead { "" } else { "the load peaks and " };
        found.extend(departure(step, peaks, &before, &place));
        before = place;
    }
    if found.is_empty() {
        return None;
    }
    let message = format!("the equilibrium path is not smooth and stable: {}", found.join(", "));
    let mut warning = Concern::Path.of_sheet(message);
    if input.deployment.final_step().status == Status::Diverged {
        warning.severity = Severity::Error;
    }
    Some(warning)
}

/// How a step of the path at a place is not a stable equilibrium; `None` if it is one.
fn departure(step: &LoadStep, peaks: &str, before: &str, place: &str) -> Option<String> {
    Some(match step.status {
        Status::Converged | Status::LeftDomain => return None,
        Status::Almost => format!("residual {:.0e} at {place}", step.residual),
        Status::LimitPoint => format!("{peaks}the sheet jumps between {before} and {place}"),
        Status::Diverged => {
            let end = step.descent_end.map(|end| format!(": {end}"));
            format!("no equilibrium was found beyond {place}{}", end.unwrap_or_default())
        }
    })
}

fn target(input: &RuleInput) -> Option<Warning> {
    let target = &input.scene.target;
    if !target.notes.is_empty() {
        let notes = target.notes.join("; ");
        return Some(
            Concern::TargetDrawing.of_sheet(format!("the drawing of the target: {notes}")),
        );
    }
    target.crossing.map(|[x, y]| {
        Concern::TargetCrosses.of_sheet(format!(
            "the target outline crosses or touches itself near ({x:.1}, {y:.1}) mm: its inside is not defined; order \
             its vertices around the outline"
        ))
    })
}

/// A point at which a panel is held or pulled does not move with its cuts.
fn point_outside(input: &RuleInput) -> Option<Warning> {
    let panels = &input.deployment.sheet.panels;
    let attachments = input.scene.actuation().attachments;
    let outside: Vec<String> = (attachments.iter())
        .filter(|attachment| matches!(attachment.point, PanelPoint::Fixed(_)))
        .filter(|attachment| {
            let panel = &panels[attachment.panel];
            !contains(&panel.corners, panel.reference)
        })
        .map(|attachment| attachment.name.clone())
        .collect();
    (!outside.is_empty()).then(|| {
        Concern::PointOutside.of_sheet(format!(
            "the design has moved a panel away from the point at which it is held or pulled ({}): move the point, or name \
             one that moves with the cuts, such as at = \"bottom\"",
            outside.join("; ")
        ))
    })
}

fn not_modelled(input: &RuleInput) -> Option<Warning> {
    input.scene.surrogate()?;
    let missing = input.run.as_ref()?.facts.self_weight.left_out()?;
    Some(Concern::NotModelled.of_sheet(format!("not modelled: {missing}")))
}

/// Panels that leave the plane unless something holds them flat.
fn leaves_plane(input: &RuleInput) -> Option<Warning> {
    let posture = input.scene.config.posture?.kind;
    let solved = |sheet: &WholeSheet| sheet.support == posture;
    if posture == Posture::HeldFlat || input.whole_sheet().is_some_and(solved) {
        return None;
    }
    let kept = match posture {
        Posture::Lying => "only its weight keeps the panels down on the surface",
        _ => "nothing keeps the panels in the plane",
    };
    let widest = (input.hinges.iter()).fold(0.0, |most, row| row.w_lig.max(most));
    let stability = |problem| Stability::new(input.scene, &problem, input.deployment);
    Some(match input.scene.material.regime(widest) {
        Regime::Plate => plate_leaves_plane(kept, input.scene.problem().ok().and_then(stability)),
        Regime::Film => film_leaves_plane(input, posture, kept, widest),
    })
}

/// How far a plate is from leaving its plane: see [`Stability`].
fn plate_leaves_plane(kept: &str, stability: Option<Stability>) -> Warning {
    let concern = Concern::LeavesPlane;
    let advice = "hold it flat, such as between two boards, take narrower ligaments, or pull more panels; `kirigami verify --sheet` solves it";
    let Some(Stability { margin, tilt, leaves_at }) = stability else {
        return concern.of_sheet(format!(
            "{kept}, and whether they stay is not known: that needs a hinge law, and a clip or clamp that holds a panel"
        ));
    };
    let percent = (100.0 * margin).round();
    match leaves_at {
        Some(opening) => concern.of_sheet(format!(
            "{kept}, and they leave it where hinges open by about {:.0} deg; in the worst state on the way {percent} % of the forces suffice. \
             The report is of the flat sheet: {advice}",
            opening.to_degrees()
        )),
        None if margin < Stability::SAFE => concern.of_sheet(format!(
            "{kept}, and they nearly leave it: {percent} % of the forces on the way suffice, and panels tilt by a degree and more; {advice}"
        )),
        None => {
            let more = if margin < MOST { "" } else { "more than " };
            Warning {
                severity: Severity::Note,
                ..concern.of_sheet(format!(
                    "{kept}, and by themselves they stay: it would take {more}{percent} % of the forces on the way to move them out of it. \
                     Bumps of ligaments tilt them by {:.2} deg (docs/results/flatness)",
                    tilt.unwrap_or_default().to_degrees()
                ))
            }
        }
    }
}

/// A film, whose ligaments buckle and tilt its panels.
fn film_leaves_plane(input: &RuleInput, posture: Posture, kept: &str, widest: f64) -> Warning {
    let (sheet, material) = (&input.deployment.sheet, &input.scene.material);
    let r_win = sheet.options.process.r_win;
    let on_table = (posture == Posture::Lying).then(|| error_on_table(material, r_win)).flatten();
    let off = match on_table {
        Some(error) => format!(
            "the corners are expected {} mm (root mean square) from where the report has them, {} % of the sheet, where hinges open by 26 deg",
            rounded(error * sheet.outline.size(), 2),
            rounded(100.0 * error, 2)
        ),
        None => "corners of whole sheets were 0.3 % of the sheet off with ligaments of 1.2 thicknesses, and 16 % with 3.6".to_owned(),
    };
    let warning = Concern::LeavesPlane.of_sheet(format!(
        "{kept}, and they leave it as the ligaments buckle, which are up to {} times as wide as the sheet is thick: by finite elements {off}; \
         hold it flat, or solve it: `kirigami verify --sheet`",
        rounded(widest / material.thickness, 2)
    ));
    let falls = match on_table {
        Some(error) => Flatness::of(error, 0.0) == Flatness::Falls,
        None => widest > FALLS * material.thickness,
    };
    Warning { severity: if falls { Severity::Error } else { warning.severity }, ..warning }
}

/// A weight that acts in the plane of the sheet but not in the model.
fn weightless(input: &RuleInput) -> Option<Warning> {
    input.scene.surrogate()?;
    let weight = &input.run.as_ref()?.facts.self_weight;
    let left_out =
        !weight.is_modelled && matches!(weight.posture?, Posture::Hanging | Posture::Free);
    let ratio = weight.over_load.filter(|ratio| left_out && *ratio > HEAVY)?;
    Some(Concern::Weight.of_sheet(format!(
        "the weight of the sheet is {} and not modelled: if it hangs, set posture.kind = \"hanging\" with `down`",
        of_the_load(ratio)
    )))
}

/// Friction that the design does not know of.
fn friction(input: &RuleInput) -> Option<Warning> {
    input.scene.surrogate()?;
    let weight = &input.run.as_ref()?.facts.self_weight;
    weight.lying.as_ref()?;
    let ratio = FRICTION * weight.over_load?;
    (ratio > HEAVY).then(|| {
        Concern::Friction.of_sheet(format!(
            "friction on the surface, at mu = {FRICTION}, is {}, and the design does not contain it: lift or shake the sheet while \
             it opens, or reduce the friction",
            of_the_load(ratio)
        ))
    })
}

fn hung_weight(input: &RuleInput) -> Option<Warning> {
    let weight = &input.run.as_ref()?.facts.self_weight;
    let ratio = weight.hung.filter(|ratio| *ratio > HUNG)?;
    Some(Concern::HungWeight.of_sheet(format!(
        "the weights that hang from the sheet have {} times its mass: mass_g is in grams; write 2 for two grams",
        rounded(ratio, 2)
    )))
}

fn load_peak(input: &RuleInput) -> Option<Warning> {
    let reached = input.run.as_ref()?.facts.reached.as_ref()?;
    let peak = reached.peak?;
    let carried = peak.dead_load_reaches?;
    let [length, force] = reached.units;
    let [maximum, at, last, end, carried] =
        [peak.load, peak.displacement, reached.load, reached.displacement, carried]
            .map(|value| rounded(value, 4));
    let such = if force == "N" { ", such as a hung weight," } else { "" };
    let consequence = if reached.load * reached.displacement > 0.0 {
        format!(
            "a dead load of {last} {force}{such} does not open this sheet: it moves it by {carried} {length} and not by {end} {length}"
        )
    } else {
        format!(
            "no dead load opens this sheet by {end} {length}: the load has changed its direction there, to {last} {force}"
        )
    };
    Some(Concern::LoadPeak.of_sheet(format!(
        "{consequence}; the load peaks at {maximum} {force} at a stroke of {at} {length}"
    )))
}

/// Weights whose forces are off by more than a tenth at their spot check, or at unseen rays, some
/// of which leave the training domain, if they have none.
fn inaccurate(input: &RuleInput) -> Option<Warning> {
    let weights = input.run.as_ref()?.facts.weights.as_ref()?;
    let card = input.scene.weights()?.card();
    let (of, states) = match &card.spot_check {
        Some(check) => (&check.errors, "random"),
        None => (&card.test_errors, "unseen"),
    };
    let forces = [("F_a", of.f_a), ("F_s", of.f_s), ("M_theta", of.m_theta)];
    let forces = forces.map(|(name, error)| (100.0 * error.relative_rmse, name));
    let forces = forces.into_iter().filter(|(error, _)| *error > INACCURATE);
    let (error, name) = forces.max_by(|one, other| one.0.total_cmp(&other.0))?;
    Some(Concern::WeakWeights.of_sheet(format!(
        "the weights {} are inaccurate: {name} is off by {} % at {states} states; solve more rays, or check this design by \
         `kirigami verify --equilibrium`",
        weights.file,
        rounded(error, 3)
    )))
}

/// Weights whose spot check mostly lies outside their training domain.
fn outside(input: &RuleInput) -> Option<Warning> {
    let weights = input.run.as_ref()?.facts.weights.as_ref()?;
    let check = weights.spot_check.as_ref()?;
    (2 * check.inside < check.states).then(|| {
        Concern::WeakWeights.of_sheet(format!(
            "only {} of {} states of the spot check lie inside the training domain of the weights {}: its errors say little \
             about them; solve more rays",
            check.inside, check.states, weights.file
        ))
    })
}

fn missed(input: &RuleInput) -> Option<Warning> {
    let RunContext { facts, after, .. } = input.run.as_ref()?;
    let error = after.outline_error;
    let ratio = error / facts.longer_side();
    let [noted, warned, refused] = MISSED;
    if ratio <= noted {
        return None;
    }
    let severity = if ratio > refused {
        Severity::Error
    } else if ratio > warned {
        Severity::Warning
    } else {
        Severity::Note
    };
    Some(Warning { severity, ..Concern::TargetMissed.of_sheet(miss(error, facts.flat_size)) })
}

/// A learned law has the slits of its training; the effect of others was measured in a range.
fn slit_width(input: &RuleInput) -> Option<Warning> {
    let known = input.scene.surrogate()?.card().hinge.kerf;
    let slit = input.deployment.sheet.options.process.slit_width;
    if (slit / known - 1.0).abs() < SAME_SLIT {
        return None;
    }
    let regime = input.scene.material.regime(input.scene.config.ligament.start);
    let [least, most] = match regime {
        Regime::Film => MEASURED_SLIT_OF_FILM,
        Regime::Plate => MEASURED_SLIT_OF_PLATE,
    };
    let beyond = input.hinges_where(|row| !(least..=most).contains(&(slit / row.w_lig)));
    let message = format!(
        "the slit of {slit} mm (process.slit_width) is neither the slit of the weights, {} mm, nor between {least} and {most} ligament widths, where its effect on the hinge energy was measured: \
         use narrower slits or wider ligaments",
        rounded(known, 4)
    );
    about(Concern::SlitUnknown, beyond, message)
}

fn other_branch(input: &RuleInput) -> Option<Warning> {
    input.run.as_ref()?.designed.search.branch_mismatch().then(|| {
        Concern::OtherBranch.of_sheet(
            "during the search a corrected path was on another branch than the path followed from the flat sheet: the designs \
             found by it are not used, and the search went on from the best design whose path was followed"
                .into(),
        )
    })
}
