//! Virtual time: a clock in whole microseconds that jumps to the next timer as soon as every task waits.
//!
//! A runtime of [`builder`] moves the clock on just before its thread would park. Clock and timers belong to that thread,
//! so that reading the clock or setting a timer takes no lock. The paused clock of tokio does the same in steps of a
//! millisecond; its timer wheel wakes the driver about twice for each timer, which took a sixth of a simulated lot.
//!
//! ```
//! let began_us = virtual_time::now_us();
//! // Takes an hour of virtual time and no wall time.
//! virtual_time::block_on(virtual_time::sleep_until(began_us + 3_600_000_000))?;
//! assert_eq!(virtual_time::now_us(), began_us + 3_600_000_000);
//! # Ok::<(), std::io::Error>(())
//! ```

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io;
use std::pin::Pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::{Context, Poll, Waker};
use tokio::runtime::Builder;

/// Instant and number of a timer, in the order in which timers fire. No two timers of a process have the same number.
type Key = (u64, u64);

/// Clock of one thread.
struct Clock {
    now_us: u64,
    /// Timers that have not fired; all lie in the future.
    timers: BTreeMap<Key, Waker>,
    /// Number of the next timer.
    number: u64,
}

/// Bits of a timer's number that count the timers of its thread; the others number the thread.
const COUNT_BITS: u32 = 40;

thread_local! {
    static CLOCK: RefCell<Clock> = RefCell::new(Clock::new());
}

impl Clock {
    fn new() -> Self {
        static THREADS: AtomicU64 = AtomicU64::new(0);
        Self {
            now_us: 0,
            timers: BTreeMap::new(),
            number: THREADS.fetch_add(1, Ordering::Relaxed) << COUNT_BITS,
        }
    }

    /// Sets a timer; returns its key.
    fn set(&mut self, at_us: u64, waker: Waker) -> Key {
        let key = (at_us, self.number);
        self.number += 1;
        self.timers.insert(key, waker);
        key
    }

    /// Removes the first timer if its instant has come.
    fn take_due(&mut self) -> Option<Waker> {
        let first = self.timers.first_entry()?;
        (first.key().0 <= self.now_us).then(|| first.remove())
    }
}

/// Returns the virtual time of this thread, microseconds; 0 when the thread begins.
pub fn now_us() -> u64 {
    CLOCK.with_borrow(|clock| clock.now_us)
}

/// Returns a timer that fires when the virtual time is `at_us`, at once if that has passed. It fires only on the thread of
/// a runtime of [`builder`]. A timer that is dropped on its thread leaves nothing behind.
pub fn sleep_until(at_us: u64) -> Sleep {
    Sleep { at_us, key: None }
}

/// Returns the builder of a runtime of one thread that runs in virtual time. Several such runtimes on one thread, one
/// after another, share the clock.
///
/// Work on a blocking thread does not hold the clock. A runtime with I/O polls the kernel at each jump of the clock.
pub fn builder() -> Builder {
    let mut builder = Builder::new_current_thread();
    builder.on_thread_park(jump);
    builder
}

/// Runs `work` in a runtime of [`builder`].
///
/// # Errors
/// Fails when the operating system refuses the runtime.
pub fn block_on<F: Future>(work: F) -> io::Result<F::Output> {
    Ok(builder().build()?.block_on(work))
}

/// Moves the clock of this thread `us` ahead at once, as a host does that pauses: timers of that time fire late.
pub fn pause_host(us: u64) {
    CLOCK.with_borrow_mut(|clock| clock.now_us += us);
    wake_due();
}

/// Runs `work` for at most `us` of virtual time; returns `None` when it has not ended by then.
pub async fn within<F: Future>(us: u64, work: F) -> Option<F::Output> {
    tokio::select! {
        biased;
        output = work => Some(output),
        () = sleep_until(now_us() + us) => None,
    }
}

/// Moves the clock to the next timer.
fn jump() {
    CLOCK.with_borrow_mut(|clock| {
        if let Some(((at_us, _), _)) = clock.timers.first_key_value() {
            debug_assert!(*at_us > clock.now_us, "a timer has been missed");
            clock.now_us = *at_us;
        }
    });
    wake_due();
}

/// Wakes the tasks of the timers whose instant has come, in the order of the instants and then of their setting.
fn wake_due() {
    // A woken task may drop timers, and so borrow the clock.
    while let Some(waker) = CLOCK.with_borrow_mut(Clock::take_due) {
        waker.wake();
    }
}

/// A timer of [`sleep_until`].
#[derive(Debug)]
#[must_use = "a timer does nothing unless it is awaited"]
pub struct Sleep {
    at_us: u64,
    /// Key of the timer while it is set, and after it has fired.
    key: Option<Key>,
}

