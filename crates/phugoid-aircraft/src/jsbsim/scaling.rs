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

    /// The other property times its sign, for a value; not finite for a scale that is level.
    pub(crate) fn inverse(&self, value: f64) -> f64 {
        let ([low, high], [least, most]) = (self.domain, self.range);
        if !self.centred {
            return low + (high - low) * (value - least) / (most - least);
        }
        let below = value * low / least;
        if below < 0.0 { below } else { value * high / most }
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

impl Follower {
    /// The angle for a value of the property; not finite for a scale that is level.
    pub(crate) fn angle(&self, value: f64) -> f64 {
        let [first, second] = self.factors;
        self.scaling.map_or(value, |scaling| scaling.inverse(value)) / (first * second)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_comes_back_from_its_property() {
        let scaling = |centred| Scaling { input: (0, 1.0), domain: [-0.4, 0.2], range: [-1.0, 1.0], centred };
        for (scaling, factor) in [(None, 1.0), (None, -1.0), (Some(scaling(true)), 1.0), (Some(scaling(false)), -1.0)] {
            let follower = Follower { property: 0, factors: [factor, 1.0], scaling };
            for angle in [-0.3, -0.1, 0.0, 0.05, 0.2] {
                let x = factor * angle;
                let value = scaling.map_or(x, |scaling| scaling.value(x));
                assert!((follower.angle(value) - angle).abs() < 1e-15, "{scaling:?} {angle}");
            }
        }
    }
}
