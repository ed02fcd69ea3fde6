//! What is measured: the networks and the other ways to the energy of a material, and the materials.

use crate::universal::judgement::Errors;
use crate::universal::states::{Film, SolvedState};
use ::train::{EnergySlopes, LawForm, LawState};
use anyhow::{Result, ensure};
use dataset::Database;
use hinge::SheetMaterial;
use std::collections::BTreeMap;
use std::path::Path;

/// Numbers of rays of the family in training; all that are not held out are added.
pub const LAWS: [usize; 3] = [30, 60, 120];
/// Number of rays of each other material in training.
pub const OTHER_RAYS: usize = 100;
/// Numbers of rays of a material.
pub const OWN_RAYS: [usize; 3] = [10, 25, 50];
/// Fraction of the laws that is held out, and fractions of the geometries of a material.
pub const TEST: f64 = 0.2;
pub const VALIDATION: f64 = 0.1;
/// What the networks are tested on when the laws are held out.
pub const HELD_OUT: &str = "laws held out";

/// A network of the family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Network {
    /// The three numbers of the law are features.
    Numbers,
    /// The same; a factor of the film's energy.
    TimesFilm,
    /// The works of the law are multiplied by weights that depend on the hinge alone.
    Works,
    /// The same; the weights depend on the three numbers too.
    WorksAndNumbers,
    /// The film's energy times ratios of works, with weights that depend on the hinge alone.
    WorksTimesFilm,
    /// The same; the weights depend on the three numbers too.
    WorksAndNumbersTimesFilm,
    /// [`Self::WorksAndNumbers`], trained also on rays of the other materials.
    WorksOfAll,
}

/// The networks that are trained on the family alone.
pub const NETWORKS: [Network; 6] = [
    Network::Numbers,
    Network::TimesFilm,
    Network::Works,
    Network::WorksAndNumbers,
    Network::WorksAndNumbersTimesFilm,
    Network::WorksTimesFilm,
];

/// A way to the energy of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// The film's, over E t^3.
    Film,
    Family(Network),
    /// The mean of the networks of works that are trained on the family alone.
    MeanOfWorks,
    /// The film's times a factor of the material's rays.
    FilmTimes,
    /// A network times a factor of the material's rays.
    FamilyTimes(Network),
    /// A network, fine-tuned on the material's rays.
    FamilyTuned(Network),
    /// The film's weights, fine-tuned on the material's rays.
    FilmTuned,
}

/// A material with its solved rays.
pub struct Material {
    pub sheet: SheetMaterial,
    pub database: Database,
    pub states: Vec<SolvedState>,
}

/// What was measured: on what, which way, with how many rays of the family and of the material.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Case {
    pub target: String,
    pub way: Way,
    pub laws: usize,
    pub own_rays: usize,
}

/// The errors of each case, one for each split.
pub type Measured = BTreeMap<Case, Vec<Errors>>;

impl Network {
    pub fn form(self) -> LawForm {
        match self {
            Self::Numbers => LawForm::Alone,
            Self::TimesFilm => LawForm::Factor,
            Self::Works => LawForm::Works { numbers: false },
            Self::WorksAndNumbers | Self::WorksOfAll => LawForm::Works { numbers: true },
            Self::WorksTimesFilm => LawForm::WorksOfKnown { numbers: false },
            Self::WorksAndNumbersTimesFilm => LawForm::WorksOfKnown { numbers: true },
        }
    }

    /// Whether the works of the law enter.
    pub fn is_of_works(self) -> bool {
        matches!(
            self.form(),
            LawForm::Works { .. } | LawForm::WorksOfKnown { .. }
        )
    }

    /// Whether the film is known to the network, so that it is no test.
    pub fn knows_film(self) -> bool {
        matches!(
            self,
            Self::TimesFilm | Self::WorksTimesFilm | Self::WorksAndNumbersTimesFilm
        )
    }
}

impl Material {
    /// The states of each ray.
    pub fn rays(&self) -> impl Iterator<Item = &[SolvedState]> {
        let mut left = self.states.as_slice();
        let rows = self.database.rows();
        rows.chunk_by(|left, right| left.job == right.job)
            .map(move |rows| left.split_off(..rows.len()).unwrap_or_default())
    }

    pub fn read(sheet: &Path, rays: &Path, film: &Film) -> Result<Self> {
        let (sheet, database) = (SheetMaterial::load(sheet)?, Database::read(rays)?);
        let windows = database.manifest().hinge;
        let similar = windows.r_win / sheet.thickness * film.sheet.thickness;
        ensure!(
            (similar / film.weights.card().hinge.r_win - 1.0).abs() < 1e-9,
            "{}: the windows are not similar to those of the film: r_win = {} mm",
            rays.display(),
            windows.r_win
        );
        let states = SolvedState::of_rows(database.rows(), &sheet, film);
        Ok(Self {
            sheet,
            database,
            states,
        })
    }
}

/// Fewer than `all`, and `all`.
pub fn counts(fewer: &[usize], all: usize) -> Vec<usize> {
    let fewer = fewer.iter().copied().filter(|&count| count < all);
    fewer.chain([all]).collect()
}

pub fn inputs(states: &[SolvedState]) -> Vec<LawState> {
    states.iter().map(SolvedState::input).collect()
}

pub fn films(states: &[SolvedState]) -> Vec<EnergySlopes> {
    states.iter().map(|state| state.film).collect()
}
