//! Lines as in-process byte streams in virtual time.
//!
//! The task of a line reads requests, waits until the last character has arrived, lets the rig answer, waits
//! until the last character of the reply has arrived, and writes the reply in one piece. A pending reply never
//! delays the next request. A lost port ends the stream; when the port comes back, its [`Plug`] offers a new
//! stream.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};

use crate::SharedRig;
use crate::config::READER;
use crate::line::{Arrival, Receiver};
use crate::pace::Pace;
use crate::rig::Reply;

/// Buffer size of a stream in each direction, bytes; a reply has at most 64 characters.
const ROOM: usize = 4_096;

/// Interval at which the line polls the code reader, microseconds.
const LOOK_US: u64 = 10_000;

/// Source of a line's stream; after the port was lost or closed it offers a new stream.
#[derive(Clone, Default)]
pub struct Plug(Arc<Mutex<Option<DuplexStream>>>);

impl Plug {
    /// Takes the stream; `None` while the port is absent or the stream is already taken.
    pub fn open(&self) -> Option<DuplexStream> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn put(&self, stream: Option<DuplexStream>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = stream;
    }

    /// Checks whether another clone of the plug exists, whose host may still open the stream.
    fn is_held(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }
}

/// Opens every line and spawns its task on the current runtime, one of [`virtual_time::builder`]. Rig time continues from
/// its present value. A stream that has ended cannot be opened again.
pub fn in_process(rig: &SharedRig) -> Vec<(String, DuplexStream)> {
    let opened = |(name, plug): (String, Plug)| plug.open().map(|stream| (name, stream));
    plugs(rig).into_iter().filter_map(opened).collect()
}

/// Opens every line as [`in_process`] does, with streams that can be opened again.
pub fn plugs(rig: &SharedRig) -> Vec<(String, Plug)> {
    let pace = Pace::start(rig.now_us());
    let lines = rig.lines();
    let open = |(number, (name, baud)): (usize, (String, u32))| {
        let plug = Plug::default();
        let line = Line {
            rig: rig.clone(),
            number,
            pace,
            baud,
            is_reader: name == READER,
            plug: plug.clone(),
            receiver: Receiver::new(baud),
            arrivals: VecDeque::new(),
            replies: Vec::new(),
        };
        let device = line.plugged();
        tokio::spawn(line.serve(device));
        (name, plug)
    };
    lines.into_iter().enumerate().map(open).collect()
}

struct Line {
    rig: SharedRig,
    number: usize,
    pace: Pace,
    baud: u32,
    /// True for the line of the code reader, which sends by itself.
    is_reader: bool,
    plug: Plug,
    receiver: Receiver,
    arrivals: VecDeque<Arrival>,
    /// Replies on their way, usually one; a later reply may overtake a delayed one.
    replies: Vec<Reply>,
}

impl Line {
    /// Creates a stream and puts the host's end into the plug.
    fn plugged(&self) -> DuplexStream {
        let (host, device) = tokio::io::duplex(ROOM);
        self.plug.put(Some(host));
        device
    }

    /// Serves until the host has closed its end and no plug is left to open it again.
    async fn serve(mut self, mut device: DuplexStream) {
        loop {
            // An error means that the host is gone, as an end of file does.
            let _ = self.converse(&mut device).await;
            drop(device);
            self.plug.put(None);
            if !self.plug.is_held() {
                return;
            }
            if let Some(restored_us) = self.rig.port_back_us(self.number, self.pace.now_us()) {
                self.pace.sleep_until(restored_us).await;
            }
            self.receiver = Receiver::new(self.baud);
            self.arrivals.clear();
            self.replies.clear();
            device = self.plugged();
        }
    }

    /// Serves until the host closes its end or the port is lost.
    async fn converse(&mut self, device: &mut DuplexStream) -> std::io::Result<()> {
        let mut bytes = [0u8; 256];
        let mut now_us = self.pace.now_us();
        while self.rig.port_back_us(self.number, now_us).is_none() {
            let (pace, next_us) = (self.pace, self.next_us(now_us));
            let due = async {
                match next_us {
                    Some(next_us) => pace.sleep_until(next_us).await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                biased;
                count = device.read(&mut bytes) => match count? {
                    0 => return Ok(()),
                    count => {
                        now_us = self.pace.now_us();
                        let arrivals = self.receiver.take(&bytes[..count], now_us);
                        self.arrivals.extend(arrivals);
                    }
                },
                () = due => {
                    now_us = self.pace.now_us();
                    self.act(device, now_us).await?;
                }
            }
        }
        Ok(())
    }

    /// Returns the instant at which the line acts next; `None` while it only waits for bytes.
    fn next_us(&self, now_us: u64) -> Option<u64> {
        let arrival = self.arrivals.front().map(|arrival| arrival.at_us);
        let reply = self.replies.iter().map(|reply| reply.at_us).min();
        let loss = self.rig.next_port_loss_us(self.number, now_us);
        let look = self.is_reader.then(|| now_us + LOOK_US);
        let due = arrival.into_iter().chain(reply).chain(loss).chain(look);
        due.min()
    }

    async fn act(&mut self, device: &mut DuplexStream, now_us: u64) -> std::io::Result<()> {
        if let Some(place) = self.due_reply(now_us) {
            let reply = self.replies.remove(place);
            device.write_all(&reply.bytes).await?;
        }
        if self
            .arrivals
            .front()
            .is_some_and(|next| next.at_us <= now_us)
            && let Some(arrival) = self.arrivals.pop_front()
        {
            let reply = self.rig.exchange(self.number, &arrival.text, arrival.at_us);
            self.replies.extend(reply);
        }
        if self.is_reader {
            self.replies
                .extend(self.rig.unprompted(self.number, now_us));
        }
        Ok(())
    }

    fn due_reply(&self, now_us: u64) -> Option<usize> {
        self.replies.iter().position(|reply| reply.at_us <= now_us)
    }
}
