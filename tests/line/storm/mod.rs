//! A storm of line faults over the controller's line task. The full one: `cargo bench --bench line_storm`.

mod rage;

use rage::{EVERY_FAULT, rage};

/// Enough for every fault to strike some two hundred times.
const TRANSACTIONS: u64 = 20_000;

#[test]
fn in_a_storm_of_faults_no_value_is_taken_for_another_and_nothing_hangs() {
    let weather = rage(1, TRANSACTIONS, &EVERY_FAULT);
    assert!(weather.is_honest(), "seed 1: {weather:#?}");
    assert_eq!(weather.transactions, TRANSACTIONS);
    assert!(weather.failures.len() >= 5, "too calm: {weather:#?}");
    assert!(weather.believed > TRANSACTIONS / 2, "{weather:#?}");
}

#[test]
fn without_faults_every_transaction_is_believed() {
    let weather = rage(1, 2_000, &[]);
    assert!(weather.is_honest(), "{weather:#?}");
    assert_eq!(weather.believed, 2_000, "{weather:#?}");
}

#[test]
fn each_fault_alone_is_told_in_its_own_way() {
    for fault in EVERY_FAULT {
        let (name, _) = fault.split_once('=').unwrap();
        let often = match name {
            "late" => "late=0.2/200".to_owned(),
            "port_lost" => "port_lost=0.2/20".to_owned(),
            name => format!("{name}=0.2"),
        };
        let weather = rage(2, 500, &[&often]);
        assert!(weather.is_honest(), "{often}: {weather:#?}");
        assert!(
            name == "reset" || !weather.failures.is_empty(),
            "{often}: {weather:#?}"
        );
    }
}
