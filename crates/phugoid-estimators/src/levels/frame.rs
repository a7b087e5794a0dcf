//! What the estimator has seen of a frame, from which the noise levels are learnt.

/// What the estimator has seen of one frame: its linearisation and residuals before the frame corrected it.
#[derive(Clone, Copy, Debug)]
pub struct Frame<const N: usize, const R: usize> {
    pub(crate) time_s: f64,
    /// `A`, over the interval that the frame ends.
    pub(crate) transition: [[f64; N]; N],
    /// `H`.
    pub(crate) state_jacobian: [[f64; N]; R],
    /// `y - h`, output units. NaN where missing.
    pub(crate) residual: [f64; R],
    /// `w`, what the unknown parameters add to the predicted variance, output units squared.
    pub(crate) taught: [f64; R],
    /// True for a row that still teaches the parameters more than they know.
    pub(crate) teaches: [bool; R],
    /// True after parameters were opened again for a change.
    pub(crate) reopened: bool,
    /// Normalised surface `xi`. NaN where missing.
    pub(crate) normalised: [f64; R],
    /// `U dtheta - dx`: by which the learning filter departs from the corrected state of the estimator.
    pub(crate) step: [f64; N],
}

impl<const N: usize, const R: usize> Frame<N, R> {
    pub(crate) const EMPTY: Self = Self {
        time_s: f64::NAN,
        transition: identity(),
        state_jacobian: [[0.0; N]; R],
        residual: [f64::NAN; R],
        taught: [0.0; R],
        teaches: [false; R],
        reopened: false,
        normalised: [f64::NAN; R],
        step: [0.0; N],
    };

    /// The frame of this time, with no row seen yet.
    pub(crate) fn begin(&mut self, time_s: f64) {
        self.time_s = time_s;
        self.residual = [f64::NAN; R];
        self.normalised = [f64::NAN; R];
        self.step = [0.0; N];
    }

    /// No time passes before the next frame.
    pub(crate) fn stand_still(&mut self) {
        self.transition = identity();
    }

    /// Notes a row before it is used: its Jacobian, `y - h`, the variance `s` that it has given the parameters, `1 + v`
    /// and its normalised surface.
    #[inline]
    pub(crate) fn see(&mut self, output: usize, h: &[f64; N], residual: f64, s: f64, one_plus_v: f64, xi: f64) {
        self.state_jacobian[output] = *h;
        self.residual[output] = residual;
        self.taught[output] = s * (one_plus_v - 1.0);
        self.teaches[output] = one_plus_v >= 2.0;
        self.normalised[output] = xi;
    }
}

const fn identity<const N: usize>() -> [[f64; N]; N] {
    let mut out = [[0.0; N]; N];
    let mut k = 0;
    while k < N {
        out[k][k] = 1.0;
        k += 1;
    }
    out
}
