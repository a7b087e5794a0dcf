//! The speed and the pitch at which a propeller takes the power that its engine gives.

use super::piston::Air;
use super::propeller::{Inflow, Power, Propeller, Work};

/// Speeds are found to this part of a turn per minute, a power of two, so that what is found does not depend on where the
/// search began.
const GRAIN: f64 = 1.0 / (1_u64 << 35) as f64;
/// Parts of the range of speeds that are looked at in turn.
const STEPS: u32 = 100;

/// An engine at a throttle from 0 to 1 in some air.
#[derive(Debug, Clone, Copy)]
pub(super) struct Running<'a> {
    pub(super) power: &'a Power,
    pub(super) throttle: f64,
    pub(super) air: Air,
}

/// Where the balance was last, to begin the next search from: turns per minute, and the change of the power to spare with it.
/// It makes the search shorter and does not change what is found.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::jsbsim) struct Guess {
    found: Option<[f64; 2]>,
}

/// A propeller of a pitch with its engine.
struct Turning<'a> {
    propeller: &'a Propeller,
    inflow: &'a Inflow,
    engine: &'a Running<'a>,
    pitch_deg: f64,
    /// Speed that it is not above, turns per minute.
    most: f64,
}

impl Propeller {
    /// The work at which engine and propeller are in balance. `lever` from 0 to 1 asks for a speed between the least and the most.
    pub(super) fn balance(&self, inflow: &Inflow, engine: &Running<'_>, lever: f64, guess: &mut Guess) -> Work {
        let [fine, coarse] = self.pitch_deg;
        let free = |pitch_deg: f64, most: f64, guess: &mut Guess| {
            let turning = Turning { propeller: self, inflow, engine, pitch_deg, most };
            self.at(inflow, turning.free_rpm(guess), pitch_deg)
        };
        if self.constant_speed && fine < coarse {
            let wanted = self.rpm[0] + (self.rpm[1] - self.rpm[0]) * lever.clamp(0.0, 1.0);
            if wanted > 0.0 {
                let given = engine.power.at(engine.throttle, wanted * self.gear, &engine.air);
                let surplus = |pitch: f64| given - self.taken(inflow, wanted, pitch);
                if surplus(fine) <= 0.0 {
                    return free(fine, wanted, guess);
                }
                if surplus(coarse) >= 0.0 {
                    return free(coarse, 1.2 * wanted, guess);
                }
                return self.at(inflow, wanted, self.balanced_pitch(surplus));
            }
        }
        free(fine, engine.power.most_rpm() / self.gear, guess)
    }

    /// Power that it takes at a speed and a pitch, foot pounds per second.
    fn taken(&self, inflow: &Inflow, rpm: f64, pitch_deg: f64) -> f64 {
        self.torque_ft_lb(inflow, rpm, pitch_deg) * rpm / 60.0 * 2.0 * std::f64::consts::PI
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
        self.engine.power.at(self.engine.throttle, rpm * self.propeller.gear, &self.engine.air)
    }

    fn taken(&self, rpm: f64) -> f64 {
        self.propeller.taken(self.inflow, rpm, self.pitch_deg)
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
            let near = (next - rpm).abs() < 0.02 * self.most;
            if !near {
                return None;
            }
            let grain = (next / GRAIN).floor();
            let low = grain * GRAIN;
            if !(low > 0.0 && low < self.most) {
                return None;
            }
            let here = self.surplus(low);
            if low != rpm {
                slope = (here - surplus) / (low - rpm);
            }
            // As good as it gets when the power to spare is what a few grains change.
            if here.abs() <= 4.0 * GRAIN * slope.abs() {
                return self.last_grain(grain, here).map(|rpm| [rpm, slope]);
            }
            (rpm, surplus) = (low, here);
        }
        None
    }

    /// The last point of the grain with power to spare, from one beside it; none where there may be a higher one.
    fn last_grain(&self, mut grain: f64, surplus: f64) -> Option<f64> {
        const TRIED: u32 = 16;
        let mut spare = surplus > 0.0;
        for _ in 0..TRIED {
            let next = if spare { grain + 1.0 } else { grain - 1.0 };
            let high = grain.max(next) * GRAIN;
            let (given, taken) = (self.given(next * GRAIN), self.taken(next * GRAIN));
            let next_spare = given - taken > 0.0;
            if spare != next_spare {
                return self.none_above(high).then_some(grain.min(next) * GRAIN);
            }
            (grain, spare) = (next, next_spare);
        }
        None
    }

    /// Whether it is certain that nowhere between a speed without power to spare and the bound there is some.
    ///
    /// At `x` times the speed, `x >= 1`, the engine gives no more than `x (given + loss) - loss`, and the propeller takes no less
    /// than `x^3` times what it would with the least coefficient in between.
    fn none_above(&self, rpm: f64) -> bool {
        let propeller = self.propeller;
        let Some(loss) = self.engine.power.constant_loss(self.engine.throttle) else { return false };
        if propeller.power_mach.is_some() || propeller.factors[1] < 0.0 {
            return false;
        }
        let advances = [self.most, rpm].map(|rpm| propeller.advance(self.inflow, rpm));
        if advances[0] > advances[1] {
            return false;
        }
        let Some(least) = propeller.power.least(advances, self.pitch_deg) else { return false };
        let here = propeller.power.value([advances[1], self.pitch_deg, 0.0]);
        let (given, taken) = (self.given(rpm), self.taken(rpm));
        // What is taken with the coefficient of now is in proportion to it.
        let taken = if least < here { taken * (least / here) } else { taken };
        let excess = |x: f64| x * x * x * taken - x * (given + loss) + loss;
        if !(taken >= 0.0 && excess(1.0) >= 0.0) {
            return false;
        }
        // Convex in x: its least value is where it does not change, or at an end.
        let flat = ((given + loss).max(0.0) / (3.0 * taken)).sqrt();
        flat <= 1.0 || excess(flat.min(self.most / rpm)) >= 0.0
    }
}
