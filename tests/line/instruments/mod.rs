//! Links to SCPI instruments against the simulated instruments: storms of faults in virtual time, commands in real
//! time, lots in both.

#[cfg(unix)]
mod commands;
mod lot;
mod storm;

use storm::{WAYS, Way, each_fault, every_fault, storm};

/// Rig time of a storm of all faults; `cargo bench --bench link_storm` sends a hundred thousand queries.
const TOGETHER_S: f64 = 100.0;
/// Rig time of a storm of one fault.
const ALONE_S: f64 = 10.0;

#[test]
fn no_reply_reaches_another_query_under_all_faults() {
    virtual_time::block_on(async {
        for (seed, way) in (1..).zip(WAYS) {
            let weather = storm(way, seed, &every_fault(0.01, TOGETHER_S), TOGETHER_S).await;
            assert!(weather.is_honest(), "{way:?}: {weather:#?}");
            assert!(!weather.failures.is_empty(), "{way:?}: no fault struck");
        }
    })
    .unwrap();
}

/// Each fault, the way on which it strikes, and the names of the first failures that it causes; none when a link must
/// survive the fault. Half a command, a busy port and another identity strike only after a connection has ended.
const EACH: [(&str, Way, &[&str]); 24] = [
    ("reply_lost=1", Way::Network, &["timeout"]),
    ("reply_late=1/1000", Way::Network, &["timeout"]),
    ("reply_late=1/1500", Way::Network, &["timeout"]),
    ("reply_late=1/10000", Way::Network, &["timeout"]),
    ("reply_twice=1", Way::Network, &["malformed"]),
    ("reply_joined=1", Way::Network, &["timeout"]),
    ("reply_split=1", Way::Network, &[]),
    ("reply_crlf=1", Way::Network, &[]),
    ("block_cut=1", Way::Blocks, &["malformed"]),
    ("block_empty=1", Way::Blocks, &["malformed"]),
    ("block_huge=1", Way::Blocks, &["malformed"]),
    ("block_newline=1", Way::Blocks, &[]),
    ("closed_before=1", Way::Network, &["disconnected"]),
    ("closed_inside=1", Way::Network, &["disconnected"]),
    ("half_kept=1", Way::Network, &["disconnected"]),
    ("port_busy=1", Way::Network, &["disconnected", "link_down"]),
    ("send_paused=1/500", Way::Network, &[]),
    ("errors_overflow=1", Way::Network, &["queue_overflow"]),
    ("local=1", Way::Network, &["local"]),
    ("power_cycle=1", Way::Network, &["timeout", "power_cycled"]),
    ("over_range=1", Way::Network, &["over_range"]),
    ("not_a_number=1", Way::Network, &["not_a_number"]),
    (
        "wrong_identity=1",
        Way::Network,
        &["disconnected", "wrong_identity"],
    ),
    ("address_changed=1", Way::Adapter, &["adapter_address"]),
];

#[test]
fn each_fault_has_its_name_and_leaves_nothing() {
    virtual_time::block_on(async {
        let name = |fault: &str| fault.split_once('=').map_or("", |it| it.0).to_owned();
        let mut tried: Vec<String> = EACH.iter().map(|it| name(it.0)).collect();
        tried.dedup();
        let known = rigsim::fault::instrument::list().into_iter();
        assert_eq!(tried, known.map(|it| it.name).collect::<Vec<_>>());
        for (fault, way, names) in EACH {
            let mut faults = vec![format!("{fault}@0.5..2")];
            if ["half_kept", "port_busy", "wrong_identity"].contains(&name(fault).as_str()) {
                faults.push("closed_before=1@0.5..0.6".to_owned());
            }
            let mut weather = storm(way, 1, &faults, 2.0).await;
            assert!(weather.is_honest(), "{faults:?}: {weather:#?}");
            weather.failures.dedup();
            let first = weather.failures.iter().take(names.len().max(1));
            assert!(first.eq(names), "{faults:?}: {weather:#?}");
        }
    })
    .unwrap();
}

#[test]
fn no_reply_reaches_another_query_under_one_fault() {
    virtual_time::block_on(async {
        for (seed, (way, faults)) in (1..).zip(each_fault(0.03, ALONE_S)) {
            let weather = storm(way, seed, &faults, ALONE_S).await;
            assert!(weather.is_honest(), "{faults:?}, {way:?}: {weather:#?}");
        }
    })
    .unwrap();
}

#[test]
fn a_calm_link_delivers_everything() {
    virtual_time::block_on(async {
        for way in WAYS {
            let weather = storm(way, 5, &[], 0.0).await;
            assert_eq!(weather.delivered, weather.queries, "{way:?}: {weather:#?}");
            assert!(weather.is_honest(), "{way:?}: {weather:#?}");
        }
    })
    .unwrap();
}
