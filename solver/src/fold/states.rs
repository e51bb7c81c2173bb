//! Flat, stowed and erected states.
