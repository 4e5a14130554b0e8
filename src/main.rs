//! The command `chartwright`; everything it does is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    chartwright::cli::run(std::env::args_os())
}
