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

pub mod compare;
pub mod cut;
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
pub(crate) mod pipeline;
pub mod studio;
