//! `kirigami material`: the sheet material, from tensile tests to a checked material file.

mod check;
mod fit;
#[cfg(feature = "pipeline")]
mod learn;

subcommands! {
    /// Fit a material file to tensile tests, check a material, and learn its hinge energy
    pub(crate) enum MaterialCommand {
        Fit(fit::FitCommand),
        Check(check::CheckCommand),
        #[cfg(feature = "pipeline")]
        Learn(learn::LearnCommand),
    }
}
