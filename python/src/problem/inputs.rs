//! Reads the arguments of a problem.

use super::Problem;
use crate::{
    arrays::{Argument, Numbers, finite, shaped, tuple},
    errors,
    waiting::while_polling,
    warm::{KnownPath, Warm},
};
use design::{
    DesignProblem, DesignVector, Evaluation, equilibrium::warm_start::WarmStart,
    objective::response::Conditions,
};
use pyo3::prelude::*;
use std::sync::{Arc, MutexGuard, PoisonError, atomic::Ordering};

impl Problem {
    /// The result of `solve`, without the GIL; Ctrl-C ends the path that it follows, and is raised.
    pub(super) fn solved<T: Send>(&self, solve: impl FnOnce() -> T + Send) -> PyResult<T> {
        self.stop.store(false, Ordering::Relaxed);
        while_polling(&self.stop, solve)
    }

    pub(super) fn mechanics(&self) -> PyResult<&design::Mechanics> {
        self.problem.model.equilibrium().map_err(errors::design)
    }

    pub(super) fn warm(&self) -> MutexGuard<'_, Warm> {
        self.warm.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn known(
        &self,
        warm: bool,
        part: impl Fn(&Warm) -> &KnownPath,
    ) -> Option<Arc<WarmStart>> {
        let follow_every = self.scene.config.solver.follow_every;
        part(&self.warm()).usable(follow_every).filter(|_| warm)
    }

    pub(super) fn design_of(&self, x: &Argument) -> PyResult<DesignVector> {
        Ok(self.start.with_flat(&shaped(x, "x", &[self.size()])?))
    }

    pub(super) fn by_panel(
        &self,
        argument: &Argument,
        name: &'static str,
    ) -> PyResult<Vec<[f64; 3]>> {
        let given = shaped(argument, name, &[self.problem.topology.panel_count(), 3])?;
        Ok(given.as_chunks::<3>().0.to_vec())
    }

    /// The problem with other loads, another thickness (mm) and other stresses than the scene has.
    pub(super) fn under(
        &self,
        loads: Option<&Argument>,
        thickness: Option<f64>,
        stress: f64,
    ) -> PyResult<Arc<DesignProblem>> {
        let loads = loads.map(|loads| self.by_panel(loads, "loads"));
        let conditions = Conditions {
            loads: loads.transpose()?,
            thickness: match thickness {
                Some(thickness) => finite("thickness", thickness)? / self.thickness(),
                None => 1.0,
            },
            stress: finite("stress", stress)?,
        };
        if conditions == Conditions::default() {
            return Ok(Arc::clone(&self.problem));
        }
        Ok(Arc::new(self.problem.under(&conditions).map_err(errors::design)?))
    }

    pub(super) fn evaluated(&self, x: &Argument, warm: bool) -> PyResult<Evaluation> {
        let design = self.design_of(x)?;
        let known = self.known(warm, |warm| &warm.path);
        let evaluation = self.solved(|| self.problem.evaluate_near(&design, known.as_deref()))?;
        let evaluation = evaluation.map_err(errors::design)?;
        self.warm().path.keep(&evaluation.deployment);
        Ok(evaluation)
    }

    /// The inputs of many solves.
    pub(super) fn many(
        &self,
        x: &Argument,
        loads: Option<&Argument>,
        thickness: Option<&Argument>,
        stress: Option<&Argument>,
    ) -> PyResult<Vec<(DesignVector, Conditions)>> {
        let read = |argument: Option<&Argument>, name, one: &[usize]| {
            let numbers = argument.map(|argument| Numbers::read(argument, name)).transpose()?;
            Ok::<_, PyErr>((numbers, one.to_vec()))
        };
        let given = [
            read(Some(x), "x", &[self.size()])?,
            read(loads, "loads", &[self.problem.topology.panel_count(), 3])?,
            read(thickness, "thickness", &[])?,
            read(stress, "stress", &[])?,
        ];
        let mut count = None;
        for (numbers, one) in &given {
            let Some(numbers) = numbers.as_ref().filter(|numbers| numbers.shape != *one) else {
                continue;
            };
            match numbers.shape.split_first() {
                Some((many, rest)) if rest == one && count.is_none_or(|count| count == *many) => {
                    count = Some(*many);
                }
                _ => {
                    let n = count.map_or("n".to_owned(), |count| count.to_string());
                    let expected = format!("{} or ({n}, ...) of these", tuple(one));
                    return Err(numbers.wrong_shape(&expected));
                }
            }
        }
        let [x, loads, thickness, stress] = given.map(|(numbers, one)| {
            let length: usize = one.iter().product();
            move |i: usize| -> Option<Vec<f64>> {
                let values = &numbers.as_ref()?.values;
                let first = if values.len() == length { 0 } else { i * length };
                Some(values[first..first + length].to_vec())
            }
        });
        let inputs = (0..count.unwrap_or(1)).map(|i| {
            let design = self.start.with_flat(&x(i).unwrap_or_default());
            let conditions = Conditions {
                loads: loads(i).map(|loads| loads.as_chunks::<3>().0.to_vec()),
                thickness: thickness(i).map_or(1.0, |mm| mm[0] / self.thickness()),
                stress: stress(i).map_or(1.0, |factor| factor[0]),
            };
            (design, conditions)
        });
        Ok(inputs.collect())
    }
}
