//! Tests: the overview of all rigs gives the counts that a history gives, and reads few rows.

use crate::answers::{database, wait};
use crate::rig::{BEGIN_US, Rig};
use crate::server::Server;
use fleet::generate::{Wanted, generate};
use fleet::overview::{Watched, overview};
use fleet::set_up;
use history::inquiry::rigs::{Condition, Overview};
use history::inquiry::shifts::{Shift, by_shift};
use history::{Filter, Moment};
use jiff::tz::TimeZone;

fn watched(server: &Server) -> Watched {
    let shift = |(name, minutes): (&str, (u16, u16))| Shift {
        name: name.to_owned(),
        minutes,
    };
    let shifts = [("early", (6 * 60, 14 * 60)), ("night", (22 * 60, 30 * 60))];
    Watched {
        target: server.owner(),
        shifts: shifts.map(shift).to_vec(),
        zone: TimeZone::UTC,
    }
}

/// Asks ten minutes after the first part.
fn ask(server: &Server) -> Overview {
    let at = Moment(BEGIN_US + 600_000_000);
    wait(overview(&watched(server), Some(at))).unwrap()
}

/// Makes two rigs that have sent what `work` does on each.
fn two_rigs(work: impl Fn(&Rig)) -> (Server, [Rig; 2]) {
    let server = Server::start();
    wait(set_up(&server.owner())).unwrap();
    let rigs = [Rig::new("rig-1"), Rig::new("rig-2")];
    for rig in &rigs {
        work(rig);
        wait(rig.push(&server.owner())).unwrap();
    }
    (server, rigs)
}

#[test]
fn an_overview_counts_as_shifts_do() {
    let (server, _rigs) = two_rigs(|rig| {
        rig.run("A", 60, 3);
        rig.gates("A");
        rig.run("B", 25, 3);
    });
    let day = ask(&server).day.unwrap();
    let filter = Filter {
        since: Some(Moment(BEGIN_US - 3_600_000_000)),
        until: Some(Moment(BEGIN_US + 600_000_000)),
        ..Filter::default()
    };
    let all = database(&server, None);
    let shifts = by_shift(&all, &filter, &watched(&server).shifts, &TimeZone::UTC).unwrap();
    assert_eq!(shifts.len(), 2, "one night on each rig");
    for (rig, expected) in day.rigs.iter().zip(&shifts) {
        let night = rig.shifts.iter().find(|it| it.counts.parts > 0);
        let night = night.unwrap_or_else(|| panic!("{rig:?}"));
        assert_eq!(
            (night.counts, &night.shift),
            (expected.counts, &expected.shift)
        );
        assert_eq!(Some(format!("{}/{}", rig.site, rig.rig)), expected.rig);
        assert_eq!(rig.counts, expected.counts, "all parts are of one night");
        let [reason] = rig.reasons.as_slice() else {
            panic!("{:?}", rig.reasons);
        };
        assert_eq!(reason.n, 8, "every tenth part fails");
    }
    assert_eq!(day.rigs.len(), 2);
}

#[test]
fn a_rig_shows_its_latest_run_and_its_alarms() {
    let (server, rigs) = two_rigs(|rig| rig.run("A", 12, 1));
    rigs[1].cut_off("C", || {});
    wait(rigs[1].push(&server.owner())).unwrap();
    let now = ask(&server).now.unwrap();
    let [one, other] = now.rigs.as_slice() else {
        panic!("{now:?}");
    };
    let lots = [one, other].map(|it| it.run.as_ref().unwrap().lot.as_str());
    assert_eq!(lots, ["A", "C"]);
    assert_eq!([one.parts_per_hour, other.parts_per_hour], [12, 16]);
    assert_eq!(
        [one.condition, other.condition],
        [Condition::Late; 2],
        "sent long after"
    );
    assert_eq!(one.alarms[0].code, "part_lost");
    assert!(one.contact.is_some() && one.lag_s.is_some(), "{one:?}");
}

#[test]
fn a_drift_that_two_rigs_share_is_seen() {
    let (server, _rigs) = two_rigs(|rig| {
        rig.reference("A", 1, 7.0);
        rig.reference("A", 60, 7.1);
        rig.reference("A", 120, 7.3);
    });
    let references = ask(&server).day.unwrap().references;
    assert_eq!(references.len(), 2, "{references:?}");
    for it in &references {
        assert_eq!((it.first, it.last, it.checks), (7.0, 7.3, 3), "{it:?}");
        assert_eq!((it.shared, it.from_others), (true, Some(0.0)), "{it:?}");
    }
}

/// Returns how many parts the server has read by reading partitions whole.
fn read_whole(server: &Server) -> i64 {
    wait(async {
        let others = "SELECT count(*) FROM pg_stat_activity WHERE application_name = 'relayrig'";
        // The server notes what a session read when the session ends.
        while server.number(others).await > 0 {}
        let sum = "SELECT coalesce(sum(seq_tup_read), 0)::bigint FROM pg_stat_user_tables
            WHERE relname LIKE 'part\\_2%' OR relname LIKE 'measurement\\_2%'";
        server.number(sum).await
    })
}

#[test]
fn an_overview_reads_no_partition_whole() {
    let wanted = Wanted {
        parts: 40_000,
        rigs: 10,
        days: 100,
    };
    let server = Server::start();
    wait(async {
        set_up(&server.owner()).await.unwrap();
        generate(&server.owner(), wanted, |_| {}).await.unwrap();
    });
    let before = read_whole(&server);
    let seen = wait(overview(&watched(&server), None)).unwrap();
    assert_eq!(seen.day.unwrap().rigs.len(), 10);
    assert_eq!(
        read_whole(&server),
        before,
        "a question has read a whole partition"
    );
}
