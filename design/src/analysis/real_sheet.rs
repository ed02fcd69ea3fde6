//! Sheets cut from one drawing: deployed, and read at parts of their actuation.

use crate::analysis::actuation_curve::ActuationCurve;
use crate::equilibrium::displacement_control::magnitude;
use crate::equilibrium::load_step::LoadStep;
use crate::equilibrium::nearby_path::KnownPath;
use crate::objective::design_problem::{Deployment, DesignError, DesignProblem, Mechanics, found};
use crate::pattern::design_vector::DesignVector;
use crate::scene::Scene;
use crate::sheet::cut_sheet::Sheet;
use crate::sheet::deviation::Deviation;

/// Parts of an actuation, with the states of the drawing's sheet there.
pub struct ReadingPlan {
    parts: Vec<f64>,
    known: KnownPath,
    /// The curve of the drawing's sheet.
    pub drawn: Option<ActuationCurve>,
}

/// A cut sheet at the parts of a plan.
pub struct Read {
    /// The flat sheet.
    pub sheet: Sheet,
    /// Its equilibria.
    pub steps: Vec<LoadStep>,
    /// From the sheet before its loads on; `None` if nothing moves the sheet.
    pub curve: Option<ActuationCurve>,
}

/// A designed sheet of which there are cut ones.
pub struct RealSheet<'a> {
    scene: &'a Scene,
    mechanics: &'a Mechanics,
    designed: Deployment,
    known: KnownPath,
}

impl<'a> RealSheet<'a> {
    /// The sheet of a design, which has an equilibrium at full load.
    pub fn new(
        scene: &'a Scene,
        problem: &'a DesignProblem,
        design: &DesignVector,
    ) -> Result<Self, DesignError> {
        let mechanics = problem.model.mechanics().ok_or(DesignError::NoMechanics)?;
        let designed = problem.deploy(design)?;
        designed.at_full_load()?;
        Ok(Self {
            scene,
            mechanics,
            known: designed.known_path(),
            designed,
        })
    }

    /// The sheet of the drawing.
    pub fn designed(&self) -> &Deployment {
        &self.designed
    }

    /// Its thickness (mm).
    pub fn thickness(&self) -> f64 {
        self.scene.material.thickness
    }

    /// The place in (displacement, load) of what the sheet answers with: 0 under dead loads, 1 if its motion is prescribed.
    pub fn answer(&self) -> usize {
        let solver = &self.mechanics.solver;
        let dead_loads = solver.stroke().is_none() && magnitude(&solver.loads).is_some();
        usize::from(!dead_loads)
    }

    /// Whether a sheet of another thickness, or of stronger material, can be computed: with a learned hinge law.
    pub fn has_similar_laws(&self) -> bool {
        self.mechanics.law.scales() == [true; 2]
    }

    /// A cut sheet at full load, with the mechanics that it has.
    pub fn deployed(&self, deviation: &Deviation) -> Result<(Deployment, Mechanics), DesignError> {
        let mechanics = self.mechanics.as_cut(deviation, self.thickness())?;
        let cut = mechanics.deploy_cut(&self.designed, deviation, &self.known, false);
        let (deployment, _) = cut?;
        Ok((deployment, mechanics))
    }

    /// The drawing's sheet at parts of its actuation, in ascending order, from which those of cut sheets are found.
    pub fn reading_plan(&self, parts: &[f64]) -> Result<ReadingPlan, DesignError> {
        let mut plan = ReadingPlan {
            parts: parts.to_vec(),
            known: KnownPath {
                designs: self.designed.sheet.designs(),
                steps: Vec::new(),
            },
            drawn: None,
        };
        let drawn = self.read(&plan, &Deviation::default())?;
        (plan.known.steps, plan.drawn) = (drawn.steps, drawn.curve);
        Ok(plan)
    }

    /// A cut sheet at the parts of a plan.
    pub fn read(&self, plan: &ReadingPlan, deviation: &Deviation) -> Result<Read, DesignError> {
        let sheet = self.designed.sheet.clone().with_deviation(deviation);
        let sheet = sheet.ok_or(DesignError::ImpossibleSheet)?;
        let mechanics = self.mechanics.as_cut(deviation, self.thickness())?;
        let prepared = mechanics.law.prepare(&sheet.designs());
        let hinged = mechanics.hinged(&sheet, &*prepared, false);
        let solver = &mechanics.solver;
        let steps = solver.readings_near(hinged, &plan.parts, &plan.known);
        let steps = steps.unwrap_or_else(|| solver.readings(hinged, &plan.parts));
        steps.iter().try_for_each(|step| found(step).map(|_| ()))?;
        let before = solver.before_loads(hinged);
        let states = (steps.iter()).map(|step| (step.load_factor, &step.configuration[..]));
        let curve = ActuationCurve::through(&mechanics, &sheet, &before, states);
        drop(prepared);
        Ok(Read {
            sheet,
            steps,
            curve,
        })
    }
}
