//! A storm of line faults on the line task of the controller. `cargo bench -p bus --bench line_storm` runs the full
//! storm.

mod rage;

use rage::{EVERY_FAULT, rage, storm};

/// Transactions of a storm: every fault occurs about two hundred times.
const TRANSACTIONS: u64 = 20_000;

#[test]
fn faults_neither_swap_values_nor_hang_the_bus() {
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
fn each_fault_alone_is_reported_as_itself() {
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

/// Run time of a late host between two pauses, microseconds.
const RUNS_US: u64 = 7_301;
/// Pause of a late host, microseconds: longer than every time-out.
const HOST_PAUSE_US: u64 = 95_003;

#[test]
fn a_late_host_takes_no_module_for_silent() {
    let weather = virtual_time::block_on(async {
        tokio::spawn(async {
            loop {
                virtual_time::sleep_until(virtual_time::now_us() + RUNS_US).await;
                virtual_time::pause_host(HOST_PAUSE_US);
            }
        });
        storm(1, 2_000, &[]).await
    });
    let weather = weather.unwrap();
    assert!(weather.is_honest(), "{weather:#?}");
    assert_eq!(weather.believed, 2_000, "{weather:#?}");
    // The host paused for most of the time.
    assert!(weather.rig_s > 2_000.0 * 0.02, "{weather:#?}");
}
