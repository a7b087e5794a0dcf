//! Why there is no steady flight.

/// A number as it is, but with an exponent where it would have tens of digits.
fn readable(value: f64) -> String {
    if value.is_finite() && value.abs() >= 1e15 { format!("{value:e}") } else { value.to_string() }
}

/// Why there is no steady flight. Numbers are those of the equilibrium that was found without the limit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrimError {
    /// A number of the condition makes no sense.
    #[error("trim: {field} is {}, expected {expected}", readable(*value))]
    Condition {
        /// Name of the field of the condition that is out of its range.
        field: &'static str,
        /// The number that was given, in the unit of the field.
        value: f64,
        /// The numbers that are allowed, in words.
        expected: &'static str,
    },
    /// More thrust is needed than the engine has at full throttle.
    #[error(
        "trim: not enough thrust: {needed_n:.0} N needed, {available_n:.0} N available at full throttle (angle of attack \
         {:.2} deg); fly lower, less steeply, or nearer to the speed of least drag", alpha_rad.to_degrees()
    )]
    NotEnoughThrust {
        /// Thrust that steady flight would need, N.
        needed_n: f64,
        /// Thrust at full throttle, N.
        available_n: f64,
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
    },
    /// A turn is asked for of an aircraft that has no side force and no rolling or yawing moment.
    #[error(
        "trim: no turn of {:.4} deg/s: nothing rolls this aircraft, yaws it or pushes it to the side, so that it flies straight \
         ahead, as every model of the longitudinal axes alone does. Leave the turn rate out, or give the aircraft the \
         coefficients CY, Cl and Cn", turn_rate_rad_s.to_degrees()
    )]
    NoTurn {
        /// Rate of the heading that was asked for, rad/s.
        turn_rate_rad_s: f64,
    },
    /// Less thrust is needed than the engine gives at idle.
    #[error(
        "trim: too much thrust: {needed_n:.0} N needed, {idle_n:.0} N at idle (angle of attack {:.2} deg); descend less \
         steeply, or at a speed with more drag", alpha_rad.to_degrees()
    )]
    TooMuchThrust {
        /// Thrust that steady flight would need, N.
        needed_n: f64,
        /// Thrust that the engine gives at idle, N.
        idle_n: f64,
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
    },
    /// A surface would have to go beyond its stop.
    #[error(
        "trim: {surface} at its limit: {:.2} deg needed, {:.2} deg available (angle of attack {:.2} deg)",
        needed_rad.to_degrees(), limit_rad.to_degrees(), alpha_rad.to_degrees()
    )]
    SurfaceLimit {
        /// Name of the surface that would have to go beyond its limit.
        surface: &'static str,
        /// Deflection that steady flight would need, rad.
        needed_rad: f64,
        /// Largest deflection to this side, rad; negative where the surface does not reach its middle.
        limit_rad: f64,
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
    },
    /// The equilibrium lies where the aircraft has no data.
    #[error(
        "trim: the only equilibrium found is at an angle of attack of {:.2} deg, the data are good from {:.2} to {:.2} deg",
        alpha_rad.to_degrees(), lowest_rad.to_degrees(), highest_rad.to_degrees()
    )]
    OutsideData {
        /// Angle of attack of the equilibrium, rad.
        alpha_rad: f64,
        /// Lowest angle of attack allowed, rad.
        lowest_rad: f64,
        /// Highest angle of attack allowed, rad.
        highest_rad: f64,
    },
    /// The condition lies where the aircraft has no data.
    #[error(
        "trim: {quantity} {value:.4}: the data of the aircraft go from {lowest} to {highest}; trim within, or extend its tables"
    )]
    OutsideTables {
        /// The quantity and its unit.
        quantity: &'static str,
        /// Its value in the condition.
        value: f64,
        /// The lowest that there are data for.
        lowest: f64,
        /// The highest.
        highest: f64,
    },
    /// Too slow for the flight path: not even the best angle of attack carries the aircraft.
    #[error(
        "trim: not enough lift: the flight path needs a load factor of {needed:.2}, the most there is at this speed and \
         altitude up to the highest angle of attack allowed is {available:.2} (at {:.1} deg with full thrust and neutral \
         surfaces); fly faster, lower, or turn less", alpha_rad.to_degrees()
    )]
    NotEnoughLift {
        /// Load factor across the flight path that is needed.
        needed: f64,
        /// Largest load factor across the flight path in the range of angle of attack, thrust included.
        available: f64,
        /// Angle of attack of the largest load factor, rad.
        alpha_rad: f64,
    },
    /// No equilibrium was found from any start.
    #[error(
        "trim: no equilibrium found: the best of {starts} starts leaves {equation} = {residual:.3e} at an angle of attack \
         of {:.2} deg", alpha_rad.to_degrees()
    )]
    NoConvergence {
        /// Number of starting points that were tried.
        starts: usize,
        /// The equation with the largest residual.
        equation: &'static str,
        /// Its residual: accelerations over gravity, the others in rad/s, rad/s^2, or sine of an angle.
        residual: f64,
        /// Angle of attack reached, rad.
        alpha_rad: f64,
    },
}
