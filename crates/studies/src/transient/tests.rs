//! Tests of cases files: reading, refusals, and answers equal to those of the file.
#![allow(clippy::unwrap_used)]

use super::*;
use serde_json::json;

const FILE: &str = include_str!("cases.json");

/// Returns the file with the value at `pointer` replaced, or removed for `None`.
fn with(pointer: &str, value: Option<Value>) -> String {
    let mut file: Value = serde_json::from_str(FILE).unwrap();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let place = file.pointer_mut(parent).unwrap();
    match (value, place) {
        (Some(value), Value::Array(list)) => list[key.parse::<usize>().unwrap()] = value,
        (Some(value), place) => place[key] = value,
        (None, place) => {
            place.as_object_mut().unwrap().remove(key);
        }
    }
    file.to_string()
}

#[track_caller]
fn refused(pointer: &str, value: Option<Value>, names: &str) {
    let error = cases::read(&with(pointer, value)).unwrap_err();
    let message = format!("{error:#}");
    assert!(
        message.contains(names) && message.contains("expected"),
        "{message}"
    );
}

/// Returns the largest error of the answers against those in the file, s: of first events and of later events.
fn distance(text: &str, rtol: f64) -> [f64; 2] {
    let file: Value = serde_json::from_str(text).unwrap();
    let mut worst = [0.0f64; 2];
    for (case, expected) in cases::read(text)
        .unwrap()
        .iter()
        .zip(file["cases"].as_array().unwrap())
    {
        let answer = integrate(case, rtol).unwrap().json();
        for (key, value) in expected["results"].as_object().unwrap() {
            let found = answer["results"][key].as_f64();
            let off = (found.unwrap() - value.as_f64().unwrap()).abs();
            assert!(
                off < 1e-7 || key.ends_with("speed") && off < 1e-5,
                "{} {key}: {off:e}",
                case.name
            );
            if !key.ends_with("speed") {
                let rank = usize::from(key.contains("last"));
                worst[rank] = worst[rank].max(off);
            }
        }
        let (own, theirs) = (
            answer["events"].as_array().unwrap(),
            expected["events"].as_array().unwrap(),
        );
        assert_eq!(own.len(), theirs.len(), "{}", case.name);
        for (one, other) in own.iter().zip(theirs) {
            assert_eq!((&one[1], &one[2]), (&other[1], &other[2]), "{}", case.name);
        }
    }
    worst
}

#[test]
fn the_answers_are_those_of_the_file() {
    let [first, last] = distance(FILE, 1e-10);
    assert!(first < 1e-9 && last < 1e-7, "{first:e} {last:e}");
}

#[test]
fn a_given_state_takes_precedence() {
    let given = [1e-3, 1e-6, 0.0, 0.0, 0.0];
    let cases = cases::read(&with("/cases/0/s0", Some(json!(given)))).unwrap();
    assert_eq!(cases[0].start, given);
    assert!(
        cases[1].start != given && cases[5].start[1] > 0.5e-3,
        "rest and sealed are found"
    );
}

#[test]
fn an_error_names_its_field() {
    refused(
        "/cases/0/t_end",
        Some(json!(0.0)),
        "cases[0].t_end: found 0.0",
    );
    refused(
        "/cases/0/t_end",
        Some(json!("soon")),
        "cases[0].t_end: found \"soon\"",
    );
    refused("/cases/1/t_end", None, "cases[1].t_end: missing");
    refused("/cases/0/name", None, "cases[0].name: missing");
    refused(
        "/cases/0/s0",
        Some(json!([0, 0, 0, 0])),
        "cases[0].s0: found [0,0,0,0]",
    );
    refused("/cases/0/s0", Some(json!([1, 0, 0, 0, 0])), "cases[0].s0");
    refused(
        "/cases/0/s0",
        Some(json!([0, 0, "v", 0, 0])),
        "cases[0].s0[2]",
    );
    refused("/cases/0/waveform", Some(json!([])), "cases[0].waveform");
    refused(
        "/cases/0/waveform",
        Some(json!([[0, 1], [0.1]])),
        "cases[0].waveform[1]",
    );
    refused(
        "/cases/0/waveform",
        Some(json!([[1, 1], [0, 2]])),
        "cases[0].waveform[1]",
    );
    refused("/cases/0/waveform", None, "cases[0].waveform: missing");
    refused(
        "/cases/0/freewheel_clamp_V",
        Some(json!(-1)),
        "cases[0].freewheel_clamp_V",
    );
    refused(
        "/cases/0/changed",
        Some(json!({"k_x": 1})),
        "cases[0].changed.k_x: unknown",
    );
    refused(
        "/cases/0/changed",
        Some(json!({"m_a": -1})),
        "cases[0].changed.m_a: found -1",
    );
    refused(
        "/cases/0/changed",
        Some(json!({"T": -300})),
        "cases[0].changed: found",
    );
    refused("/cases/0/waves", Some(json!(1)), "cases[0].waves: unknown");
    refused(
        "/parameters/N",
        Some(json!(null)),
        "parameters.N: found null",
    );
    refused(
        "/parameters/phis",
        Some(json!(0)),
        "parameters.phis: found 0",
    );
    refused("/cases", Some(json!([])), "cases: found none");
    refused("/cases", None, "cases: missing");
    let error = cases::read("{\"cases\": [").unwrap_err();
    assert!(format!("{error:#}").contains("line 1"), "{error:#}");
}

#[test]
fn an_initial_state_is_rest_or_sealed() {
    let with_initial = |label: &str| {
        let mut file: Value = serde_json::from_str(FILE).unwrap();
        file["cases"][0]["initial"] = json!(label);
        file["cases"][0].as_object_mut().unwrap().remove("s0");
        cases::read(&file.to_string())
    };
    assert!(with_initial("rest").is_ok() && with_initial("sealed9.5").is_ok());
    for label in ["sealed1", "sealed", "floating"] {
        let error = with_initial(label).unwrap_err();
        assert!(
            format!("{error:#}").contains("cases[0].initial"),
            "{error:#}"
        );
    }
}
