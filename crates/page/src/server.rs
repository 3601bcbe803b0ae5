//! Accepts connections and speaks HTTP over them, in the clear or over TLS.
//!
//! | trouble | what happens |
//! |---|---|
//! | a connection sends no whole request header within [`FIRST`], the TLS handshake included | the connection ends |
//! | a connection that has sent requests sends no further header within [`IDLE`] | the connection ends |
//! | a body is not whole within [`BODY_TIME`](super::asked::BODY_TIME) | 408 |
//! | a client connects while all places are taken | the oldest connection of the lowest rank ends (`connections.rs`) |
//!
//! So 500 connections that never finish a request delay no order: each new connection takes the place of the oldest.

mod connections;
mod listener;
#[cfg_attr(not(feature = "tls"), path = "server/no_tls.rs")]
mod tls;

use super::router::router;
use super::sessions::token;
use super::{GRACE, Sessions, Shared, end_of_program};
use axum::Router;
use axum::body::Body;
use axum::extract::ConnectInfo;
use axum::http::{Request, Response};
use connections::{Connections, Lost, Place, Rank};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
pub use listener::{ListenError, Listener};
use std::convert::Infallible;
use std::net::SocketAddr;
use std::pin::pin;
use std::time::Duration;
pub use tls::Tls;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Mutex, watch};
use tokio::task::JoinSet;
use tokio::time::{sleep, timeout};
use tower_service::Service;

/// Longest time from the connection to its first whole request header.
const FIRST: Duration = Duration::from_secs(10);
/// Longest time from an answer to the next whole request header: browsers keep connections for later requests.
const IDLE: Duration = Duration::from_secs(75);
/// Largest request header, bytes; this limit bounds the memory of a connection.
const HEADER: usize = 32 * 1024;
/// Wait after the system refused a connection, mostly because the program has too many files open.
const REFUSED: Duration = Duration::from_millis(100);

/// A connection, with or without TLS.
trait Stream: AsyncRead + AsyncWrite + Unpin + Send {}
impl<T: AsyncRead + AsyncWrite + Unpin + Send> Stream for T {}

/// Serves the page of a rig at `listener` until `ended` turns true or loses its sender, then at most [`GRACE`] longer.
pub async fn serve(
    listener: TcpListener,
    tls: Option<Tls>,
    shared: Shared,
    ended: watch::Receiver<bool>,
) {
    let sessions = Some(shared.sessions.clone());
    let router = router(shared, ended.clone());
    serve_routes(listener, tls, (router, sessions), ended).await;
}

/// Serves the routes of a router, as [`serve`] does; without `sessions` all clients are anonymous.
pub(super) async fn serve_routes(
    listener: TcpListener,
    tls: Option<Tls>,
    (router, sessions): (Router, Option<Sessions>),
    ended: watch::Receiver<bool>,
) {
    let server = Server {
        sessions,
        router,
        tls,
        ended: ended.clone(),
    };
    let connections = Connections::default();
    let mut open = JoinSet::new();
    let mut over = pin!(end_of_program(ended));
    loop {
        tokio::select! {
            () = &mut over => break,
            Some(_) = open.join_next() => {}
            accepted = listener.accept() => match accepted {
                Ok((stream, peer)) => {
                    if let Some(place) = connections.take(peer.ip()) {
                        open.spawn(server.clone().hold(stream, peer, place));
                    }
                }
                Err(error) => {
                    tracing::debug!("a connection was refused: {error}");
                    sleep(REFUSED).await;
                }
            },
        }
    }
    drop(listener);
    let all_closed = async { while open.join_next().await.is_some() {} };
    // Connections that are still open close with the program.
    let _ = timeout(GRACE, all_closed).await;
}

/// State that the tasks of all connections share.
#[derive(Debug, Clone)]
struct Server {
    router: Router,
    sessions: Option<Sessions>,
    tls: Option<Tls>,
    ended: watch::Receiver<bool>,
}

impl Server {
    /// Serves a connection until it ends, is too slow, or loses its place.
    async fn hold(self, stream: TcpStream, peer: SocketAddr, (place, lost): (Place, Lost)) {
        // With Nagle's algorithm each event would wait until the client acknowledges the event before.
        let _ = stream.set_nodelay(true);
        let place = &place;
        let silent = async {
            sleep(FIRST).await;
            if place.rank() > Rank::Silent {
                std::future::pending::<()>().await;
            }
        };
        tokio::select! {
            _ = lost => {}
            () = silent => {}
            () = self.speak(stream, peer, place) => {}
        }
    }

    async fn speak(&self, stream: TcpStream, peer: SocketAddr, place: &Place) {
        let stream: Box<dyn Stream> = match &self.tls {
            None => Box::new(stream),
            Some(_) if is_in_the_clear(&stream).await => return say_https(stream).await,
            Some(tls) => match tls.accept(stream).await {
                Ok(stream) => Box::new(stream),
                Err(error) => {
                    tracing::debug!("no TLS with {peer}: {error}");
                    return;
                }
            },
        };
        let checked = Mutex::default();
        let service = service_fn(|request| self.answer(request, peer, (place, &checked)));
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(IDLE)
            .max_buf_size(HEADER)
            .serve_connection(TokioIo::new(stream), service);
        let mut connection = pin!(connection);
        // An error concerns only this connection, which ends in any case.
        tokio::select! {
            _ = connection.as_mut() => return,
            () = end_of_program(self.ended.clone()) => connection.as_mut().graceful_shutdown(),
        }
        let _ = connection.await;
    }

    /// Answers a request. `checked` holds the last token of this connection that belongs to no session; the server does
    /// not look up this token again.
    async fn answer(
        &self,
        request: Request<Incoming>,
        peer: SocketAddr,
        (place, checked): (&Place, &Mutex<Option<String>>),
    ) -> Result<Response<Body>, Infallible> {
        place.rise(Rank::Anonymous);
        let token = token(request.headers());
        if let Some(sessions) = &self.sessions
            && place.rank() < Rank::Session
            && *checked.lock().await != token
        {
            match sessions.who(request.headers()).await {
                Ok(Some(_)) => place.rise(Rank::Session),
                Ok(None) | Err(_) => *checked.lock().await = token,
            }
        }
        let mut request = request.map(Body::new);
        request.extensions_mut().insert(ConnectInfo(peer));
        self.router.clone().call(request).await
    }
}

/// Returns true when the client begins with something else than a TLS handshake, such as a request for `http://`.
async fn is_in_the_clear(stream: &TcpStream) -> bool {
    const HANDSHAKE: u8 = 22;
    let mut first = [HANDSHAKE];
    stream.peek(&mut first).await.is_ok() && first != [HANDSHAKE]
}

/// Tells a client that asked for `http://` that the page is at `https://`.
async fn say_https(mut stream: TcpStream) {
    const ANSWER: &[u8] =
        b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\nContent-Type: text/plain\r\n\r\n\
                            This page is at https, not at http.\n";
    // Unread bytes would turn the end of the connection into an error.
    let _ = stream.read(&mut [0; 4096]).await;
    // A client that has gone needs no answer.
    let _ = stream.write_all(ANSWER).await;
}
