"""Flight control systems: what feedback adds to the surfaces, with gains drawn for each flight."""

import math

import numpy as np


def system(plan, trim: dict, response: dict):
    """The system of a flight. Its gains have random numbers of their own: those of the flight are drawn without it."""
    rng = np.random.default_rng([plan.seed, 2])
    return (Lateral if plan.axes == "lateral" else Longitudinal)(rng, trim, response)


class Lateral:
    """Roll damper, bank hold in half of the flights, yaw damper with a washout in half of them, sideslip feedback, and
    rudder with the ailerons."""

    def __init__(self, rng, trim, m):
        self.trim = trim
        self.kp = rng.uniform(1.0, 3.0) / abs(m["L_aileron"])
        self.kphi = (rng.random() < 0.5) * rng.uniform(0.5, 2.0) / abs(m["L_aileron"])
        self.kr = rng.uniform(0.6, 2.0) / abs(m["N_rudder"])
        self.washout = rng.uniform(1.0, 3.0) if rng.random() < 0.5 else math.inf
        self.kbeta = (rng.random() < 0.5) * rng.uniform(0.3, 1.0) * max(m["N_beta"], 0.5) / abs(m["N_rudder"])
        self.with_aileron = rng.uniform(0.0, 0.3)
        self.slow = 0.0

    def step(self, step, phi, theta, p, q, r, beta, altitude, aileron):
        """Elevator, aileron and rudder to be added, rad."""
        self.slow += step / self.washout * (r - self.slow)
        return (
            0.0,
            self.kp * p + self.kphi * (phi - self.trim["phi"]),
            self.kr * (r - self.slow) - self.kbeta * beta + self.with_aileron * aileron,
        )


class Longitudinal:
    """Pitch damper and attitude hold; in half of the flights the altitude is held by the attitude."""

    def __init__(self, rng, trim, m):
        self.trim = trim
        self.kq = rng.uniform(1.0, 3.0) / abs(m["M_elevator"])
        self.ktheta = rng.uniform(1.0, 4.0) / abs(m["M_elevator"])
        self.kh = (rng.random() < 0.5) * rng.uniform(0.1, 0.4) / trim["speed"]

    def step(self, step, phi, theta, p, q, r, beta, altitude, aileron):
        """Elevator, aileron and rudder to be added, rad."""
        wanted = min(max(self.kh * (self.trim["altitude"] - altitude), -0.15), 0.15)
        return self.kq * q + self.ktheta * (theta - self.trim["theta"] - wanted), 0.0, 0.0
