//! Runs the lines and the cycle on a thread of their own, with a priority above all ordinary processes where the system
//! grants it.
//!
//! At real pace neither history nor page nor log run on this thread. In virtual time the lines and the cycle run on the
//! caller's thread, because the virtual clock of that thread is the clock of the rig.

use anyhow::Context;
use bus::{Pace, Passage};
use cycle::Lateness;
use machine::view::HostView;
use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, getrlimit};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle as Thread;
use std::time::Duration;
use thiserror::Error;
use thread_priority::{
    RealtimeThreadSchedulePolicy, ScheduleParams, ThreadPriority, ThreadSchedulePolicy,
    set_thread_priority_and_policy, thread_native_id,
};
use tokio::runtime::Handle;
use tokio::sync::{mpsc, oneshot};
use tokio::task::{JoinError, JoinHandle};
use units::{RigTime, Span};

/// Priority under SCHED_FIFO: above every ordinary process, below the kernel threads that handle interrupts (50).
pub const PRIORITY: u8 = 49;
/// Interval of the waits of a latency test, the default of cyclictest.
pub const INTERVAL: Span = Span::ms(1);
/// Interval of the waits of the bare loop: about that of the cycle. A stall of the computer ends one wait late, however
/// short the others are, so percentiles compare only between loops that wait equally often.
const BARE_INTERVAL: Span = Span::ms(10);

/// Longest time for which the thread, before it ends, waits for tasks that must end by themselves.
const ENDS_WITHIN: Duration = Duration::from_secs(12);

/// Spawns tasks onto the rig's thread.
#[derive(Debug, Clone)]
pub struct Keeper {
    /// Spawns tasks that are aborted when the thread ends.
    pub handle: Handle,
    /// Each task that must end by itself holds a clone.
    awaited: mpsc::Sender<()>,
}

impl Keeper {
    /// Spawns a task for which the thread, before it ends, waits for at most [`ENDS_WITHIN`].
    pub fn spawn<T: Send + 'static>(
        &self,
        task: impl Future<Output = T> + Send + 'static,
    ) -> JoinHandle<T> {
        let awaited = self.awaited.clone();
        self.handle.spawn(async move {
            let _awaited = awaited;
            task.await
        })
    }
}

/// Handle of a task; dropping the handle aborts the task.
#[derive(Debug)]
pub struct Owned<T>(JoinHandle<T>);

impl<T> Owned<T> {
    /// Takes over a task.
    pub fn new(task: JoinHandle<T>) -> Self {
        Self(task)
    }

    /// Waits for the end of the task.
    ///
    /// # Errors
    /// Fails when the task panicked.
    pub async fn end(mut self) -> Result<T, JoinError> {
        (&mut self.0).await
    }
}

impl<T> Drop for Owned<T> {
    fn drop(&mut self) {
        self.0.abort();
    }
}

/// A thread whose runtime serves the lines and the cycle. At real pace, dropping the value waits for the tasks of
/// [`Keeper::spawn`] and then aborts all other tasks.
pub struct RigThread {
    keeper: Keeper,
    /// Rights that the system grants the thread; this view holds no lateness.
    pub rights: HostView,
    /// How late this computer passes bytes on; measured at real pace only.
    pub passage: Passage,
    own: Option<(oneshot::Sender<()>, Thread<()>)>,
}

impl RigThread {
    /// Takes the current thread in virtual time; at real pace starts a thread and raises its priority.
    ///
    /// # Errors
    /// Fails when the system refuses a thread or its runtime.
    pub fn start(pace: Pace) -> anyhow::Result<Self> {
        if pace.is_virtual() {
            return Ok(Self {
                keeper: Keeper {
                    handle: Handle::current(),
                    awaited: mpsc::channel(1).0,
                },
                rights: HostView::default(),
                passage: Passage::default(),
                own: None,
            });
        }
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .context("starting the runtime of the rig")?;
        let (awaited, mut others) = mpsc::channel(1);
        let handle = runtime.handle().clone();
        let keeper = Keeper { handle, awaited };
        let (granted, rights) = std::sync::mpsc::sync_channel(1);
        let (stop, stopped) = oneshot::channel();
        let serve = move || {
            // `start` waits for the rights below, so the channel is open.
            let _ = granted.send(raise());
            let _ = runtime.block_on(stopped);
            // Ends when the last task has dropped its sender.
            let ended = async { tokio::time::timeout(ENDS_WITHIN, others.recv()).await };
            if runtime.block_on(ended).is_err() {
                tracing::error!("a task of the rig did not end in time");
            }
        };
        let thread = std::thread::Builder::new().name("rig".into());
        let thread = thread.spawn(serve).context("starting the rig's thread")?;
        let rights = rights.recv().context("starting the rig's thread")?;
        log(&rights);
        let passage = Passage::default();
        keeper.handle.spawn(passage.clone().measure());
        Ok(Self {
            keeper,
            rights,
            passage,
            own: Some((stop, thread)),
        })
    }
}

impl RigThread {
    /// Returns the spawner of tasks on this thread.
    pub fn keeper(&self) -> &Keeper {
        &self.keeper
    }
}

