//! Writes an input as files: for `phugoid simulate` and for autopilots.

use std::fmt::Write as _;
use std::path::Path;

use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Quantity, Record};

use super::{Design, DesignError};
use phugoid_simulation::manoeuvre::Surface;

/// The input as a record: time and the deflection of each surface from trim, zero first, so that a manoeuvre of type `csv`
/// plays exactly it.
pub fn record(design: &Design) -> Record {
    let channels = design
        .inputs
        .iter()
        .map(|input| Channel {
            name: input.surface.name().to_owned(),
            quantity: Quantity::Angle,
            values: input.deflection.clone(),
        })
        .collect();
    let rows = design.time_s.len();
    let sample_time_s = 1.0 / design.sample_rate_hz;
    Record {
        source: format!("{} input", design.kind.name()),
        time: design.time_s.clone(),
        channels,
        quality: QualityReport { rows_read: rows, rows_kept: rows, sample_time_s, ..QualityReport::default() },
    }
}

/// A scenario file that plays `csv` (a path relative to the scenario file): the text of the scenario that the input was designed
/// for, with its manoeuvres, duration and sample rate replaced. The file of its aircraft, which is relative to `folder`, gets
/// its whole path: the new scenario may lie elsewhere.
///
/// # Errors
/// [`DesignError::Unsuitable`] if the text is no TOML.
pub fn scenario_text(scenario: &str, folder: &Path, design: &Design, csv: &str) -> Result<String, DesignError> {
    let unsuitable = |e: &dyn std::fmt::Display| DesignError::Unsuitable(e.to_string());
    let mut table: toml::Table = scenario.parse().map_err(|e: toml::de::Error| unsuitable(&e))?;
    let file = table.get_mut("aircraft").and_then(|aircraft| aircraft.get_mut("file"));
    if let Some(file) = file
        && let Some(whole) = file.as_str().and_then(|path| std::fs::canonicalize(folder.join(path)).ok())
    {
        *file = toml::Value::String(whole.to_string_lossy().into_owned());
    }
    let manoeuvre = |surface: Surface| {
        let keys = [("type", "csv"), ("surface", surface.name()), ("file", csv)];
        toml::Value::Table(keys.map(|(key, value)| (key.to_owned(), value.into())).into_iter().collect())
    };
    let manoeuvres = design.inputs.iter().map(|input| manoeuvre(input.surface)).collect();
    table.insert("manoeuvre".to_owned(), toml::Value::Array(manoeuvres));
    let name = table.get("name").and_then(toml::Value::as_str).unwrap_or("scenario");
    table.insert("name".to_owned(), format!("{name}, with a designed {}", design.kind.name()).into());
    let duration = design.time_s.last().copied().unwrap_or(0.0);
    table.insert("duration".to_owned(), format!("{duration} s").into());
    table.insert("sample_rate".to_owned(), format!("{} Hz", design.sample_rate_hz).into());
    let text = toml::to_string(&table).map_err(|e| unsuitable(&e))?;
    Ok(format!("# Plays the input in `{csv}`, designed by `phugoid design`.\n{text}"))
}

/// What stands at the head of every file for an autopilot, line by line.
fn header(design: &Design) -> Vec<String> {
    let duration = design.time_s.last().copied().unwrap_or(0.0);
    let mut lines = vec![
        format!("{} input for system identification, written by `phugoid design`", design.kind.name()),
        format!("{duration} s at {} samples per second; commands are held between the samples", design.sample_rate_hz),
        "Deflections from trim in degrees. Signs: elevator positive trailing edge down, aileron positive".to_owned(),
        "right trailing edge down, rudder positive trailing edge left. CHECK THEM ON THE GROUND.".to_owned(),
    ];
    for input in &design.inputs {
        lines.push(format!(
            "Largest {} deflection {:.3} deg, largest rate {:.1} deg/s",
            input.surface.name(),
            input.peak().to_degrees(),
            input.peak_rate(1.0 / design.sample_rate_hz).to_degrees()
        ));
    }
    lines.extend(
        [
            "SAFETY: the amplitudes come from a simulation, not from this aircraft. Fly a tenth of them first, with",
            "height in hand, in steady trimmed flight, within the cleared envelope, and with a pilot who can stop it",
            "at any moment. The author of this file does not know your aircraft.",
        ]
        .map(str::to_owned),
    );
    lines
}

/// A table for any autopilot or test equipment that can play one: `time_s` and `<surface>_deg` from trim, with units, signs,
/// amplitudes and a safety note in `#` lines before it.
pub fn table(design: &Design) -> String {
    let mut text: String = header(design).iter().map(|line| format!("# {line}\n")).collect();
    text.push_str("time_s");
    for input in &design.inputs {
        let _ = write!(text, ",{}_deg", input.surface.name());
    }
    text.push('\n');
    for (k, t) in design.time_s.iter().enumerate() {
        let _ = write!(text, "{t:.4}");
        for input in &design.inputs {
            let degrees = input.deflection.get(k).copied().unwrap_or(0.0).to_degrees();
            let _ = write!(text, ",{}", number(degrees));
        }
        text.push('\n');
    }
    text
}

