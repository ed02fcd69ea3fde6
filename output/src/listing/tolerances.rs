//! What the tolerances of cutting do to a deployed sheet, in numbers.

use crate::drawing;
use crate::report::columns::rounded;
use design::analysis::cutting_errors::{
    CuttingError, CuttingErrors, CuttingErrorsError, FirstOrder, SampledSheets, Spread,
};
use design::analysis::error_budget::{Cause, ErrorBudget};
use design::equilibrium::load_step::LoadStep;
use design::objective::design_problem::DesignProblem;
use design::pattern::design_vector::DesignVector;
use design::scene::{Scene, ToleranceConfig};
use design::sheet::cut_sheet::Sheet;
use serde::{Serialize, Serializer};
use serde_json::json;
use std::fmt;
use support::table::number_or_dash;

/// Number of single ligaments that are shown.
const SHOWN: usize = 8;

/// The effects of tolerances on the deployed sheet.
#[derive(Clone, Debug, Serialize)]
pub struct ToleranceListing {
    /// Two standard deviations each (mm).
    #[serde(serialize_with = "with_ligament")]
    pub tolerances: ToleranceConfig,
    /// To first order.
    pub first_order: FirstOrder,
    /// Sheets with errors at random, if there were any.
    pub samples: Option<SampledSheets>,
    /// The movement of the corners that is allowed, root mean square, one standard deviation (mm); `None` if none is known.
    pub within: Option<f64>,
    /// Whether it is that of the known errors of the model.
    within_model: bool,
    /// The tolerance of the ligaments, the kerf and the thickness, each alone, that moves the corners by that (mm).
    #[serde(serialize_with = "with_ligament")]
    pub allowed: Option<ToleranceConfig>,
    /// The designed sheet, and its state at full load.
    #[serde(skip)]
    designed: (Sheet, LoadStep),
}

/// Tolerances with that of the ligaments, which is no key of a scene.
fn with_ligament<S: Serializer>(
    of: &(impl Into<Option<ToleranceConfig>> + Copy),
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let of: Option<ToleranceConfig> = (*of).into();
    let all =
        of.map(|of| json!({ "ligament": of.ligament, "kerf": of.kerf, "thickness": of.thickness }));
    all.serialize(serializer)
}

/// Seed of the sheets at random.
const SEED: u64 = 0;

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub struct ToleranceQuestion {
    /// Two standard deviations each (mm).
    pub tolerances: ToleranceConfig,
    /// Number of sheets at random.
    pub samples: usize,
    /// The movement that is allowed (mm); by default that of the model's known errors.
    pub within: Option<f64>,
}

impl ToleranceListing {
    /// The effects on a design of a scene and its problem. `progress` is called with the number of errors and sheets that are
    /// done, and of all.
    pub fn new(
        scene: &Scene,
        problem: &DesignProblem,
        design: &DesignVector,
        question: ToleranceQuestion,
        progress: &mut dyn FnMut(usize, usize),
    ) -> Result<Self, CuttingErrorsError> {
        let ToleranceQuestion {
            tolerances,
            samples,
            within,
        } = question;
        let errors = CuttingErrors::new(scene, problem, design, tolerances)?;
        let all = errors.errors().len() + samples;
        let mut done = 0;
        let mut tick = || {
            done += 1;
            progress(done, all);
        };
        let first_order = errors.first_order(&mut tick)?;
        let samples = (samples > 0)
            .then(|| errors.sampled(samples, SEED, &mut tick))
            .transpose()?;
        let model = || {
            let budget = ErrorBudget::new(scene, problem, errors.designed(), None)?;
            let cut = [Cause::Kerf, Cause::Thickness];
            let [rms, _] = budget.sum(|cause| !cut.contains(&cause)).corners;
            (rms > 0.0).then_some(rms)
        };
        let within_model = within.is_none();
        let within = within.or_else(model);
        Ok(Self {
            tolerances,
            designed: (
                errors.designed().sheet.clone(),
                errors.designed().compared().clone(),
            ),
            allowed: within.map(|within| allowed(&first_order, tolerances, within)),
            first_order,
            samples,
            within,
            within_model,
        })
    }

    /// The deployed sheet, its hinges coloured by the share of their ligament in the variance of the panel corners (SVG); `None` without a tolerance of the ligaments.
    pub fn picture(&self, scene: &Scene) -> Option<String> {
        self.tolerances
            .ligament
            .filter(|ligament| *ligament > 0.0)?;
        let (sheet, last) = &self.designed;
        let mut shares = vec![0.0; sheet.hinges.len()];
        for effect in &self.first_order.errors {
            if let CuttingError::Ligament(hinge) = effect.error {
                shares[hinge] = 100.0 * effect.share;
            }
        }
        let of = format!(
            "the share of their ligament in the variance of the corners, {:.0} % in all",
            shares.iter().sum::<f64>()
        );
        let picture = drawing::deployed_by_share(scene, sheet, last, &shares, SHOWN, &of);
        Some(picture)
    }
}

/// The tolerances that each alone move the corners by `within` (mm).
fn allowed(first_order: &FirstOrder, tolerances: ToleranceConfig, within: f64) -> ToleranceConfig {
    let [rms, _] = first_order.corners;
    let alone = |given: Option<f64>, is: fn(CuttingError) -> bool| {
        let effects = first_order.errors.iter().filter(|effect| is(effect.error));
        let moved = rms * effects.map(|effect| effect.share).sum::<f64>().sqrt();
        given
            .map(|tolerance| tolerance * within / moved)
            .filter(|allowed| allowed.is_finite())
    };
    ToleranceConfig {
        ligament: alone(tolerances.ligament, |error| {
            matches!(error, CuttingError::Ligament(_))
        }),
        kerf: alone(tolerances.kerf, |error| error == CuttingError::Kerf),
        thickness: alone(tolerances.thickness, |error| {
            error == CuttingError::Thickness
        }),
    }
}

