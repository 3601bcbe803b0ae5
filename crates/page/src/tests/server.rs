//! Tests over real loopback connections: many of them, TLS, the end of the program.

use super::*;
use crate::{ListenError, Listener, Tls, serve};
use std::net::{Ipv4Addr, SocketAddr};
use std::time::{Duration, Instant};
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::CertificateDer;
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::{ClientConfig, RootCertStore};

const STOP: &str = r#"{"order":"stop"}"#;

impl Fixture {
    /// Serves on a free port; returns its address.
    async fn served(&self, tls: Option<Tls>) -> (SocketAddr, JoinHandle<()>) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let shared = Shared {
            mimic: Arc::new(Mimic::default()),
            sessions: self.sessions.clone(),
            view: self.view.subscribe(),
            traffic: some_traffic(),
            plans: Arc::new(plans::OneStep),
            db: self.db.clone(),
            config: Folder::built_in(),
            orders: self.orders.clone(),
        };
        let served = serve(listener, tls, shared, self.ended.subscribe());
        (address, tokio::spawn(served))
    }

    /// Orders a stop over `stream`, and returns the answer.
    async fn stop_over(&self, mut stream: impl AsyncRead + AsyncWrite + Unpin) -> String {
        let request = format!(
            "POST /api/orders HTTP/1.1\r\nHost: x\r\nConnection: close\r\nContent-Type: application/json\r\n\
             Authorization: {}\r\nContent-Length: {}\r\n\r\n{STOP}",
            self.bearer(),
            STOP.len()
        );
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut answer = Vec::new();
        // A TLS connection may end without the closing alert.
        let _ = stream.read_to_end(&mut answer).await;
        String::from_utf8(answer).unwrap()
    }
}

/// Opens connections that send `header` and then stay silent.
async fn half_open(address: SocketAddr, count: usize, header: &str) -> Vec<TcpStream> {
    let mut open = Vec::new();
    for _ in 0..count {
        let mut stream = TcpStream::connect(address).await.unwrap();
        // The server may have closed this connection for a later one.
        let _ = stream.write_all(header.as_bytes()).await;
        open.push(stream);
    }
    open
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn five_hundred_half_open_connections_do_not_delay_a_stop() {
    let fixture = Fixture::new();
    let (address, _served) = fixture.served(None).await;
    let kinds = [
        "GET / HTTP/1.1\r\nHos",
        "",
        "GET /api/events HTTP/1.1\r\nHost: x\r\n\r\n",
        "POST /api/login HTTP/1.1\r\nHost: x\r\nContent-Length: 9\r\n\r\n{",
    ];
    let mut worst = Duration::ZERO;
    for kind in kinds {
        let _open = half_open(address, 500, kind).await;
        let begun = Instant::now();
        let stream = TcpStream::connect(address).await.unwrap();
        let answer = fixture.stop_over(stream).await;
        worst = worst.max(begun.elapsed());
        assert!(answer.starts_with("HTTP/1.1 200 "), "{kind}: {answer}");
    }
    assert!(worst < Duration::from_secs(1), "{worst:?}");
    assert!(fixture.stopped());
}

#[tokio::test]
async fn a_session_keeps_its_connection_under_a_flood() {
    let fixture = Fixture::new();
    let (address, _served) = fixture.served(None).await;
    let mut screen = TcpStream::connect(address).await.unwrap();
    let request = format!(
        "GET /api/events HTTP/1.1\r\nHost: x\r\nAuthorization: {}\r\n\r\n",
        fixture.bearer()
    );
    screen.write_all(request.as_bytes()).await.unwrap();
    until(&mut screen, "event: view").await;
    let _open = half_open(address, 500, "GET /api/events HTTP/1.1\r\nHost: x\r\n\r\n").await;
    fixture.view.send_modify(|view| view.lot = "after".into());
    until(&mut screen, "\"lot\":\"after\"").await;
}

/// Reads from `stream` until `expected` has come.
async fn until(stream: &mut TcpStream, expected: &str) {
    let mut seen = String::new();
    while !seen.contains(expected) {
        let mut piece = [0; 4096];
        let length = stream.read(&mut piece).await.unwrap();
        assert!(length > 0, "{seen}");
        seen.push_str(&String::from_utf8_lossy(&piece[..length]));
    }
}

#[tokio::test(start_paused = true)]
async fn a_connection_without_a_request_ends() {
    let fixture = Fixture::new();
    let (address, _served) = fixture.served(None).await;
    let mut open = half_open(address, 1, "GET / HTTP/1.1\r\nHos").await;
    let mut rest = Vec::new();
    open[0].read_to_end(&mut rest).await.unwrap();
    assert!(rest.is_empty());
}

fn fixture_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("src/tests/tls")
        .join(name)
}

