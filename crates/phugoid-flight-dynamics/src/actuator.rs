//! Surface actuators: first-order lag with rate and position limits.
