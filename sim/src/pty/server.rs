//! Real-time server of one line: timestamps on reads, replies at absolute deadlines, recovery of a lost port.

use std::fs::File;
use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use thread_priority::{
    RealtimeThreadSchedulePolicy, ScheduleParams, ThreadPriority, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};

use super::socket::Socket;
use super::tty::Tty;
use crate::SharedRig;
use crate::line::{self, Arrival};
use crate::rig::Reply;

/// Longest sleep of a line's thread.
const IDLE: Duration = Duration::from_millis(50);

/// Time before a deadline at which the thread wakes: a sleep ends about 60 us late, so the thread sleeps short and
/// yields for the remaining time.
const EARLY: Duration = Duration::from_micros(120);

/// Lateness from which the journal records a reply, microseconds: two characters at 19,200 baud.
const LATE_US: u64 = 1_000;

/// Priority of the threads under SCHED_FIFO: below a controller on the same computer, above every ordinary process.
const PRIORITY: i32 = 40;

/// Bytes of one read, with the instant of the read.
type Piece = (Instant, Vec<u8>);

pub(super) struct Server {
    pub(super) rig: SharedRig,
    pub(super) number: usize,
    pub(super) baud: u32,
    /// Baud rate that the client has set; `None` while the rate is ignored.
    pub(super) host_baud: Option<u32>,
    /// Instant of rig time 0.
    pub(super) origin: Instant,
    pub(super) socket: Arc<Socket>,
    pub(super) stop: Arc<AtomicBool>,
    pub(super) receiver: line::Receiver,
    pub(super) arrivals: Vec<Arrival>,
    pub(super) replies: Vec<Reply>,
}

/// Thread that reads the master until `end` is set.
struct Reader {
    thread: JoinHandle<()>,
    pieces: Receiver<Piece>,
    end: Arc<AtomicBool>,
}

impl Reader {
    fn start(master: &File) -> io::Result<Self> {
        let (sender, pieces) = mpsc::channel();
        let end = Arc::new(AtomicBool::new(false));
        let (reading, ended) = (master.try_clone()?, Arc::clone(&end));
        let thread = std::thread::Builder::new()
            .name("line reader".into())
            .spawn(move || {
                raise();
                read(reading, &sender, &ended);
            })?;
        Ok(Self {
            thread,
            pieces,
            end,
        })
    }

    fn finish(self, socket: &Socket) {
        self.end.store(true, Ordering::Release);
        socket.wake_reader();
        // A thread that panicked has already written its message to stderr.
        let _ = self.thread.join();
    }
}

fn read(mut master: File, pieces: &Sender<Piece>, end: &AtomicBool) {
    let mut bytes = [0u8; 512];
    while !end.load(Ordering::Acquire) {
        let Ok(count) = master.read(&mut bytes) else {
            return;
        };
        let piece = (Instant::now(), bytes[..count].to_vec());
        if count == 0 || pieces.send(piece).is_err() {
            return;
        }
    }
}

/// Raises this thread to SCHED_FIFO where the system permits it. Elsewhere a busy computer may make replies late, and
/// the journal records them.
fn raise() {
    let priority = ThreadPriority::from_posix(ScheduleParams {
        sched_priority: PRIORITY,
    });
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let _ = set_thread_priority_and_policy(thread_native_id(), priority, policy);
}

impl Server {
    /// Serves until `stop` is set; opens a new terminal when a lost port comes back.
    pub(super) fn serve(mut self, mut master: File) {
        raise();
        loop {
            // An I/O error of the terminal counts as a lost port.
            let _ = self.converse(master);
            self.socket.unplug();
            self.wait_for_port();
            if self.stopped() {
                return;
            }
            self.receiver = line::Receiver::new(self.baud);
            self.arrivals.clear();
            self.replies.clear();
            let again = Tty::open(self.baud).and_then(|tty| {
                self.socket.plug(&tty.path, tty.slave)?;
                Ok(tty.master)
            });
            master = match again {
                Ok(master) => master,
                Err(why) => {
                    eprintln!("a lost port cannot be opened again: {why}");
                    return;
                }
            };
        }
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    fn away(&self) -> bool {
        let now_us = self.rig_us(Instant::now());
        self.rig.port_back_us(self.number, now_us).is_some()
    }

    /// Advances the rig while the port is lost.
    fn wait_for_port(&self) {
        while self.away() && !self.stopped() {
            std::thread::sleep(IDLE);
            self.rig.advance(self.rig_us(Instant::now()));
        }
    }

    /// Serves one terminal until `stop` is set or the port is lost.
    fn converse(&mut self, mut master: File) -> io::Result<()> {
        let reader = Reader::start(&master)?;
        let mut outcome = Ok(());
        while outcome.is_ok() && !self.stopped() && !self.away() {
            match reader.pieces.recv_timeout(self.pause()) {
                Ok((at, bytes)) => {
                    let at_us = self.rig_us(at);
                    self.retune();
                    self.arrivals.extend(self.receiver.take(&bytes, at_us));
                }
                Err(RecvTimeoutError::Timeout) if self.next_us().is_none() => self.socket.share(),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            outcome = self.act(&mut master);
        }
        reader.finish(&self.socket);
        outcome
    }

    /// Adopts the baud rate that the client has set.
    fn retune(&mut self) {
        if let Some(known) = self.host_baud {
            let baud = self.socket.baud().unwrap_or(known);
            self.host_baud = Some(baud);
            self.receiver.retune(baud);
        }
    }

    fn rig_us(&self, at: Instant) -> u64 {
        at.saturating_duration_since(self.origin).as_micros() as u64
    }

    fn next_us(&self) -> Option<u64> {
        let arrival = self.arrivals.iter().map(|arrival| arrival.at_us);
        let reply = self.replies.iter().map(|reply| reply.at_us);
        arrival.chain(reply).min()
    }

    fn pause(&self) -> Duration {
        match self.next_us() {
            None => IDLE,
            Some(due_us) => (self.origin + Duration::from_micros(due_us))
                .saturating_duration_since(Instant::now())
                .saturating_sub(EARLY)
                .min(IDLE),
        }
    }

    /// Returns the rig time; when the next deadline is at most [`EARLY`] away, first waits until that deadline.
    fn close_to_deadline(&self) -> u64 {
        let next_us = self.next_us();
        loop {
            let now_us = self.rig_us(Instant::now());
            match next_us {
                Some(due_us)
                    if (1..=EARLY.as_micros() as u64).contains(&due_us.saturating_sub(now_us)) =>
                {
                    std::thread::yield_now();
                }
                _ => return now_us,
            }
        }
    }

    fn act(&mut self, master: &mut File) -> io::Result<()> {
        let now_us = self.close_to_deadline();
        while self
            .arrivals
            .first()
            .is_some_and(|next| next.at_us <= now_us)
        {
            let arrival = self.arrivals.remove(0);
            let reply =
                self.rig
                    .exchange_at(self.number, self.host_baud, &arrival.text, arrival.at_us);
            self.replies.extend(reply);
        }
        self.replies
            .extend(self.rig.unprompted(self.number, now_us));
        while let Some(place) = self.replies.iter().position(|reply| reply.at_us <= now_us) {
            let reply = self.replies.remove(place);
            master.write_all(&reply.bytes)?;
            let late_us = self.rig_us(Instant::now()) - reply.at_us;
            if late_us > LATE_US {
                self.rig.record_late(self.number, reply.at_us, late_us);
            }
        }
        if self.arrivals.is_empty() && self.replies.is_empty() {
            self.rig.advance(now_us);
        }
        Ok(())
    }
}
