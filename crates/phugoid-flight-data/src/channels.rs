//! The table of known channels: canonical names, quantities, signs and synonyms.
//!
//! Axes are body axes: x forward, y to the right wing, z down. Angles and rates follow the right-hand rule about them.
//! `docs/units-and-signs.md` shows this table; a test keeps both equal.
//!
//! ```
//! use phugoid_flight_data::channels::{by_any_name, by_name, nearest};
//! let alpha = by_name("alpha").expect("it is in the table");
//! assert_eq!((alpha.quantity.si_unit(), alpha.sign), ("rad", "air from below"));
//! // `q` alone can be a pitch rate or a dynamic pressure: the unit decides.
//! let meanings: Vec<&str> = by_any_name("q").iter().map(|spec| spec.name).collect();
//! assert_eq!(meanings, ["q", "dynamic_pressure"]);
//! assert_eq!(nearest("aplha"), Some("alpha"));
//! ```

use crate::units::Quantity;
use Quantity::{
    Acceleration, Angle, AngularAcceleration, AngularRate, Density, Force, Inertia, Length, Mass, Number, Pressure,
    Speed, Temperature, Time,
};

/// The entry of one known channel in [`CHANNELS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelSpec {
    /// Canonical name, as used in records and model files.
    pub name: &'static str,
    /// Its physical quantity; values in records are in the SI unit of this quantity.
    pub quantity: Quantity,
    /// What the channel is, in words.
    pub description: &'static str,
    /// Which direction is positive; empty for quantities that have no direction, such as a pressure.
    pub sign: &'static str,
    /// Other names that are understood in headers. Case, spaces and underscores do not matter.
    pub synonyms: &'static [&'static str],
    /// True if the signal changes in any manoeuvre, so that a constant value is worth a note in the quality report.
    pub moves: bool,
}

const fn moving(
    name: &'static str,
    quantity: Quantity,
    description: &'static str,
    sign: &'static str,
    synonyms: &'static [&'static str],
) -> ChannelSpec {
    ChannelSpec { name, quantity, description, sign, synonyms, moves: true }
}

const fn slow(
    name: &'static str,
    quantity: Quantity,
    description: &'static str,
    sign: &'static str,
    synonyms: &'static [&'static str],
) -> ChannelSpec {
    ChannelSpec { name, quantity, description, sign, synonyms, moves: false }
}

