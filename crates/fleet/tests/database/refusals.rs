//! Tests: the database refuses rows that must not mix, the refusal names a remedy, and the remedy works.

use crate::rig::Rig;
use crate::server::Server;
use fleet::{FleetError, Refusal, set_up, start_again, take_over};

fn refusal(error: FleetError) -> Refusal {
    error
        .refusal()
        .cloned()
        .unwrap_or_else(|| panic!("{error}"))
}

#[tokio::test]
async fn a_second_rig_of_the_same_name_is_refused() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let (first, second) = (Rig::new("rig-1"), Rig::new("rig-1"));
    first.run("A", 10, 1);
    second.run("A", 10, 1);
    first.push(&server.owner()).await.unwrap();
    let error = second.push(&server.owner()).await.unwrap_err();
    assert!(
        error.to_string().contains("fleet push --take-over"),
        "{error}"
    );
    assert!(matches!(
        refusal(error),
        Refusal::OtherFile { epoch: 1, .. }
    ));
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.part").await,
        10
    );

    let settings = second.settings(&server.owner());
    take_over(&mut second.outbox(), &settings, &server.owner())
        .await
        .unwrap();
    assert_eq!(second.push(&server.owner()).await.unwrap().parts, 10);
    let error = first.push(&server.owner()).await.unwrap_err();
    assert!(matches!(
        refusal(error),
        Refusal::Superseded { epoch: 2, .. }
    ));
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.part").await,
        20
    );
}

#[tokio::test]
async fn a_restored_backup_is_refused_by_run_and_count() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 10, 1);
    rig.push(&server.owner()).await.unwrap();
    let backup = rig.folder.path().join("backup.db");
    history::Archive::open(&rig.db)
        .unwrap()
        .backup(&backup)
        .unwrap();
    rig.run("B", 7, 1);
    rig.push(&server.owner()).await.unwrap();

    let restored = Rig {
        db: backup,
        ..Rig::new("rig-1")
    };
    restored.run("C", 4, 1);
    let refused = refusal(restored.push(&server.owner()).await.unwrap_err());
    let run: String = {
        let file = rusqlite::Connection::open(&rig.db).unwrap();
        file.query_row("SELECT uuid FROM run ORDER BY id DESC LIMIT 1", [], |row| {
            row.get(0)
        })
        .unwrap()
    };
    let Refusal::FileOlder {
        run: found, parts, ..
    } = refused
    else {
        panic!("{refused}")
    };
    assert_eq!((found, parts), (run, 7));
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.part").await,
        17,
        "nothing was mixed"
    );

    let settings = restored.settings(&server.owner());
    take_over(&mut restored.outbox(), &settings, &server.owner())
        .await
        .unwrap();
    assert_eq!(
        restored.push(&server.owner()).await.unwrap().parts,
        4,
        "only what the database lacks"
    );
    assert_eq!(
        server
            .number("SELECT count(*) FROM relayrig.lots WHERE rig = 'rig-1'")
            .await,
        3
    );
}

#[tokio::test]
async fn a_copied_file_never_mixes_with_its_original() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 10, 1);
    rig.push(&server.owner()).await.unwrap();
    let copied = rig.folder.path().join("copy.db");
    history::Archive::open(&rig.db)
        .unwrap()
        .backup(&copied)
        .unwrap();
    let copy = Rig {
        db: copied,
        ..Rig::new("rig-1")
    };
    rig.run("B", 5, 1);
    copy.run("C", 5, 1);
    let (one, other) = (server.owner(), server.owner());
    let both = tokio::join!(rig.push(&one), copy.push(&other));
    assert_eq!(
        [both.0.is_ok(), both.1.is_ok()]
            .iter()
            .filter(|it| **it)
            .count(),
        1,
        "one of them"
    );
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.part").await,
        15
    );
}

#[tokio::test]
async fn a_database_from_a_backup_gets_what_it_lacks() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 10, 1);
    rig.push(&server.owner()).await.unwrap();
    rig.run("B", 7, 1);
    rig.push(&server.owner()).await.unwrap();
    let lose = "DELETE FROM relayrig.batch WHERE number = 2; DELETE FROM relayrig.part WHERE run_id IN
        (SELECT id FROM relayrig.run WHERE lot = 'B'); DELETE FROM relayrig.measurement WHERE run_id IN
        (SELECT id FROM relayrig.run WHERE lot = 'B'); DELETE FROM relayrig.run WHERE lot = 'B'";
    server.client().await.batch_execute(lose).await.unwrap();
    let refused = refusal(rig.push(&server.owner()).await.unwrap_err());
    assert!(
        matches!(
            refused,
            Refusal::DatabaseOlder {
                there: 1,
                here: 2,
                ..
            }
        ),
        "{refused}"
    );
    let settings = rig.settings(&server.owner());
    start_again(&mut rig.outbox(), &settings, &server.owner())
        .await
        .unwrap();
    rig.push(&server.owner()).await.unwrap();
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.part").await,
        17
    );
    assert_eq!(
        server
            .number("SELECT count(*) FROM relayrig.measurement")
            .await,
        17
    );
    assert_eq!(
        server.number("SELECT count(*) FROM relayrig.alarms").await,
        2
    );
}

#[tokio::test]
async fn troubles_name_the_database_and_the_remedy() {
    let server = Server::start();
    let rig = Rig::new("rig-1");
    rig.run("A", 1, 1);
    let said = async |user: &str, port| {
        rig.push(&server.target(user, port))
            .await
            .unwrap_err()
            .to_string()
    };
    assert!(
        said("owner", server.port)
            .await
            .contains("run `relayrig fleet init`")
    );
    let nowhere = said("owner", 1).await;
    assert!(
        nowhere.contains("127.0.0.1:1/relayrig: Connection refused")
            && nowhere.contains("stay in the queue"),
        "{nowhere}"
    );
    let stranger = said("nobody", server.port).await;
    assert!(
        stranger.contains("role \"nobody\" does not exist") && stranger.contains("pg_hba.conf"),
        "{stranger}"
    );
    server
        .client()
        .await
        .batch_execute("CREATE SCHEMA relayrig")
        .await
        .unwrap();
    assert!(
        said("owner", server.port)
            .await
            .contains("belongs to another program")
    );
    assert!(
        set_up(&server.owner())
            .await
            .unwrap_err()
            .to_string()
            .contains("belongs to another program")
    );
    server
        .client()
        .await
        .batch_execute("DROP SCHEMA relayrig")
        .await
        .unwrap();
    set_up(&server.owner()).await.unwrap();
    let newer = "INSERT INTO relayrig.schema_step (step, program) VALUES (9, 'later')";
    server.client().await.batch_execute(newer).await.unwrap();
    assert_eq!(
        rig.push(&server.owner()).await.unwrap().parts,
        1,
        "an older rig works with a newer schema"
    );
}
