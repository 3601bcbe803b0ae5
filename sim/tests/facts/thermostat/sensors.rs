//! Tests of the sensors at their modules, with their faults.

use super::hand::Hand;

#[test]
fn three_sensors_agree_in_a_cold_chamber() {
    let mut hand = Hand::new(&[]);
    hand.wait(5.0);
    let [control, reference, rack] = hand.temperatures();
    assert!((18.0..28.0).contains(&control), "{control}");
    assert!((control - reference).abs() < 0.3, "{control} {reference}");
    assert!((control - rack).abs() < 0.3, "{control} {rack}");
    assert!((control - hand.heater_c()).abs() < 5.0);
}

#[test]
fn broken_and_touching_wires_leave_the_range() {
    let mut hand = Hand::new(&["control_open=1", "reference_short=1", "thermocouple_open=1"]);
    hand.wait(3.0);
    let reply = hand.request("#21");
    assert_eq!(&reply[..9], ">7FFF8000");
    assert_ne!(&reply[9..], "7FFF");
    assert_eq!(hand.request("#220"), ">+9999.9");
}

#[test]
fn a_stuck_sensor_stays_while_the_others_follow() {
    let mut hand = Hand::new(&["rack_stuck=1"]);
    hand.start();
    hand.drive(1.0, 0.0);
    hand.wait(5.0);
    let before = hand.temperatures();
    hand.wait(60.0);
    let after = hand.temperatures();
    assert!(after[0] > before[0] + 20.0);
    assert!((after[2] - before[2]).abs() < 0.01);
}

#[test]
fn a_drifting_sensor_leaves_the_others() {
    let mut hand = Hand::new(&["control_drift=1"]);
    hand.wait(5.0);
    let mean = |hand: &mut Hand| {
        let mut sum = 0.0;
        for _ in 0..50 {
            hand.wait(1.0);
            let [control, reference, _] = hand.temperatures();
            sum += control - reference;
        }
        sum / 50.0
    };
    let before = mean(&mut hand);
    hand.wait(3600.0);
    let after = mean(&mut hand);
    assert!((after - before - 0.51).abs() < 0.02, "{before} {after}");
}

#[test]
fn noise_of_a_reading_is_that_of_the_world() {
    let mut hand = Hand::new(&[]);
    hand.wait(600.0);
    let mut differences = Vec::new();
    for _ in 0..500 {
        hand.wait(1.0);
        let [control, reference, _] = hand.temperatures();
        differences.push(control - reference);
    }
    let mean = differences.iter().sum::<f64>() / 500.0;
    let squares = differences.iter().map(|it| (it - mean).powi(2));
    let sd = (squares.sum::<f64>() / 500.0 / 2.0).sqrt();
    assert!((sd / 0.02 - 1.0).abs() < 0.15, "{sd}");
}

#[test]
fn heater_and_mains_faults_take_their_power() {
    let heated_k = |fault: &str| {
        let mut hand = Hand::new(&[]);
        if !fault.is_empty() {
            hand.rig.inject(fault).expect("a fault");
        }
        hand.start();
        let before = hand.temperatures()[0];
        hand.drive(0.5, 0.0);
        hand.wait(60.0);
        hand.temperatures()[0] - before
    };
    let whole = heated_k("");
    for (fault, share) in [
        ("heater_half", 0.5),
        ("heater_open", 0.0),
        ("mains_low", 0.7225),
    ] {
        let rise = heated_k(fault);
        // The fan alone warms by a kelvin or two.
        assert!(
            (rise - whole * share).abs() < 1.5,
            "{fault}: {rise} of {whole}"
        );
    }
}
