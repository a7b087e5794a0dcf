//! Settings of the search for manoeuvres.

/// Settings of the search ([`find`](super::find)). The defaults suit aircraft from small drones to airliners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Time without motion that is wanted before an input, s; the deflections of the input count from the level there.
    pub lead_s: f64,
    /// Time that the aircraft is given to settle after an input, s; inputs less than this apart are one manoeuvre.
    pub settling_s: f64,
    /// A surface that comes back to where it was within this time, s, was held: a long pulse, not two steps.
    pub held_s: f64,
    /// A surface moves where it travels by this many sigmas of its noise within [`Self::window_s`].
    pub sigmas: f64,
    /// Window of the travel, s; at least three samples.
    pub window_s: f64,
    /// The aircraft answered where an angle or a rate has at least this rms over its noise.
    pub signal_to_noise: f64,
    /// Lowest airspeed that counts as flight, m/s.
    pub slowest_m_s: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            lead_s: 1.0,
            settling_s: 2.0,
            held_s: 20.0,
            sigmas: 10.0,
            window_s: 0.4,
            signal_to_noise: 5.0,
            slowest_m_s: 5.0,
        }
    }
}
