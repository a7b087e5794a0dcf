//! The published plant cases, embedded.

use super::format::PlantCase;
use crate::embedded::published_cases;

published_cases! {
    PlantCase;
    "first-order"/1: "First order, case 1: step, a = 3",
    "first-order"/2: "First order, case 2: larger lambda",
    "first-order"/3: "First order, case 3: a = 5, unit step",
    "first-order"/4: "First order, case 4: a = 5, step of 3",
    "first-order"/5: "First order, case 5: unstable plant, narrow bounds",
    "first-order-nonlinear"/1: "First order nonlinear, case 1: a = 7, input of 3 at 0.7 rad/s",
    "first-order-nonlinear"/2: "First order nonlinear, case 2: slower input",
    "first-order-nonlinear"/3: "First order nonlinear, case 3: larger input",
    "first-order-nonlinear"/4: "First order nonlinear, case 4: a = -3",
    "second-order"/1: "Second order, case 1: step",
    "second-order"/2: "Second order, case 2: start above the truth, very low lambda",
    "second-order"/3: "Second order, case 3: sine of amplitude 10",
    "second-order"/4: "Second order, case 4: negative sine",
    "second-order"/5: "Second order, case 5: unstable plant",
    "second-order-nonlinear"/1: "Second order nonlinear, case 1: step of 5",
    "second-order-nonlinear"/2: "Second order nonlinear, case 2: start far off",
    "second-order-nonlinear"/3: "Second order nonlinear, case 3: larger lambda",
    "second-order-nonlinear"/4: "Second order nonlinear, case 4: unstable plant",
    "noise"/1: "Noise, case 1: step of 5",
    "noise"/2: "Noise, case 2: step of 20, highest noise",
    "noise"/3: "Noise, case 3: step of 20, lowest noise",
}
