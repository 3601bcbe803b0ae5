//! Troubles of network, server and clock: each gives one message with database and remedy, and the rows stay in the
//! queue.

use crate::rig::Rig;
use crate::server::Server;
use config::{FleetTarget, SampleChoice, TlsChoice};
use fleet::{FleetError, report, set_up};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpListener;
use tokio::task::JoinHandle;

fn target(port: u16) -> FleetTarget {
    FleetTarget {
        url: format!("postgres://rig_07@127.0.0.1:{port}/relayrig"),
        tls: TlsChoice::Off,
        ca: None,
        samples: SampleChoice::None,
        alarm_after_s: 60,
    }
}

/// Returns the error of a rig with one part that sends to `target`; the part must stay in the queue.
async fn said(target: &FleetTarget) -> String {
    let rig = Rig::new("rig-1");
    rig.run("A", 1, 1);
    rig.outbox().target(&target.url).unwrap();
    let error = rig.push(target).await.unwrap_err();
    let queued = rig.number("SELECT count(*) FROM outbox WHERE kind = 'part'");
    assert_eq!(queued, 1, "{error}");
    error.to_string()
}

/// Listens like a server that greets every connection with `answer` and then says nothing.
async fn server_that_says(answer: Vec<u8>) -> (u16, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let port = listener.local_addr().unwrap().port();
    let serving = tokio::spawn(async move {
        let mut held = Vec::new();
        while let Ok((mut stream, _)) = listener.accept().await {
            let mut greeting = [0; 1024];
            let _ = stream.read(&mut greeting).await;
            let _ = stream.write_all(&answer).await;
            held.push(stream);
        }
    });
    (port, serving)
}

/// Returns the message by which a server refuses with this code.
fn refusal(code: &str, text: &str) -> Vec<u8> {
    let fields = format!("SFATAL\0VFATAL\0C{code}\0M{text}\0\0");
    let length = u32::try_from(4 + fields.len()).unwrap().to_be_bytes();
    [b"E".as_slice(), &length, fields.as_bytes()].concat()
}

#[tokio::test]
async fn a_refusal_of_the_server_names_its_remedy() {
    let cases = [
        (
            "53100",
            "could not extend file: No space left on device",
            "make room there",
        ),
        (
            "53300",
            "sorry, too many clients already",
            "Raise max_connections",
        ),
        (
            "28P01",
            "password authentication failed for user \"rig_07\"",
            "PGPASSWORD",
        ),
        (
            "3D000",
            "database \"relayrig\" does not exist",
            "Create the database",
        ),
        (
            "57P03",
            "the database system is starting up",
            "see the log of the server",
        ),
    ];
    for (code, text, remedy) in cases {
        let (port, _serving) = server_that_says(refusal(code, text)).await;
        let said = said(&target(port)).await;
        let named = said.starts_with(&format!(
            "postgres://rig_07@127.0.0.1:{port}/relayrig: {text}"
        ));
        assert!(named && said.contains(remedy), "{said}");
    }
}

#[tokio::test]
async fn a_password_that_nobody_gave_is_named() {
    // The server asks for a password in the clear.
    let (port, _serving) = server_that_says(vec![b'R', 0, 0, 0, 8, 0, 0, 0, 3]).await;
    let said = said(&target(port)).await;
    assert!(
        said.contains("password missing") && said.contains("PGPASSWORD"),
        "{said}"
    );
}

#[tokio::test]
async fn tls_that_cannot_be_had_sends_no_rows() {
    let (port, _serving) = server_that_says(b"N".to_vec()).await;
    let asked = FleetTarget {
        tls: TlsChoice::Verify,
        ca: Some("Cargo.toml".into()),
        ..target(port)
    };
    let said = said(&asked).await;
    let expected = match cfg!(feature = "tls") {
        true => "`ca` of fleet.toml",
        false => "tls = \"off\" in a network of your own",
    };
    assert!(said.contains(expected), "{said}");
}

#[tokio::test(start_paused = true)]
async fn a_server_that_never_answers_is_left() {
    let (port, _serving) = server_that_says(Vec::new()).await;
    let said = said(&target(port)).await;
    assert!(
        said.contains("no answer in 10 s while connecting"),
        "{said}"
    );
}

#[tokio::test]
async fn a_clock_an_hour_off_is_a_fault() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 1, 1);
    rig.push(&server.owner()).await.unwrap();
    let late = "CREATE SCHEMA late; CREATE FUNCTION late.clock_timestamp() RETURNS timestamptz LANGUAGE sql
          AS 'SELECT pg_catalog.clock_timestamp() - interval ''1 hour''';
        ALTER ROLE owner SET search_path = late, pg_catalog";
    server.client().await.batch_execute(late).await.unwrap();
    let settings = rig.settings(&server.owner());
    let report = report(&rig.outbox(), &settings, &server.owner())
        .await
        .unwrap();
    let said = report.faults.join("\n");
    assert!(
        said.contains("differs from that of the server by 3600 s") && said.contains("time"),
        "{said}"
    );
}

#[tokio::test]
async fn a_schema_older_than_the_program_is_refused() {
    let server = Server::start();
    set_up(&server.owner()).await.unwrap();
    let older = "DELETE FROM relayrig.schema_step WHERE step > 1";
    server.client().await.batch_execute(older).await.unwrap();
    let rig = Rig::new("rig-1");
    rig.run("A", 1, 1);
    let error = rig.push(&server.owner()).await.unwrap_err();
    assert!(
        matches!(error, FleetError::SchemaOlder { found: 1, .. }),
        "{error}"
    );
    assert!(
        error
            .to_string()
            .contains("run `relayrig fleet init` as its owner"),
        "{error}"
    );
}
