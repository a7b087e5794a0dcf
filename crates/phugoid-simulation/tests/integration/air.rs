//! The air that scenarios fly through: turbulence, wind and the atmosphere, against formulas that are in print.

use std::f64::consts::{PI, TAU};

use phugoid_flight_dynamics::rigid_body::Angles;
use phugoid_identification::aircraft::ModelAircraft;
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::course::Course;
use phugoid_simulation::flight::{Flight, fly, fly_aircraft, trimmed_aircraft};
use phugoid_simulation::scenario::Scenario;

const FOOT: f64 = 0.3048;
const SPEED: f64 = 675.0 * FOOT;

fn f16(seed: u64, duration: &str, tables: &str) -> Scenario {
    let text = format!(
        "name = \"air\"\nduration = \"{duration}\"\nsample_rate = \"25 Hz\"\nseed = {seed}\n\
         [aircraft]\ntype = \"f16\"\ncg = 0.30\n[condition]\naltitude = \"20000 ft\"\nspeed = \"675 ft/s\"\n{tables}"
    );
    Scenario::parse(&text, "air.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// Velocity of the air in body axes at every sample, m/s: what the aircraft has over the still air less what it has over
/// the air that it feels.
fn gusts(scenario: &Scenario) -> Vec<[f64; 3]> {
    let (aircraft, trim) = trimmed_aircraft(scenario).unwrap();
    let mut course = Course::new(scenario, aircraft.as_ref(), None, &trim).unwrap();
    let body = |speed, alpha, beta| Angles::of(alpha, beta, 0.0, 0.0).body_velocity(speed);
    let mut gusts = Vec::new();
    for _ in 0..scenario.samples() {
        let (state, air) = (course.state(), course.sample(trim.controls()).air);
        let (over_still, felt) = (body(state.speed, state.alpha, state.beta), body(air.speed, air.alpha, air.beta));
        gusts.push(std::array::from_fn(|i| over_still[i] - felt[i]));
        course.advance(trim.controls()).unwrap();
    }
    gusts
}

/// One-sided density of von Karman's spectra over the angular frequency, per unit of variance (MIL-F-8785C, 3.7.1; scale
/// length 2500 ft): along the flight path, and across it.
fn von_karman(w: f64) -> [f64; 2] {
    let tau = 2500.0 * FOOT / SPEED;
    let a = (1.339 * tau * w).powi(2);
    [2.0 * tau / PI * (1.0 + a).powf(-5.0 / 6.0), tau / PI * (1.0 + 8.0 / 3.0 * a) * (1.0 + a).powf(-11.0 / 6.0)]
}

/// The same of Dryden's (3.7.2; scale length 1750 ft).
fn dryden(w: f64) -> [f64; 2] {
    let tau = 1750.0 * FOOT / SPEED;
    let a = (tau * w).powi(2);
    [2.0 * tau / PI / (1.0 + a), tau / PI * (1.0 + 3.0 * a) / (1.0 + a).powi(2)]
}

const SAMPLES: usize = 2048;
const RATE: f64 = 25.0;
const SIGMA: f64 = 0.5;
const SEEDS: u64 = 60;

/// Density of the gusts along x, y and z per unit of variance, and the frequency (rad/s), averaged over flights, in bins of
/// the periodogram with a Hann window; and the variances over that of the scenario.
fn flown(spectrum: &str) -> (Vec<(f64, [f64; 3])>, [f64; 3]) {
    let bins: Vec<usize> = (6..=64).collect();
    let mut density = vec![[0.0; 3]; bins.len()];
    let mut variance = [0.0; 3];
    for seed in 0..SEEDS {
        let scenario =
            f16(seed, "81.88 s", &format!("[turbulence]\nsigma = \"{SIGMA} m/s\"\nspectrum = \"{spectrum}\"\n"));
        let gusts = gusts(&scenario);
        assert_eq!(gusts.len(), SAMPLES);
        for axis in 0..3 {
            let mean_square = gusts.iter().map(|g| g[axis] * g[axis]).sum::<f64>() / SAMPLES as f64;
            variance[axis] += mean_square / (SIGMA * SIGMA) / SEEDS as f64;
            for (bin, density) in bins.iter().zip(&mut density) {
                let step = TAU * *bin as f64 / SAMPLES as f64;
                let (mut re, mut im) = (0.0, 0.0);
                for (k, gust) in gusts.iter().enumerate() {
                    let hann = 0.5 - 0.5 * (TAU * k as f64 / SAMPLES as f64).cos();
                    let (sin, cos) = (step * k as f64).sin_cos();
                    re += hann * gust[axis] * cos;
                    im -= hann * gust[axis] * sin;
                }
                // The window passes 3/8 of the power. Two sides, per rad/s: 2/(2 pi rate samples).
                let power = (re * re + im * im) / (0.375 * PI * RATE * SAMPLES as f64);
                density[axis] += power / (SIGMA * SIGMA) / SEEDS as f64;
            }
        }
    }
    let frequency = |bin: usize| TAU * RATE * bin as f64 / SAMPLES as f64;
    (bins.into_iter().map(frequency).zip(density).collect(), variance)
}

/// The flown density over a formula's in octaves of the frequency, for the three axes.
fn ratios(flown: &[(f64, [f64; 3])], formula: fn(f64) -> [f64; 2]) -> Vec<[f64; 3]> {
    let octave = |k: usize| 6 * (1 << k);
    (0..3)
        .map(|k| {
            let band = &flown[octave(k) - 6..octave(k + 1) - 6];
            std::array::from_fn(|axis| {
                let measured: f64 = band.iter().map(|(_, density)| density[axis]).sum();
                measured / band.iter().map(|(w, _)| formula(*w)[usize::from(axis > 0)]).sum::<f64>()
            })
        })
        .collect()
}

/// 60 flights of 82 s: a periodogram averaged over 60 flights and the 6, 12 and 24 bins of an octave, of which the window
/// joins neighbours, is good to 7, 5 and 3 % (one sigma). The filters are within 10 % of the spectra here.
#[test]
fn a_scenario_flies_the_spectrum_that_it_names() {
    let (density, variance) = flown("von-karman");
    for band in ratios(&density, von_karman) {
        assert!(band.iter().all(|ratio| (0.82..1.18).contains(ratio)), "von Karman: {band:?}");
    }
    // The filters leave out the end of the spectrum; the standard error of each is some 5 %.
    assert!(variance.iter().all(|ratio| (0.80..1.12).contains(ratio)), "{variance:?}");
    let (density, variance) = flown("dryden");
    for band in ratios(&density, dryden) {
        assert!(band.iter().all(|ratio| (0.85..1.15).contains(ratio)), "Dryden: {band:?}");
    }
    assert!(variance.iter().all(|ratio| (0.84..1.16).contains(ratio)), "{variance:?}");
    // The two differ by a quarter and more, so that the limits above tell which one is flown.
    let other = ratios(&density, von_karman);
    assert!(other.iter().flatten().any(|ratio| *ratio > 1.22), "{other:?}");
}

/// Nothing is said, and `dryden`, are one flight; another word is refused with the words that are known.
#[test]
fn the_spectrum_is_dryden_where_none_is_named() {
    let with =
        |line: &str| gusts(&f16(3, "2 s", &format!("[turbulence]\nintensity = \"light\"\nrates = true\n{line}")));
    assert_eq!(with(""), with("spectrum = \"dryden\"\n"));
    assert_ne!(with(""), with("spectrum = \"von-karman\"\n"));
    for word in ["\"karman\"", "\"von karman\"", "\"flat\"", "3"] {
        let text = format!(
            "name = \"a\"\nduration = \"1 s\"\nsample_rate = \"25 Hz\"\n[aircraft]\ntype = \"f16\"\n\
             [condition]\naltitude = \"20000 ft\"\nspeed = \"675 ft/s\"\n[turbulence]\nsigma = \"1 m/s\"\nspectrum = {word}\n"
        );
        let message = Scenario::parse(&text, "air.toml").unwrap_err().to_string();
        assert!(message.contains("spectrum = "), "{message}");
        assert!(message.contains("von-karman") || word == "3", "{message}");
    }
}

fn scenario_of(aircraft: &str, condition: &str, tables: &str) -> Result<Scenario, String> {
    let text = format!(
        "name = \"wind\"\nduration = \"20 s\"\nsample_rate = \"100 Hz\"\nseed = 1\n[aircraft]\n{aircraft}\n\
         [condition]\n{condition}\n[[manoeuvre]]\ntype = \"3-2-1-1\"\nsurface = \"elevator\"\nstart = \"1 s\"\n\
         unit = \"0.6 s\"\namplitude = \"1 deg\"\n[[manoeuvre]]\ntype = \"doublet\"\nsurface = \"rudder\"\n\
         start = \"8 s\"\nwidth = \"1 s\"\namplitude = \"2 deg\"\n{tables}"
    );
    let mut scenario = Scenario::parse(&text, "wind.toml").map_err(|error| error.to_string())?;
    scenario.folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios").into();
    Ok(scenario)
}

fn flown_in(aircraft: &str, condition: &str, tables: &str) -> Flight {
    fly(&scenario_of(aircraft, condition, tables).unwrap()).unwrap()
}

fn truth<'a>(flight: &'a Flight, name: &str) -> &'a [f64] {
    &flight.truth.channel(name).unwrap_or_else(|| panic!("no {name}")).values
}

