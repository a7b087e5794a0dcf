//! The speed and the pitch at which a propeller takes the power that its engine gives.

use super::piston::Air;
use super::propeller::{Inflow, Power, Propeller, Rows, Running, Taking, Work};

/// Speeds are found to this part of a turn per minute, a power of two, so that what is found does not depend on where the
/// search began.
const GRAIN: f64 = 1.0 / (1_u64 << 35) as f64;
/// Distance from the balance times that of the points of a line, over the speed, for the line to stand for the curve.
const NEAR: f64 = 1e-3 * GRAIN;
/// Share of the grain that the error of such a line is far below.
const MARGIN: f64 = 0.05;
/// Parts of the range of speeds that are looked at in turn.
const STEPS: u32 = 100;

/// Where the balance was last, to begin the next search from: turns per minute, and the change of the power to spare with it.
/// It makes the search shorter and does not change what is found.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::jsbsim) struct Guess {
    found: Option<[f64; 2]>,
    /// Rows of the tables.
    pub(super) rows: Rows,
}

/// An engine at a throttle from 0 to 1 in some air.
#[derive(Debug)]
pub(super) struct Engine<'a> {
    running: Running<'a>,
    most_rpm: f64,
    /// As [`Power::constant_loss`].
    loss: Option<f64>,
}

impl<'a> Engine<'a> {
    /// `factor` as in [`Power::running`].
    pub(super) fn new(power: &'a Power, throttle: f64, factor: f64, air: &Air) -> Self {
        Self {
            running: power.running(throttle, factor, air),
            most_rpm: power.most_rpm(),
            loss: power.constant_loss(throttle),
        }
    }

    /// One that gives the same power, foot pounds per second and not negative, at every speed up to `most_rpm`.
    pub(super) fn of_power(power: f64, most_rpm: f64) -> Self {
        Self { running: Running::Constant(power), most_rpm, loss: Some(0.0) }
    }
}

/// A propeller of a pitch with its engine.
struct Turning<'a> {
    propeller: &'a Propeller,
    inflow: &'a Inflow,
    engine: &'a Engine<'a>,
    taking: Taking<'a>,
    /// Speed that it is not above, turns per minute.
    most: f64,
}

impl Propeller {
    /// The work at which engine and propeller are in balance. `lever` from 0 to 1 asks for a speed between the least and the most.
    pub(super) fn balance(&self, inflow: &Inflow, engine: &Engine<'_>, lever: f64, guess: &mut Guess) -> Work {
        let [fine, coarse] = self.pitch_deg;
        let free = |pitch_deg: f64, most: f64, guess: &mut Guess| {
            let turning =
                Turning { propeller: self, inflow, engine, taking: self.taking(inflow, pitch_deg, guess.rows), most };
            let rpm = turning.free_rpm(guess);
            turning.taking.work(rpm, &mut guess.rows)
        };
        if self.constant_speed && fine < coarse {
            let wanted = self.rpm[0] + (self.rpm[1] - self.rpm[0]) * lever.clamp(0.0, 1.0);
            if wanted > 0.0 {
                let given = engine.running.at(wanted * self.gear);
                let rows = guess.rows;
                let surplus = |pitch: f64| given - self.taking(inflow, pitch, rows).at(wanted);
                if surplus(fine) <= 0.0 {
                    return free(fine, wanted, guess);
                }
                if surplus(coarse) >= 0.0 {
                    return free(coarse, 1.2 * wanted, guess);
                }
                let pitch = self.balanced_pitch(surplus);
                return self.taking(inflow, pitch, rows).work(wanted, &mut guess.rows);
            }
        }
        free(fine, engine.most_rpm / self.gear, guess)
    }

    /// The pitch at which there is no power to spare, of which there is some at the finest and none at the coarsest.
    fn balanced_pitch(&self, surplus: impl Fn(f64) -> f64) -> f64 {
        let [mut low, mut high] = self.pitch_deg;
        let Some((_, columns, _)) = self.power.flat() else {
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                *(if surplus(middle) > 0.0 { &mut low } else { &mut high }) = middle;
            }
            return low;
        };
        // Between two columns the power that is taken is linear in the pitch.
        let [start, end] = [low, high].map(|end| columns.partition_point(|&column| column <= end));
        let mut inside = columns[start..end].iter().copied().filter(|&column| column < self.pitch_deg[1]);
        if let Some(above) = inside.find(|&column| {
            let spare = surplus(column) > 0.0;
            if spare {
                low = column;
            }
            !spare
        }) {
            high = above;
        }
        let [above, below] = [low, high].map(surplus);
        low + (high - low) * (above / (above - below))
    }
}

