//! A thread that waits for Ctrl-C and SIGTERM and stops the run.
//!
//! | signal | effect |
//! |---|---|
//! | first | the run finishes the parts inside |
//! | second | the run ends at once; after [`RUN_ENDS_WITHIN`] the program ends without the run |
//! | third | the program ends without the run |
//!
//! The run has another thread, so these signals also end a program whose run never returns. The program then gives only
//! a message and an exit status; the host watchdogs of the modules make the outputs safe.

use super::controls::Interrupts;
use super::exit::{Cause, Exit};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::sync::oneshot;

/// Longest time from the second signal to the end of the run: more than the tasks of the rig's thread may take.
const RUN_ENDS_WITHIN: Duration = Duration::from_secs(20);

/// Handle of the thread; dropping the handle ends the thread.
#[derive(Debug)]
pub struct StopSignals {
    _run: oneshot::Sender<()>,
}

impl StopSignals {
    /// Starts to listen, also outside a runtime; the first signal sets the first flag, the second signal the second
    /// flag.
    ///
    /// # Errors
    /// Fails when the operating system refuses the handlers or the thread.
    pub fn listen(flags: [Arc<AtomicBool>; 2]) -> std::io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let mut interrupts = {
            let _inside = runtime.enter();
            Interrupts::listen()?
        };
        let (run, ended) = oneshot::channel();
        let serve = move || {
            let hung = stop(flags, async || interrupts.next().await);
            runtime.block_on(async {
                tokio::select! {
                    () = hung => end_program(),
                    _ = ended => {}
                }
            });
        };
        std::thread::Builder::new()
            .name("signals".into())
            .spawn(serve)?;
        Ok(Self { _run: run })
    }
}

/// Sets a flag at each of the first two signals; returns when the program must end without the run. A signal that
/// arrives while this function logs is not lost.
async fn stop(flags: [Arc<AtomicBool>; 2], mut signal: impl AsyncFnMut()) {
    let said = [
        "stopping when the parts inside are finished; once more stops at once",
        "stopping at once, outputs safe; once more ends the program without waiting",
    ];
    for (flag, said) in flags.into_iter().zip(said) {
        signal().await;
        flag.store(true, Ordering::Release);
        tracing::warn!("{said}");
    }
    // A third signal and the end of the wait have the same effect.
    let _ = tokio::time::timeout(RUN_ENDS_WITHIN, signal()).await;
}

fn end_program() {
    let cause = Cause::hung();
    tracing::error!(code = cause.code, "{}", cause.text);
    std::process::exit(Exit::Trouble(cause).code().into());
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    /// Asks the test below, in a process of its own, to hang.
    const HANG: &str = "RELAYRIG_TEST_HANG";

    fn flags() -> [Arc<AtomicBool>; 2] {
        Default::default()
    }

    /// Prints what the flags are, as soon as they change, and never returns.
    fn hang() -> ! {
        let flags = flags();
        let _signals = StopSignals::listen(flags.clone()).unwrap();
        let set = || flags.each_ref().map(|flag| flag.load(Ordering::Acquire));
        let mut before = [true; 2];
        loop {
            let now = set();
            if std::mem::replace(&mut before, now) != now {
                eprintln!("flags {now:?}");
            }
            std::thread::yield_now();
        }
    }

    #[test]
    fn a_third_signal_ends_a_program_that_hangs() {
        if std::env::var_os(HANG).is_some() {
            hang();
        }
        let name = concat!(
            "stop_signals::tests::",
            "a_third_signal_ends_a_program_that_hangs"
        );
        let mut process = Command::new(std::env::current_exe().unwrap())
            .args([name, "--exact", "--nocapture"])
            .env(HANG, "1")
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let pid = rustix::process::Pid::from_child(&process);
        let mut lines = BufReader::new(process.stderr.take().unwrap()).lines();
        for expected in ["[false, false]", "[true, false]", "[true, true]"] {
            let told = lines.find(|line| line.as_ref().is_ok_and(|it| it.ends_with(expected)));
            assert!(told.is_some(), "no flags {expected}");
            rustix::process::kill_process(pid, rustix::process::Signal::TERM).unwrap();
        }
        assert_eq!(process.wait().unwrap().code(), Some(3));
    }

    #[tokio::test(start_paused = true)]
    async fn a_second_signal_gives_the_run_twenty_seconds() {
        let mut left = 2;
        let began = tokio::time::Instant::now();
        let signal = async || match left {
            0 => std::future::pending().await,
            _ => left -= 1,
        };
        let flags = flags();
        stop(flags.clone(), signal).await;
        assert_eq!(began.elapsed(), RUN_ENDS_WITHIN);
        assert!(flags.iter().all(|flag| flag.load(Ordering::Acquire)));
    }
}
