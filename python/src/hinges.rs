//! The learned hinge energy: weights, hinges prepared for evaluation, and the domain and
//! spread of their states.

use crate::{
    arrays::{Argument, Array, Numbers, Plain, array, plain, tuple},
    errors,
    waiting::unlocked,
};
use design::hinge_law::{HingeDamage, HingeEnergy, Order, PreparedLaw, PreparedSurrogate};
use hinge::{DesignGradient, HingeConstants, HingeDeformation, HingeDesign};
use pyo3::{exceptions::PyValueError, prelude::*};
use rayon::prelude::*;
use std::{path::PathBuf, sync::Arc};
use surrogate::mean_and_variance;

/// The learned energy of a hinge, W(a, s, theta; w_lig, alpha), with its continuation outside the
/// training domain.
///
/// Units are mm, N, N mm and rad.
///
/// >>> film = kirigami.Surrogate.load("data/pet-0.5mm/medium.safetensors")
/// >>> film([0.0, 0.0, 0.5], w_lig=18.0, alpha=1.2).energy
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct Surrogate {
    /// Its own network first, then the networks of the ensemble.
    networks: Vec<Arc<surrogate::Surrogate>>,
    /// Their files, from which another process reads it.
    files: Vec<PathBuf>,
}

/// Hinges of given designs, prepared once for any number of evaluations.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct Hinges(Arc<PreparedHinges>);

/// Hinges that one thread evaluates together.
const CHUNK: usize = 2048;

type Law = PreparedSurrogate<Arc<surrogate::Surrogate>>;

struct PreparedHinges {
    networks: Vec<Arc<surrogate::Surrogate>>,
    /// Laws of the first network, one for each chunk of the designs.
    laws: Vec<Law>,
    designs: Vec<HingeDesign>,
    shape: Vec<usize>,
}

/// Hinges in given states. Energy, forces and tangent are evaluated by the call; damage, depth and
/// spread when they are read.
#[pyclass(frozen, module = "kirigami")]
pub(crate) struct HingeStates {
    hinges: Arc<PreparedHinges>,
    deformations: Vec<HingeDeformation>,
    /// Energies of each chunk.
    energies: Vec<Vec<HingeEnergy>>,
    order: Order,
}

#[pymethods]
impl Surrogate {
    /// Weights (.safetensors) with the card (.json) next to them, and further networks of the same
    /// training, whose disagreement is the spread.
    #[new]
    #[pyo3(signature = (weights, ensemble=Vec::new()))]
    fn new(weights: PathBuf, ensemble: Vec<PathBuf>) -> PyResult<Self> {
        let files = std::iter::once(weights).chain(ensemble);
        let files: Vec<PathBuf> = files.map(std::path::absolute).collect::<Result<_, _>>()?;
        let networks = unlocked(|| {
            (files.iter())
                .map(|file| surrogate::Surrogate::load(file).map(Arc::new))
                .collect::<Result<_, _>>()
        })?;
        let networks = networks.map_err(errors::weights)?;
        Ok(Self { networks, files })
    }

    /// The same as `Surrogate(weights, ensemble)`.
    #[staticmethod]
    #[pyo3(signature = (weights, ensemble=Vec::new()))]
    fn load(weights: PathBuf, ensemble: Vec<PathBuf>) -> PyResult<Self> {
        Self::new(weights, ensemble)
    }

    /// What the class is made of again when it is unpickled.
    fn __getnewargs__(&self) -> (PathBuf, Vec<PathBuf>) {
        let mut files = self.files.iter().cloned();
        (files.next().unwrap_or_default(), files.collect())
    }

    /// The card of the weights: units, scaling, training data, training domain, test errors.
    #[getter]
    fn card(&self) -> Plain {
        plain(self.networks[0].card())
    }

    /// Hinges prepared for evaluation.
    ///
    /// w_lig: ligament width (mm), a number or an array of the shape of the hinges; alpha: cut
    /// angle (rad), likewise; hole: radius of the hole over w_lig, by default the hole of reference
    /// on the card of the weights.
    #[pyo3(signature = (w_lig, alpha, hole=None))]
    fn hinges(
        &self,
        w_lig: &Argument,
        alpha: &Argument,
        hole: Option<&Argument>,
    ) -> PyResult<Hinges> {
        self.prepared(None, w_lig, alpha, hole)
    }

    /// The states (a, s, theta), an array of shape (..., 3) in (mm, mm, rad), of hinges of the
    /// shape (...) or of a single design. For many evaluations of the same hinges, prepare them by
    /// `hinges`.
    #[pyo3(signature = (states, w_lig, alpha, hole=None, order="tangent"))]
    fn __call__(
        &self,
        states: &Argument,
        w_lig: &Argument,
        alpha: &Argument,
        hole: Option<&Argument>,
        order: &str,
    ) -> PyResult<HingeStates> {
        let states = read_states(states)?;
        let shape = &states.shape[..states.shape.len() - 1];
        let hinges = self.prepared(Some(shape), w_lig, alpha, hole)?;
        hinges.evaluated(states, order)
    }

