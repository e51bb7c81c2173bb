//! Names of the table columns that the commands read, where a name is needed more than once.

/// Whether a small change of the ratios would change the verdict.
pub const NEAR_THRESHOLD: &str = "close";
/// Relative change of the ratios that [`NEAR_THRESHOLD`] means.
pub const NEAR_THRESHOLD_MARGIN: &str = "close_margin";
/// Time at which a failed job stopped, s.
pub const STOP_TIME: &str = "stop_time";
/// Element, node or part of the model at which a failed job stopped.
pub const STOP_LOCATION: &str = "stop_place";