const F16: (&str, &str) = ("type = \"f16\"\ncg = 0.30", "altitude = \"20000 ft\"\nspeed = \"675 ft/s\"");
/// A model file, and one with propeller, slipstream, actuators and fuel.
const HFB: (&str, &str) = ("file = \"hfb320\"", "altitude = \"4300 m\"\nspeed = \"104.67 m/s\"");
const NAVION: (&str, &str) =
    ("file = \"propeller-model.toml\"\nactuators = true", "altitude = \"1000 m\"\nspeed = \"55 m/s\"");

#[test]
fn the_same_wind_everywhere_carries_every_aircraft_and_does_nothing_else() {
    for (aircraft, condition) in [F16, HFB, NAVION] {
        let rough = "[turbulence]\nsigma = \"1 m/s\"\nrates = true\n[sensors]\nalpha = { noise = \"0.1 deg\" }\n";
        let still = flown_in(aircraft, condition, rough);
        // From 240 deg at 20 m/s: towards 60 deg, 10 m/s to the north and 17.32 m/s to the east.
        let windy = flown_in(aircraft, condition, &format!("{rough}[wind]\nfrom = \"240 deg\"\nspeed = \"20 m/s\"\n"));
        let carried = [("north", 10.0), ("east", 300.0_f64.sqrt())];
        for channel in &still.truth.channels {
            let wind = carried.iter().find(|(name, _)| *name == channel.name).map(|(_, wind)| *wind);
            let there = truth(&windy, &channel.name);
            match wind {
                None => assert_eq!(there, channel.values, "{aircraft} {}", channel.name),
                Some(wind) => {
                    for ((time, a), b) in still.truth.time.iter().zip(&channel.values).zip(there) {
                        assert!((b - a - wind * time).abs() < 1e-8, "{aircraft} {} {time}", channel.name);
                    }
                }
            }
        }
        assert_eq!(windy.measured.channels, still.measured.channels, "nothing on board sees it");
        // Over the ground: the position's own rate.
        let (north, east, ground) = (truth(&windy, "north"), truth(&windy, "east"), truth(&windy, "ground_speed"));
        for k in 1..ground.len() - 1 {
            let rate = (north[k + 1] - north[k - 1]).hypot(east[k + 1] - east[k - 1]) / 0.02;
            assert!((rate - ground[k]).abs() < 2e-3, "{aircraft} {k}: {rate} {}", ground[k]);
        }
        assert!(still.truth.channel("ground_speed").is_none() && still.truth.channel("wind_north").is_none());
    }
}

