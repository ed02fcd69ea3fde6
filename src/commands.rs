//! The subcommands, one per file.

/// Subcommands, each run by its own command.
macro_rules! subcommands {
    ($(#[$about:meta])* $visible:vis enum $name:ident {
        $($(#[cfg($of:meta)])? $(#[command($kind:ident)])? $variant:ident($command:ty),)*
    }) => {
        $(#[$about])*
        #[derive(clap::Subcommand)]
        $visible enum $name {
            $($(#[cfg($of)])? $(#[command($kind)])? $variant($command),)*
        }

        impl $name {
            pub(crate) fn run(&self) -> anyhow::Result<()> {
                match self {
                    $($(#[cfg($of)])? Self::$variant(command) => command.run(),)*
                }
            }
        }
    };
}

#[cfg(feature = "pipeline")]
pub mod campaign;
pub mod compare;
pub mod cut;
#[cfg(feature = "pipeline")]
pub mod dataset;
#[cfg(feature = "pipeline")]
pub mod demo;
pub mod design;
pub mod doctor;
pub mod export;
pub mod init;

pub mod inspect;
pub mod levels;
pub mod material;
#[cfg(feature = "pipeline")]
pub mod mesh;
#[cfg(feature = "pipeline")]
pub(crate) mod pipeline;
#[cfg(feature = "pipeline")]
pub mod solve;
#[cfg(feature = "pipeline")]
pub mod solve_args;
pub mod studio;
#[cfg(feature = "pipeline")]
pub mod surrogate;
#[cfg(feature = "pipeline")]
pub mod train;
#[cfg(feature = "pipeline")]
pub mod verify;
#[cfg(feature = "pipeline")]
mod window_args;
