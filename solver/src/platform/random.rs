//! Pseudo-random numbers without a state: `SplitMix64` (G. L. Steele, D. Lea, C. H. Flood, "Fast splittable
//! pseudorandom number generators", 2014). The number of a seed and an index is always the same.

/// The number of a seed with this index; the first one that the generator draws has index 1.
pub fn hash(seed: u64, index: u64) -> u64 {
    let mut z = seed.wrapping_add(index.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The first 53 bits of a number as a fraction in [0, 1).
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}