/// Climbing into a wind that grows, and that turns: what the accelerometers and gravity add up to is the velocity over the
/// ground, which with the wind taken off is what the air data show. Neither side of it is how the equations are written.
#[test]
fn in_a_shear_the_momentum_over_the_ground_is_what_the_forces_make_it() {
    let climbs = [
        (F16.0, "altitude = \"3000 m\"\nspeed = \"200 m/s\"\nflight_path = \"6 deg\"", 3000.0),
        (HFB.0, "altitude = \"3000 m\"\nspeed = \"104.67 m/s\"\nflight_path = \"6 deg\"", 3000.0),
    ];
    for (aircraft, condition, base) in climbs {
        let wind = format!(
            "[[wind.aloft]]\naltitude = \"{base} m\"\nfrom = \"90 deg\"\nspeed = \"4 m/s\"\n[[wind.aloft]]\n\
             altitude = \"{} m\"\nfrom = \"180 deg\"\nspeed = \"40 m/s\"\n",
            base + 1000.0
        );
        let (still, flight) = (flown_in(aircraft, condition, ""), flown_in(aircraft, condition, &wind));
        let of = |name: &str| truth(&flight, name);
        let count = flight.truth.time.len();
        let to_ground = |k: usize, v: [f64; 3]| {
            let (sf, cf) = of("phi")[k].sin_cos();
            let (st, ct) = of("theta")[k].sin_cos();
            let (sp, cp) = of("psi")[k].sin_cos();
            [
                ct * cp * v[0] + (sf * st * cp - cf * sp) * v[1] + (cf * st * cp + sf * sp) * v[2],
                ct * sp * v[0] + (sf * st * sp + cf * cp) * v[1] + (cf * st * sp - sf * cp) * v[2],
                -st * v[0] + sf * ct * v[1] + cf * ct * v[2],
            ]
        };
        let over_ground = |k: usize| {
            let (speed, alpha, beta) = (of("true_airspeed")[k], of("alpha")[k], of("beta")[k]);
            let body = [speed * alpha.cos() * beta.cos(), speed * beta.sin(), speed * alpha.sin() * beta.cos()];
            let [north, east, down] = to_ground(k, body);
            // The wind of the table, worked out here: from the east 4 m/s at the start, from the south 40 m/s 1000 m above.
            let share = (of("altitude")[k] - base) / 1000.0;
            let wind = [40.0 * share, -4.0 * (1.0 - share)];
            assert!((of("wind_north")[k] - wind[0]).abs() < 1e-9 && (of("wind_east")[k] - wind[1]).abs() < 1e-9);
            [north + wind[0], east + wind[1], down]
        };
        // 9.80665, or the rounded one of the book: what the still flight falls with.
        let gravity = -truth(&still, "az")[0] * truth(&still, "theta")[0].cos()
            + truth(&still, "ax")[0] * truth(&still, "theta")[0].sin();
        let force = |k: usize| to_ground(k, [of("ax")[k], of("ay")[k], of("az")[k]]);
        let start = over_ground(0);
        let mut gained = [0.0, 0.0, 0.0];
        for k in 1..count {
            let (before, after) = (force(k - 1), force(k));
            for i in 0..3 {
                gained[i] += 0.005 * (before[i] + after[i]) + if i == 2 { 0.01 * gravity } else { 0.0 };
            }
            let now = over_ground(k);
            for i in 0..3 {
                let error = now[i] - start[i] - gained[i];
                assert!(error.abs() < 0.02, "{aircraft} {k} {i}: {error}");
            }
        }
        let climbed = of("altitude")[count - 1] - base;
        assert!(climbed > 100.0, "{climbed}");
        // The first change of the airspeed: trimmed, V' = -W' h' cos(gamma), the heading north and the wind from the south.
        let (speed, gamma) = (of("true_airspeed"), 6.0_f64.to_radians());
        let rate = (speed[50] - speed[0]) / 0.5;
        let expected = -0.04 * speed[0] * gamma.sin() * gamma.cos();
        assert!((rate / expected - 1.0).abs() < 0.06, "{aircraft}: {rate} {expected}");
        assert!((truth(&still, "true_airspeed")[50] - speed[0]).abs() < 0.05 * expected.abs());
    }
}

