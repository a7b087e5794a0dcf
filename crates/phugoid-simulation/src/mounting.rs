//! What sensors feel that are not at the centre of gravity.

use phugoid_flight_data::record::Record;

use crate::scenario::Sensors;

/// The true channels that are different where their sensors are: accelerometers feel the rotation,
/// `a = a_cg + w' x r + w x (w x r)`, vanes the air relative to `v + w x r` (Klein & Morelli, Aircraft System
/// Identification, section 10.1).
pub(crate) fn at_the_sensors(truth: &Record, sensors: &Sensors) -> Vec<(&'static str, Vec<f64>)> {
    let position = |p: &[crate::quantity::Length; 3]| p.map(crate::quantity::Length::si);
    let mut moved = Vec::new();
    let accelerometers = position(&sensors.accelerometers);
    if accelerometers != [0.0; 3]
        && let (Some(rates), Some(changes), Some(forces)) = (
            channels(truth, ["p", "q", "r"]),
            channels(truth, ["pdot", "qdot", "rdot"]),
            channels(truth, ["ax", "ay", "az"]),
        )
    {
        let felt = (0..truth.time.len()).map(|k| {
            let at = |c: &[&[f64]; 3]| c.map(|values| values[k]);
            let (w, w_dot) = (at(&rates), at(&changes));
            let (turning, whirling) = (cross(w_dot, accelerometers), cross(w, cross(w, accelerometers)));
            let force = at(&forces);
            std::array::from_fn::<f64, 3, _>(|i| force[i] + turning[i] + whirling[i])
        });
        let felt: Vec<[f64; 3]> = felt.collect();
        for (i, name) in ["ax", "ay", "az"].into_iter().enumerate() {
            moved.push((name, felt.iter().map(|f| f[i]).collect()));
        }
    }
    let vanes = position(&sensors.vanes);
    if vanes != [0.0; 3]
        && let (Some(rates), Some(air)) =
            (channels(truth, ["p", "q", "r"]), channels(truth, ["true_airspeed", "alpha", "beta"]))
    {
        let felt = (0..truth.time.len()).map(|k| {
            let [speed, alpha, beta] = air.map(|values| values[k]);
            let v = [speed * alpha.cos() * beta.cos(), speed * beta.sin(), speed * alpha.sin() * beta.cos()];
            let turning = cross(rates.map(|values| values[k]), vanes);
            let [u, v, w]: [f64; 3] = std::array::from_fn(|i| v[i] + turning[i]);
            (w.atan2(u), v.atan2(u.hypot(w)))
        });
        let (alpha, beta): (Vec<f64>, Vec<f64>) = felt.unzip();
        moved.push(("alpha", alpha));
        moved.push(("beta", beta));
    }
    moved
}

fn channels<'a>(record: &'a Record, names: [&str; 3]) -> Option<[&'a [f64]; 3]> {
    let [a, b, c] = names.map(|name| record.channel(name).map(|channel| channel.values.as_slice()));
    Some([a?, b?, c?])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use crate::flight::fly;
    use crate::scenario::Scenario;

    const CALM: &str = include_str!("../../../scenarios/f16-calm.toml");

    /// In symmetric flight: `az = az_cg - qdot x - q^2 z`, `ax = ax_cg + qdot z - q^2 x`, and a vane ahead of the centre of
    /// gravity sees `alpha - q x/V` (small angles).
    #[test]
    fn sensors_ahead_feel_the_pitching() {
        let text = CALM.replace(
            "[sensors]",
            "[sensors]\naccelerometers = [\"2 m\", \"0 m\", \"0.5 m\"]\nvanes = [\"5 m\", \"0 m\", \"0 m\"]",
        );
        let text: String = text.lines().filter(|l| !l.contains("noise")).collect::<Vec<_>>().join("\n");
        let flight = fly(&Scenario::parse(&text, "x").unwrap()).unwrap();
        let truth = |name: &str| &flight.truth.channel(name).unwrap().values;
        let measured = |name: &str| &flight.measured.channel(name).unwrap().values;
        let mut largest = 0.0_f64;
        for k in 0..flight.truth.time.len() {
            let (q, q_dot, v) = (truth("q")[k], truth("qdot")[k], truth("true_airspeed")[k]);
            // The engine's rotor turns pitching into a little roll and yaw; their squares are left out here.
            assert!((measured("az")[k] - (truth("az")[k] - q_dot * 2.0 - q * q * 0.5)).abs() < 1e-4);
            assert!((measured("ax")[k] - (truth("ax")[k] + q_dot * 0.5 - q * q * 2.0)).abs() < 1e-4);
            // Second order in q x/V: at most 3 (0.1 rad/s 5 m/206 m/s)^2 and as much with alpha.
            assert!((measured("alpha")[k] - (truth("alpha")[k] - q * 5.0 / v)).abs() < 1e-4);
            largest = largest.max((measured("alpha")[k] - truth("alpha")[k]).abs());
        }
        assert!(largest > 5e-4, "the manoeuvre pitches by more than 0.02 rad/s: {largest}");
    }
}
