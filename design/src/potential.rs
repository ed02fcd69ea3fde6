//! The potential (10) of a configuration at one point of the path, with its first two derivatives.
//!
//! Under load control the load factor zeta is given. A driven sheet is told the stroke c . q of its
//! loads instead, c their direction; zeta is then the multiplier that balances them best,
//!
//! ```text
//! min |grad U - zeta f|     over zeta, moments compared with forces by the size of a panel
//! ```
//!
//! and what is minimised is U alone, because the loads do the same work in every such configuration. U
//! counts the work of loads that are held, if there are any, as stored with its sign turned.

use crate::equilibrium::HingedSheet;
use crate::hinge_law::{HingeEnergy, Order};
use crate::kinematics::{Configuration, HingeMotion};
use crate::panel_vectors::{add_at_hinge, at_hinge, gather, spread};
use crate::stroke::Stroke;
use crate::tangent::TangentPattern;
use hinge::HingeDeformation;

/// The potential (10) at one point of the path.
pub(crate) struct Potential<'a> {
    pub sheet: HingedSheet<'a>,
    pub pattern: &'a TangentPattern,
    /// Numbers of the free degrees of freedom.
    pub free: &'a [Option<usize>],
    pub control: Control<'a>,
    /// Size of a panel, which makes moments comparable with forces (mm).
    pub panel_size: f64,
    /// (F_x, F_y, M) per panel at zeta = 1.
    pub loads: &'a [[f64; 3]],
    /// Loads that do not depend on zeta.
    pub held: &'a [[f64; 3]],
    /// What unbalanced forces are measured by, at least (N): on the way through a state without force
    /// that of the states before.
    pub force: f64,
}

/// Hinges of a panel at most, whose roundings add up.
const HINGES_OF_A_PANEL: f64 = 4.0;

/// What is given of the loads.
#[derive(Clone, Copy)]
pub(crate) enum Control<'a> {
    /// zeta
    Load(f64),
    /// Their way.
    Stroke(&'a Stroke),
}

/// The potential and its first derivatives at a configuration.
pub(crate) struct State {
    pub configuration: Configuration,
    pub motions: Vec<HingeMotion>,
    pub energies: Vec<HingeEnergy>,
    /// zeta
    pub load_factor: f64,
    /// Energy of the hinges.
    pub stored: f64,
    /// What is minimised: Pi, or U of a driven sheet, less the work of loads that are held.
    pub potential: f64,
    /// Sum of the sizes of the terms of `potential`.
    pub magnitude: f64,
    /// Hinge forces expected on the way here, by their rates, if they shall stand for those that are in
    /// f . d2(eps) of the tangent.
    pub expected: Option<Vec<[f64; 3]>>,
    /// d Pi / d q over the free degrees of freedom.
    pub gradient: Vec<f64>,
    /// Greatest unbalanced force over `force`.
    pub residual: f64,
    /// Greatest force that the rounding of hinge deformations leaves unbalanced, over `force`.
    pub rounding: f64,
    /// The greatest force (N).
    pub force: f64,
}

impl State {
    /// Whether no more is unbalanced than the tolerance allows or rounding leaves.
    pub fn is_balanced(&self, tolerance: f64) -> bool {
        self.residual <= tolerance.max(self.rounding)
    }

    /// (F_a, F_s, M_theta) per hinge.
    pub fn forces(&self) -> Vec<[f64; 3]> {
        self.energies.iter().map(|energy| energy.forces).collect()
    }

    pub fn deformations(&self) -> Vec<HingeDeformation> {
        self.motions.iter().map(HingeMotion::deformation).collect()
    }
}

impl Control<'_> {
    /// The stroke that is held, if one is.
    pub fn stroke(&self) -> Option<&Stroke> {
        match self {
            Self::Load(_) => None,
            Self::Stroke(stroke) => Some(stroke),
        }
    }
}

