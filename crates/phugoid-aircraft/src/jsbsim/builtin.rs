//! The properties that JSBSim has by itself, without a file that makes them: those of its catalogue (version 1.3.3).
//!
//! A name that a file reads and that is neither here nor made by the file is a mistake, at which JSBSim refuses the aircraft.

use super::model::Model;
use super::units::{FOOT, SLUG_FT3};

/// Acceleration of gravity that properties begin with, m/s2.
const GRAVITY: f64 = 9.806_65;

/// Folders of properties, with the names in each that JSBSim always has. What this crate makes itself is not among them.
#[rustfmt::skip]
const ALWAYS: &[(&str, &str)] = &[
    (
        "accelerations/",
        "Nx Ny Nz a-pilot-x-ft_sec2 a-pilot-y-ft_sec2 a-pilot-z-ft_sec2 gravity-ft_sec2 n-pilot-x-norm n-pilot-y-norm \
         n-pilot-z-norm pdot-rad_sec2 pidot-rad_sec2 qdot-rad_sec2 qidot-rad_sec2 rdot-rad_sec2 ridot-rad_sec2 udot-ft_sec2 \
         uidot-ft_sec2 vdot-ft_sec2 vidot-ft_sec2 wdot-ft_sec2 widot-ft_sec2",
    ),
    (
        "aero/",
        "alpha-max-rad alpha-min-rad cl-squared stall-hyst-norm",
    ),
    (
        "atmosphere/",
        "P-sl-psf RH SL-graded-delta-T T-sl-R a-ratio a-sl-fps cosine-gust/X-velocity-ft_sec cosine-gust/Y-velocity-ft_sec \
         cosine-gust/Z-velocity-ft_sec cosine-gust/end-duration-sec cosine-gust/frame cosine-gust/magnitude-ft_sec \
         cosine-gust/start cosine-gust/startup-duration-sec cosine-gust/steady-duration-sec delta-T dew-point-R gust-down-fps \
         gust-east-fps gust-north-fps p-turb-rad_sec psiw-rad q-turb-rad_sec r-turb-rad_sec randomseed rho-sl-slugs_ft3 \
         saturated-vapor-pressure-psf total-wind-down-fps total-wind-east-fps total-wind-north-fps turb-down-fps turb-east-fps \
         turb-gain turb-north-fps turb-rate turb-rhythmicity turb-type turbulence/milspec/severity \
         turbulence/milspec/windspeed_at_20ft_AGL-fps updownburst/number-of-cells vapor-fraction-ppm vapor-pressure-psf \
         wind-down-fps wind-east-fps wind-mag-fps wind-north-fps",
    ),
    (
        "fcs/",
        "aileron-cmd-norm center-brake-cmd-norm elevator-cmd-norm elevator-pos-deg elevator-pos-norm elevator-pos-rad \
         flap-cmd-norm flap-pos-deg flap-pos-norm flap-pos-rad left-aileron-pos-deg left-aileron-pos-norm left-aileron-pos-rad \
         left-brake-cmd-norm mag-elevator-pos-rad mag-left-aileron-pos-rad mag-right-aileron-pos-rad mag-rudder-pos-rad \
         mag-speedbrake-pos-rad mag-spoiler-pos-rad pitch-trim-cmd-norm right-aileron-pos-deg right-aileron-pos-norm \
         right-aileron-pos-rad right-brake-cmd-norm roll-trim-cmd-norm rudder-cmd-norm rudder-pos-deg rudder-pos-norm \
         rudder-pos-rad speedbrake-cmd-norm speedbrake-pos-deg speedbrake-pos-norm speedbrake-pos-rad spoiler-cmd-norm \
         spoiler-pos-deg spoiler-pos-norm spoiler-pos-rad steer-cmd-norm wing-fold-pos-norm yaw-trim-cmd-norm",
    ),
    (
        "flight-path/",
        "gamma-deg psi-gt-rad",
    ),
    (
        "forces/",
        "fbx-aero-lbs fbx-buoyancy-lbs fbx-external-lbs fbx-gear-lbs fbx-prop-lbs fbx-total-lbs fbx-weight-lbs fby-aero-lbs \
         fby-buoyancy-lbs fby-external-lbs fby-gear-lbs fby-prop-lbs fby-total-lbs fby-weight-lbs fbz-aero-lbs fbz-buoyancy-lbs \
         fbz-external-lbs fbz-gear-lbs fbz-prop-lbs fbz-total-lbs fbz-weight-lbs fsx-aero-lbs fsy-aero-lbs fsz-aero-lbs \
         fwx-aero-lbs fwy-aero-lbs fwz-aero-lbs hold-down load-factor lod-norm",
    ),
    (
        "gear/",
        "gear-cmd-norm gear-pos-norm num-units tailhook-pos-norm wow",
    ),
    (
        "ground/",
        "bumpiness maximum-force-lbs rolling_friction-factor solid static-friction-factor",
    ),
    (
        "ic/",
        "alpha-deg alpha-rad beta-deg beta-rad gamma-deg gamma-rad geod-alt-ft h-agl-ft h-sl-ft lat-gc-deg lat-gc-rad \
         lat-geod-deg lat-geod-rad long-gc-deg long-gc-rad mach p-rad_sec phi-deg phi-rad psi-true-deg psi-true-rad q-rad_sec \
         r-rad_sec roc-fpm roc-fps targetNlf terrain-elevation-ft theta-deg theta-rad u-fps v-fps vc-kts vd-fps ve-fps ve-kts \
         vg-fps vg-kts vn-fps vt-fps vt-kts vw-bx-fps vw-by-fps vw-bz-fps vw-dir-deg vw-down-fps vw-east-fps vw-mag-fps \
         vw-north-fps w-fps",
    ),
    (
        "inertia/",
        "cg-x-in cg-y-in cg-z-in empty-weight-lbs ixx-slugs_ft2 ixy-slugs_ft2 ixz-slugs_ft2 iyy-slugs_ft2 iyz-slugs_ft2 \
         izz-slugs_ft2 mass-slugs print-mass-properties weight-lbs",
    ),
    (
        "inertial/",
        "sea-level-radius_ft",
    ),
    (
        "metrics/",
        "terrain-radius",
    ),
    (
        "moments/",
        "l-aero-lbsft l-buoyancy-lbsft l-external-lbsft l-gear-lbsft l-prop-lbsft l-total-lbsft m-aero-lbsft m-buoyancy-lbsft \
         m-external-lbsft m-gear-lbsft m-prop-lbsft m-total-lbsft n-aero-lbsft n-buoyancy-lbsft n-external-lbsft n-gear-lbsft \
         n-prop-lbsft n-total-lbsft pitch-stab-aero-lbsft pitch-wind-aero-lbsft roll-stab-aero-lbsft roll-wind-aero-lbsft \
         yaw-stab-aero-lbsft yaw-wind-aero-lbsft",
    ),
    (
        "orbital/",
        "apoapsis-radius-ft argument-of-perigee-deg eccentricity inclination-deg periapsis-radius-ft period-sec \
         right-ascension-deg specific-angular-momentum-ft2_sec true-anomaly-deg",
    ),
    (
        "position/",
        "distance-from-start-lat-mt distance-from-start-lon-mt distance-from-start-mag-mt ecef-x-ft ecef-y-ft ecef-z-ft \
         eci-x-ft eci-y-ft eci-z-ft epa-rad from-start-neu-e-ft from-start-neu-n-ft from-start-neu-u-ft geod-alt-ft geod-alt-km \
         lat-gc-deg lat-gc-rad lat-geod-deg lat-geod-rad long-gc-deg long-gc-rad radius-to-vehicle-ft terrain-elevation-asl-ft \
         vrp-gc-latitude_deg vrp-longitude_deg vrp-radius-ft",
    ),
    (
        "propulsion/",
        "active_engine cutoff_cmd fuel_dump fuel_freeze magneto_cmd pt-lbs_sqft refuel set-running starter_cmd tat-c tat-r \
         total-fuel-lbs total-oxidizer-lbs",
    ),
    (
        "simulation/",
        "channel-dt disperse do_linearization do_simple_trim dt force-output frame gravitational-torque gravity-model \
         integrator/position/rotational integrator/position/translational integrator/rate/rotational \
         integrator/rate/translational jsbsim-debug models/FGAccelerations/enabled models/FGAerodynamics/enabled \
         models/FGAircraft/enabled models/FGAtmosphere/enabled models/FGAuxiliary/enabled models/FGBuoyantForces/enabled \
         models/FGExternalReactions/enabled models/FGFCS/enabled models/FGGroundReactions/enabled models/FGInertial/enabled \
         models/FGInput/enabled models/FGMassBalance/enabled models/FGOutput/enabled models/FGPropagate/enabled \
         models/FGPropulsion/enabled models/FGWinds/enabled pause randomseed reset sim-time-sec terminate trim-completed \
         write-state-file",
    ),
    (
        "systems/",
        "stall-warn-norm",
    ),
    (
        "velocities/",
        "ecef-x-fps ecef-y-fps ecef-z-fps eci-velocity-mag-fps eci-x-fps eci-y-fps eci-z-fps ned-velocity-mag-fps",
    ),
];