    fn __repr__(&self) -> String {
        let (card, others) = (self.networks[0].card(), self.networks.len() - 1);
        format!("Surrogate({}, {} mesh, ensemble of {others} more)", card.material, card.tier)
    }
}

impl Surrogate {
    fn prepared(
        &self,
        shape: Option<&[usize]>,
        w_lig: &Argument,
        alpha: &Argument,
        hole: Option<&Argument>,
    ) -> PyResult<Hinges> {
        let constants = self.networks[0].card().hinge;
        let given = [("w_lig", Some(w_lig)), ("alpha", Some(alpha)), ("hole", hole)];
        let mut columns = Vec::new();
        for (name, argument) in given {
            columns.push(match argument {
                Some(argument) => Numbers::read(argument, name)?,
                None => Numbers { name, values: vec![constants.fillet_ratio], shape: Vec::new() },
            });
        }
        let widest = columns.iter().map(|numbers| &numbers.shape);
        let shape = match shape {
            Some(shape) => shape.to_vec(),
            None => widest.max_by_key(|shape| shape.len()).cloned().unwrap_or_default(),
        };
        let filled = columns.into_iter().map(|numbers| numbers.filled(&shape));
        let columns: Vec<Vec<f64>> = filled.collect::<PyResult<_>>()?;
        let designs: Vec<HingeDesign> = (0..columns[0].len())
            .map(|h| {
                let fillet_ratio = columns[2][h];
                HingeConstants { fillet_ratio, ..constants }.hinge(columns[0][h], columns[1][h])
            })
            .collect();
        designs.iter().enumerate().try_for_each(|(h, design)| {
            let wrong = |error| PyValueError::new_err(format!("hinge {h}: {error}"));
            design.validate().map_err(wrong)
        })?;
        let networks = self.networks.clone();
        let laws = unlocked(|| prepared(&networks[0], &designs))?;
        Ok(Hinges(Arc::new(PreparedHinges { networks, laws, designs, shape })))
    }
}

fn read_states(states: &Argument) -> PyResult<Numbers> {
    let states = Numbers::read(states, "states")?;
    if states.shape.last() != Some(&3) {
        return Err(states.wrong_shape("(..., 3): (a, s, theta)"));
    }
    Ok(states)
}

fn read_order(order: &str) -> PyResult<Order> {
    Ok(match order {
        "value" => Order::Value,
        "forces" => Order::Forces,
        "tangent" => Order::Tangent,
        "design" => Order::Design,
        _ => {
            return Err(PyValueError::new_err(format!(
                "`order` is \"{order}\", expected \"value\", \"forces\", \"tangent\" or \"design\""
            )));
        }
    })
}

#[pymethods]
impl Hinges {
    /// The states (a, s, theta) (mm, mm, rad) of all hinges, an array of their shape + (3,).
    ///
    /// order: "value" evaluates W, "forces" its gradient, "tangent" its Hessian, "design" the
    /// derivatives in (w_lig, alpha, hole) too.
    #[pyo3(signature = (states, order="tangent"))]
    fn __call__(&self, states: &Argument, order: &str) -> PyResult<HingeStates> {
        self.evaluated(read_states(states)?, order)
    }

    /// The shape of the hinges.
    #[getter]
    fn shape(&self) -> Vec<usize> {
        self.0.shape.clone()
    }
}

impl Hinges {
    fn evaluated(&self, states: Numbers, order: &str) -> PyResult<HingeStates> {
        let order = read_order(order)?;
        let expected = [&self.0.shape[..], &[3]].concat();
        if states.shape != expected {
            return Err(states.wrong_shape(&tuple(&expected)));
        }
        let (deformations, _) = states.values.as_chunks::<3>();
        let deformations: Vec<HingeDeformation> =
            deformations.iter().map(|state| HingeDeformation::from(*state)).collect();
        let hinges = Arc::clone(&self.0);
        let energies = unlocked(|| {
            by_chunk(&hinges.laws, &deformations, |law, states| law.energies(states, order))
        })?;
        Ok(HingeStates { hinges, deformations, energies, order })
    }
}

#[pymethods]
impl HingeStates {
    /// W (N mm), of the shape of the hinges.
    #[getter]
    fn energy(&self) -> Array {
        self.column(|energy| [energy.w], &[])
    }

    /// (F_a, F_s, M_theta) = dW/d(a, s, theta) (N, N, N mm), shape (..., 3).
    #[getter]
    fn forces(&self) -> PyResult<Array> {
        self.needs(Order::Forces, "forces")?;
        Ok(self.column(|energy| energy.forces, &[3]))
    }

    /// d2W/d(a, s, theta)^2, shape (..., 3, 3).
    #[getter]
    fn tangent(&self) -> PyResult<Array> {
        self.needs(Order::Tangent, "tangent")?;
        Ok(self.column(|energy| energy.tangent.into_iter().flatten(), &[3, 3]))
    }

    /// dW/d(w_lig, alpha, hole) at constant (a, s, theta), shape (..., 3).
    #[getter]
    fn by_design(&self) -> PyResult<Array> {
        self.needs(Order::Design, "design")?;
        Ok(self.column(|energy| energy.design.to_array(), &[3]))
    }