impl Potential<'_> {
    /// With what the tangent needs; `None` where the potential is not finite.
    pub fn state(&self, configuration: Configuration) -> Option<State> {
        self.state_up_to(configuration, Order::Tangent)
    }

    /// With the derivatives of the hinge energies up to `order`, forces at least.
    pub fn state_up_to(&self, configuration: Configuration, order: Order) -> Option<State> {
        let sheet = self.sheet.sheet;
        let motions: Vec<HingeMotion> = (0..sheet.hinges.len())
            .map(|hinge| HingeMotion::new(sheet, hinge, &configuration))
            .collect();
        let deformations: Vec<HingeDeformation> =
            motions.iter().map(HingeMotion::deformation).collect();
        let energies = self.sheet.energies(&deformations, order);

        let mut inner = vec![[0.0; 3]; configuration.len()];
        for ((hinge, motion), energy) in sheet.hinges.iter().zip(&motions).zip(&energies) {
            add_at_hinge(&mut inner, hinge, motion.forces(energy.forces));
        }
        for (inner, held) in std::iter::zip(inner.as_flattened_mut(), self.held.as_flattened()) {
            *inner -= held;
        }
        let (load_factor, worked) = match self.control {
            Control::Load(zeta) => (zeta, zeta),
            Control::Stroke(_) => (self.multiplier(&inner), 0.0),
        };
        let unbalanced: Vec<[f64; 3]> = std::iter::zip(&inner, self.loads)
            .map(|(inner, load)| std::array::from_fn(|d| inner[d] - load_factor * load[d]))
            .collect();
        let works = (self.loads.as_flattened().iter())
            .zip(self.held.as_flattened())
            .zip(configuration.as_flattened())
            .map(|((load, held), u)| -(worked * load + held) * u);
        let terms = energies.iter().map(|energy| energy.w).chain(works);
        let gradient = gather(self.free, &unbalanced);
        let left = self.greatest(spread(self.free, &gradient).into_iter());
        let held = self.greatest(self.held.iter().copied());
        let loads = held + load_factor.abs() * self.greatest(self.loads.iter().copied());
        let hinges = self.greatest(energies.iter().map(|energy| energy.forces));
        let force = self.force.max(loads).max(hinges);
        let over_force = |unbalanced: f64| match unbalanced {
            0.0 => 0.0,
            _ => unbalanced / force,
        };
        let state = State {
            stored: energies.iter().map(|energy| energy.w).sum(),
            potential: terms.clone().sum(),
            magnitude: terms.map(f64::abs).sum(),
            residual: over_force(left),
            rounding: over_force(self.rounding(&motions, &energies)),
            force,
            expected: None,
            gradient,
            load_factor,
            configuration,
            motions,
            energies,
        };
        let finite = state.potential.is_finite() && state.gradient.iter().all(|g| g.is_finite());
        finite.then_some(state)
    }

    /// The greatest force that the rounding of kinematics and law leaves on a panel (N).
    fn rounding(&self, motions: &[HingeMotion], energies: &[HingeEnergy]) -> f64 {
        let resolution = self.sheet.law.resolution();
        let hinges = self.sheet.sheet.hinges.iter().zip(motions).zip(energies);
        HINGES_OF_A_PANEL
            * self.greatest(hinges.map(|((hinge, motion), energy)| {
                let [length, angle] = motion.rounding();
                let length = length + resolution * hinge.w_lig;
                let deformation = [length, length, angle + resolution];
                std::array::from_fn(|c| energy.tangent[c][c].abs() * deformation[c])
            }))
    }

    /// The zeta that leaves the least unbalanced.
    fn multiplier(&self, inner: &[[f64; 3]]) -> f64 {
        let arm = 1.0 / (self.panel_size * self.panel_size);
        let product = |[x, y, m]: [f64; 3], [fx, fy, fm]: [f64; 3]| x * fx + y * fy + arm * m * fm;
        let (mut along, mut square) = (0.0, 0.0);
        for (&inner, &load) in std::iter::zip(inner, self.loads) {
            along += product(inner, load);
            square += product(load, load);
        }
        along / square
    }

    /// Greatest of forces and moments, as a force (N).
    pub fn greatest(&self, forces: impl Iterator<Item = [f64; 3]>) -> f64 {
        forces
            .map(|[x, y, moment]| (x * x + y * y).sqrt().max(moment.abs() / self.panel_size))
            .fold(0.0, f64::max)
    }

    /// H of (20); away from an equilibrium with the forces that were expected on the way to the state.
    pub fn tangent(&self, state: &State) -> Vec<f64> {
        let hinges = state.motions.iter().zip(&state.energies).enumerate();
        self.pattern.assemble(hinges.map(|(h, (motion, energy))| {
            let forces = (state.expected.as_ref()).map_or(energy.forces, |expected| expected[h]);
            motion.stiffness(&energy.tangent, forces)
        }))
    }

    /// The rates of the hinge forces under a motion of all panels.
    pub fn force_rates(&self, state: &State, motion: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let hinges = state.motions.iter().zip(&state.energies);
        std::iter::zip(&self.sheet.sheet.hinges, hinges)
            .map(|(hinge, (hinge_motion, energy))| {
                let rates = hinge_motion.rates(at_hinge(hinge, motion));
                let along = |row: [f64; 3]| std::iter::zip(row, rates).map(|(k, e)| k * e).sum();
                energy.tangent.map(along)
            })
            .collect()
    }

    /// H times a motion of all panels, those of the supports included.
    pub fn resistance(&self, state: &State, motion: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; motion.len()];
        let hinges = std::iter::zip(&state.motions, &state.energies);
        for (hinge, (hinge_motion, energy)) in std::iter::zip(&self.sheet.sheet.hinges, hinges) {
            let motions = at_hinge(hinge, motion);
            let force = hinge_motion
                .stiffness(&energy.tangent, energy.forces)
                .map(|row| std::iter::zip(row, motions).map(|(k, q)| k * q).sum());
            add_at_hinge(&mut forces, hinge, force);
        }
        forces
    }

    pub fn moved(&self, state: &State, motion: &[[f64; 3]], fraction: f64) -> Option<State> {
        self.state(moved(&state.configuration, motion, fraction))
    }

    /// Greatest panel rotation (rad) or hinge translation (panel sizes) of a motion.
    pub fn length(&self, state: &State, motion: &[[f64; 3]]) -> f64 {
        std::iter::zip(&self.sheet.sheet.hinges, &state.motions)
            .map(|(hinge, hinge_motion)| {
                let motions = at_hinge(hinge, motion);
                let [along, across, _] = hinge_motion.rates(motions);
                let translation = (along * along + across * across).sqrt() / self.panel_size;
                translation.max(motions[2].abs()).max(motions[5].abs())
            })
            .fold(0.0, f64::max)
    }
}

/// What has reached `configuration`, after a fraction of a motion.
pub(crate) fn moved(
    configuration: &[[f64; 3]],
    motion: &[[f64; 3]],
    fraction: f64,
) -> Configuration {
    std::iter::zip(configuration, motion)
        .map(|(q, d)| std::array::from_fn(|c| q[c] + fraction * d[c]))
        .collect()
}
