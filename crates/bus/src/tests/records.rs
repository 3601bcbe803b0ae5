//! Tests of what a line records: trace, health, bounds, time.

use super::*;

#[test]
fn health_counts_each_module_and_each_kind_of_trouble() {
    let settings = settings();
    let log = settings.log.clone();
    let reset = Common::ReadResetStatus.to(Address(4));
    let script = vec![
        vec![(2_600, THIRTY)],
        vec![(2_600, b">0000001FD4\r")],
        vec![],
        vec![(2_000, b"!041B6\r")],
    ];
    let asks = [(count(), 1), (count(), 1), (count(), 1), (reset, 1)];
    let (got, _) = in_virtual_time(played(settings, script, &asks));
    assert_eq!(got[3].outcome, Ok(Reply::Flag(true)));
    let health = log.health();
    let module = health.module(Address(3)).unwrap();
    assert_eq!(
        (
            module.transactions,
            module.time_outs,
            module.checksum_errors
        ),
        (3, 1, 1)
    );
    let p50 = module.latency.percentile(0.5).unwrap().0;
    // 2600 us from request to reply, of which 19 characters are time on the wire.
    assert!((950..1_200).contains(&p50), "{p50}");
    assert_eq!(health.module(Address(4)).unwrap().resets, 1);
}

#[test]
fn fingerprints_agree_only_for_equal_traffic() {
    let fingerprint = |reply: &'static [u8]| {
        let settings = settings();
        let log = settings.log.clone();
        in_virtual_time(played(
            settings,
            vec![vec![(2_000, reply)]; 3],
            &[(count(), 1); 3],
        ));
        assert_eq!(log.trace().entries().count(), 6);
        assert_eq!(log.trace().entries().nth(1).unwrap().bytes(), reply);
        log.fingerprint()
    };
    assert_eq!(fingerprint(THIRTY), fingerprint(THIRTY));
    assert_ne!(fingerprint(THIRTY), fingerprint(NINE));
}

#[test]
fn the_trace_keeps_the_last_entries_only() {
    let mut settings = settings();
    settings.log = LineLog::with_trace(4);
    let log = settings.log.clone();
    in_virtual_time(played(
        settings,
        vec![vec![(2_000, THIRTY)]; 9],
        &[(count(), 1); 9],
    ));
    assert_eq!(log.trace().entries().count(), 4);
}

#[test]
fn the_longest_transaction_is_that_of_the_slowest_command() {
    let settings = settings();
    let both = longest_transaction(&settings, &[count(), write(), Command::HostOk]);
    assert_eq!(both, longest_transaction(&settings, &[count()]));
    // Three exchanges (request, repetition, resynchronisation), each 7 + 12 characters, 30 ms and a pause of two
    // characters. Then a silence of 12 characters and 30 ms.
    let wire = |characters| settings.wire().time(characters).0;
    assert_eq!(
        both.0,
        3 * (wire(7) + wire(12) + 30_000 + wire(2)) + wire(12) + 30_000
    );
    assert_eq!(longest_transaction(&settings, &[]), Span(0));
}

#[test]
fn a_virtual_second_passes_without_a_real_one() {
    in_virtual_time(async {
        let pace = Pace::virtual_time();
        pace.sleep_until(RigTime(3_560)).await;
        assert_eq!(pace.now(), RigTime(3_560));
        pace.sleep_until(RigTime(3_600_000_000)).await;
        assert_eq!(pace.now(), RigTime(3_600_000_000));
    });
}
