//! The view as text at given sizes of the terminal.

use std::time::Duration;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use serde_json::{Value, json};

use super::*;

const HELLO: &str = r#"{"type":"hello","version":"0","source":"udp:127.0.0.1:14550","flight":0,"layout":{"model":"hfb320",
"method":"smpe","axes":["longitudinal"],"parameters":[
{"name":"CL_V","unit":"-","initial":0.2,"prior_std":0.2,"nuisance":false},
{"name":"Cm_alpha","unit":"per rad","initial":-1.0,"prior_std":0.3,"nuisance":false},
{"name":"Cm_q","unit":"per rad","initial":-30.0,"prior_std":10.0,"nuisance":false},
{"name":"bias_alpha","unit":"rad","initial":0.0,"prior_std":0.01,"nuisance":true}],"outputs":[],"inputs":[]}}"#;

fn estimate(time_s: f64) -> Value {
    let parameter = |value: f64, sigma: f64, status: &str, verdict: &str| json!({"value": value, "std_error": sigma, "status": status, "readiness": {"verdict": verdict, "reason": "r"}});
    json!({"type": "estimate", "flight": 0, "time_s": time_s, "phase": "sliding", "change": "steady", "parameters": [
        parameter(0.15, 0.09, "improving", "not_identifiable"),
        parameter(-0.99762 + 0.01 * (20.0 - time_s), 0.0203, "converged", "ready"),
        parameter(-35.71, 1.07, "converged", "doubtful"),
        {"value": 0.001, "std_error": null, "status": "not_excited", "readiness": null},
    ]})
}

struct Screen(State, Instant);

impl Screen {
    fn new(documents: &[Value]) -> Self {
        let mut screen = Self(State::default(), Instant::now());
        for document in documents {
            screen.0.take(&document.to_string(), screen.1);
        }
        screen
    }

    fn flying() -> Self {
        let mut screen = Self::new(&[serde_json::from_str(HELLO).unwrap()]);
        for second in 2..=20 {
            let mut estimate = estimate(f64::from(second));
            // Readiness is only where it was renewed.
            for parameter in estimate["parameters"].as_array_mut().into_iter().flatten().filter(|_| second > 4) {
                parameter.as_object_mut().unwrap().remove("readiness");
            }
            screen.0.take(&estimate.to_string(), screen.1);
        }
        let event = json!({"type": "event", "time_s": 12.4, "kind": "gap", "message": "nothing for 0.31 s"});
        let link = json!({"type": "link", "received": 12_345, "lost": 7, "late": 1, "reordered": 4, "restarts": 0,
            "latency_ms": {"p50": 0.21, "p99_9": 1.9}, "recorded_bytes": 2_500_000, "waiting": null});
        screen.0.take(&event.to_string(), screen.1);
        screen.0.take(&link.to_string(), screen.1);
        screen
    }

    fn lines(&self, width: u16, height: u16, later_s: u64) -> Vec<String> {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        let now = self.1 + Duration::from_secs(later_s);
        let picture = terminal.draw(|frame| draw(frame, &self.0, now)).unwrap();
        let cells = picture.buffer.content().chunks(usize::from(width));
        cells.map(|row| row.iter().map(|cell| cell.symbol()).collect::<String>().trim_end().to_owned()).collect()
    }
}

#[test]
fn a_flight_on_a_wide_terminal() {
    let lines = Screen::flying().lines(110, 14, 0);
    let expected = [
        "Phugoid  udp:127.0.0.1:14550, model hfb320, method smpe                                          ● live 20.0 s",
        "",
        "parameter     estimate    2 sigma unit      verdict                  course",
        "CL_V              0.15     ± 0.18           ⊘ needs another input    ▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅",
        "Cm_alpha        -0.998    ± 0.041 per rad   ✓ converged              ██▇▇▆▆▆▅▅▅▄▄▃▃▃▂▂▁▁",
        "Cm_q             -35.7      ± 2.1 per rad   ? doubtful               ▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅",
        "bias_alpha     0.05730        ± - deg       ○ not excited            ▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅▅",
        "",
        "link  received 12 345, lost 7, late 1, twice 0, out of order 4, restarts 0",
        "      latency 0.21 ms, 99.9 % below 1.90 ms; recorded 2.5 MB",
        "   12.40 s  gap: nothing for 0.31 s",
        "",
        "",
        "q leave   space pause   up/down scroll",
    ];
    assert_eq!(lines, expected, "{}", lines.join("\n"));
}

#[test]
fn the_smallest_terminal_keeps_values_and_verdicts() {
    let mut screen = Screen::flying();
    let lines = screen.lines(80, 11, 0);
    assert!(lines[3].contains("0.15     ± 0.18") && lines[3].contains("⊘ needs another input"), "{lines:?}");
    assert!(lines.iter().all(|line| !line.contains("bias_alpha")), "there is no room for the last: {lines:?}");
    screen.0.scroll(2);
    let lines = screen.lines(80, 11, 0);
    assert!(lines[3].starts_with("Cm_q") && lines[4].starts_with("bias_alpha"), "{lines:?}");
    screen.0.scroll(-5);
    assert!(screen.lines(80, 11, 0)[3].starts_with("CL_V"));
    // Nothing overflows where there is next to no room.
    for (width, height) in [(1, 1), (20, 3), (40, 6)] {
        screen.lines(width, height, 0);
    }
}

#[test]
fn states_are_shown_in_words() {
    let hello: Value = serde_json::from_str(HELLO).unwrap();
    assert!(Screen::new(&[]).lines(80, 11, 0)[1].contains("Waiting for measurements."));
    let link = json!({"type": "link", "received": 40, "waiting": "1.2 s of 2.0 s collected"});
    let waiting = Screen::new(&[hello.clone(), link]).lines(80, 11, 0);
    assert!(waiting[0].contains("◌ waiting") && waiting[1].contains("1.2 s of 2.0 s collected"), "{waiting:?}");
    let stale = Screen::flying().lines(80, 11, 7);
    assert!(stale[0].contains("△ old data 20.0 s") && stale[1].contains("No estimate for 7 s."), "{stale:?}");
    let mut screen = Screen::flying();
    screen.0.take(&json!({"type": "end", "reason": "the source has ended"}).to_string(), screen.1);
    let ended = screen.lines(80, 11, 60);
    assert!(ended[0].contains("■ ended") && ended[1].contains("the source has ended"), "{ended:?}");
    screen = Screen::flying();
    let mut doubt = estimate(21.0);
    doubt["change"] = json!("in_doubt");
    screen.0.take(&doubt.to_string(), screen.1);
    assert!(screen.lines(80, 11, 0)[1].contains("A change of the aircraft is suspected"));
    screen.0.take("{\"type\":", screen.1);
    assert!(screen.lines(80, 11, 0)[1].contains("was not understood"));
    // Types of later versions are ignored.
    let screen = Screen::new(&[hello, json!({"type": "weather"})]);
    assert!(screen.0.unreadable.is_none());
}

#[test]
fn a_pause_holds_the_picture_while_documents_are_taken() {
    let mut screen = Screen::flying();
    screen.0.pause();
    screen.0.take(&estimate(30.0).to_string(), screen.1);
    let paused = screen.lines(80, 11, 0);
    assert!(paused[0].contains("‖ paused 20.0 s"), "{paused:?}");
    screen.0.pause();
    assert!(screen.lines(80, 11, 0)[0].contains("● live 30.0 s"));
}