#[test]
fn winds_that_cannot_be_are_refused_by_their_keys() {
    let level = |altitude: &str, from: &str, speed: &str| {
        format!("[[wind.aloft]]\naltitude = \"{altitude}\"\nfrom = \"{from}\"\nspeed = \"{speed}\"\n")
    };
    let two = |a: &str, b: &str| level(a, "10 deg", "5 kt") + &level(b, "20 deg", "9 kt");
    for (tables, words) in [
        ("[wind]\n".to_owned(), "takes either `from` and `speed`"),
        ("[wind]\nfrom = \"270 deg\"\n".to_owned(), "`wind.speed` is missing"),
        ("[wind]\nspeed = \"20 kt\"\n".to_owned(), "`wind.from` is missing"),
        ("[wind]\nfrom = \"270 deg\"\nspeed = \"-20 m/s\"\n".to_owned(), "`wind.speed` is -20 m/s"),
        ("[wind]\nfrom = \"-90 deg\"\nspeed = \"20 m/s\"\n".to_owned(), "`wind.from` is -90 deg"),
        ("[wind]\nfrom = \"361 deg\"\nspeed = \"20 m/s\"\n".to_owned(), "0 to 360 deg"),
        ("[wind]\nfrom = 270\nspeed = \"20 m/s\"\n".to_owned(), "no unit"),
        ("[wind]\nfrom = \"nan deg\"\nspeed = \"20 m/s\"\n".to_owned(), "does not start with a number"),
        ("[wind]\nfrom = \"270 deg\"\nspeed = \"20 ft\"\n".to_owned(), "not a unit of a speed"),
        ("[wind]\nform = \"270 deg\"\nspeed = \"20 m/s\"\n".to_owned(), "did you mean `from`"),
        ("[wind]\naloft = []\n".to_owned(), "`wind.aloft` has no altitude"),
        ("[wind]\nfrom = \"1 deg\"\nspeed = \"2 m/s\"\n".to_owned() + &level("0 m", "1 deg", "2 m/s"), "either"),
        (two("100 m", "100 m"), "entry 2 of `wind.aloft` is at 100 m, not above"),
        (two("2000 m", "100 m"), "from the lowest to the highest"),
        (level("0 m", "1 deg", "2 m/s") + &level("9 m", "400 deg", "2 m/s"), "entry 2 of `wind.aloft`: `from` is 400"),
        (level("0 m", "1 deg", "-45 kt"), "entry 1 of `wind.aloft`: `speed` is -23.15 m/s:"),
        (level("0 furlongs", "1 deg", "2 m/s"), "furlongs"),
        ("[[wind.aloft]]\naltitude = \"0 m\"\nfrom = \"1 deg\"\n".to_owned(), "missing field `speed`"),
    ] {
        let message = scenario_of(F16.0, F16.1, &tables).unwrap_err();
        assert!(message.contains(words) && message.starts_with("wind.toml"), "{tables}{message}");
    }
    // What no file can say a program can.
    let mut scenario = scenario_of(F16.0, F16.1, "[wind]\nfrom = \"0 deg\"\nspeed = \"2 m/s\"\n").unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        scenario.wind.as_mut().unwrap().speed = Some(phugoid_simulation::quantity::Speed::from_si(bad));
        assert!(fly(&scenario).unwrap_err().to_string().contains("`wind.speed`"));
    }
}

