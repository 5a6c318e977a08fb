//! The program: everything is in the library; a panic becomes an exit code of its own.

use std::process::ExitCode;

fn main() -> ExitCode {
    // The standard hook has printed the place by the time the panic arrives here.
    let code = std::panic::catch_unwind(resurf::cli::main).unwrap_or(resurf::cli::exit_code::INTERNAL);
    ExitCode::from(code)
}
