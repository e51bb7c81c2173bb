//! Empty: the measurements are in `kernels.rs`.