impl Future for Sleep {
    type Output = ();

    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<()> {
        let (at_us, key) = (self.at_us, self.key);
        let waker = context.waker();
        // The waker that another one replaces is dropped after the clock has been given back, because with it a task
        // may end, and drop timers.
        let (set, _replaced) = CLOCK.with_borrow_mut(|clock| {
            if at_us <= clock.now_us {
                return (None, None);
            }
            match key.map(|key| clock.timers.entry(key)) {
                Some(Entry::Occupied(mut entry)) if !entry.get().will_wake(waker) => {
                    (key, Some(entry.insert(waker.clone())))
                }
                Some(Entry::Occupied(_)) => (key, None),
                Some(Entry::Vacant(_)) | None => (Some(clock.set(at_us, waker.clone())), None),
            }
        });
        self.key = set;
        match set {
            Some(_) => Poll::Pending,
            None => Poll::Ready(()),
        }
    }
}

impl Drop for Sleep {
    fn drop(&mut self) {
        if let Some(key) = self.key {
            // The clock is gone when its thread ends; another thread's clock does not have the timer.
            let _ended = CLOCK.try_with(|clock| clock.borrow_mut().timers.remove(&key));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::sync::mpsc;
    use std::time::Duration;

    /// Returns the order in which tasks wake that wait for `instants_us`.
    fn order(instants_us: &'static [u64]) -> Vec<(u64, usize)> {
        let (woken, order) = mpsc::channel();
        let wait = async move {
            let tasks = instants_us.iter().enumerate().map(|(task, at_us)| {
                let woken = woken.clone();
                tokio::spawn(async move {
                    sleep_until(*at_us).await;
                    woken.send((now_us(), task)).unwrap();
                })
            });
            for task in tasks.collect::<Vec<_>>() {
                task.await.unwrap();
            }
        };
        block_on(wait).unwrap();
        order.try_iter().collect()
    }

    fn timers() -> usize {
        CLOCK.with_borrow(|clock| clock.timers.len())
    }

    #[test]
    fn timers_fire_at_their_instant_in_order() {
        let order = order(&[70_000, 3, 70_000, 4_097, 3]);
        assert_eq!(
            order,
            [(3, 1), (3, 4), (4_097, 3), (70_000, 0), (70_000, 2)]
        );
    }

    #[test]
    fn a_past_timer_fires_at_once() {
        block_on(async {
            sleep_until(500).await;
            sleep_until(499).await;
            sleep_until(500).await;
        })
        .unwrap();
        assert_eq!(now_us(), 500);
    }

    #[test]
    fn a_dropped_timer_leaves_nothing() {
        let output = block_on(within(1_000, async {
            assert_eq!(within(10, sleep_until(20)).await, None);
            assert_eq!(within(10, sleep_until(20)).await, Some(()));
        }));
        assert_eq!(output.unwrap(), Some(()));
        assert_eq!((now_us(), timers()), (20, 0));
    }

    #[test]
    fn an_ended_runtime_leaves_no_timer() {
        block_on(async {
            tokio::spawn(sleep_until(1_000));
            tokio::task::yield_now().await;
            assert_eq!(timers(), 1);
        })
        .unwrap();
        assert_eq!((now_us(), timers()), (0, 0));
    }

    #[test]
    fn a_timer_wakes_the_task_that_polled_it_last() {
        block_on(async {
            let mut timer = Box::pin(sleep_until(50));
            let early = within(10, timer.as_mut()).await;
            assert_eq!(early, None);
            let moved = tokio::spawn(timer);
            moved.await.unwrap();
        })
        .unwrap();
        assert_eq!(now_us(), 50);
    }

    #[test]
    fn after_a_pause_of_the_host_timers_fire_late() {
        block_on(async {
            let late = tokio::spawn(async {
                sleep_until(30).await;
                now_us()
            });
            tokio::task::yield_now().await;
            pause_host(100);
            assert_eq!(late.await.unwrap(), 100);
        })
        .unwrap();
    }

    #[test]
    fn another_thread_has_another_clock() {
        fn set() -> Pin<Box<Sleep>> {
            let mut timer = Box::pin(sleep_until(900));
            let polled = timer.as_mut().poll(&mut Context::from_waker(Waker::noop()));
            assert!(polled.is_pending());
            timer
        }
        block_on(sleep_until(700)).unwrap();
        let other = std::thread::spawn(|| (set(), now_us()));
        let (theirs, their_us) = other.join().unwrap();
        assert_eq!((their_us, now_us()), (0, 700));
        let ours = set();
        drop(theirs);
        assert_eq!(timers(), 1);
        drop(ours);
        assert_eq!(timers(), 0);
    }

    #[test]
    fn work_of_another_thread_wakes_a_waiting_runtime() {
        let (answer, asked) = tokio::sync::oneshot::channel();
        let other = std::thread::spawn(move || {
            std::thread::park_timeout(Duration::from_millis(20));
            answer.send(7).unwrap();
        });
        assert_eq!(block_on(asked).unwrap(), Ok(7));
        other.join().unwrap();
        assert_eq!(now_us(), 0);
    }
}
