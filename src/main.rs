//! The `covact` program.
use std::process::ExitCode;

fn main() -> ExitCode {
    covact::cli::main()
}
