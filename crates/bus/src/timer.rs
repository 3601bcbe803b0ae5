//! A timer that wakes a task at an instant, at real pace more precisely than the milliseconds of tokio's timers.

use super::Pace;
use rustix::time::{
    Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, Timespec, timerfd_create,
    timerfd_settime,
};
use std::io;
use std::sync::OnceLock;
use tokio::net::unix::pipe::Receiver;
use units::RigTime;

/// Timer of one task. At real pace a kernel timer wakes the task, or tokio's timer where the kernel refuses one.
#[derive(Debug)]
pub struct Timer {
    pace: Pace,
    /// Kernel timer, created at the first wait at real pace; `None` when the kernel refuses it.
    fd: OnceLock<Option<Receiver>>,
}

impl Timer {
    /// Creates a timer on the clock of `pace`.
    pub fn new(pace: Pace) -> Self {
        Self {
            pace,
            fd: OnceLock::new(),
        }
    }

    /// Waits until `until`; returns at once if that time has passed. A dropped wait leaves nothing behind. Panics
    /// outside a tokio runtime with I/O, and in another runtime than that of the first wait.
    pub async fn until(&self, until: RigTime) {
        if self.pace.is_virtual() {
            return self.pace.sleep_until(until).await;
        }
        let now = self.pace.now();
        if now >= until {
            return;
        }
        let fd = self.fd.get_or_init(|| kernel_timer().ok());
        match fd.as_ref().filter(|fd| arm(fd, until.since(now).0).is_ok()) {
            Some(fd) => fired(fd).await,
            None => self.pace.sleep_until(until).await,
        }
    }
}

/// Creates a kernel timer. It reads like a pipe: as soon as it has fired, eight bytes wait in it.
fn kernel_timer() -> io::Result<Receiver> {
    let flags = TimerfdFlags::NONBLOCK | TimerfdFlags::CLOEXEC;
    let fd = timerfd_create(TimerfdClockId::Monotonic, flags)?;
    Receiver::from_owned_fd_unchecked(fd)
}

/// Sets the timer to fire once, after `us` microseconds; this replaces an earlier setting.
fn arm(fd: &Receiver, us: u64) -> io::Result<()> {
    let zero = Timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    let after = Timespec {
        tv_sec: (us / 1_000_000) as _,
        tv_nsec: (us % 1_000_000 * 1_000) as _,
    };
    let once = Itimerspec {
        it_interval: zero,
        it_value: after,
    };
    timerfd_settime(fd, TimerfdTimerFlags::empty(), &once)?;
    Ok(())
}

async fn fired(fd: &Receiver) {
    // After an error, which every later call would return too, the wait ends: the task continues early rather than
    // never.
    while fd.readable().await.is_ok() {
        match fd.try_read(&mut [0; 8]) {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Ok(_) | Err(_) => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::Span;

    #[tokio::test]
    async fn a_wait_ends_at_its_instant_after_a_dropped_one() {
        let pace = Pace::real();
        let timer = Timer::new(pace);
        for _ in 0..3 {
            let long = timer.until(pace.now() + Span::ms(60_000));
            let dropped = tokio::time::timeout(std::time::Duration::ZERO, long).await;
            assert!(dropped.is_err(), "the wait ended early");
            let until = pace.now() + Span::ms(3);
            timer.until(until).await;
            assert!(pace.now() >= until);
        }
    }

    #[test]
    fn virtual_waits_end_at_their_instant() {
        virtual_time::block_on(async {
            let pace = Pace::virtual_time();
            let timer = Timer::new(pace);
            timer.until(RigTime(87)).await;
            assert_eq!(pace.now(), RigTime(87));
        })
        .expect("a runtime");
    }
}