/// All known channels. Where two share a synonym (`q` is a pitch rate or a dynamic pressure, `t` a time or a
/// temperature) the unit decides, and without a unit the first one here is meant.
#[rustfmt::skip]
pub const CHANNELS: &[ChannelSpec] = &[
    slow("time", Time, "time", "strictly increasing", &["t", "timestamp", "elapsed_time", "elapsed", "time_stamp"]),

    moving("true_airspeed", Speed, "true airspeed", "", &["tas", "vt", "vtas", "v_true", "airspeed_true", "speed_true"]),
    slow("calibrated_airspeed", Speed, "calibrated airspeed", "", &["cas", "vc", "vcas", "vcal", "airspeed_calibrated"]),
    slow("indicated_airspeed", Speed, "indicated airspeed", "", &["ias", "vi", "vias", "airspeed_indicated"]),
    slow("equivalent_airspeed", Speed, "equivalent airspeed", "", &["eas", "ve", "veas", "airspeed_equivalent"]),
    slow("ground_speed", Speed, "speed over ground", "", &["gs", "gnd_spd", "ground_spd"]),
    slow("vertical_speed", Speed, "rate of climb", "up", &["climb_rate", "rate_of_climb", "roc", "vspd", "hdot", "altitude_rate"]),
    moving("u", Speed, "velocity through the air along body x", "forward", &["u_body", "ub"]),
    moving("v", Speed, "velocity through the air along body y", "to the right", &["v_body", "vb"]),
    moving("w", Speed, "velocity through the air along body z", "down", &["w_body", "wb"]),

    moving("alpha", Angle, "angle of attack", "air from below", &["aoa", "angle_of_attack", "alfa", "alpha_true"]),
    moving("beta", Angle, "angle of sideslip", "air from the right", &["aos", "sideslip", "angle_of_sideslip", "sideslip_angle", "beta_true"]),
    moving("theta", Angle, "pitch attitude", "nose up", &["pitch", "pitch_angle", "pitch_attitude"]),
    moving("phi", Angle, "bank angle", "right wing down", &["roll", "roll_angle", "roll_attitude", "bank", "bank_angle"]),
    slow("psi", Angle, "heading", "nose right, zero at north", &["yaw", "yaw_angle", "heading", "hdg", "true_heading", "heading_true"]),
    moving("flight_path_angle", Angle, "flight-path angle", "climbing", &["gamma", "fpa"]),

    moving("p", AngularRate, "roll rate about body x", "right wing going down", &["roll_rate", "p_body", "gyro_x", "gyr_x", "omega_x"]),
    moving("q", AngularRate, "pitch rate about body y", "nose going up", &["pitch_rate", "q_body", "gyro_y", "gyr_y", "omega_y"]),
    moving("r", AngularRate, "yaw rate about body z", "nose going right", &["yaw_rate", "r_body", "gyro_z", "gyr_z", "omega_z"]),
    moving("pdot", AngularAcceleration, "roll acceleration", "as p", &["roll_acceleration", "roll_accel", "dp_dt"]),
    moving("qdot", AngularAcceleration, "pitch acceleration", "as q", &["pitch_acceleration", "pitch_accel", "dq_dt"]),
    moving("rdot", AngularAcceleration, "yaw acceleration", "as r", &["yaw_acceleration", "yaw_accel", "dr_dt"]),

    moving("ax", Acceleration, "specific force at the centre of gravity along body x, what an accelerometer shows", "forward",
        &["accel_x", "acc_x", "a_x", "x_accel", "acceleration_x", "longitudinal_acceleration", "longitudinal_accel"]),
    moving("ay", Acceleration, "specific force at the centre of gravity along body y", "to the right",
        &["accel_y", "acc_y", "a_y", "y_accel", "acceleration_y", "lateral_acceleration", "lateral_accel"]),
    moving("az", Acceleration, "specific force at the centre of gravity along body z", "down: about -9.8 m/s2 in level flight",
        &["accel_z", "acc_z", "a_z", "z_accel", "acceleration_z"]),
    moving("nx", Number, "load factor ax/g", "forward", &["n_x", "longitudinal_load_factor"]),
    moving("ny", Number, "load factor ay/g", "to the right", &["n_y", "lateral_load_factor"]),
    moving("nz", Number, "normal load factor -az/g", "up: about +1 in level flight", &["n_z", "load_factor", "normal_load_factor"]),

    moving("elevator", Angle, "elevator or all-moving tail deflection", "trailing edge down",
        &["de", "delta_e", "elev", "elevator_deflection", "elevator_position", "elevator_angle", "stabilator", "el"]),
    slow("aileron", Angle, "aileron deflection", "right aileron trailing edge down (rolls left)",
        &["da", "delta_a", "ail", "aileron_deflection", "aileron_position", "aileron_angle"]),
    slow("rudder", Angle, "rudder deflection", "trailing edge left (yaws left)",
        &["dr", "delta_r", "rud", "rudder_deflection", "rudder_position", "rudder_angle", "rdr"]),
    slow("flaps", Angle, "trailing-edge flap deflection", "trailing edge down", &["flap", "flap_angle", "flap_position", "flap_deflection"]),
    slow("leading_edge_flap", Angle, "leading-edge flap deflection", "leading edge down", &["lef", "leading_edge_flaps"]),
    slow("speed_brake", Angle, "speed-brake deflection", "open", &["speedbrakes", "airbrake"]),
    slow("throttle", Number, "throttle, 0 idle to 1 full", "more thrust", &["thr", "throttle_position", "power_lever"]),

    slow("altitude", Length, "geometric altitude above mean sea level", "up", &["alt", "h", "altitude_msl", "alt_msl", "geometric_altitude"]),
    slow("pressure_altitude", Length, "altitude of the static pressure in the standard atmosphere", "up",
        &["hp", "palt", "press_alt", "alt_press", "baro_altitude", "altitude_pressure", "altitude_baro"]),
    slow("north", Length, "distance flown to the north", "north", &["position_north", "pos_n"]),
    slow("east", Length, "distance flown to the east", "east", &["position_east", "pos_e"]),
    slow("latitude", Angle, "latitude", "north", &["lat"]),
    slow("longitude", Angle, "longitude", "east", &["lon", "lng"]),

    slow("dynamic_pressure", Pressure, "dynamic pressure, half density times true airspeed squared", "", &["qbar", "q", "dyn_press", "pdyn", "dynamic_press"]),
    slow("impact_pressure", Pressure, "pitot minus static pressure", "", &["qc", "qci", "differential_pressure", "diff_press"]),
    slow("static_pressure", Pressure, "static pressure of the air", "", &["pressure", "p", "ps", "p_static", "ambient_pressure", "baro_pressure"]),
    slow("air_density", Density, "density of the air", "", &["rho", "density"]),
    slow("temperature", Temperature, "static temperature of the air", "", &["oat", "sat", "static_temperature", "outside_air_temperature", "air_temperature", "temp", "t"]),
    slow("total_temperature", Temperature, "total temperature of the air", "", &["tat"]),
    slow("mach", Number, "Mach number", "", &["mach_number", "mach_no"]),

    slow("thrust", Force, "total thrust of all engines", "forward", &["net_thrust", "total_thrust", "thrust_total", "thrust_x", "t"]),
    slow("mass", Mass, "mass of the aircraft", "", &["aircraft_mass", "gross_mass", "weight", "gross_weight"]),
    slow("ixx", Inertia, "moment of inertia about body x", "", &["jx", "i_xx"]),
    slow("iyy", Inertia, "moment of inertia about body y", "", &["jy", "i_yy"]),
    slow("izz", Inertia, "moment of inertia about body z", "", &["jz", "i_zz"]),
    slow("ixz", Inertia, "product of inertia, integral of x z dm", "", &["jxz", "i_xz"]),
    slow("cg", Number, "centre of gravity, fraction of the mean aerodynamic chord behind its leading edge", "aft", &["xcg", "x_cg", "cg_position", "center_of_gravity", "centre_of_gravity"]),
    slow("fuel", Mass, "fuel on board", "", &["fuel_mass", "fuel_quantity", "fuel_weight", "fuel_total"]),
];

