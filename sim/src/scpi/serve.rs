//! Instruments as sockets and pseudo-terminals in real time, or as streams in virtual time.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt, DuplexStream};
use tokio::net::{TcpListener, UnixStream};
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep};

use super::bench::{Desk, SharedBench};
use super::file::Link;
use super::port::Out;
use crate::error::SimError;
use crate::pace::Pace;
use crate::pty::tty::Tty;

/// Longest time between two checks of the port while a reply is pending: its instant may depend on a trigger.
const LOOK_US: u64 = 20_000;
/// Interval at which the circuit advances in real time, so that it never has to catch up on hours at once.
const BEAT: Duration = Duration::from_millis(50);
/// Buffer size of a stream in virtual time, bytes.
const ROOM: usize = 1 << 16;

/// Clock of the links.
#[derive(Debug, Clone, Copy)]
enum Clock {
    /// Instant of rig time 0.
    Real(Instant),
    Virtual(Pace),
}

impl Clock {
    fn now_us(self) -> u64 {
        match self {
            Self::Real(origin) => origin.elapsed().as_micros() as u64,
            Self::Virtual(pace) => pace.now_us(),
        }
    }

    async fn sleep_until(self, t_us: u64) {
        match self {
            Self::Real(origin) => {
                tokio::time::sleep_until(origin + Duration::from_micros(t_us)).await;
            }
            Self::Virtual(pace) => pace.sleep_until(t_us).await,
        }
    }
}

/// Ports that are open in real time. Dropping this closes them and ends the connections of their hosts.
#[derive(Debug)]
pub struct Served {
    /// Name and link of each instrument, as the option `--link` of `relayrig instrument` takes them.
    pub links: Vec<(String, String)>,
    /// Ends its tasks when it is dropped.
    _tasks: JoinSet<()>,
}

/// Opens every port on the current runtime, and serves it until the result is dropped.
///
/// # Errors
/// Fails when the system refuses a socket or a pseudo-terminal.
pub async fn real_time(bench: &SharedBench) -> Result<Served, SimError> {
    in_real_time(Arc::new(bench.clone()), Instant::now()).await
}

/// Opens every port as [`real_time`] does; `origin` is the instant of rig time 0.
///
/// # Errors
/// Fails as [`real_time`] does.
pub(crate) async fn in_real_time(
    bench: Arc<dyn Desk>,
    origin: Instant,
) -> Result<Served, SimError> {
    let clock = Clock::Real(origin);
    let (mut links, mut tasks) = (Vec::new(), JoinSet::new());
    for (number, (name, link)) in bench.ports().into_iter().enumerate() {
        let place = open(&mut tasks, bench.clone(), number, link, clock).await;
        let place = place.map_err(|source| SimError::Terminal {
            what: format!("open the port `{name}`"),
            source,
        })?;
        links.extend(bench.links(number, &place));
    }
    tasks.spawn(beat(bench.clone(), clock));
    Ok(Served {
        links,
        _tasks: tasks,
    })
}

/// Advances the bench at regular intervals, also while no host sends anything.
async fn beat(bench: Arc<dyn Desk>, clock: Clock) {
    loop {
        sleep(BEAT).await;
        bench.advance(clock.now_us());
    }
}

/// Opens a port and starts to serve it; returns its place (`tcp:HOST:PORT`, `serial:PATH:BAUD`).
async fn open(
    tasks: &mut JoinSet<()>,
    bench: Arc<dyn Desk>,
    number: usize,
    link: Link,
    clock: Clock,
) -> io::Result<String> {
    match link {
        Link::Tcp(port) => {
            let listener = TcpListener::bind(("127.0.0.1", port)).await?;
            let place = format!("tcp:{}", listener.local_addr()?);
            tasks.spawn(accept(bench, number, listener, clock));
            Ok(place)
        }
        Link::Serial(baud) => {
            let (path, stream) = terminal(baud)?;
            tasks.spawn(keep(bench, number, stream, clock));
            Ok(format!("serial:{}:{baud}", path.display()))
        }
    }
}

