//! Missing programs, a failing solver, output that cannot be written, files that are none. Messages
//! about wrong input: messages.txt.

use crate::common::{Workplace, failure};
use std::os::unix::fs::PermissionsExt;
use testkit::failing_ccx;

const CAMPAIGN: &str = "configs/campaigns/tiny.toml";
const SCENE: &str = "configs/scenes/linear-7x7.toml";

#[test]
fn the_message_about_a_missing_program_states_how_to_install_it() {
    let work = Workplace::new();
    for (variable, package) in [("KIRIGAMI_GMSH", "gmsh"), ("KIRIGAMI_CCX", "calculix-ccx")] {
        let mut command = work.program("solve --tier tiny");
        let message = failure(command.env(variable, "/no/such/program"));
        assert!(message.contains(variable), "{message}");
        assert!(message.contains(&format!("apt-get install {package}")), "{message}");
    }
    let doctor = |ccx: &str| {
        let mut doctor = work.program("doctor");
        let output = doctor.env("KIRIGAMI_CCX", work.path(ccx)).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{ccx}");
        String::from_utf8(output.stdout).unwrap()
    };
    let said = doctor("/no/such/program");
    assert!(said.contains("was not found") && said.contains("weights data/petg-3mm/"), "{said}");
    assert!(said.starts_with(concat!("kirigami ", env!("CARGO_PKG_VERSION"))), "{said}");
    // A program that cannot be loaded, and another one, which prints a number.
    for (status, printed) in [(127, "libspooles.so.2.2: cannot open"), (0, "line 4, in x")] {
        let script = format!("#!/bin/sh\necho '{printed}' >&2\nexit {status}\n");
        work.write("ccx", script);
        std::fs::set_permissions(work.path("ccx"), PermissionsExt::from_mode(0o755)).unwrap();
        let text = doctor("ccx");
        assert!(text.contains(printed), "{text}");
    }
}

#[test]
fn the_output_of_a_failing_solver_is_quoted_and_the_deck_kept() {
    let work = Workplace::new();
    let ccx = failing_ccx(&work.path(""), "echo ' *ERROR reading *SOLID SECTION'");
    let message = failure(work.program("solve --tier tiny").env("KIRIGAMI_CCX", &ccx));
    assert!(message.contains("*ERROR reading *SOLID SECTION"), "{message}");
    assert!(work.path("runs/solve/window.inp").exists(), "the deck is kept");
}

/// Neither the environment nor the home of the user reaches the solver.
#[test]
fn the_solver_runs_in_its_own_environment() {
    let work = Workplace::new();
    let ccx = failing_ccx(&work.path(""), "env > environment.txt");
    let mut solve = work.program("solve --tier tiny");
    solve.env("KIRIGAMI_CCX", ccx);
    solve.env("CCX_NPROC_STIFFNESS", "4").env("OMP_NUM_THREADS", "4");
    failure(solve.env("HOME", "/somewhere").env("SECRET", "1"));
    let seen = work.read("runs/solve/environment.txt");
    for line in ["CCX_NPROC_STIFFNESS=1", "OMP_NUM_THREADS=1"] {
        assert!(seen.lines().any(|it| it == line), "{seen}");
    }
    assert!(!seen.contains("SECRET") && !seen.contains("/somewhere"), "{seen}");
}

/// Output goes to `/dev/full`, or into a pipe that is full and does not block.
#[test]
fn output_that_cannot_be_written_is_an_error_and_no_panic() {
    let work = Workplace::new();
    let full = std::fs::File::options().write(true).open("/dev/full");
    let message = failure(work.program(&format!("campaign plan {CAMPAIGN}")).stdout(full.unwrap()));
    assert!(
        message.starts_with("error: cannot write to stdout: No space left")
            && message.lines().count() == 1,
        "{message}"
    );
    for arguments in ["--help", "--version", "design --help", "help"] {
        let full = std::fs::File::options().write(true).open("/dev/full");
        let message = failure(work.program(arguments).stdout(full.unwrap()));
        assert!(
            message.contains("cannot write to stdout") && message.lines().count() == 1,
            "{arguments}: {message}"
        );
    }
}

#[test]
fn counts_have_an_upper_bound() {
    let work = Workplace::new();
    for arguments in [
        format!("campaign run {CAMPAIGN} --jobs 1025"),
        format!("campaign run {CAMPAIGN} --jobs 0"),
        format!("verify {SCENE} --equilibrium --rounds 1000001"),
    ] {
        let output = work.program(&arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}");
    }
}

#[test]
fn a_refused_thread_is_an_error_and_no_panic() {
    let work = Workplace::new();
    let fault = "starts no further thread";
    for command in [
        "design configs/scenes/pet-3x3.toml --steps 1",
        &format!("campaign run {CAMPAIGN} --folder campaign"),
    ] {
        // No machine has memory for stacks of this size.
        let message = failure(work.program(command).env("RUST_MIN_STACK", "1000000000000000"));
        assert!(message.contains(fault), "{command}: {message}");
    }
}

#[test]
fn a_pipe_in_place_of_a_file_is_refused() {
    let work = Workplace::new();
    for kind in ["toml", "json", "safetensors", "parquet", "csv", "svg"] {
        let pipe = work.path("pipe").with_extension(kind);
        let made = std::process::Command::new("mkfifo").arg(pipe).status();
        assert!(made.unwrap().success());
    }
    std::fs::copy(work.path("configs/scenes/pin-7x7.toml"), work.path("target.toml")).unwrap();
    work.edit(
        "target.toml",
        &[
            ("../materials", "configs/materials"),
            ("[target.circle]", "[target.svg]\nfile = \"pipe.svg\""),
            ("radius", "height"),
        ],
    );
    for command in [
        "campaign plan pipe.toml",
        "train pipe.parquet",
        "surrogate card pipe.safetensors",
        "design pipe.toml",
        "design target.toml",
        "material fit pipe.csv --name film --thickness 0.1 --density-kg-m3 1000",
        "init sheet --material pipe.toml",
    ] {
        let message = work.error(command);
        assert!(message.contains("not a regular file"), "{command}: {message}");
    }
}

/// A limit that is lower than the program's own cannot be raised.
#[test]
fn a_lower_limit_of_the_file_size_remains() {
    let kirigami = env!("CARGO_BIN_EXE_kirigami");
    let limited = format!("ulimit -f 100000; exec {kirigami} doctor");
    let output = std::process::Command::new("sh").args(["-c", &limited]).output();
    let output = output.unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("ccx"), "{output:?}");
}