/// German, French and Spanish names: the channel, and what it is called. Case, spaces, underscores and apostrophes do not
/// matter.
pub const FOREIGN: &[(&str, &[&str])] = &[
    (
        "true_airspeed",
        &[
            "fahrt_tas",
            "fahrtmesser_tas",
            "wahre_fahrt",
            "wahre_fluggeschwindigkeit",
            "wahre_eigengeschwindigkeit",
            "vitesse_vraie",
            "vitesse_propre",
            "velocidad_verdadera",
        ],
    ),
    ("calibrated_airspeed", &["fahrt_cas", "fahrtmesser_cas", "vitesse_conventionnelle", "velocidad_calibrada"]),
    (
        "indicated_airspeed",
        &[
            "fahrt_ias",
            "fahrtmesser",
            "fahrtmesser_ias",
            "fahrtmesseranzeige",
            "angezeigte_fahrt",
            "angezeigte_fluggeschwindigkeit",
            "angezeigte_eigengeschwindigkeit",
            "vitesse_indiquée",
            "vitesse_indiquee",
            "velocidad_indicada",
        ],
    ),
    (
        "alpha",
        &[
            "anstellwinkel",
            "anstellwinkel_alpha",
            "anstellwinkel_alfa",
            "incidence",
            "angle_d_incidence",
            "ángulo_de_ataque",
            "angulo_de_ataque",
        ],
    ),
    (
        "beta",
        &["schiebewinkel", "schiebewinkel_beta", "dérapage", "derapage", "ángulo_de_derrape", "angulo_de_derrape"],
    ),
    (
        "theta",
        &[
            "nickwinkel",
            "längsneigung",
            "laengsneigung",
            "längsneigungswinkel",
            "laengsneigungswinkel",
            "assiette",
            "assiette_longitudinale",
            "ángulo_de_cabeceo",
            "angulo_de_cabeceo",
        ],
    ),
    (
        "phi",
        &[
            "hängewinkel",
            "haengewinkel",
            "rollwinkel",
            "querneigung",
            "querneigungswinkel",
            "querlage",
            "roulis",
            "angle_de_roulis",
            "ángulo_de_alabeo",
            "angulo_de_alabeo",
        ],
    ),
    ("psi", &["gierwinkel", "steuerkurs"]),
    ("p", &["rollrate", "rollgeschwindigkeit", "vitesse_de_roulis", "taux_de_roulis", "velocidad_de_alabeo"]),
    ("q", &["nickrate", "nickgeschwindigkeit", "vitesse_de_tangage", "taux_de_tangage", "velocidad_de_cabeceo"]),
    ("r", &["gierrate", "giergeschwindigkeit", "vitesse_de_lacet", "taux_de_lacet", "velocidad_de_guiñada"]),
    (
        "elevator",
        &[
            "höhenruder",
            "hoehenruder",
            "höhenruderausschlag",
            "hoehenruderausschlag",
            "höhenruderwinkel",
            "hoehenruderwinkel",
            "profondeur",
            "gouverne_de_profondeur",
            "timón_de_profundidad",
            "timon_de_profundidad",
        ],
    ),
    ("aileron", &["querruder", "querruderausschlag", "querruderwinkel", "ailerons", "alerones"]),
    (
        "rudder",
        &[
            "seitenruder",
            "seitenruderausschlag",
            "seitenruderwinkel",
            "gouverne_de_direction",
            "timón_de_dirección",
            "timon_de_direccion",
        ],
    ),
    ("altitude", &["höhe", "hoehe", "altitud"]),
    ("pressure_altitude", &["druckhöhe", "druckhoehe", "altitude_pression", "altitud_de_presión"]),
    ("dynamic_pressure", &["staudruck", "pression_dynamique", "presión_dinámica", "presion_dinamica"]),
    ("static_pressure", &["statischer_druck", "pression_statique", "presión_estática", "presion_estatica"]),
    ("air_density", &["luftdichte"]),
    ("thrust", &["schub", "poussée", "poussee", "empuje"]),
    ("mass", &["masse", "masa"]),
];

