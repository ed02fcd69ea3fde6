//! `kirigami-studies`: cost and error of the choices at each stage, and the pages of `docs/results`.

mod attempt;
mod calibration;
mod chain;
mod charts;
mod choices;
mod coupon;
mod cpu_seconds;
mod designed;
mod extremes;
mod keys;
mod levels;
mod pages;
mod polyester;
mod printed;
mod spread;
mod stop;
mod surrogate;
mod tradeoff;
mod window;

use anyhow::Result;
use clap::{Parser, Subcommand};
use kirigami::ui::exit::{self, Exit};
use kirigami::ui::interrupt;

/// Measure cost and error of the choices at each stage, and make the pages of docs/results
#[derive(Parser)]
#[command(version, propagate_version = true)]
struct Cli {
    #[command(subcommand)]
    study: Study,
}

#[derive(Subcommand)]
enum Study {
    Levels(levels::LevelsStudy),
    Chain(chain::ChainStudy),
    Window(window::WindowStudy),
    Polyester(polyester::PolyesterStudy),
    Calibration(calibration::CalibrationStudy),
    Coupon(coupon::CouponStudy),
    Extremes(extremes::ExtremesStudy),
    Surrogate(surrogate::SurrogateStudy),
    Tradeoff(tradeoff::TradeoffCommand),
    Printed(printed::PrintedStudy),
    Pages(pages::PagesCommand),
    Keys(keys::KeysCommand),
}

impl Study {
    fn run(&self) -> Result<()> {
        match self {
            Self::Levels(study) => study.run(),
            Self::Chain(study) => study.run(),
            Self::Window(study) => study.run(),
            Self::Polyester(study) => study.run(),
            Self::Calibration(study) => study.run(),
            Self::Coupon(study) => study.run(),
            Self::Extremes(study) => study.run(),
            Self::Surrogate(study) => study.run(),
            Self::Tradeoff(command) => command.run(),
            Self::Printed(study) => study.run(),
            Self::Pages(command) => command.run(),
            Self::Keys(command) => command.run(),
        }
    }
}

fn main() -> Exit {
    interrupt::end_quietly_when_nobody_reads();
    exit::report_failures_of_the_system();
    Exit::from_result(Cli::parse().study.run())
}
