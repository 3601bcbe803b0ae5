//! Tests: questions find their rows in the large tables by an index, according to the counters of the server.

use crate::answers;
use crate::server::Server;
use fleet::generate::{VALUES, Wanted, generate};
use fleet::set_up;
use history::inquiry::figures::figures;
use history::inquiry::shifts::{Shift, by_shift};
use history::{Archive, Filter};
use jiff::tz::TimeZone;

const WANTED: Wanted = Wanted {
    parts: 16_000,
    rigs: 10,
    days: 300,
};

/// Returns how many measurements the server has read by reading partitions whole, and how often it used an index.
async fn reads(server: &Server) -> [i64; 2] {
    let count = |column: &str| {
        format!(
            "SELECT sum({column})::bigint FROM pg_stat_user_tables WHERE relname LIKE 'measurement\\_2%'"
        )
    };
    let (whole, by_index) = (count("seq_tup_read"), count("idx_scan"));
    [server.number(&whole).await, server.number(&by_index).await]
}

/// Waits until the server has noted what ended sessions read.
async fn until_noted(server: &Server) {
    let others = "SELECT count(*) FROM pg_stat_activity WHERE application_name = 'relayrig'";
    while server.number(others).await > 0 {}
}

fn ask(all: &Archive, of_rig: &Archive) {
    let of_lot = Filter {
        lot: Some("L-3-1".to_owned()),
        ..Filter::default()
    };
    let filter = Filter {
        verdict: Some("fail".to_owned()),
        param: Some("made_up_7_v".to_owned()),
        min: Some(7.0),
        ..of_lot.clone()
    };
    assert!(!of_rig.query(&filter).unwrap().is_empty());
    let found = figures(of_rig, "made_up_3_v", &of_lot, None).unwrap();
    assert_eq!(found.summary.n, 1000);
    let life = all.of_serial("S-5-1234").unwrap();
    assert_eq!(life[0].values.len() as i64, VALUES);
}

#[test]
fn questions_find_measurements_by_an_index() {
    let server = Server::start();
    answers::wait(async {
        set_up(&server.owner()).await.unwrap();
        generate(&server.owner(), WANTED, |_| {}).await.unwrap();
        until_noted(&server).await;
    });
    let before = answers::wait(reads(&server));
    ask(
        &answers::database(&server, None),
        &answers::database(&server, Some("rig-003")),
    );
    let after = answers::wait(async {
        until_noted(&server).await;
        reads(&server).await
    });
    assert_eq!(after[0], before[0], "a question has read a whole partition");
    assert!(after[1] > before[1], "{before:?} {after:?}");
}

/// Asks one question; returns the partitions of parts that it used, and the parts and measurements read by reading
/// partitions whole.
fn used(server: &Server, question: impl FnOnce()) -> (i64, i64) {
    answers::wait(async {
        until_noted(server).await;
        server
            .number("SELECT (pg_stat_reset() IS NULL)::int::bigint")
            .await;
    });
    question();
    answers::wait(async {
        until_noted(server).await;
        let partitions = "SELECT count(*) FROM pg_stat_user_tables WHERE relname LIKE 'part\\_2%'
            AND seq_scan + idx_scan > 0";
        let whole = "SELECT coalesce(sum(seq_tup_read), 0)::bigint FROM pg_stat_user_tables
            WHERE relname LIKE 'part\\_2%' OR relname LIKE 'measurement\\_2%'";
        (server.number(partitions).await, server.number(whole).await)
    })
}

#[test]
fn questions_about_some_days_use_their_months_alone() {
    let server = Server::start();
    answers::wait(async {
        set_up(&server.owner()).await.unwrap();
        generate(&server.owner(), WANTED, |_| {}).await.unwrap();
    });
    let some_days = Filter {
        since: Some("-9d".parse().unwrap()),
        until: Some("-2d".parse().unwrap()),
        ..Filter::default()
    };
    let failed = Filter {
        verdict: Some("fail".to_owned()),
        ..some_days.clone()
    };
    let of_rig = || answers::database(&server, Some("rig-003"));
    let shifts = [Shift {
        name: "day".to_owned(),
        minutes: (0, 24 * 60),
    }];
    let zone = TimeZone::UTC;
    let filtered = used(&server, || drop(of_rig().query(&failed).unwrap()));
    let yields = used(&server, || {
        drop(by_shift(&of_rig(), &some_days, &shifts, &zone).unwrap());
    });
    for (partitions, whole) in [filtered, yields] {
        assert!((1..=2).contains(&partitions), "{partitions} months");
        assert_eq!(whole, 0, "rows of partitions read whole");
    }
    let (_, whole) = used(&server, || {
        let life = answers::database(&server, None).of_serial("S-5-1234");
        assert_eq!(life.unwrap().len(), 1);
    });
    assert_eq!(whole, 0, "the life of a serial number");
}

#[test]
fn made_up_rigs_never_join_real_ones() {
    let server = Server::start();
    answers::wait(async {
        set_up(&server.owner()).await.unwrap();
        let rig = crate::rig::Rig::new("rig-1");
        rig.run("A", 3, 1);
        rig.push(&server.owner()).await.unwrap();
        let refused = generate(&server.owner(), WANTED, |_| {}).await.unwrap_err();
        assert!(
            refused
                .to_string()
                .contains("found rigs of the plant suzhou"),
            "{refused}"
        );
    });
}