/// Names that could mean several channels, or one channel and something else, and the channels that they could mean. A
/// column of such a name becomes a known channel only if its unit leaves one meaning.
///
/// LN 9300 and ISO 1151 write eta, xi and zeta for the elevator, the ailerons and the rudder, with the signs of
/// [`CHANNELS`] (a positive deflection gives a negative moment). An efficiency and a damping ratio have these letters too,
/// so that the unit of an angle has to be there. A German `Fahrt` is mostly what the airspeed indicator shows, but not
/// always; at altitude the true airspeed is another one by tens of per cent.
pub const AMBIGUOUS: &[(&str, &[&str])] = &[
    ("airspeed", &["true_airspeed", "calibrated_airspeed", "indicated_airspeed"]),
    ("speed", &["true_airspeed", "calibrated_airspeed", "indicated_airspeed", "ground_speed"]),
    ("velocity", &["true_airspeed", "ground_speed"]),
    ("v", &["true_airspeed", "v"]),
    ("m", &["mach", "mass"]),
    ("fahrt", &["indicated_airspeed", "calibrated_airspeed", "true_airspeed"]),
    ("fluggeschwindigkeit", &["true_airspeed", "calibrated_airspeed", "indicated_airspeed", "ground_speed"]),
    ("eigengeschwindigkeit", &["true_airspeed", "calibrated_airspeed", "indicated_airspeed"]),
    ("eta", &["elevator"]),
    ("xi", &["aileron"]),
    ("zeta", &["rudder"]),
];

/// The channel with exactly this canonical name, or `None`.
pub fn by_name(name: &str) -> Option<&'static ChannelSpec> {
    CHANNELS.iter().find(|channel| channel.name == name)
}

