//! Scenarios, Monte Carlo studies and Cramer-Rao bounds.
