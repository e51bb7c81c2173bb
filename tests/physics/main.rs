//! Physics against numbers: analytic cases, properties, conservation.