#[test]
fn a_satellite_receiver_is_recorded_where_it_is_named() {
    let wind = "[wind]\nfrom = \"270 deg\"\nspeed = \"20 m/s\"\n";
    let named = "[sensors]\nnorth = {}\neast = { noise = \"2 m\" }\nground_speed = { quantisation = \"0.1 m/s\" }\n";
    let with = flown_in(F16.0, F16.1, &format!("{wind}{named}"));
    let without = flown_in(F16.0, F16.1, wind);
    for name in ["north", "east", "ground_speed"] {
        assert!(with.measured.channel(name).is_some() && without.measured.channel(name).is_none(), "{name}");
    }
    assert_eq!(with.measured.channel("north").unwrap().values, truth(&with, "north"));
    let ground = &with.measured.channel("ground_speed").unwrap().values;
    assert!(ground.iter().zip(truth(&with, "ground_speed")).all(|(m, t)| (m - t).abs() <= 0.0501));
    // A tail-wind component of zero: the wind is from the side.
    assert!((ground[0] - (205.74_f64.powi(2) + 400.0).sqrt()).abs() < 0.06, "{}", ground[0]);
    // In still air it is recorded too, in symmetric flight as well.
    let still = flown_in(F16.0, F16.1, named);
    assert!(still.measured.channel("east").is_some() && still.truth.channel("wind_east").is_none());
    assert!((truth(&still, "ground_speed")[0] - 205.74).abs() < 1e-9);
}

