//! Flight over the Earth: six degrees of freedom over a plane, a sphere or an ellipsoid, turning or at rest.
//!
//! [`motion`](crate::motion) is for estimators: a flat earth, and states that an aircraft's sensors see. This module is
//! for simulation over any distance: the state is the motion relative to an inertial frame at the centre of the planet,
//! so that the equations hold at the poles, at 90 degrees of pitch and at rest.
//!
//! - [`planet`]: shape, gravitation and rotation; latitude, longitude and altitude.
//! - [`attitude`]: quaternions and Euler angles.
//! - [`condition`]: everything that follows from a state at one instant, air data above all.
//! - [`loads`]: the trait [`Loads`](loads::Loads) that a vehicle implements to be flown.
//! - [`flight`]: the equations of motion and their integration in time.
//! - [`steady`]: trim for straight flight.
//! - [`moving_air`]: gusts and turbulence.
//! - [`coefficients`]: any [`Aircraft`](crate::aircraft::Aircraft) as such a vehicle.
//!
//! Units are SI and angles are in radians throughout. The equations are those of B. L. Stevens, F. L. Lewis and
//! E. N. Johnson, Aircraft Control and Simulation, 3rd ed., sections 1.4 to 1.7. They agree with the simulators of NASA's
//! check cases (NASA/TM-2015-218675).
pub mod attitude;
pub mod coefficients;
pub mod condition;
pub mod flight;
pub mod loads;
pub mod moving_air;
pub mod planet;
pub mod steady;
pub mod vector;
