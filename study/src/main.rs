//! The `billow` program. Everything is in the library, so that tests call the same code.

fn main() -> std::process::ExitCode {
    billow_study::cli::main()
}