impl Drop for RigThread {
    fn drop(&mut self) {
        // From here on only tasks hold clones of the sender.
        self.keeper.awaited = mpsc::channel(1).0;
        if let Some((stop, thread)) = self.own.take() {
            let _ = stop.send(());
            if thread.join().is_err() {
                tracing::error!("an assertion on the rig's thread failed");
            }
        }
    }
}

/// Raises this thread to SCHED_FIFO and locks the memory of the program, as far as the system grants these rights.
fn raise() -> HostView {
    let mut rights = HostView::default();
    match raise_thread() {
        Ok(()) => rights.fifo_priority = Some(PRIORITY),
        Err(why) => rights.refused.push(why.to_string()),
    }
    match lock_memory() {
        Ok(()) => rights.memory_locked = true,
        Err(why) => rights.refused.push(why.to_string()),
    }
    rights
}

/// Reason why the system refuses a right.
#[derive(Debug, Error)]
pub enum Refused {
    /// The thread may not have a real-time priority.
    #[error("SCHED_FIFO: {0}")]
    Fifo(thread_priority::Error),
    /// The program may lock memory only up to a limit, beyond which the system would refuse it further memory.
    #[error("locked memory: found a limit of {limit_kb} kB, expected none")]
    Limit {
        /// The limit (RLIMIT_MEMLOCK), kB.
        limit_kb: u64,
    },
    /// The program may not lock memory.
    #[error("locked memory: {0}")]
    Lock(rustix::io::Errno),
}

/// Raises this thread to SCHED_FIFO.
///
/// # Errors
/// Fails when the system refuses the priority.
pub fn raise_thread() -> Result<(), Refused> {
    let priority = ThreadPriority::from_posix(ScheduleParams {
        sched_priority: PRIORITY.into(),
    });
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), priority, policy).map_err(Refused::Fifo)
}

/// Keeps the pages of the program in memory from their first use on.
fn lock_memory() -> Result<(), Refused> {
    if let Some(limit) = getrlimit(Resource::Memlock).current
        && !rustix::process::geteuid().is_root()
    {
        let limit_kb = limit / 1024;
        return Err(Refused::Limit { limit_kb });
    }
    let all = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT;
    mlockall(all).map_err(Refused::Lock)
}

fn log(rights: &HostView) {
    if rights.refused.is_empty() {
        let priority = rights.fifo_priority.unwrap_or_default();
        return tracing::info!("lines and cycle run under SCHED_FIFO {priority}, memory locked");
    }
    let why = rights.refused.join("; ");
    tracing::warn!("no real-time rights ({why}): a busy computer may delay the rig");
}

/// A thread that only sleeps, under SCHED_FIFO, beside the rig: shows how late this computer wakes the simplest
/// program.
pub struct BareLoop {
    stop: Arc<AtomicBool>,
    thread: Thread<Lateness>,
}

impl BareLoop {
    /// Starts the loop on a thread of its own, with the priority of the rig's thread.
    ///
    /// # Errors
    /// Fails when the system refuses the thread.
    pub fn start() -> anyhow::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let thread = std::thread::Builder::new().name("bare loop".into());
        let thread = thread.spawn(move || {
            // Without the right to this priority, the loop measures a thread of usual priority.
            let _ = raise_thread();
            bare_loop(&stopped)
        });
        Ok(Self {
            stop,
            thread: thread.context("starting the bare loop")?,
        })
    }

    /// Ends the loop and returns its lateness.
    pub fn end(self) -> Lateness {
        self.stop.store(true, Ordering::Release);
        self.thread.join().unwrap_or_default()
    }
}

fn bare_loop(stop: &AtomicBool) -> Lateness {
    let began = std::time::Instant::now();
    let now = || RigTime(began.elapsed().as_micros() as u64);
    let mut lateness = Lateness::default();
    let mut next = now() + BARE_INTERVAL;
    while !stop.load(Ordering::Acquire) {
        std::thread::sleep(Duration::from_micros(next.since(now()).0));
        lateness.count(next, now());
        next = next.max(now()) + BARE_INTERVAL;
    }
    lateness
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[tokio::test]
    async fn tasks_run_on_a_thread_of_their_own() {
        let thread = RigThread::start(Pace::real()).unwrap();
        let name = async { std::thread::current().name().map(str::to_owned) };
        let name = thread.keeper().handle.spawn(name).await.unwrap();
        assert_eq!(name.as_deref(), Some("rig"));
        let rights = &thread.rights;
        let granted = u32::from(rights.fifo_priority.is_some()) + u32::from(rights.memory_locked);
        assert_eq!(granted as usize + rights.refused.len(), 2, "{rights:?}");
    }

    #[test]
    fn virtual_time_stays_on_the_callers_thread() {
        virtual_time::block_on(async {
            let thread = RigThread::start(Pace::virtual_time()).unwrap();
            let here = std::thread::current().id();
            let there = async { std::thread::current().id() };
            assert_eq!(thread.keeper().handle.spawn(there).await.unwrap(), here);
            assert_eq!(thread.rights, HostView::default());
        })
        .unwrap();
    }
}
