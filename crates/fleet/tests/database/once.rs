//! Tests: every row of a history arrives once and unchanged.

use crate::rig::Rig;
use crate::server::Server;
use fleet::{Pusher, SCHEMA, Setup, TargetState, set_up};
use history::Store;
use history::outbox::SampleChoice;
use std::time::Duration;

/// Longest wait for an attempt of the sender on a busy machine.
const LONG: Duration = Duration::from_secs(120);

#[tokio::test]
async fn every_row_of_a_history_arrives_once() {
    let server = Server::start();
    let first = set_up(&server.owner()).await.unwrap();
    assert!(matches!(first, Setup { from: 0, to: SCHEMA, partitions } if partitions >= 72));
    let again = set_up(&server.owner()).await.unwrap();
    assert_eq!(
        again,
        Setup {
            from: SCHEMA,
            to: SCHEMA,
            partitions: 0
        }
    );

    let rig = Rig::new("rig-1");
    rig.run("A", 120, 3);
    let pushed = rig.push(&server.owner()).await.unwrap();
    assert_eq!(pushed.parts, 120);
    rig.run("B", 30, 3);
    assert_eq!(rig.push(&server.owner()).await.unwrap().parts, 30);
    assert_eq!(
        rig.push(&server.owner()).await.unwrap(),
        fleet::Pushed::default()
    );

    for table in ["run", "part", "measurement", "sample", "reason"] {
        let sql = format!("SELECT count(*) FROM {table}");
        let there = server
            .number(&format!("SELECT count(*) FROM relayrig.{table}"))
            .await;
        assert_eq!(there, rig.number(&sql), "{table}");
    }
    let value = "SELECT count(*) FROM relayrig.measurements AS m WHERE lot = 'A' AND seq = 20 AND value = 7.02";
    assert_eq!(server.number(value).await, 1, "to the last digit");
    let closed = "SELECT count(*) FROM relayrig.lots WHERE rig = 'rig-1' AND closed IS NOT NULL AND parts IN (120, 30)";
    assert_eq!(server.number(closed).await, 2);
    let months = "SELECT count(DISTINCT tableoid) FROM relayrig.part";
    assert_eq!(server.number(months).await, 2, "January and February");
    assert_eq!(
        server
            .number("SELECT count(*) FROM relayrig.alarms WHERE code = 'part_lost'")
            .await,
        2
    );
}

#[tokio::test]
async fn what_becomes_known_later_arrives_later() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 5, 1);
    rig.push(&server.owner()).await.unwrap();
    let landed = "SELECT count(*) FROM relayrig.part_now WHERE landed_bin = 'pass'";
    assert_eq!(server.number(landed).await, 4);
    let file = rusqlite::Connection::open(&rig.db).unwrap();
    let land = "UPDATE part SET landed_bin = 'pass', landed_at_us = judged_at_us + 5 WHERE landed_bin IS NULL";
    assert_eq!(file.execute(land, []).unwrap(), 1);
    let alarm = "UPDATE alarm SET cleared_at_us = raised_at_us + 7";
    assert_eq!(file.execute(alarm, []).unwrap(), 1);
    rig.push(&server.owner()).await.unwrap();
    assert_eq!(server.number(landed).await, 5);
    assert_eq!(
        server
            .number("SELECT count(*) FROM relayrig.alarms WHERE cleared IS NOT NULL")
            .await,
        1
    );
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.part").await,
        5,
        "no part changed"
    );
}

