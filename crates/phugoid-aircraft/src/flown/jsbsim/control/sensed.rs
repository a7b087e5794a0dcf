//! What flight control senses of the motion, and the properties of JSBSim that tell it.

use crate::jsbsim::{Aircraft, Evaluator, FlightCondition};

/// The properties of the stick and the pedals, in the order of the surfaces, from -1 to 1.
pub(crate) const STICKS: [&str; 3] = ["fcs/elevator-cmd-norm", "fcs/aileron-cmd-norm", "fcs/rudder-cmd-norm"];
/// Metres in a foot, and in an inch.
const FOOT: f64 = 0.3048;
const INCH: f64 = 0.0254;
/// Standard gravity, by which JSBSim makes load factors of accelerations, m/s2.
const STANDARD_GRAVITY: f64 = 9.806_65;

/// What flight control senses of the motion at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensed {
    /// Motion through the air with its gusts, and the air itself. The rates are those of gyroscopes, and what channels read of the
    /// velocity over the ground is that of [`velocity_m_s`](Self::velocity_m_s).
    pub flight: FlightCondition,
    /// Velocity over the ground: north, east, down, m/s.
    pub velocity_m_s: [f64; 3],
    /// Specific force at the centre of gravity, body axes, m/s2: what accelerometers feel, -9.81 along z in level flight.
    pub specific_force_m_s2: [f64; 3],
    /// Angular acceleration about the body axes, rad/s2.
    pub angular_acceleration_rad_s2: [f64; 3],
    /// Lift over weight, 1 in level flight.
    pub lift_over_weight: f64,
    /// Throttle, 0 to 1.
    pub throttle: f64,
}

/// Quantities that a flight condition does not have; axes of the body, or north, east and down.
#[derive(Clone, Copy, Debug)]
enum Quantity {
    /// Specific force at the centre of gravity over gravity, with a sign.
    Load(usize, f64),
    /// Specific force at the eyes of the pilot, ft/s2, and over gravity.
    PilotForce(usize),
    PilotLoad(usize),
    LiftOverWeight,
    /// Rate of the components of the velocity over the ground.
    VelocityRate(usize),
    AngularAcceleration(usize),
    /// Velocity over the ground in body axes, and in those of the earth, with a sign, ft/s.
    BodyVelocity(usize),
    GroundVelocity(usize, f64),
    GroundSpeed,
    Speed,
    /// Angle of the path above the horizon times a factor.
    Climb(f64),
}

use Quantity::{
    AngularAcceleration, BodyVelocity, Climb, GroundSpeed, GroundVelocity, LiftOverWeight, Load, PilotForce, PilotLoad,
    Speed, VelocityRate,
};

#[rustfmt::skip]
const QUANTITIES: [(&str, Quantity); 33] = [
    ("accelerations/Nx", Load(0, 1.0)), ("accelerations/Ny", Load(1, 1.0)), ("accelerations/Nz", Load(2, -1.0)),
    ("accelerations/a-pilot-x-ft_sec2", PilotForce(0)), ("accelerations/a-pilot-y-ft_sec2", PilotForce(1)),
    ("accelerations/a-pilot-z-ft_sec2", PilotForce(2)),
    ("accelerations/n-pilot-x-norm", PilotLoad(0)), ("accelerations/n-pilot-y-norm", PilotLoad(1)),
    ("accelerations/n-pilot-z-norm", PilotLoad(2)),
    ("forces/load-factor", LiftOverWeight),
    ("accelerations/udot-ft_sec2", VelocityRate(0)), ("accelerations/vdot-ft_sec2", VelocityRate(1)),
    ("accelerations/wdot-ft_sec2", VelocityRate(2)),
    ("accelerations/uidot-ft_sec2", VelocityRate(0)), ("accelerations/vidot-ft_sec2", VelocityRate(1)),
    ("accelerations/widot-ft_sec2", VelocityRate(2)),
    ("accelerations/pdot-rad_sec2", AngularAcceleration(0)), ("accelerations/qdot-rad_sec2", AngularAcceleration(1)),
    ("accelerations/rdot-rad_sec2", AngularAcceleration(2)),
    ("accelerations/pidot-rad_sec2", AngularAcceleration(0)), ("accelerations/qidot-rad_sec2", AngularAcceleration(1)),
    ("accelerations/ridot-rad_sec2", AngularAcceleration(2)),
    ("velocities/u-fps", BodyVelocity(0)), ("velocities/v-fps", BodyVelocity(1)), ("velocities/w-fps", BodyVelocity(2)),
    ("velocities/v-north-fps", GroundVelocity(0, 1.0)), ("velocities/v-east-fps", GroundVelocity(1, 1.0)),
    ("velocities/v-down-fps", GroundVelocity(2, 1.0)), ("velocities/h-dot-fps", GroundVelocity(2, -1.0)),
    ("velocities/vg-fps", GroundSpeed), ("velocities/ned-velocity-mag-fps", Speed),
    ("flight-path/gamma-rad", Climb(1.0)), ("flight-path/gamma-deg", Climb(180.0 / std::f64::consts::PI)),
];

