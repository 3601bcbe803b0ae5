//! Tests of the end of the program, over a real loopback connection.

use super::*;
use crate::serve;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

#[tokio::test]
async fn open_streams_and_half_requests_do_not_delay_exit() {
    let fixture = Fixture::new();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let shared = Shared {
        mimic: Arc::new(Mimic::default()),
        sessions: fixture.sessions.clone(),
        view: fixture.view.subscribe(),
        traffic: some_traffic(),
        db: fixture.db.clone(),
        config: PathBuf::from("config"),
        orders: fixture.orders.clone(),
    };
    let served = tokio::spawn(serve(listener, shared, fixture.ended.subscribe()));

    let mut stream = TcpStream::connect(address).await.unwrap();
    stream
        .write_all(b"GET /api/events HTTP/1.1\r\nHost: x\r\n\r\n")
        .await
        .unwrap();
    let mut seen = String::new();
    while !seen.contains("event: view") {
        let mut piece = [0; 4096];
        let length = stream.read(&mut piece).await.unwrap();
        assert!(length > 0, "{seen}");
        seen.push_str(&String::from_utf8_lossy(&piece[..length]));
    }
    let mut half = TcpStream::connect(address).await.unwrap();
    half.write_all(b"GET / HTTP/1.1\r\nHos").await.unwrap();

    fixture.ended.send_replace(true);
    let mut rest = Vec::new();
    stream.read_to_end(&mut rest).await.unwrap();
    served.await.unwrap().unwrap();
    drop(half);
}
