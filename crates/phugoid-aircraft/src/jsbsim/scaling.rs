//! Properties that follow others through a scale.

/// How a property follows from another through a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scaling {
    /// The other property, by its index, and its sign.
    pub(crate) input: (usize, f64),
    /// Ends of the other property.
    pub(crate) domain: [f64; 2],
    /// The values at these ends.
    pub(crate) range: [f64; 2],
    /// Whether 0 goes to 0, with a slope of its own on either side.
    pub(crate) centred: bool,
}

impl Scaling {
    /// The value for one of the other property times its sign. It goes on beyond the ends, and is NaN for an empty domain.
    pub(crate) fn value(&self, x: f64) -> f64 {
        let ([low, high], [least, most]) = (self.domain, self.range);
        if self.centred {
            return if x < 0.0 { least * x / low } else { most * x / high };
        }
        least + (most - least) * (x - low) / (high - low)
    }
}

/// A property of the aerodynamics that follows the angle of a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Follower {
    pub(crate) property: usize,
    /// What the angle is multiplied by, one after the other.
    pub(crate) factors: [f64; 2],
    /// The scale of the result, if it is not the result itself.
    pub(crate) scaling: Option<Scaling>,
}
