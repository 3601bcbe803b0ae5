//! Tests: a database answers as the history file does, for one rig and for many.

use crate::rig::Rig;
use crate::server::Server;
use config::{FleetTarget, Folder, TlsChoice, load_recipe};
use fleet::differential::compare;
use fleet::{Reader, Rigs, set_up};
use history::inquiry::shifts::{Shift, by_shift};
use history::{Archive, Filter};
use jiff::tz::TimeZone;

/// Opens the database for the rigs of this name.
pub fn database(server: &Server, rig: Option<&str>) -> Archive {
    let rigs = Rigs {
        site: None,
        rig: rig.map(str::to_owned),
    };
    let target = server.owner();
    Archive::of_server(Box::new(Reader::open(&target, &rigs).unwrap()))
}

/// Runs `work` on a runtime of its own, which does not disturb the runtime of a reader.
pub fn wait<T>(work: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.unwrap().block_on(work)
}

/// Makes two rigs with one lot of the same name, and a database that has both.
fn two_rigs() -> (Server, [Rig; 2]) {
    let server = Server::start();
    wait(set_up(&server.owner())).unwrap();
    let rigs = [Rig::new("rig-1"), Rig::new("rig-2")];
    for rig in &rigs {
        rig.run("A", 60, 3);
        rig.gates("A");
        rig.run("B", 25, 3);
        rig.run("A", 10, 2);
        rig.external("E");
        rig.cut_off("C", || {
            wait(rig.push(&server.owner())).unwrap();
        });
        wait(rig.push(&server.owner())).unwrap();
    }
    (server, rigs)
}

#[test]
fn a_database_answers_like_the_file() {
    let (server, rigs) = two_rigs();
    let recipe = load_recipe(&Folder::built_in(), "jzc-22f-012").unwrap();
    let file = Archive::open(&rigs[1].db).unwrap();
    let there = database(&server, Some("rig-2"));
    let asked = compare((&file, &there), (250, 7), &[recipe]).unwrap();
    let different = &asked.different[..asked.different.len().min(3)];
    assert_eq!(different, [""; 0], "{} differ", asked.different.len());
    assert!(asked.refused < 80 && asked.bytes > 100_000, "{asked:?}");
}

#[test]
fn without_a_rig_all_rigs_answer() {
    let (server, _rigs) = two_rigs();
    let all = database(&server, None);
    let of_lot = Filter {
        lot: Some("A".to_owned()),
        ..Filter::default()
    };
    assert_eq!(all.count_parts(&of_lot).unwrap(), 142);
    let named = |rig: &str| {
        all.lots(&of_lot)
            .unwrap()
            .iter()
            .filter(|it| it.rig.as_deref() == Some(rig))
            .count()
    };
    assert_eq!((named("suzhou/rig-1"), named("suzhou/rig-2")), (3, 3));
    let life = all.of_serial("A-000007").unwrap();
    assert_eq!(life.len(), 4, "two runs on each rig");
    assert!(life.iter().all(|it| !it.measurements.is_empty()));
}

#[test]
fn only_a_file_answers_what_was_never_sent() {
    let (server, _rigs) = two_rigs();
    let refused = database(&server, None).plans(5).unwrap_err().to_string();
    assert!(
        refused.contains("127.0.0.1") && refused.contains("history file of the rig"),
        "{refused}"
    );
}

#[test]
fn an_unknown_rig_is_refused_with_those_there_are() {
    let (server, _rigs) = two_rigs();
    let rigs = Rigs {
        site: Some("suzhou".to_owned()),
        rig: Some("rig-9".to_owned()),
    };
    let refused = Reader::open(&server.owner(), &rigs)
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("found no rig suzhou/rig-9, expected one of suzhou/rig-1, suzhou/rig-2"),
        "{refused}"
    );
}

#[test]
fn a_question_that_fails_speaks_of_no_queue() {
    let nowhere = FleetTarget {
        url: "postgres://office@127.0.0.1:1/relayrig".to_owned(),
        tls: TlsChoice::Off,
        ..FleetTarget::default()
    };
    let refused = Reader::open(&nowhere, &Rigs::default()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "postgres://office@127.0.0.1:1/relayrig: Connection refused (os error 111) (while connecting). Check address, \
         network and server"
    );
}

#[test]
fn shifts_count_alike_in_file_and_database() {
    let (server, rigs) = two_rigs();
    let file = Archive::open(&rigs[0].db).unwrap();
    let shifts =
        [("early", (6 * 60, 14 * 60)), ("night", (22 * 60, 30 * 60))].map(|(name, minutes)| {
            Shift {
                name: name.to_owned(),
                minutes,
            }
        });
    let filter = Filter {
        since: Some("2026-01-31T00:00:00Z".parse().unwrap()),
        until: Some("2026-02-02T00:00:00Z".parse().unwrap()),
        ..Filter::default()
    };
    let ask = |archive: &Archive| by_shift(archive, &filter, &shifts, &TimeZone::UTC).unwrap();
    let here = ask(&file);
    assert_eq!(
        here.len(),
        1,
        "only the night of 31 January has parts: {here:?}"
    );
    let parts = file.count_parts(&Filter::default()).unwrap();
    assert_eq!(here[0].counts.parts, parts - 1, "one was tested again");
    let mut there = ask(&database(&server, None));
    assert_eq!(there.len(), 2, "one entry for each rig");
    assert_eq!(there[0].rig.take().as_deref(), Some("suzhou/rig-1"));
    assert_eq!(there[0], here[0]);
}
