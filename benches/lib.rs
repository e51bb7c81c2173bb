//! Empty: the measurements are in `kernels.rs` and `factorisation/`.
