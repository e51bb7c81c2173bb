//! Nothing: the measurements are in `kernels.rs`.