/// Whether a property is one of these.
pub(crate) fn is_sensed(name: &str) -> bool {
    QUANTITIES.iter().any(|(sensed, _)| *sensed == name)
}

/// Where the properties are that are written before channels run.
#[derive(Clone, Debug)]
pub(super) struct Written {
    quantities: Vec<(usize, Quantity)>,
    /// The properties of the eyes of the pilot in the structural frame, inches; where the files do not say, its origin.
    eyes: [Option<usize>; 3],
    /// Commands of the throttles.
    throttles: Vec<usize>,
    /// Positions of the throttles of engines that push, with the most of each.
    positions: Vec<(usize, f64)>,
    gravity_m_s2: f64,
    /// Whether channels read forces, or what engines do.
    forces: bool,
}

impl Written {
    pub(super) fn new(aircraft: &Aircraft, gravity_m_s2: f64, positions: Vec<usize>, most: Vec<f64>) -> Self {
        let read = aircraft.channels_read();
        let quantities = QUANTITIES.iter().filter_map(|(name, quantity)| {
            let index = aircraft.property(name)?;
            read[index].then_some((index, *quantity))
        });
        let command = |number: usize| aircraft.property(&format!("fcs/throttle-cmd-norm[{number}]"));
        let engines = aircraft.engines().len();
        Self {
            quantities: quantities.collect(),
            eyes: ["x", "y", "z"].map(|axis| aircraft.property(&format!("metrics/eyepoint-{axis}-in"))),
            throttles: (0..engines.max(1)).filter_map(command).collect(),
            positions: positions.into_iter().zip(most).collect(),
            gravity_m_s2,
            forces: read.iter().enumerate().any(|(index, read)| *read && aircraft.follows_forces(index)),
        }
    }

    /// Writes what is sensed at an instant.
    pub(super) fn write(&self, evaluator: &mut Evaluator<'_>, sensed: &Sensed) {
        evaluator.set_flight(&sensed.flight);
        for &command in &self.throttles {
            evaluator.set_index(command, sensed.throttle);
        }
        for &(position, most) in &self.positions {
            evaluator.set_index(position, sensed.throttle * most);
        }
        let known = Known::new(sensed, self.arm_m(evaluator), self.gravity_m_s2);
        for &(index, quantity) in &self.quantities {
            evaluator.set_index(index, known.value(quantity));
        }
        if self.forces {
            evaluator.propulsive_force_moment();
            evaluator.aerodynamic_force_moment();
        }
    }

    /// From the centre of gravity to the eyes of the pilot, body axes, m.
    fn arm_m(&self, evaluator: &mut Evaluator<'_>) -> [f64; 3] {
        let centre = ["x", "y", "z"].map(|axis| evaluator.get(&format!("inertia/cg-{axis}-in")).unwrap_or(0.0));
        let eyes = self.eyes.map(|index| index.and_then(|index| evaluator.get_index(index)).unwrap_or(0.0));
        [centre[0] - eyes[0], eyes[1] - centre[1], centre[2] - eyes[2]].map(|inches| inches * INCH)
    }
}

/// What follows from what is sensed.
struct Known<'a> {
    sensed: &'a Sensed,
    /// Specific force at the eyes of the pilot, m/s2.
    pilot: [f64; 3],
    /// Velocity over the ground in body axes, m/s, and its rate.
    velocity: [f64; 3],
    velocity_rate: [f64; 3],
}

impl<'a> Known<'a> {
    fn new(sensed: &'a Sensed, arm_m: [f64; 3], gravity: f64) -> Self {
        let turn = sensed.flight.rates_rad_s;
        let [along, across] = [cross(sensed.angular_acceleration_rad_s2, arm_m), cross(turn, cross(turn, arm_m))];
        let [phi, theta, psi] = sensed.flight.attitude_rad;
        let ((sphi, cphi), (stheta, ctheta), (spsi, cpsi)) = (phi.sin_cos(), theta.sin_cos(), psi.sin_cos());
        let to_body = |[north, east, down]: [f64; 3]| {
            let (forward, side) = (north * cpsi + east * spsi, east * cpsi - north * spsi);
            let up = forward * stheta + down * ctheta;
            [forward * ctheta - down * stheta, side * cphi + up * sphi, up * cphi - side * sphi]
        };
        let velocity = to_body(sensed.velocity_m_s);
        let (weight, turned) = (to_body([0.0, 0.0, gravity]), cross(turn, velocity));
        let force = sensed.specific_force_m_s2;
        Self {
            sensed,
            pilot: std::array::from_fn(|k| force[k] + along[k] + across[k]),
            velocity,
            velocity_rate: std::array::from_fn(|k| force[k] + weight[k] - turned[k]),
        }
    }

