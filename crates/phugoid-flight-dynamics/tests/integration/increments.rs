//! Increments as scenario files name them, and as they change in flight.

use phugoid_flight_dynamics::increments::{IncrementChange, IncrementSchedule, Increments, ScheduleError};

#[test]
fn names_of_scenario_files() {
    let read: Increments = serde_json::from_str(r#"{"dCm_alpha": -0.2, "dCL_alpha": 0.4, "dCl_p": 0.05}"#).unwrap();
    assert_eq!(read, Increments { dCm_alpha: -0.2, dCL_alpha: 0.4, dCl_p: 0.05, ..Increments::NONE });
    let wrong = serde_json::from_str::<Increments>(r#"{"dCm_alfa": -0.2}"#).unwrap_err().to_string();
    assert!(wrong.contains("dCm_alfa") && wrong.contains("dCm_alpha"), "{wrong}");
}

#[test]
fn damage_counts_from_its_own_time_on() {
    let damage = Increments { dCm_alpha: 0.3, ..Increments::NONE };
    let worse = Increments { dCm_alpha: 0.5, ..Increments::NONE };
    let schedule = IncrementSchedule::new(vec![
        IncrementChange { time: 10.0, increments: damage },
        IncrementChange { time: 12.0, increments: worse },
    ])
    .unwrap();
    assert_eq!(schedule.at(9.999), Increments::NONE);
    assert_eq!(schedule.at(10.0), damage);
    assert_eq!(schedule.at(11.0), damage);
    assert_eq!(schedule.at(100.0), worse);
    assert_eq!(IncrementSchedule::constant(damage).at(-1e9), damage);
    assert_eq!(IncrementSchedule::default().at(5.0), Increments::NONE);
    // JSON has no infinity: a change for the whole flight goes without a time, there and back.
    for schedule in [schedule, IncrementSchedule::constant(damage)] {
        let text = serde_json::to_string(&schedule).unwrap();
        assert_eq!(serde_json::from_str::<IncrementSchedule>(&text).unwrap(), schedule, "{text}");
    }
}

#[test]
fn a_schedule_out_of_order_is_refused_with_its_place() {
    let change = |time| IncrementChange { time, increments: Increments::NONE };
    let error = IncrementSchedule::new(vec![change(1.0), change(5.0), change(3.0)]).unwrap_err();
    assert_eq!(error, ScheduleError::Disorder { index: 2, time: 3.0, previous: 5.0 });
    assert!(IncrementSchedule::new(vec![change(f64::NAN)]).is_err());
    let text = r#"[{"time": 5.0, "increments": {}}, {"time": 1.0, "increments": {}}]"#;
    let message = serde_json::from_str::<IncrementSchedule>(text).unwrap_err().to_string();
    assert!(message.contains("change 1 is at 1 s"), "{message}");
}
