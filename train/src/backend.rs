//! The Burn backends compiled in, chosen at run time.

use burn::tensor::Device;
use std::fmt;
use std::str::FromStr;

#[cfg(not(any(feature = "flex", feature = "ndarray")))]
compile_error!("training needs one of the features `flex` and `ndarray`");

/// The backend of the tensor operations of a training; the model is the same on all backends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Burn's backend flex.
    #[cfg(feature = "flex")]
    Flex,
    /// Burn's backend ndarray.
    #[cfg(feature = "ndarray")]
    NdArray,
}

/// A backend name that is not compiled in.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("unknown backend `{name}`; this program was built with {built}: choose one of these", built = names())]
pub struct UnknownBackend {
    name: String,
}

impl Backend {
    /// All compiled-in backends, the fastest first.
    pub const ALL: &[Self] = &[
        #[cfg(feature = "flex")]
        Self::Flex,
        #[cfg(feature = "ndarray")]
        Self::NdArray,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(feature = "flex")]
            Self::Flex => "flex",
            #[cfg(feature = "ndarray")]
            Self::NdArray => "ndarray",
        }
    }

    /// The device, recording gradients.
    #[cfg_attr(
        feature = "ndarray",
        expect(
            deprecated,
            reason = "Burn recommends flex; users may still compare both"
        )
    )]
    pub(crate) fn device(self) -> Device {
        match self {
            #[cfg(feature = "flex")]
            Self::Flex => Device::flex(),
            #[cfg(feature = "ndarray")]
            Self::NdArray => Device::ndarray(),
        }
        .autodiff()
    }
}

impl Default for Backend {
    fn default() -> Self {
        Self::ALL[0]
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Backend {
    type Err = UnknownBackend;

    fn from_str(name: &str) -> Result<Self, UnknownBackend> {
        let mut all = Self::ALL.iter();
        all.find(|backend| backend.name() == name)
            .copied()
            .ok_or_else(|| UnknownBackend { name: name.into() })
    }
}

fn names() -> String {
    let names: Vec<&str> = Backend::ALL.iter().map(|backend| backend.name()).collect();
    names.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_unknown_names_are_errors_with_the_list() {
        for &backend in Backend::ALL {
            assert_eq!(backend.name().parse(), Ok(backend));
        }
        let message = "cuda".parse::<Backend>().unwrap_err().to_string();
        assert!(message.contains(Backend::default().name()), "{message}");
    }
}
