//! Fuel, and what the body of an aircraft becomes as it is burnt.

use crate::mass::MassProperties;

/// The body of an aircraft that has burnt some of its fuel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Burnt {
    /// Mass and inertia about the centre of gravity that the aircraft has now.
    pub mass: MassProperties,
    /// How far the centre of gravity has moved aft, mean chords.
    pub shift: f64,
    /// Fuel that is left, kg. Without any the engines do not run: the aircraft has neither thrust nor torque.
    pub left: f64,
}

/// Fuel of an aircraft in one place: what the body becomes as it is burnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fuel {
    /// Fuel at the beginning, kg, which is part of the mass of the aircraft.
    pub mass: f64,
    /// How far its centre is aft of the centre of gravity that the aircraft has at the beginning, m.
    pub aft: f64,
    /// Moments of inertia of the fuel at the beginning about its own centre, body x, y and z, kg m^2. They shrink with its mass.
    pub inertia: [f64; 3],
}

impl Fuel {
    /// The body when `burnt` kg are burnt (not below 0, not above all), of an aircraft that at the beginning has these mass properties
    /// and mean chord (m). `None` where what is left is no body: the fuel is heavier, or has more inertia, than the aircraft.
    ///
    /// By the parallel axes, with the burnt mass `b` at the distance `d` from the centre of gravity of the beginning: the mass is
    /// `m - b`, the centre of gravity has moved aft by `s = -b d/(m - b)`, and about body y and z the inertia has lost that of the fuel
    /// itself, `b d^2` and `(m - b) s^2`.
    pub fn burnt(&self, burnt: f64, whole: &MassProperties, mean_chord: f64) -> Option<Burnt> {
        // `f64::clamp` panics where its limits are no numbers.
        let burnt = burnt.max(0.0).min(self.mass.max(0.0));
        let mass = whole.mass() - burnt;
        let part = if self.mass > 0.0 { burnt / self.mass } else { 0.0 };
        let aft = -burnt * self.aft / mass;
        let across = burnt * self.aft * self.aft + mass * aft * aft;
        let mut tensor = whole.inertia_tensor();
        let [x, y, z] = self.inertia;
        for (axis, lost) in [part * x, part * y + across, part * z + across].into_iter().enumerate() {
            tensor[axis][axis] -= lost;
        }
        let mass = MassProperties::from_tensor(mass, tensor, whole.rotor_momentum())?;
        Some(Burnt { mass, shift: aft / mean_chord, left: self.mass - burnt })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two points of 1000 kg each, 2 m ahead and 2 m aft of the middle. The one aft is fuel: without it the one ahead is left.
    #[test]
    fn what_is_left_is_the_other_part() {
        let own = 50.0;
        let tensor = [[2.0 * own, 0.0, 0.0], [0.0, 8000.0 + 2.0 * own, 0.0], [0.0, 0.0, 8000.0 + 2.0 * own]];
        let whole = MassProperties::from_tensor(2000.0, tensor, 0.0).unwrap();
        let fuel = Fuel { mass: 1000.0, aft: 2.0, inertia: [own; 3] };
        let all = fuel.burnt(1000.0, &whole, 4.0).unwrap();
        assert!((all.mass.mass() - 1000.0).abs() < 1e-9 && all.left == 0.0);
        assert!((all.shift + 0.5).abs() < 1e-12, "2 m ahead are half a chord: {}", all.shift);
        for axis in 0..3 {
            assert!((all.mass.inertia_tensor()[axis][axis] - own).abs() < 1e-6, "{axis}");
        }
        assert_eq!(fuel.burnt(5000.0, &whole, 4.0), Some(all));
        // Half of it: 500 kg at +2 m and 1000 kg at -2 m have their centre at -2/3 m.
        let half = fuel.burnt(500.0, &whole, 4.0).unwrap();
        assert!((half.shift * 4.0 + 2.0 / 3.0).abs() < 1e-12);
        let expected = 1.5 * own + 500.0 * (8.0_f64 / 3.0).powi(2) + 1000.0 * (4.0_f64 / 3.0).powi(2);
        assert!((half.mass.inertia_tensor()[1][1] - expected).abs() < 1e-6);
        assert!(Fuel { mass: 2000.0, ..fuel }.burnt(2000.0, &whole, 4.0).is_none());
        assert!(Fuel { inertia: [500.0; 3], ..fuel }.burnt(1000.0, &whole, 4.0).is_none());
    }
}