/// Serves one host at a time; the next one waits until the present one disconnects.
async fn accept(bench: Arc<dyn Desk>, number: usize, listener: TcpListener, clock: Clock) {
    loop {
        let Ok((mut stream, _)) = listener.accept().await else {
            continue;
        };
        let _ = stream.set_nodelay(true);
        if bench.open(number, clock.now_us()) {
            // An error means that the host is gone, as an end of file does.
            let _ = converse(&*bench, number, &mut stream, clock).await;
            bench.close(number, clock.now_us());
        }
    }
}

/// Serves a terminal, which does not show when hosts come and go; after a fault ends a connection, the next begins at
/// once.
async fn keep(bench: Arc<dyn Desk>, number: usize, mut terminal: UnixStream, clock: Clock) {
    while converse(&*bench, number, &mut terminal, clock)
        .await
        .is_ok()
    {
        bench.close(number, clock.now_us());
    }
}

/// A connector of a port in virtual time.
#[derive(Clone)]
pub struct Plug {
    bench: Arc<dyn Desk>,
    number: usize,
    clock: Clock,
}

impl Plug {
    /// Connects to the port; `None` while a fault keeps it busy. The task ends when the host drops the stream.
    pub fn open(&self) -> Option<DuplexStream> {
        let clock = self.clock;
        let (bench, number) = (self.bench.clone(), self.number);
        if !bench.open(number, clock.now_us()) {
            return None;
        }
        let (host, mut device) = tokio::io::duplex(ROOM);
        tokio::spawn(async move {
            let _ = converse(&*bench, number, &mut device, clock).await;
            bench.close(number, clock.now_us());
        });
        Some(host)
    }
}

/// Returns each port's name and connector. The ports run on the current runtime, one of [`virtual_time::builder`].
pub fn virtual_time(bench: &SharedBench) -> Vec<(String, Plug)> {
    plugs(Arc::new(bench.clone()), 0)
}

/// Returns a connector per port as [`virtual_time()`] does; rig time is `from_us` now.
pub(crate) fn plugs(bench: Arc<dyn Desk>, from_us: u64) -> Vec<(String, Plug)> {
    let clock = Clock::Virtual(Pace::start(from_us));
    let plug = |(number, (name, _)): (usize, (String, Link))| {
        let bench = bench.clone();
        let plug = Plug {
            bench,
            number,
            clock,
        };
        (name, plug)
    };
    bench.ports().into_iter().enumerate().map(plug).collect()
}

/// Serves until the host or a fault ends the connection.
async fn converse<S: AsyncRead + AsyncWrite + Unpin>(
    bench: &dyn Desk,
    number: usize,
    stream: &mut S,
    clock: Clock,
) -> io::Result<()> {
    let mut bytes = [0u8; 4096];
    loop {
        for out in bench.due(number, clock.now_us()) {
            match out {
                Out::Bytes(bytes) => stream.write_all(&bytes).await?,
                Out::Close => return Ok(()),
            }
        }
        let now_us = clock.now_us();
        let next_us = bench.next_us(number).map(|next_us| match next_us > now_us {
            true => next_us,
            false => now_us + 100,
        });
        let look_us = next_us.unwrap_or(0).min(now_us + LOOK_US);
        tokio::select! {
            biased;
            count = stream.read(&mut bytes) => match count? {
                0 => return Ok(()),
                count => bench.receive(number, &bytes[..count], clock.now_us()),
            },
            () = clock.sleep_until(look_us), if next_us.is_some() => {}
        }
    }
}

/// Opens a pseudo-terminal; returns its path and its stream. Two threads carry the bytes until
/// the stream is dropped and no host has the terminal open.
fn terminal(baud: u32) -> io::Result<(PathBuf, UnixStream)> {
    let Tty {
        master,
        slave,
        path,
    } = Tty::open(baud)?;
    let (ours, theirs) = std::os::unix::net::UnixStream::pair()?;
    ours.set_nonblocking(true)?;
    let (mut from_host, mut to_host) = (master.try_clone()?, master);
    let (mut to_bench, mut from_bench) = (theirs.try_clone()?, theirs);
    std::thread::spawn(move || io::copy(&mut from_host, &mut to_bench));
    std::thread::spawn(move || {
        // The open slave keeps the terminal alive between hosts.
        let _slave = slave;
        io::copy(&mut from_bench, &mut to_host)
    });
    Ok((path, UnixStream::from_std(ours)?))
}