#[tokio::test]
async fn the_writer_inserts_and_the_reader_reads() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let users = "CREATE ROLE rig LOGIN IN ROLE relayrig_writer; CREATE ROLE office LOGIN IN ROLE relayrig_reader";
    server.client().await.batch_execute(users).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 10, 2);
    assert_eq!(
        rig.push(&server.target("rig", server.port))
            .await
            .unwrap()
            .parts,
        10
    );
    for (user, sql) in [
        ("rig", "UPDATE relayrig.part SET verdict = 'pass'"),
        ("rig", "DELETE FROM relayrig.measurement"),
        (
            "office",
            "INSERT INTO relayrig.rig (site, rig) VALUES ('a', 'b')",
        ),
        ("office", "SELECT relayrig.ensure_months(0, 0)"),
    ] {
        let url = server.target(user, server.port).url;
        let (client, connection) = tokio_postgres::connect(&url, tokio_postgres::NoTls)
            .await
            .unwrap();
        tokio::spawn(connection);
        let refused = client.batch_execute(sql).await.unwrap_err();
        assert!(
            refused
                .as_db_error()
                .unwrap()
                .message()
                .starts_with("permission denied"),
            "{user}: {sql}"
        );
    }
}

#[tokio::test]
async fn retention_waits_for_every_target() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 10, 1);
    rig.outbox().target(&server.owner().url).unwrap();
    let mut store = Store::open(&rig.db).unwrap();
    let all = history::Filter {
        kind: Some("all".to_owned()),
        ..history::Filter::default()
    };
    store.record_export(&all, "copy.db", 1).unwrap();
    assert_eq!(
        store.prunable(i64::MAX).unwrap(),
        [],
        "the target has nothing yet"
    );
    rig.push(&server.owner()).await.unwrap();
    assert_eq!(store.prunable(i64::MAX).unwrap().len(), 1);
    store.prune(i64::MAX, 2, |_| ()).unwrap();
    assert_eq!(rig.number("SELECT count(*) FROM part"), 0);
    rig.run("B", 10, 1);
    rig.push(&server.owner()).await.unwrap();
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.part").await,
        20,
        "no number was used twice"
    );
}

#[tokio::test]
async fn a_batch_that_did_not_arrive_shrinks() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 40, 1);
    let (mut outbox, url) = (rig.outbox(), server.owner().url);
    outbox.target(&url).unwrap();
    let mut next = || {
        let batch = outbox
            .prepare(&url, 2000, SampleChoice::None)
            .unwrap()
            .unwrap();
        (batch.uuid, batch.parts.len())
    };
    let (name, all) = next();
    assert_eq!(all, 40);
    let sizes = [next(), next()].map(|(again, parts)| {
        assert_eq!(again, name);
        parts
    });
    assert!(sizes[0] < all && sizes[1] < sizes[0], "{sizes:?}");
    outbox.confirm(&url, &name).unwrap();
    outbox.confirm(&url, &name).unwrap();
    let other = outbox.confirm(&url, "another").unwrap_err().to_string();
    assert!(other.contains("another program"), "{other}");
}

#[tokio::test]
async fn parts_far_apart_make_their_own_months_alone() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let partitions = "SELECT count(*) FROM pg_inherits WHERE inhparent = 'relayrig.part'::regclass";
    let before = server.number(partitions).await;
    let rig = Rig::new("rig-1");
    rig.run("A", 3, 1);
    let file = rusqlite::Connection::open(&rig.db).unwrap();
    let jumped = "UPDATE part SET judged_at_us = 5 WHERE seq = 1";
    assert_eq!(file.execute(jumped, []).unwrap(), 1);
    assert_eq!(rig.push(&server.owner()).await.unwrap().parts, 3);
    let made = server.number(partitions).await - before;
    assert!((1..=2).contains(&made), "{made} partitions");
}

#[tokio::test]
async fn a_rig_without_new_rows_does_not_connect() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 3, 1);
    let (tell, told) = std::sync::mpsc::channel();
    let note = move |states: &[TargetState]| tell.send(states[0].clone()).unwrap_or_default();
    let _pusher = Pusher::start(
        &rig.settings(&server.owner()),
        rig.db.clone(),
        Box::new(note),
    );
    let first = told.recv_timeout(LONG).unwrap();
    assert_eq!((first.sent_parts, first.last_error), (3, None));
    drop(server);
    for _ in 0..2 {
        assert_eq!(told.recv_timeout(LONG).unwrap().last_error, None);
    }
    rig.run("B", 1, 1);
    let error = told.iter().find_map(|state| state.last_error);
    assert!(error.is_some_and(|it| it.contains("stay in the queue")));
}
