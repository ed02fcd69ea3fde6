//! How a ligament deforms as its hinge opens: by its width over the thickness of the sheet.

/// The two ways in which a ligament deforms. A learned energy holds in one of them.
#[derive(Clone, Copy, Debug, PartialEq, strum::Display)]
#[strum(serialize_all = "kebab-case")]
pub enum Regime {
    /// Wide ligaments buckle out of the plane and fold.
    Film,
    /// Ligaments no wider than the sheet is thick bend in its plane.
    Plate,
}

impl Regime {
    /// Ligament width over thickness up to which ligaments bend in the plane
    /// (docs/results/flatness).
    pub const WIDEST_PLATE: f64 = 1.0;
    /// Thickness (mm) from which a sheet is a plate unless its size says otherwise: ligaments of a
    /// thinner one, narrower than its thickness, have no room for a hole wider than a usual kerf.
    pub const THINNEST_PLATE: f64 = 1.0;

    /// eta_a of a ligament that turns freely by theta (rad): the coefficients of theta and theta^2.
    /// The ligament of a plate turns about its middle.
    pub const fn free_opening(self) -> [f64; 2] {
        match self {
            Self::Film => [0.0; 2],
            Self::Plate => [0.5, 0.16],
        }
    }

    /// Height over the thickness of the bump of a ligament as cut: of a film the height that the
    /// paper measured, of a plate one fiftieth, because a plate does not warp where it is cut. With
    /// one thickness, W of a plate is 13 to 37 % too small.
    pub const fn bump(self) -> f64 {
        match self {
            Self::Film => 1.0,
            Self::Plate => 0.02,
        }
    }

    /// The regime of a sheet of a thickness (mm) of which no more is known.
    pub fn usual(thickness: f64) -> Self {
        if thickness >= Self::THINNEST_PLATE { Self::Plate } else { Self::Film }
    }

    /// The regime of a ligament, by its width over the thickness.
    pub fn of(width: f64) -> Self {
        if width <= Self::WIDEST_PLATE { Self::Plate } else { Self::Film }
    }
}