/// The given tolerances in words, with their unit.
fn in_words(tolerances: ToleranceConfig) -> String {
    let ToleranceConfig {
        ligament,
        kerf,
        thickness,
    } = tolerances;
    let all = [
        ("ligament", ligament),
        ("kerf", kerf),
        ("thickness", thickness),
    ];
    let given = all.into_iter().filter_map(|(name, tolerance)| {
        let millimetres = rounded(tolerance?, 3);
        Some(format!("{name} +- {millimetres} mm"))
    });
    given.collect::<Vec<_>>().join(", ")
}

fn name(error: CuttingError) -> String {
    match error {
        CuttingError::Ligament(hinge) => format!("ligament of hinge {hinge}"),
        CuttingError::Kerf => "kerf".into(),
        CuttingError::Thickness => "thickness".into(),
    }
}

/// A relative change in per cent.
fn percent(change: Option<f64>) -> String {
    change.map_or("-".into(), |change| format!("{:.2} %", 100.0 * change))
}

/// A line of the table of standard deviations.
struct Line<'a> {
    name: &'a str,
    corners: [f64; 2],
    load: Option<f64>,
    d_peak: Option<f64>,
    share: Option<f64>,
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [rms, most] = self.corners;
        let share = self.share;
        writeln!(
            f,
            "{:<26}{rms:>14.3}{most:>14.3}{:>12}{:>10}{:>9}",
            self.name,
            percent(self.load),
            number_or_dash(self.d_peak.unwrap_or(f64::NAN), 4),
            share.map_or(String::new(), |share| format!("{:.0} %", 100.0 * share)),
        )
    }
}

impl fmt::Display for ToleranceListing {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let given = in_words(self.tolerances);
        writeln!(f, "tolerances, two standard deviations: {given}\n")?;
        self.write_deviations(f)?;
        self.write_samples(f)?;
        self.write_allowed(f)?;
        writeln!(
            f,
            "\nNot in these numbers: holes that are off by other than the kerf, cuts that are rough, material that differs along the sheet"
        )
    }
}

impl ToleranceListing {
    fn write_deviations(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(
            f,
            "{:<26}{:>14}{:>14}{:>12}{:>10}{:>9}",
            "one standard deviation of", "corners, mm", "largest, mm", "load", "D_peak", "share"
        )?;
        let FirstOrder {
            errors,
            corners,
            load,
            d_peak,
        } = &self.first_order;
        for effect in errors.iter().take(SHOWN) {
            let line = Line {
                name: &name(effect.error),
                corners: effect.corners,
                load: effect.load,
                d_peak: effect.d_peak,
                share: Some(effect.share),
            };
            write!(f, "{line}")?;
        }
        let all = Line {
            name: "all, to first order",
            corners: *corners,
            load: *load,
            d_peak: *d_peak,
            share: None,
        };
        write!(f, "{all}")?;
        if let Some(samples) = &self.samples {
            let deviation = |moments: Option<[f64; 2]>| moments.map(|[_, deviation]| deviation);
            let sampled = Line {
                name: &format!("all, {} sheets", samples.deployed),
                corners: samples.corners,
                load: deviation(samples.load),
                d_peak: deviation(samples.d_peak),
                share: None,
            };
            write!(f, "{sampled}")?;
        }
        if let further @ 1.. = errors.len().saturating_sub(SHOWN) {
            writeln!(f, "{further} further errors have smaller shares (--json)")?;
        }
        Ok(())
    }

    fn write_samples(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Some(samples) = &self.samples else {
            return Ok(());
        };
        let [median, most] = samples.largest;
        writeln!(
            f,
            "\nthe corner that moves most moves by {median:.3} mm in the median sheet, and by less than {most:.3} mm in 95 % of them"
        )?;
        if let Some([mean, deviation]) = samples.d_peak {
            writeln!(
                f,
                "the largest D_peak changes by {mean:+.4} +- {deviation:.4}"
            )?;
        }
        writeln!(
            f,
            "\n{:<26}{:>14}{:>14}{:>14}",
            "", "drawn", "mean", "95 % below"
        )?;
        for (name, Spread { drawn, mean, most }) in [
            ("outline error (mm)", samples.outline_error),
            ("loss (mm^2)", samples.loss),
        ] {
            writeln!(f, "{name:<26}{drawn:>14.3}{mean:>14.3}{most:>14.3}")?;
        }
        writeln!(
            f,
            "{:<26}{:>28}",
            "hinges leave the domain",
            format!("in {} of {} sheets", samples.outside, samples.deployed)
        )?;
        if samples.failed > 0 {
            writeln!(
                f,
                "{} sheets have no equilibrium at full load and are not counted",
                samples.failed
            )?;
        }
        Ok(())
    }

    fn write_allowed(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (Some(within), Some(allowed)) = (self.within, self.allowed) else {
            return Ok(());
        };
        let what = match self.within_model {
            true => "the known errors of the model move the corners by",
            false => "allowed movement of the corners:",
        };
        writeln!(
            f,
            "\n{what} {within:.3} mm (root mean square, one standard deviation). That much moves them, each alone: {}",
            in_words(allowed)
        )
    }
}
