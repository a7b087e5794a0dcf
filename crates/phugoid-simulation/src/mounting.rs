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
