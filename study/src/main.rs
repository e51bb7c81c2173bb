//! The `billow` program. The library holds everything, so that tests call the same code.

fn main() -> std::process::ExitCode {
    billow_study::cli::main()
}
