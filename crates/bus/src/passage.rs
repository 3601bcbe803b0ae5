//! How late this computer passes bytes on between a serial port and the program.
//!
//! The kernel hands the bytes of every terminal, serial or pseudo, to its reader in a worker thread of ordinary
//! priority, which a busy computer delays however high the priority of the program is. No timer shows this delay. So
//! [`Passage::measure`] sends a byte through a pair of pseudo-terminals every 10 ms, and takes the time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio_serial::SerialStream;
use units::Span;

/// Time between two bytes.
const INTERVAL: Duration = Duration::from_millis(10);

/// Delays of the bytes so far, shared by all clones; none without [`Passage::measure`].
#[derive(Debug, Clone, Default)]
pub struct Passage(Arc<Delays>);

#[derive(Debug)]
struct Delays {
    began: Instant,
    /// Longest delay since the last call of [`Passage::take_worst`], us.
    worst_us: AtomicU64,
    /// Time at which the byte under way was sent, us since `began`; 0 while none is.
    sent_us: AtomicU64,
}

impl Default for Delays {
    fn default() -> Self {
        Self {
            began: Instant::now(),
            worst_us: AtomicU64::new(0),
            sent_us: AtomicU64::new(0),
        }
    }
}

impl Passage {
    /// Returns a passage with one byte that came `delay` late, and no measurement.
    pub fn late_by(delay: Span) -> Self {
        let passage = Self::default();
        passage.0.worst_us.store(delay.0, Ordering::Relaxed);
        passage
    }

    /// Returns the longest delay since the last call; a byte that is still under way counts with its time so far.
    pub fn take_worst(&self) -> Span {
        let under_way = match self.0.sent_us.load(Ordering::Relaxed) {
            0 => 0,
            sent_us => self.now_us().saturating_sub(sent_us),
        };
        Span(self.0.worst_us.swap(0, Ordering::Relaxed).max(under_way))
    }

    /// Sends bytes until the task is dropped. Ends at once where the system has no pseudo-terminal.
    pub async fn measure(self) {
        let Ok((mut near, mut far)) = SerialStream::pair() else {
            return;
        };
        let mut ticks = tokio::time::interval(INTERVAL);
        ticks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        loop {
            ticks.tick().await;
            self.sent();
            let passed = async {
                near.write_all(b"\0").await?;
                far.read_exact(&mut [0]).await
            };
            if passed.await.is_err() {
                self.0.sent_us.store(0, Ordering::Relaxed);
                return;
            }
            self.came();
        }
    }

    fn now_us(&self) -> u64 {
        u64::try_from(self.0.began.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn sent(&self) {
        self.0
            .sent_us
            .store(self.now_us().max(1), Ordering::Relaxed);
    }

    fn came(&self) {
        let sent_us = self.0.sent_us.swap(0, Ordering::Relaxed);
        let late_us = self.now_us().saturating_sub(sent_us);
        self.0.worst_us.fetch_max(late_us, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_under_way_counts_with_its_time_so_far() {
        let passage = Passage::default();
        assert_eq!(passage.take_worst(), Span(0));
        passage.sent();
        while passage.take_worst() < Span(300) {
            std::hint::spin_loop();
        }
        passage.came();
        assert!(passage.take_worst() >= Span(300), "came late");
        assert_eq!(passage.take_worst(), Span(0), "none since the last look");
    }

    #[tokio::test]
    async fn bytes_pass_a_pair_of_terminals() {
        let passage = Passage::default();
        let measured = passage.clone();
        let seen = async {
            while measured.0.worst_us.load(Ordering::Relaxed) == 0 {
                tokio::task::yield_now().await;
            }
        };
        tokio::select! {
            () = passage.measure() => panic!("no pair of terminals"),
            () = seen => {}
        }
    }
}