    /// d2W/d(a, s, theta)d(w_lig, alpha, hole), shape (..., 3, 3).
    #[getter]
    fn forces_by_design(&self) -> PyResult<Array> {
        self.needs(Order::Design, "design")?;
        Ok(self
            .column(|energy| energy.mixed.into_iter().flat_map(DesignGradient::to_array), &[3, 3]))
    }

    /// D, the mean plastic strain of the ligament over that at fracture; nan outside the training
    /// domain, where it is unknown.
    #[getter]
    fn damage(&self) -> PyResult<Array> {
        self.damaged(|damage| Some(damage.d))
    }

    /// D_peak, the damage of the most strained 1 % of the ligament: it tears at 1. nan outside the
    /// training domain, and if the weights do not predict it.
    #[getter]
    fn damage_peak(&self) -> PyResult<Array> {
        self.damaged(|damage| damage.d_peak)
    }

    /// Depth in the training domain: 1 at its centre, 0 at its edge, negative outside.
    #[getter]
    fn depth(&self) -> Array {
        let domain = self.hinges.networks[0].domain();
        let depths = std::iter::zip(&self.hinges.designs, &self.deformations)
            .map(|(design, state)| domain.depth(design, state));
        array(depths, &[&self.hinges.shape])
    }

    /// Whether each state, the width, the angle and the hole of its hinge are inside the training
    /// domain (bool).
    #[getter]
    fn inside(&self) -> PyResult<Array<bool>> {
        let inside = || by_chunk(&self.hinges.laws, &self.deformations, Law::inside);
        let inside = unlocked(inside)?.concat();
        Ok(array(inside, &[&self.hinges.shape]))
    }

    /// Standard deviation over the networks of the ensemble of (W, F_a, F_s, M_theta), shape (...,
    /// 4).
    #[getter]
    fn spread(&self) -> PyResult<Array> {
        let PreparedHinges { networks, designs, shape, .. } = &*self.hinges;
        if networks.len() == 1 {
            return Err(PyValueError::new_err(
                "one network has no spread: load its ensemble, Surrogate.load(weights, ensemble=[...])",
            ));
        }
        let spreads = unlocked(|| {
            let forces =
                |law: &Law, states: &[HingeDeformation]| law.energies(states, Order::Forces);
            let of_networks: Vec<Vec<HingeEnergy>> = (networks.iter())
                .map(|network| prepared(network, designs))
                .map(|laws| by_chunk(&laws, &self.deformations, forces).concat())
                .collect();
            let spread = |hinge: usize, quantity: usize| {
                let values = of_networks.iter().map(|energies| {
                    let HingeEnergy { w, forces: [f_a, f_s, m], .. } = energies[hinge];
                    [w, f_a, f_s, m][quantity]
                });
                mean_and_variance(values)[1].sqrt()
            };
            (0..4 * designs.len()).map(|i| spread(i / 4, i % 4)).collect::<Vec<_>>()
        })?;
        Ok(array(spreads, &[shape, &[4]]))
    }
}

impl HingeStates {
    fn needs(&self, order: Order, name: &str) -> PyResult<()> {
        if self.order < order {
            return Err(PyValueError::new_err(format!(
                "this was not evaluated: call the hinges with order=\"{name}\""
            )));
        }
        Ok(())
    }

    fn column<R: IntoIterator<Item = f64>>(
        &self,
        of: impl Fn(&HingeEnergy) -> R,
        shape: &[usize],
    ) -> Array {
        let values = self.energies.iter().flatten().flat_map(of);
        array(values, &[&self.hinges.shape, shape])
    }

    fn damaged(&self, of: impl Fn(&HingeDamage) -> Option<f64> + Sync) -> PyResult<Array> {
        let known = |law: &Law, states: &[HingeDeformation]| -> Vec<f64> {
            let damages = law.damage(states, false);
            let known = std::iter::zip(&damages, law.inside(states));
            let known = known.map(|(damage, inside)| of(damage).filter(|_| inside));
            known.map(|damage| damage.unwrap_or(f64::NAN)).collect()
        };
        let values = || by_chunk(&self.hinges.laws, &self.deformations, known);
        let values = unlocked(values)?.concat();
        Ok(array(values, &[&self.hinges.shape]))
    }
}

/// The law of a network prepared for each chunk of some hinges.
fn prepared(network: &Arc<surrogate::Surrogate>, designs: &[HingeDesign]) -> Vec<Law> {
    let chunks = designs.par_chunks(CHUNK);
    chunks.map(|designs| PreparedSurrogate::new(Arc::clone(network), designs)).collect()
}

/// The values of a law at the states of each chunk.
fn by_chunk<T: Send>(
    laws: &[Law],
    states: &[HingeDeformation],
    of: impl Fn(&Law, &[HingeDeformation]) -> Vec<T> + Sync,
) -> Vec<Vec<T>> {
    // A single chunk takes less time than waking another thread.
    if let [law] = laws {
        return vec![of(law, states)];
    }
    let chunks = laws.par_iter().zip(states.par_chunks(CHUNK));
    chunks.map(|(law, states)| of(law, states)).collect()
}