impl Turning<'_> {
    fn given(&self, rpm: f64) -> f64 {
        self.engine.running.at(rpm * self.propeller.gear)
    }

    fn taken(&self, rpm: f64) -> f64 {
        self.taking.at(rpm)
    }

    fn surplus(&self, rpm: f64) -> f64 {
        self.given(rpm) - self.taken(rpm)
    }

    /// The highest speed below the bound at which there is no power to spare; 0 where there is none at any speed.
    fn free_rpm(&self, guess: &mut Guess) -> f64 {
        let found = guess.found.and_then(|found| self.from(found));
        let found = found.or_else(|| {
            let rpm = self.searched()?;
            let beside = rpm - 1e-4 * self.most;
            Some([rpm, (self.surplus(rpm) - self.surplus(beside)) / (rpm - beside)])
        });
        guess.found = found;
        found.map_or(0.0, |[rpm, _]| rpm)
    }

    /// The speed found by looking at all speeds from the highest down.
    fn searched(&self) -> Option<f64> {
        let step = self.most / f64::from(STEPS);
        let below = (1..=STEPS).rev().map(|k| f64::from(k) * step).find(|&rpm| self.surplus(rpm) > 0.0)?;
        if below >= self.most {
            return Some(self.most);
        }
        let high = (below + step).min(self.most);
        // Between points of the grain: the last with power to spare.
        let (mut low, mut high) = ((below / GRAIN).floor(), (high / GRAIN).ceil());
        while high - low > 1.0 {
            let middle = (0.5 * (low + high)).floor();
            *(if self.surplus(middle * GRAIN) > 0.0 { &mut low } else { &mut high }) = middle;
        }
        Some(low * GRAIN)
    }

    /// The speed found from one that was found before, with the new slope; none where it is not near, or where it is not certain
    /// that there is no higher one.
    fn from(&self, [before, slope]: [f64; 2]) -> Option<[f64; 2]> {
        let (mut rpm, mut surplus, mut slope) = (before, self.surplus(before), slope);
        for _ in 0..6 {
            let next = rpm - surplus / slope;
            let low = (next / GRAIN).floor() * GRAIN;
            if !((next - rpm).abs() < 0.02 * self.most && low > 0.0 && low < self.most) {
                return None;
            }
            let (given, taken) = (self.given(low), self.taken(low));
            let here = given - taken;
            let slope_before = slope;
            if low != rpm {
                slope = (here - surplus) / (low - rpm);
            }
            // A line through the last two differs from the curve by a share of their distance, unless there is a kink between.
            let off = (here / slope).abs();
            if off * (low - rpm).abs() <= NEAR * rpm && (slope - slope_before).abs() <= 2e-3 * slope.abs() {
                let rpm = self.last_grain(low, here, slope)?;
                return self.none_above(rpm, given, taken).then_some([rpm, slope]);
            }
            (rpm, surplus) = (low, here);
        }
        None
    }

    /// The last point of the grain with power to spare, from the power to spare at one near it and the slope.
    fn last_grain(&self, near: f64, surplus: f64, slope: f64) -> Option<f64> {
        const TRIED: u32 = 16;
        let crossing = (near - surplus / slope) / GRAIN;
        let low = crossing.floor();
        if (MARGIN..=1.0 - MARGIN).contains(&(crossing - low)) {
            return Some(low * GRAIN);
        }
        // The crossing is beside a point of the grain, where only the power to spare tells on which side.
        let mut grain = crossing.round();
        let mut spare = self.surplus(grain * GRAIN) > 0.0;
        for _ in 0..TRIED {
            let next = if spare { grain + 1.0 } else { grain - 1.0 };
            let next_spare = self.surplus(next * GRAIN) > 0.0;
            if spare != next_spare {
                return Some(grain.min(next) * GRAIN);
            }
            (grain, spare) = (next, next_spare);
        }
        None
    }

    /// Whether it is certain that nowhere between a speed of balance and the bound there is power to spare, from the powers beside
    /// the balance.
    ///
    /// At `x` times the speed, `x >= 1`, the engine gives no more than `x (given + loss) - loss`, and the propeller takes no less
    /// than `x^3` times what it takes now where no coefficient in between is less than that of now.
    fn none_above(&self, rpm: f64, given: f64, taken: f64) -> bool {
        let propeller = self.propeller;
        let Some(loss) = self.engine.loss else { return false };
        let advances = [self.most, rpm].map(|rpm| propeller.advance(self.inflow, rpm));
        // Then it takes more than the engine gives from here on, because it does so where x begins to rise.
        propeller.power_mach.is_none()
            && propeller.factors[1] >= 0.0
            && 3.0 * taken > 1.001 * (given + loss)
            && advances[0] <= advances[1]
            && self.taking.is_least_at_end(advances)
    }
}