/// All channels that have this name as canonical name or synonym, in the order of [`CHANNELS`], which puts the more
/// likely one first. Case, spaces and underscores do not matter.
pub fn by_any_name(name: &str) -> Vec<&'static ChannelSpec> {
    let key = key(name);
    CHANNELS
        .iter()
        .filter(|channel| {
            let mut names = channel.synonyms.iter().copied().chain(foreign(channel.name));
            key_is(channel.name, &key) || names.any(|name| key_is(name, &key))
        })
        .collect()
}

/// Names are taken for misspellings of each other from this similarity on: 1 - edits / letters.
pub(crate) const MIN_SIMILARITY: f64 = 0.75;

/// The canonical name of the channel whose name or synonym is most similar to a misspelt name; `None` if none is
/// similar.
pub fn nearest(name: &str) -> Option<&'static str> {
    nearest_spelling(name).map(|(name, _)| name)
}

/// The name, synonym or foreign name that is most similar to a misspelt name, behind the canonical name of its channel.
pub(crate) fn nearest_spelling(name: &str) -> Option<(&'static str, &'static str)> {
    let key = key(name);
    // Short names are all similar to each other, so that only swapped letters count (`beat`: beta). For the same reason
    // synonyms such as `delta_e` are left out below.
    if key.len() < 4 {
        return None;
    }
    let letters = |text: &str| {
        let mut letters: Vec<char> = text.chars().collect();
        letters.sort_unstable();
        letters
    };
    let near_enough = |spelling: &str| key.len() > 4 || letters(&key) == letters(spelling);
    let spellings = CHANNELS.iter().flat_map(|channel| {
        let synonyms = channel.synonyms.iter().filter(|synonym| synonym.len() > 3 && !synonym.starts_with("delta_"));
        let names = std::iter::once(channel.name).chain(synonyms.copied()).chain(foreign(channel.name));
        names.map(move |spelling| (channel.name, spelling))
    });
    spellings
        .filter(|(_, spelling)| may_be_similar(spelling, &key))
        .map(|(name, spelling)| (name, spelling, strsim::normalized_damerau_levenshtein(&key, &self::key(spelling))))
        .filter(|&(_, spelling, likeness)| likeness >= MIN_SIMILARITY && near_enough(spelling))
        .max_by(|a, b| a.2.total_cmp(&b.2))
        .map(|(name, spelling, _)| (name, spelling))
}

/// The foreign names of a channel.
fn foreign(canonical: &str) -> impl Iterator<Item = &'static str> {
    FOREIGN.iter().filter(move |(name, _)| *name == canonical).flat_map(|(_, names)| *names).copied()
}

/// False for most words that are not similar, without computing the distance: an edit changes the length by at most
/// one, and adds or removes at most one letter.
fn may_be_similar(spelling: &str, key: &str) -> bool {
    // Of characters, as the distance counts them: an umlaut is one.
    let (length, key_length) = (spelling.chars().filter(|&c| c != '_').count(), key.chars().count());
    let edits = ((1.0 - MIN_SIMILARITY) * length.max(key_length) as f64) as u32;
    let letters = |text: &str| {
        text.bytes().filter(u8::is_ascii_lowercase).fold(0_u32, |letters, byte| letters | 1 << (byte - b'a'))
    };
    let (ours, theirs) = (letters(spelling), letters(key));
    length.abs_diff(key_length) <= edits as usize
        && (ours & !theirs).count_ones() <= edits
        && (theirs & !ours).count_ones() <= edits
}

/// The name in lower case with letters and digits only, so that `True Airspeed`, `true_airspeed` and `TrueAirspeed` are
/// equal, and with Greek letters spelt, so that `δe` is `delta_e`.
pub(crate) fn key(name: &str) -> String {
    let mut key = String::with_capacity(name.len());
    for c in name.chars() {
        match greek(c) {
            Some(spelt) => key.push_str(spelt),
            // A bar above the letter before it.
            None if c == '\u{304}' => key.push_str("bar"),
            None if c.is_alphanumeric() => key.extend(c.to_lowercase()),
            None => {}
        }
    }
    key
}