/// A Lua script for ArduPilot (Plane 4.1 or later, `SCR_ENABLE` = 1) that plays the input on top of the servo positions of the
/// moment in which a switch is raised, and stops at once when it is lowered or another mode is chosen.
///
/// It uses `SRV_Channels:set_output_pwm_chan_timeout`, which gives the servo back after its time if the script stops. Throttle
/// and surfaces that the input leaves alone stay with the autopilot. Degrees become pulse widths through `SERVOn_MIN`,
/// `SERVOn_MAX` and the travel entered at the top of the script.
pub fn ardupilot_lua(design: &Design) -> String {
    let mut text: String = header(design).iter().map(|line| format!("-- {line}\n")).collect();
    text.push_str(
        "-- Needs SCR_ENABLE = 1 and memory for the tables below (SCR_HEAP_SIZE). Set these four before use:\n\
         local SWITCH_CHANNEL = 7        -- RC channel of the switch: above 1700 us plays, below stops\n\
         local PART_OF_AMPLITUDE = 0.1   -- 1 for the whole input; begin with 0.1\n",
    );
    let functions = |surface: Surface| match surface {
        Surface::Elevator => 19,
        Surface::Aileron => 4,
        Surface::Rudder => 21,
    };
    text.push_str("local surfaces = {\n");
    for input in &design.inputs {
        let _ = writeln!(
            text,
            "  -- {name}: SERVOn_FUNCTION; deflection (deg) from SERVOn_TRIM to SERVOn_MAX; -1 if a longer pulse moves it the \
             negative way\n  {{ name = \"{name}\", servo_function = {function}, travel_deg = 25.0, sign = 1, deflection_deg = {{",
            name = input.surface.name(),
            function = functions(input.surface)
        );
        for chunk in input.deflection.chunks(20) {
            let cells: Vec<String> = chunk.iter().map(|d| number(d.to_degrees())).collect();
            let _ = writeln!(text, "    {},", cells.join(","));
        }
        text.push_str("  } },\n");
    }
    let _ = write!(
        text,
        "}}\nlocal PERIOD_MS = {period:.3}\nlocal SAMPLES = {samples}\n{PLAYER}",
        period = 1000.0 / design.sample_rate_hz,
        samples = design.time_s.len()
    );
    text
}

/// Three decimals without trailing zeros or a negative zero: a servo resolves no more, and a flight controller has little memory.
fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

const PLAYER: &str = r#"
local UPDATE_MS = math.max(5, math.floor(PERIOD_MS))
local start_ms = nil     -- while playing: when it began
local start_mode = nil
local played = false     -- the switch has to be lowered before it plays again

local function stop(words)
  for _, s in ipairs(surfaces) do
    if s.channel and s.trim_pwm then
      SRV_Channels:set_output_pwm_chan_timeout(s.channel, s.trim_pwm, 0)
    end
  end
  start_ms = nil
  played = true
  gcs:send_text(5, "input: " .. words)
end

local function begin()
  for _, s in ipairs(surfaces) do
    s.channel = SRV_Channels:find_channel(s.servo_function)
    s.trim_pwm = SRV_Channels:get_output_pwm(s.servo_function)
    if not s.channel or not s.trim_pwm then
      played = true
      gcs:send_text(3, "input: no servo for the " .. s.name)
      return
    end
    s.min = param:get("SERVO" .. s.channel + 1 .. "_MIN")
    s.max = param:get("SERVO" .. s.channel + 1 .. "_MAX")
    s.pwm_per_deg = s.sign * (s.max - param:get("SERVO" .. s.channel + 1 .. "_TRIM")) / s.travel_deg
  end
  start_ms = millis()
  start_mode = vehicle:get_mode()
  gcs:send_text(5, "input: playing")
end

function update()
  local wanted = arming:is_armed() and (rc:get_pwm(SWITCH_CHANNEL) or 0) > 1700
  if start_ms == nil then
    if not wanted then
      played = false
    elseif not played then
      begin()
    end
    return update, UPDATE_MS
  end
  if not wanted then
    stop("stopped by the switch")
  elseif vehicle:get_mode() ~= start_mode then
    stop("stopped by a change of mode")
  else
    local index = math.floor((millis() - start_ms):tofloat() / PERIOD_MS) + 1
    if index > SAMPLES then
      stop("finished")
    else
      for _, s in ipairs(surfaces) do
        local pwm = s.trim_pwm + PART_OF_AMPLITUDE * s.deflection_deg[index] * s.pwm_per_deg
        pwm = math.max(s.min, math.min(s.max, pwm))
        SRV_Channels:set_output_pwm_chan_timeout(s.channel, math.floor(pwm + 0.5), 4 * UPDATE_MS)
      end
    end
  end
  return update, UPDATE_MS
end

gcs:send_text(5, "input: ready, raise the switch to play")
return update()
"#;