/// U.S. Standard Atmosphere 1976, table I over geopotential altitude: density and speed of sound at 32 km. The air that is
/// isothermal above 20 km has 0.01336 kg/m^3 and 295.07 m/s there.
#[test]
fn the_standard_atmosphere_is_flown_up_to_its_end() {
    let glider = ModelFile::parse(
        "glider.toml",
        r#"
axes = ["longitudinal"]
[aircraft]
mass = "450 kg"
iyy = "600 kg*m^2"
wing_area = "10.5 m^2"
mean_chord = "0.75 m"
thrust = 0
air_density = "standard_atmosphere"
[simulation]
largest_thrust = "600 N"
[coefficients]
CL = ["1", "alpha"]
CD = ["1", "alpha^2"]
Cm = ["alpha", "q_hat", "elevator"]
[parameters]
CL_0 = { start = 0.3, prior_std = 0.3 }
CL_alpha = { start = 5.5, prior_std = 2 }
CD_0 = { start = 0.015, prior_std = 0.02 }
CD_alpha2 = { start = 0.5, prior_std = 2 }
Cm_alpha = { start = -0.8, prior_std = 1 }
Cm_q = { start = -15, prior_std = 15 }
Cm_elevator = { start = -1.2, prior_std = 1 }
"#,
    )
    .unwrap();
    let glider = ModelAircraft::new(&glider).unwrap();
    let fly = |condition: &str| fly_aircraft(&glider, &scenario_of(F16.0, condition, "").unwrap(), &|_| ());
    let flight = fly("altitude = \"32000 m\"\nspeed = \"282 m/s\"").unwrap();
    let [density, speed, mach] = ["air_density", "true_airspeed", "mach"].map(|name| truth(&flight, name)[0]);
    assert!((density / 0.013_225 - 1.0).abs() < 1e-4, "{density}");
    assert!((speed / mach - 303.131).abs() < 1e-3, "{}", speed / mach);
    let message = fly("altitude = \"84900 m\"\nspeed = \"12 km/s\"").unwrap_err().to_string();
    assert!(message.contains("altitude is 84900") && message.contains("1976 ends at 86 km"), "{message}");
    // In air so thin only a speed that no aircraft has carries one; it climbs out of the air within a second.
    let message = fly("altitude = \"84800 m\"\nspeed = \"12 km/s\"\nflight_path = \"4 deg\"").unwrap_err().to_string();
    assert!(message.contains("above 84852 m, where its model of the atmosphere ends"), "{message}");
}