/// Elements of which there is one or more, with the names of the properties that one of them may have.
#[rustfmt::skip]
const ELEMENTS: &[(&str, &str)] = &[
    (
        "buoyant_forces/gas-cell",
        "ballonet/blower-cmd-norm ballonet/contents-mol ballonet/dU_conduction ballonet/dU_radiation ballonet/in-flow-ft3ps \
         ballonet/max_volume-ft3 ballonet/pressure-psf ballonet/temp-R ballonet/valve_open ballonet/volume-ft3 buoyancy-lbs \
         burst contents-mol dU_conduction dU_radiation dU_sun max_volume-ft3 pressure-psf temp-R valve_open volume-ft3",
    ),
    (
        "contact/unit",
        "AGL-ft WOW bumpiness compression-ft compression-velocity-fps dynamic_friction_coeff maximum-force-lbs \
         rolling_friction-factor solid static-friction-factor static_friction_coeff x-position y-position z-position",
    ),
    (
        "gear/unit",
        "AGL-ft WOW bumpiness castered compression-ft compression-velocity-fps dynamic_friction_coeff maximum-force-lbs \
         pos-norm rolling_friction-factor rolling_friction_coeff side_friction_coeff slip-angle-deg solid \
         static-friction-factor static_friction_coeff steering-angle-deg wheel-speed-fps x-position y-position z-position",
    ),
    (
        "propulsion/engine",
        "AFR AugThrust EnginePowerVC IdleThrust InjN1increment InjN2increment InjWaterNorm InjectionTimer MaxN1 MaxN2 MilThrust \
         a0-rad a1-rad advance-ratio air-intake-impedance-factor antitorque-ctrl-rad atsfc b1-rad blade-angle bleed-factor \
         boost-speed boostloss-factor boostloss-hp brake-ctrl-norm bsfc-lbs_hphr cht-degF clutch-ctrl-norm collective-ctrl-rad \
         combustion_efficiency constant-speed-mode cooling-factor egt-degF engine-rpm engtemp-c free-wheel-transmission \
         friction-hp fuel-flow-rate-gph fuel-flow-rate-pps fuel-used-lbs groundeffect-scale-norm helical-tip-Mach \
         ielu_intervent induced-inflow-ratio inflow-ratio injection_cmd isp itt-c lateral-ctrl-rad longitudinal-ctrl-rad \
         map-inhg map-pa mixture-ratio n1 n2 oil-pressure-psi oil-temperature-degF oxi-flow-rate-pps phi-downwash-rad \
         pitch-angle-rad power-hp prop-induced-velocity_fps propeller-power-ftlbps propeller-rpm propeller-sense \
         propeller-torque-ftlb ram-air-factor reverser reverser-angle-rad rotor-rpm seized set-running stalled starter-norm \
         theta-downwash-rad thrust-coefficient thrust-lbs torque-lbsft total-impulse total-vac-impulse tsfc vacuum-thrust_lbs \
         vi-fps volumetric-efficiency x-position x-reference-position y-position y-reference-position yaw-angle-rad z-position \
         z-reference-position",
    ),
    (
        "propulsion/tank",
        "contents-lbs density-lbs_per_gal external-flow-rate-pps local-ixx-slug_ft2 local-iyy-slug_ft2 local-izz-slug_ft2 \
         pct-full priority unusable-volume-gal x-position y-position z-position",
    ),
];

