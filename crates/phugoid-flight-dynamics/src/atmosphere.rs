//! Air density, speed of sound and dynamic pressure.
