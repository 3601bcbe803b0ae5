//! The end of the program over a real loopback connection.

use super::*;
use crate::serve;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

#[tokio::test]
async fn neither_an_open_stream_nor_half_a_request_holds_up_the_end() {
    let bench = Bench::new();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let shared = Shared {
        mimic: Arc::new(Mimic::default()),
        gate: bench.gate.clone(),
        view: bench.view.subscribe(),
        traffic: some_traffic(),
        db: bench.db.clone(),
        config: PathBuf::from("config"),
        orders: bench.orders.clone(),
    };
    let served = tokio::spawn(serve(listener, shared, bench.ended.subscribe()));

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

    bench.ended.send_replace(true);
    let mut rest = Vec::new();
    stream.read_to_end(&mut rest).await.unwrap();
    served.await.unwrap().unwrap();
    drop(half);
}
