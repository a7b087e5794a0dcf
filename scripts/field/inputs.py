"""What moves: the pilot's commands to the surfaces, and the air."""

import math

import numpy as np

# Trapezoid edges of a step, s: no hand and no servo is faster.
EDGE = 0.06


def steps(time: np.ndarray, start: float, unit: float, pattern: tuple, amplitude: float) -> np.ndarray:
    """Steps of lengths `|pattern| * unit` (s) and signs of `pattern`, from `start` on, with edges of 0.06 s."""
    knots, values = [start], [0.0]
    now = start
    for length in pattern:
        level = math.copysign(amplitude, length)
        knots += [now + EDGE, now + abs(length) * unit]
        values += [level, level]
        now += abs(length) * unit
    knots.append(now + EDGE)
    values.append(0.0)
    return np.interp(time, knots, values, left=0.0, right=0.0)


PATTERNS = {"3211": (3, -2, 1, -1), "doublet": (1, -1), "pulse": (1,), "2311": (2, -3, 1, -1), "to-and-fro": (1, -2, 1)}

# Which harmonics of its duration each surface has in a multisine: no two share one, so that they are orthogonal.
HARMONICS = {"elevator": 0, "aileron": 1, "rudder": 2}


def sweep(time: np.ndarray, start: float, end: float, highest_hz: float, amplitude: float) -> np.ndarray:
    """A sine whose frequency grows with its logarithm from a twentieth of `highest_hz` to `highest_hz`."""
    lowest, duration = highest_hz / 20, end - start
    rate = math.log(highest_hz / lowest) / duration
    within = np.clip(time - start, 0.0, duration)
    return amplitude * _window(time, start, end) * np.sin(2 * math.pi * lowest / rate * (np.exp(rate * within) - 1))


def multisine(time: np.ndarray, start: float, end: float, highest_hz: float, amplitude: float, surface: str) -> np.ndarray:
    """Harmonics of the duration, every third one, up to `highest_hz` with phases after M. R. Schroeder (IEEE Transactions
    on Information Theory 16, 1970) that keep the peak low; `amplitude` is the peak."""
    duration = end - start
    orders = np.arange(2 + HARMONICS[surface], max(int(highest_hz * duration), 8), 3)
    k = np.arange(1, len(orders) + 1)
    phases = -math.pi * k * (k - 1) / len(orders)
    out = np.cos(2 * math.pi * np.outer(time - start, orders) / duration + phases).sum(axis=1)
    inside = (time > start) & (time < end)
    return out * _window(time, start, end) * amplitude / np.abs(out[inside]).max()


def waves(time: np.ndarray, start: float, end: float, amplitude: float) -> np.ndarray:
    """Two slow waves, as of pull-ups and push-overs."""
    inside = (time > start) & (time < end)
    return np.where(inside, amplitude * np.sin(4 * math.pi * (time - start) / (end - start)), 0.0)


def _window(time: np.ndarray, start: float, end: float) -> np.ndarray:
    """One from `start` to `end`, and zero outside, with half a second at either end in which it grows."""
    return np.clip(np.minimum(time - start, end - time) / 0.5, 0.0, 1.0)


def stick(time: np.ndarray, start: float, end: float, corner_hz: float, amplitude: float, rng) -> np.ndarray:
    """Random motions of a hand: white noise through two lags of `corner_hz`; `amplitude` is three sigma."""
    step = time[1] - time[0]
    a = math.exp(-2 * math.pi * corner_hz * step)
    noise = rng.standard_normal(len(time))
    out = np.empty(len(time))
    first = second = 0.0
    for k, n in enumerate(noise):
        first = a * first + (1 - a) * n
        second = a * second + (1 - a) * first
        out[k] = second
    inside = (time > start) & (time < end)
    if not inside.any():
        return np.zeros(len(time))
    return out * _window(time, start, end) * amplitude / 3 / out[inside].std()


def dryden(time: np.ndarray, speed: float, sigma: float, length: float, rng) -> np.ndarray:
    """Gusts u, v, w (m/s, body axes, three columns) with the spectra of MIL-F-8785C, 3.7.2; `sigma` in each axis,
    scale length `length` (m). The gust is that of a point: no gradients over the aircraft."""
    step = time[1] - time[0]
    tau = length / speed
    n = rng.standard_normal((len(time), 3)) / math.sqrt(step)
    u = np.empty(len(time))
    a = math.exp(-step / tau)
    # The variance of the discrete lag is made that of the continuous one.
    gain = sigma * math.sqrt((1 - a * a) * step)
    state = sigma * rng.standard_normal()
    for k in range(len(time)):
        u[k] = state
        state = a * state + gain * n[k, 0]
    columns = [u]
    for axis in (1, 2):
        # sigma sqrt(tau) (1 + sqrt(3) tau s)/(1 + tau s)^2, by steps of the second order; a run-in makes it stationary.
        x1 = x2 = 0.0
        lead = math.sqrt(3) * tau
        scale = sigma * math.sqrt(tau)
        out = np.empty(len(time))
        run_in = rng.standard_normal(int(4 * tau / step)) / math.sqrt(step)
        for k, noise in enumerate(np.concatenate([run_in, n[:, axis]])):
            x1n = a * x1 + (1 - a) * noise
            x2n = a * x2 + (1 - a) * x1
            x1, x2 = x1n, x2n
            if k >= len(run_in):
                # (1 + lead s)/(1 + tau s) applied to x1: x1 lead/tau + (1 - lead/tau) x2.
                out[k - len(run_in)] = scale * (lead / tau * x1 + (1 - lead / tau) * x2)
        columns.append(out)
    return np.column_stack(columns)
