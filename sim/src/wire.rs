//! Lines as in-process byte streams in virtual time (tokio's paused clock, current-thread runtime).
//!
//! A task per line reads requests, waits until their last character has arrived, lets the rig
//! answer, waits until the reply's last character has arrived and hands the reply over in one
//! piece. Replies that are on their way never hinder the next request.

use std::collections::VecDeque;

use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};
use tokio::time::sleep_until;

use crate::SharedRig;
use crate::line::{Arrival, Receiver};
use crate::pace::Pace;
use crate::rig::Reply;

/// Room of a stream in each direction; a reply is at most 64 characters.
const ROOM: usize = 4_096;

/// Opens every line of the rig and spawns its task on the current runtime. Rig time goes on from
/// where the rig stands.
pub fn in_process(rig: &SharedRig) -> Vec<(String, DuplexStream)> {
    let pace = Pace::start();
    let lines = rig.lines();
    let from_us = rig.now_us();
    let open = |(number, (name, baud)): (usize, (String, u32))| {
        let (host, device) = tokio::io::duplex(ROOM);
        let line = Line {
            rig: rig.clone(),
            number,
            pace,
            from_us,
            receiver: Receiver::new(baud),
            arrivals: VecDeque::new(),
            replies: Vec::new(),
        };
        tokio::spawn(line.serve(device));
        (name, host)
    };
    lines.into_iter().enumerate().map(open).collect()
}

struct Line {
    rig: SharedRig,
    number: usize,
    pace: Pace,
    from_us: u64,
    receiver: Receiver,
    arrivals: VecDeque<Arrival>,
    /// Few and mostly one: late replies overtake each other.
    replies: Vec<Reply>,
}

impl Line {
    /// Until the host closes its end.
    async fn serve(mut self, mut device: DuplexStream) {
        let mut bytes = [0u8; 256];
        loop {
            let next_us = self.next_us();
            let due = sleep_until(
                self.pace
                    .at(next_us.unwrap_or(0).saturating_sub(self.from_us)),
            );
            tokio::select! {
                biased;
                count = device.read(&mut bytes) => match count {
                    Ok(0) | Err(_) => return,
                    Ok(count) => self.take(&bytes[..count]),
                },
                () = due, if next_us.is_some() => {
                    if self.act(&mut device).await.is_err() {
                        return;
                    }
                }
            }
        }
    }

    fn now_us(&self) -> u64 {
        self.from_us + self.pace.now_us()
    }

    fn take(&mut self, bytes: &[u8]) {
        let arrivals = self.receiver.take(bytes, self.now_us());
        self.arrivals.extend(arrivals);
    }

    fn next_us(&self) -> Option<u64> {
        let arrival = self.arrivals.front().map(|arrival| arrival.at_us);
        let reply = self.replies.iter().map(|reply| reply.at_us).min();
        arrival.into_iter().chain(reply).min()
    }

    async fn act(&mut self, device: &mut DuplexStream) -> std::io::Result<()> {
        let now_us = self.now_us();
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
        Ok(())
    }

    fn due_reply(&self, now_us: u64) -> Option<usize> {
        self.replies.iter().position(|reply| reply.at_us <= now_us)
    }
}
