//! By how much the record of a surface is late.

/// When one surface was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceDelay {
    /// Canonical name of the surface.
    pub(crate) name: &'static str,
    /// By how much the record is late, s; negative: early. Against positions that run straight between the samples, so
    /// that a position that was held from its sample on is half a sample early.
    pub(crate) late_s: f64,
    /// One sigma of it, s.
    pub(crate) std_s: f64,
    /// Median step of the samples, s.
    pub(crate) step_s: f64,
}
