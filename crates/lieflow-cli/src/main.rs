//! The program `lieflow`.
#![forbid(unsafe_code)]

use std::io::Write;
use std::process::ExitCode;

use lieflow_cli::args::{Cli, Command};
use lieflow_cli::cmd;
use lieflow_cli::error::CliError;

fn dispatch(cli: &Cli) -> Result<(), CliError> {
    match &cli.command {
        None => cmd::demo::run(&cli.demo),
        Some(Command::Demo(args)) => cmd::demo::run(args),
        Some(Command::Compare(args)) => cmd::compare::run(args),
        Some(Command::Check(args)) => cmd::check::run(args),
        Some(Command::Paper(args)) => cmd::paper::run(args),
        Some(Command::Plot(args)) => cmd::plot::run(args),
        Some(Command::Run(args)) => cmd::run::run(args),
        Some(Command::Scenes(args)) => cmd::scenes::run(args),
        Some(Command::Methods(args)) => cmd::methods::run(args),
        Some(Command::Order(args)) => cmd::order::run(args),
        Some(Command::Completions(args)) => cmd::completions::run(args),
    }
}

fn main() -> ExitCode {
    match dispatch(&Cli::started_with()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody is left to tell when stderr is gone too.
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