    fn value(&self, quantity: Quantity) -> f64 {
        let sensed = self.sensed;
        let [north, east, down] = sensed.velocity_m_s;
        match quantity {
            Load(axis, sign) => sign * sensed.specific_force_m_s2[axis] / STANDARD_GRAVITY,
            PilotForce(axis) => self.pilot[axis] / FOOT,
            PilotLoad(axis) => self.pilot[axis] / STANDARD_GRAVITY,
            LiftOverWeight => sensed.lift_over_weight,
            VelocityRate(axis) => self.velocity_rate[axis] / FOOT,
            AngularAcceleration(axis) => sensed.angular_acceleration_rad_s2[axis],
            BodyVelocity(axis) => self.velocity[axis] / FOOT,
            GroundVelocity(axis, sign) => sign * sensed.velocity_m_s[axis] / FOOT,
            GroundSpeed => north.hypot(east) / FOOT,
            Speed => north.hypot(east).hypot(down) / FOOT,
            Climb(factor) => factor * (-down).atan2(north.hypot(east)),
        }
    }
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use phugoid_flight_dynamics::atmosphere::Atmosphere;

    use super::*;

    fn sensed(attitude_rad: [f64; 3], velocity_m_s: [f64; 3]) -> Sensed {
        let flight =
            FlightCondition { attitude_rad, ..FlightCondition::axial(100.0, 1000.0, &Atmosphere::Standard.at(1000.0)) };
        Sensed {
            flight,
            velocity_m_s,
            specific_force_m_s2: [0.0, 0.0, -9.806_65],
            angular_acceleration_rad_s2: [0.0; 3],
            lift_over_weight: 1.0,
            throttle: 0.5,
        }
    }

    fn value(sensed: &Sensed, arm_m: [f64; 3], name: &str) -> f64 {
        let quantity = QUANTITIES.iter().find(|(found, _)| *found == name).unwrap().1;
        Known::new(sensed, arm_m, 9.806_65).value(quantity)
    }

    #[test]
    fn velocities_over_the_ground_are_turned_into_the_body() {
        // Eastward on a heading of east; upward along the nose; falling with the right wing down.
        for (attitude, velocity, name) in [
            ([0.0, 0.0, FRAC_PI_2], [0.0, 100.0, 0.0], "velocities/u-fps"),
            ([0.0, 0.2, 0.0], [100.0 * 0.2_f64.cos(), 0.0, -100.0 * 0.2_f64.sin()], "velocities/u-fps"),
            ([FRAC_PI_2, 0.0, 0.0], [0.0, 0.0, 100.0], "velocities/v-fps"),
            ([0.0, -FRAC_PI_2, 0.0], [0.0, 0.0, 100.0], "velocities/u-fps"),
        ] {
            let now = sensed(attitude, velocity);
            for other in ["velocities/u-fps", "velocities/v-fps", "velocities/w-fps"] {
                let expected = if other == name { 100.0 / FOOT } else { 0.0 };
                assert!((value(&now, [0.0; 3], other) - expected).abs() < 1e-12, "{attitude:?} {other}");
            }
        }
        let climbing = sensed([0.0, 0.2, 0.0], [3.0, 4.0, -5.0]);
        assert!((value(&climbing, [0.0; 3], "flight-path/gamma-deg") - 45.0).abs() < 1e-12);
        assert!((value(&climbing, [0.0; 3], "velocities/h-dot-fps") - 5.0 / FOOT).abs() < 1e-12);
    }

    #[test]
    fn load_factors_have_the_signs_of_jsbsim() {
        let mut now = sensed([0.0; 3], [100.0, 0.0, 0.0]);
        assert_eq!(value(&now, [0.0; 3], "accelerations/Nz"), 1.0);
        assert_eq!(value(&now, [0.0; 3], "accelerations/n-pilot-z-norm"), -1.0);
        assert!(value(&now, [0.0; 3], "accelerations/wdot-ft_sec2").abs() < 1e-12);
        // Pitching up at 2 rad/s2, 3 m ahead of the centre of gravity: 6 m/s2 upward more, and at 0.5 rad/s 0.75 m/s2 backward.
        now.angular_acceleration_rad_s2 = [0.0, 2.0, 0.0];
        now.flight.rates_rad_s = [0.0, 0.5, 0.0];
        assert!(
            (value(&now, [3.0, 0.0, 0.0], "accelerations/a-pilot-z-ft_sec2") + (9.806_65 + 6.0) / FOOT).abs() < 1e-12
        );
        assert!((value(&now, [3.0, 0.0, 0.0], "accelerations/a-pilot-x-ft_sec2") + 0.75 / FOOT).abs() < 1e-12);
        // The nose turns from the velocity: 100 m/s times 0.5 rad/s.
        assert!((value(&now, [0.0; 3], "accelerations/wdot-ft_sec2") - 50.0 / FOOT).abs() < 1e-11);
    }
}