/// Properties of an engine's controls, of which there is one for each engine.
const OF_ENGINES: &str = "throttle-cmd-norm throttle-pos-norm mixture-cmd-norm mixture-pos-norm advance-cmd-norm advance-pos-norm \
                          feather-cmd-norm feather-pos-norm";

/// Whether JSBSim has a property of a name, without the index of a first element, in some aircraft without a file that makes it.
pub(super) fn is_builtin(name: &str) -> bool {
    let among = |names: &str, wanted: &str| names.split_ascii_whitespace().any(|name| name == wanted);
    if ALWAYS.iter().any(|(folder, names)| name.strip_prefix(folder).is_some_and(|rest| among(names, rest))) {
        return true;
    }
    if let Some(rest) = name.strip_prefix("fcs/")
        && among(OF_ENGINES, without_index(rest))
    {
        return true;
    }
    ELEMENTS.iter().any(|(element, names)| {
        let rest = name.strip_prefix(element).and_then(|rest| {
            // The index of the element, where there is one.
            let end = if rest.starts_with('[') { rest.find(']')? + 1 } else { 0 };
            rest[end..].strip_prefix('/')
        });
        rest.is_some_and(|rest| among(names, rest))
    })
}

/// A name without the index at its end.
fn without_index(name: &str) -> &str {
    match name.strip_suffix(']').and_then(|rest| rest.split_once('[')) {
        Some((stem, index)) if index.bytes().all(|digit| digit.is_ascii_digit()) => stem,
        _ => name,
    }
}

/// Gives properties that are the same in every flight the values that JSBSim has for them, where the files name them: the
/// standard air at the sea and gravity. The load factor along the vertical axis is that of level flight. Gives the
/// indices of those that never change.
pub(super) fn begin_constants(model: &mut Model) -> Vec<usize> {
    let constants = [
        ("atmosphere/P-sl-psf", 2116.228),
        ("atmosphere/T-sl-R", 518.67),
        ("atmosphere/rho-sl-slugs_ft3", 1.225 / SLUG_FT3),
        ("atmosphere/a-sl-fps", 340.294 / FOOT),
        ("accelerations/gravity-ft_sec2", GRAVITY / FOOT),
    ];
    let level = [("accelerations/Nz", 1.0), ("accelerations/n-pilot-z-norm", -1.0), ("forces/load-factor", 1.0)];
    let mut begin = |name: &str, value: f64| {
        let index = model.find(name).filter(|&index| !model.properties[index].declared)?;
        model.begin(index, value);
        Some(index)
    };
    for (name, value) in level {
        begin(name, value);
    }
    constants.iter().filter_map(|&(name, value)| begin(name, value)).collect()
}
