//! Solved states of any sheet without dimensions: energies over E t^3, lengths over t.

use crate::universal::law::{Law, works_of_material};
use dataset::Row;
use hinge::{HingeDeformation, HingeDesign, HingeSample, SheetMaterial};
use std::f64::consts::PI;
use surrogate::{Order, Surrogate};
use train::{EnergySlopes, LAW_STRAINS, LawState};

/// The state of a hinge at a converged increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolvedState {
    pub law: Law,
    /// w_lig / t
    pub ligament: f64,
    /// Cut angle (rad).
    pub alpha: f64,
    /// (eta_a, eta_s, theta), theta in rad.
    pub at: [f64; 3],
    /// By finite elements.
    pub solved: EnergySlopes,
    /// By the weights of the film.
    pub film: EnergySlopes,
    /// Work of its law in tension, over E.
    pub works: [f64; LAW_STRAINS],
    /// That of the law of the film.
    pub film_works: [f64; LAW_STRAINS],
}

/// The weights of the film, with its sheet.
pub struct Film {
    pub weights: Surrogate,
    pub sheet: SheetMaterial,
}

impl SolvedState {
    /// A sample of a sheet whose hardening is, or is described by, a law of the family.
    pub fn new(
        design: &HingeDesign,
        sample: &HingeSample,
        sheet: &SheetMaterial,
        law: Law,
        film: &Film,
    ) -> Self {
        let [eta_a, eta_s] = sample.deformation().eta(design.w_lig);
        let forces = [sample.f_a, sample.f_s, sample.m_theta];
        let state = Self {
            law,
            ligament: design.w_lig / sheet.thickness,
            alpha: design.alpha,
            at: [eta_a, eta_s, sample.theta],
            solved: over_stiffness(sample.w, forces, design, sheet),
            film: EnergySlopes::default(),
            works: law.works(),
            film_works: [0.0; LAW_STRAINS],
        };
        film.filled(state)
    }

    /// The rows of a database of one material, with the numbers of its law of the family and the works of its own.
    pub fn of_rows(rows: &[Row], sheet: &SheetMaterial, film: &Film) -> Vec<Self> {
        let law = Law::of_material(sheet);
        let works = works_of_material(sheet);
        let state = |row: &Row| Self {
            works,
            ..Self::new(&row.design, &row.sample, sheet, law, film)
        };
        rows.iter().map(state).collect()
    }

    /// The state of the mirrored hinge.
    fn mirrored(&self) -> Self {
        let mirror = |energy: EnergySlopes| {
            let [a, s, theta] = energy.slopes;
            EnergySlopes {
                slopes: [a, -s, theta],
                ..energy
            }
        };
        let [eta_a, eta_s, theta] = self.at;
        Self {
            alpha: PI - self.alpha,
            at: [eta_a, -eta_s, theta],
            solved: mirror(self.solved),
            film: mirror(self.film),
            ..*self
        }
    }

    /// As the input of a network.
    pub fn input(&self) -> LawState {
        let [eta_a, eta_s, theta] = self.at;
        let [first, second, third] = self.law.features();
        LawState {
            features: [
                eta_a,
                eta_s,
                theta,
                self.ligament.ln(),
                self.alpha,
                self.law.poisson,
                first,
                second,
                third,
            ],
            scale: self.law.energy_size(),
            known: self.film,
            works: self.works,
            known_works: self.film_works,
        }
    }

    /// (F_a, F_s) over E t^2 and M over E t^3 of an energy at this state.
    pub fn forces(&self, of: &EnergySlopes) -> [f64; 3] {
        let [a, s, theta] = of.slopes;
        [a / self.ligament, s / self.ligament, theta]
    }
}

/// The states and their mirror images, as training data.
pub fn training_data<'a>(
    states: impl IntoIterator<Item = &'a SolvedState>,
) -> Vec<(LawState, EnergySlopes)> {
    let both = states.into_iter().flat_map(|it| [*it, it.mirrored()]);
    both.map(|it| (it.input(), it.solved)).collect()
}

impl Film {
    /// The state with energy and works of the film.
    pub fn filled(&self, state: SolvedState) -> SolvedState {
        let [eta_a, eta_s, theta] = state.at;
        let w_lig = state.ligament * self.sheet.thickness;
        let design = self.weights.card().hinge.hinge(w_lig, state.alpha);
        let prepared = self.weights.prepare(&[design]);
        let deformation = HingeDeformation::from_eta(eta_a, eta_s, theta, w_lig);
        let energies = self
            .weights
            .evaluate(&prepared, &[deformation], Order::Forces);
        let film = over_stiffness(energies[0].w, energies[0].forces, &design, &self.sheet);
        SolvedState {
            film,
            film_works: works_of_material(&self.sheet),
            ..state
        }
    }
}

/// W and its derivatives in (eta_a, eta_s, theta), over E t^3.
fn over_stiffness(
    w: f64,
    [f_a, f_s, m_theta]: [f64; 3],
    design: &HingeDesign,
    sheet: &SheetMaterial,
) -> EnergySlopes {
    let size = sheet.young * sheet.thickness.powi(3);
    EnergySlopes {
        energy: w / size,
        slopes: [f_a * design.w_lig, f_s * design.w_lig, m_theta].map(|slope| slope / size),
    }
}
