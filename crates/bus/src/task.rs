//! Hands tasks to the runtime from this crate.
//!
//! The compiler makes the code that polls a task in the crate that hands the task to the runtime, with the optimisation
//! of that crate. A release build does not optimise `app` (see the profile in `Cargo.toml`), so tasks of the line, and
//! the scheduler itself, would run several times slower from there.

use std::pin::Pin;
use tokio::runtime::{Handle, Runtime};
use tokio::task::JoinHandle;

/// A task whose type is erased where it is made.
pub type Task<T = ()> = Pin<Box<dyn Future<Output = T> + Send>>;

/// Spawns `task` on the runtime of `handle`.
pub fn spawn(handle: &Handle, task: Task) -> JoinHandle<()> {
    handle.spawn(task)
}

/// Runs `work` and the tasks of `runtime` until `work` has ended. Panics inside a runtime.
pub fn block_on(runtime: &Runtime, work: Pin<&mut dyn Future<Output = ()>>) {
    runtime.block_on(work);
}
