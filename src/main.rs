//! The `kirigami` program; see [`kirigami::cli`].

use clap::Parser;
use kirigami::{
    cli::Cli,
    ui::{
        exit::{self, Exit},
        interrupt,
    },
};

fn main() -> Exit {
    interrupt::end_quietly_when_nobody_reads();
    exit::report_failures_of_the_system();
    match Cli::try_parse() {
        Ok(command) => Exit::from_result(command.run()),
        Err(answer) => exit::print_answer(&answer),
    }
}