fn certificate() -> Tls {
    Tls::load(&fixture_file("cert.pem"), &fixture_file("key.pem")).unwrap()
}

#[tokio::test]
async fn orders_pass_over_tls_and_not_in_the_clear() {
    let fixture = Fixture::new();
    let (address, _served) = fixture.served(Some(certificate())).await;
    let clear = TcpStream::connect(address).await.unwrap();
    let answer = fixture.stop_over(clear).await;
    assert!(answer.ends_with("at https, not at http.\n"), "{answer}");
    assert!(!fixture.stopped());

    let mut roots = RootCertStore::empty();
    let cert = CertificateDer::from_pem_file(fixture_file("cert.pem")).unwrap();
    roots.add(cert).unwrap();
    let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()));
    let config = config.with_safe_default_protocol_versions().unwrap();
    let config = config.with_root_certificates(roots).with_no_client_auth();
    let stream = TcpStream::connect(address).await.unwrap();
    let name = "localhost".try_into().unwrap();
    let stream = TlsConnector::from(Arc::new(config)).connect(name, stream);
    let answer = fixture.stop_over(stream.await.unwrap()).await;
    assert!(answer.starts_with("HTTP/1.1 200 "), "{answer}");
    assert!(fixture.stopped());
}

#[test]
fn other_computers_reach_the_page_over_tls_only() {
    let here: [SocketAddr; 3] =
        ["127.0.0.1:0", "[::1]:0", "[::ffff:127.0.0.1]:0"].map(|it| it.parse().unwrap());
    for listen in here {
        assert!(Listener::open(listen, None).is_ok(), "{listen}");
    }
    let everywhere = SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0));
    let refused = Listener::open(everywhere, None);
    assert!(matches!(refused, Err(ListenError::InTheClear(_))));
    assert!(Listener::open(everywhere, Some(certificate())).is_ok());
}

#[test]
fn a_wrong_certificate_or_key_is_named() {
    let (cert, key) = (fixture_file("cert.pem"), fixture_file("key.pem"));
    for (given, expected) in [
        ([&key, &key], "key.pem: expected a certificate"),
        ([&cert, &cert], "cert.pem: expected a private key"),
        ([&cert.with_file_name("absent.pem"), &key], "absent.pem: "),
        ([&cert, &fixture_file("other-key.pem")], "cert.pem and "),
    ] {
        let refused = Tls::load(given[0], given[1]).unwrap_err().to_string();
        assert!(refused.contains(expected), "{refused}");
    }
}

#[tokio::test]
async fn open_streams_and_half_requests_do_not_delay_exit() {
    let fixture = Fixture::new();
    let (address, served) = fixture.served(None).await;
    let mut stream = TcpStream::connect(address).await.unwrap();
    stream
        .write_all(b"GET /api/events HTTP/1.1\r\nHost: x\r\n\r\n")
        .await
        .unwrap();
    until(&mut stream, "event: view").await;
    let half = half_open(address, 1, "GET / HTTP/1.1\r\nHos").await;

    fixture.ended.send_replace(true);
    let mut rest = Vec::new();
    stream.read_to_end(&mut rest).await.unwrap();
    served.await.unwrap();
    drop(half);
}
