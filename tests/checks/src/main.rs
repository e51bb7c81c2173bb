//! The program `billow-checks`. The library holds everything, so that tests call the same code.

fn main() -> std::process::ExitCode {
    billow_checks::commands::main()
}
