/// What the one-parameter law looks like from inside after one sample: what a figure of the reaching condition needs.
///
/// Energies are in scaled channel units squared, `parameter` stands for the unit of the unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// `E = sum (y^2 - ym^2)/2`.
    pub energy: f64,
    /// `s = E + lambda * integral of E`. The sliding surface is `s = 0`.
    pub surface: f64,
    /// `sdot = D + lambda E` with the estimate that holds from this sample on, 1/s.
    pub surface_rate: f64,
    /// `s sdot + eta |s|`: the reaching condition `s sdot <= -eta |s|` holds where this is not positive.
    pub reaching: f64,
    /// `K = |theta (1/alpha - 1) z| - eta`, the printed gain. The other forms do not use it.
    pub gain: f64,
    /// `|theta (1/alpha - 1) z| + eta`: what the gain of a switching law with the thesis's bound on the mismatch has to
    /// exceed for the reaching condition. The printed gain lies `2 eta` below it.
    pub required_gain: f64,
    /// Largest `|(theta_true - theta) z|` for a true parameter inside the bounds: the rate of the surface that the unknown
    /// can cause, 1/s.
    pub mismatch: f64,
    /// `K D + eta`, denominator of the printed law. The law has no value where it vanishes.
    pub denominator: f64,
    /// `z = dD/dtheta`. Zero: the surface says nothing about the parameter.
    pub slope: f64,
}