/// The name of a Greek letter that stands for a quantity of flight, as channels spell it.
fn greek(letter: char) -> Option<&'static str> {
    Some(match letter {
        'α' | 'Α' => "alpha",
        'β' | 'Β' | 'ϐ' => "beta",
        'γ' | 'Γ' => "gamma",
        'δ' | 'Δ' => "delta",
        'ζ' => "zeta",
        'η' => "eta",
        'θ' | 'ϑ' | 'Θ' => "theta",
        'ξ' => "xi",
        'ρ' => "rho",
        'φ' | 'ϕ' | 'Φ' => "phi",
        'ψ' | 'Ψ' => "psi",
        _ => return None,
    })
}

fn key_is(spelling: &str, key: &str) -> bool {
    spelling.bytes().filter(|&b| b != b'_').eq(key.bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_means_one_channel_per_quantity() {
        for channel in CHANNELS {
            for spelling in std::iter::once(channel.name).chain(channel.synonyms.iter().copied()) {
                let same: Vec<_> =
                    by_any_name(spelling).into_iter().filter(|other| other.quantity == channel.quantity).collect();
                assert_eq!(same, [channel], "{spelling} is claimed twice");
            }
            assert_eq!(by_any_name(channel.name).first(), Some(&channel), "{} must mean itself first", channel.name);
        }
    }

    #[test]
    fn foreign_names_mean_one_known_channel() {
        for (name, spellings) in FOREIGN {
            for spelling in *spellings {
                let found: Vec<&str> = by_any_name(spelling).iter().map(|spec| spec.name).collect();
                assert_eq!(found, [*name], "{spelling}");
            }
        }
        for (header, name) in [
            ("Fahrt TAS", "true_airspeed"),
            ("Fahrtmesser TAS", "true_airspeed"),
            ("Wahre Eigengeschwindigkeit", "true_airspeed"),
            ("Fahrtmesser", "indicated_airspeed"),
            ("Vitesse vraie", "true_airspeed"),
            ("Querneigung", "phi"),
            ("Höhenruder", "elevator"),
            ("Höhenruderausschlag", "elevator"),
            ("Querruderausschlag", "aileron"),
            ("Seitenruderausschlag", "rudder"),
            ("Staudruck", "dynamic_pressure"),
        ] {
            assert_eq!(by_any_name(header).first().map(|spec| spec.name), Some(name), "{header}");
        }
    }

    #[test]
    fn ambiguous_names_lead_to_known_channels() {
        for (_, meanings) in AMBIGUOUS {
            for meaning in *meanings {
                assert!(by_name(meaning).is_some(), "{meaning}");
            }
        }
    }

    /// The quick comparison never rejects a name that the full comparison would find.
    #[test]
    fn the_quick_comparison_agrees_with_the_full_one() {
        let words = CHANNELS
            .iter()
            .flat_map(|c| std::iter::once(c.name).chain(c.synonyms.iter().copied()).chain(foreign(c.name)));
        let words: Vec<String> = words.map(key).filter(|word| word.len() > 3).collect();
        for word in &words {
            for (index, letter) in word.char_indices() {
                let misspelt = word.replacen(letter, if index % 2 == 0 { "x" } else { "" }, 1);
                for other in &words {
                    let likeness = strsim::normalized_damerau_levenshtein(&misspelt, other);
                    assert!(
                        likeness < MIN_SIMILARITY || may_be_similar(other, &misspelt),
                        "{misspelt} {other} {likeness}"
                    );
                }
            }
        }
    }

    #[test]
    fn misspelt_names_find_their_neighbour() {
        assert_eq!(nearest("aplha"), Some("alpha"));
        assert_eq!(nearest("elevater"), Some("elevator"));
        assert_eq!(nearest("True_Airsped"), Some("true_airspeed"));
        assert_eq!(nearest("pich_rate"), Some("q"));
        assert_eq!(nearest("beat"), Some("beta"));
        assert_eq!(nearest("Hohenruder"), Some("elevator"));
        assert_eq!(nearest_spelling("Höhenuder"), Some(("elevator", "höhenruder")));
        assert_eq!(nearest("Anstelwinkel"), Some("alpha"));
        assert_eq!(nearest("Gierwinkle"), Some("psi"));
        assert_eq!(nearest("flag"), None);
        assert_eq!(nearest("q1"), None);
        assert_eq!(nearest("humidity"), None);
    }
}
