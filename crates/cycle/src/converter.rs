//! Carries out long calculations: at real pace on a thread of ordinary priority, so that lines and cycle never wait for
//! one; in virtual time at once, so that equal runs stay equal.

use super::instruments::Deliverer;
use bus::Pace;
use machine::instrument::conversion::Converted;
use machine::instrument::query::Delivered;
use scpi::SamplesError;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc as threads;
use std::thread::Result as Outcome;
use tokio::sync::mpsc;

/// Result of a calculation.
pub(super) enum Finished {
    /// Result of a conversion.
    Converted(Converted),
    /// Values of a reply with a block.
    Decoded(Deliverer, Result<Delivered, SamplesError>),
}

/// A calculation.
type Work = Box<dyn FnOnce() -> Finished + Send>;
/// A calculation or its outcome, with the number of jobs that were dropped before the calculation began; a number below
/// the present one marks it as stale.
type Numbered<T> = (u64, T);

/// Carries out the calculations of a measuring job, one after the other.
pub(super) struct Converter {
    /// Queue of calculations for the thread; `None` without a thread.
    orders: Option<threads::Sender<Numbered<Work>>>,
    finished: mpsc::UnboundedReceiver<Numbered<Outcome<Finished>>>,
    finish: mpsc::UnboundedSender<Numbered<Outcome<Finished>>>,
    dropped: u64,
    waiting: Option<Numbered<Outcome<Finished>>>,
}

impl Converter {
    /// Makes a converter. At real pace it starts its thread, which takes the priority of the caller; so the caller must
    /// not be the thread of the cycle.
    pub fn new(pace: Pace) -> Self {
        let (finish, finished) = mpsc::unbounded_channel();
        let orders = (!pace.is_virtual())
            .then(|| thread(finish.clone()))
            .flatten();
        Self {
            orders,
            finished,
            finish,
            dropped: 0,
            waiting: None,
        }
    }

    /// Begins a calculation.
    pub fn begin(&self, work: impl FnOnce() -> Finished + Send + 'static) {
        let order: Numbered<Work> = (self.dropped, Box::new(work));
        let left = match &self.orders {
            Some(orders) => orders.send(order).err().map(|it| it.0),
            None => Some(order),
        };
        if let Some((dropped, work)) = left {
            // The receiver is in `self`.
            let _ = self.finish.send((dropped, Ok(work())));
        }
    }

    /// Forgets the calculations under way, because their job has been dropped.
    pub fn forget(&mut self) {
        self.dropped += 1;
    }

    /// Returns the next result of the present job. Fails with the assertion that failed in a calculation, so that the
    /// run ends like after one of the cycle.
    pub fn next_result(&mut self) -> Option<Finished> {
        loop {
            let next = self.waiting.take();
            let (dropped, outcome) = next.or_else(|| self.finished.try_recv().ok())?;
            assert!(dropped <= self.dropped, "a result of a job to come");
            let finished = outcome.unwrap_or_else(|assertion| resume_unwind(assertion));
            if dropped == self.dropped {
                return Some(finished);
            }
        }
    }

    /// Resolves when a result has arrived.
    pub async fn result(&mut self) {
        if self.waiting.is_none() {
            self.waiting = self.finished.recv().await;
        }
    }
}

/// Starts the thread; `None` when the system refuses one. It ends with the converter.
fn thread(
    finish: mpsc::UnboundedSender<Numbered<Outcome<Finished>>>,
) -> Option<threads::Sender<Numbered<Work>>> {
    let (orders, ordered) = threads::channel::<Numbered<Work>>();
    let work = move || {
        for (dropped, work) in ordered {
            let outcome = catch_unwind(AssertUnwindSafe(work));
            if finish.send((dropped, outcome)).is_err() {
                return;
            }
        }
    };
    let thread = std::thread::Builder::new().name("converter".into());
    thread.spawn(work).ok().map(|_| orders)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use machine::instrument::conversion::Conversion;
    use std::thread::{ThreadId, current};

    fn begin(converter: &Converter) {
        let conversion = Conversion::new(|_| current().id());
        converter.begin(move || Finished::Converted(conversion.run(&[])));
    }

    fn thread_of(finished: &Finished) -> ThreadId {
        let Finished::Converted(converted) = finished else {
            panic!("no conversion");
        };
        *converted.get().unwrap()
    }

    async fn ran_here(pace: Pace) -> bool {
        let mut converter = Converter::new(pace);
        begin(&converter);
        converter.result().await;
        thread_of(&converter.next_result().unwrap()) == current().id()
    }

    #[tokio::test]
    async fn a_calculation_at_real_pace_runs_on_another_thread() {
        assert!(!ran_here(Pace::real()).await);
    }

    #[test]
    fn a_calculation_in_virtual_time_takes_no_time() {
        virtual_time::block_on(async {
            let pace = Pace::virtual_time();
            let began = pace.now();
            assert!(ran_here(pace).await);
            assert_eq!(pace.now(), began);
        })
        .expect("a runtime");
    }

    #[tokio::test]
    async fn the_result_of_a_dropped_job_is_no_result() {
        let mut converter = Converter::new(Pace::real());
        let begin = |converter: &Converter, number: u32| {
            let conversion = Conversion::new(move |_| number);
            converter.begin(move || Finished::Converted(conversion.run(&[])));
        };
        begin(&converter, 1);
        converter.forget();
        begin(&converter, 2);
        let finished = loop {
            converter.result().await;
            if let Some(finished) = converter.next_result() {
                break finished;
            }
        };
        let Finished::Converted(converted) = finished else {
            panic!("no conversion");
        };
        assert_eq!(converted.get(), Some(&2u32));
    }

    #[tokio::test]
    #[should_panic(expected = "no such edge")]
    async fn a_failed_assertion_of_a_calculation_reaches_the_cycle() {
        let mut converter = Converter::new(Pace::real());
        converter.begin(|| panic!("no such edge"));
        converter.result().await;
        converter.next_result();
    }
}
