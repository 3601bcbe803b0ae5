//! Sends the queue of a file to one database again and again. Connects only when there is something to send.

use crate::error::{FleetError, Result};
use crate::session::{Pushed, Session};
use config::{FleetSettings, FleetTarget};
use history::outbox::{Lag, Outbox};
use std::any::Any;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use tokio::runtime::{Builder, Runtime};

/// Time after the last rows for which the connection stays open: a line tests the next part within seconds.
const KEPT: Duration = Duration::from_secs(60);

/// Sends to one database.
#[derive(Debug)]
pub(crate) struct Sender {
    fleet: FleetSettings,
    /// Index of the database in the settings.
    pub(crate) place: usize,
    db: PathBuf,
    runtime: Runtime,
    session: Option<Session>,
    /// End of the last attempt that succeeded.
    succeeded: Option<Instant>,
}

impl Sender {
    /// Makes a sender for the database with index `place` in the settings; does not connect yet.
    pub(crate) fn new(fleet: FleetSettings, place: usize, db: PathBuf) -> std::io::Result<Self> {
        assert!(place < fleet.targets.len(), "a database without settings");
        Ok(Self {
            fleet,
            place,
            db,
            runtime: Builder::new_current_thread().enable_all().build()?,
            session: None,
            succeeded: None,
        })
    }

    fn target(&self) -> &FleetTarget {
        &self.fleet.targets[self.place]
    }

    /// Sends what the database lacks, until `stop` returns true. The first attempt connects in any case, so that a
    /// wrong password shows before the first part; later attempts connect only to send rows.
    pub(crate) fn attempt(&mut self, stop: impl Fn() -> bool) -> Result<Pushed> {
        self.send_rows(stop).map_err(FleetError::while_sending)
    }

    fn send_rows(&mut self, stop: impl Fn() -> bool) -> Result<Pushed> {
        let mut outbox = Outbox::open(&self.db)?;
        if let Some(last) = self.succeeded
            && outbox.is_sent(&self.target().url)?
        {
            self.session.take_if(|_| last.elapsed() > KEPT);
            return Ok(Pushed::default());
        }
        let sent = match self.session.take() {
            // The server may have closed a connection that nothing used.
            Some(kept) => match self.send(&mut outbox, kept, &stop) {
                Err(error) if error.is_broken() => self.connect_and_send(&mut outbox, &stop),
                sent => sent,
            },
            None => self.connect_and_send(&mut outbox, &stop),
        }?;
        self.succeeded = Some(Instant::now());
        Ok(sent)
    }

    fn connect_and_send(&mut self, outbox: &mut Outbox, stop: impl Fn() -> bool) -> Result<Pushed> {
        let session = self.runtime.block_on(Session::open(self.target()))?;
        self.send(outbox, session, stop)
    }

    /// Sends over a session, and keeps it when that succeeds.
    fn send(
        &mut self,
        outbox: &mut Outbox,
        mut session: Session,
        stop: impl Fn() -> bool,
    ) -> Result<Pushed> {
        let sending = session.send_queue(outbox, &self.fleet, self.target(), stop);
        let sent = self.runtime.block_on(sending)?;
        self.session = Some(session);
        Ok(sent)
    }

    /// Returns what the database lacks; `None` when the file cannot be read.
    pub(crate) fn lag(&self) -> Option<Lag> {
        let outbox = Outbox::open(&self.db).ok()?;
        match outbox.known(&self.target().url).ok()? {
            Some(known) => outbox.lag(&known).ok(),
            None => Some(Lag::default()),
        }
    }

    /// Returns the error for a panic of [`Self::attempt`].
    pub(crate) fn fault(&mut self, panic: &(dyn Any + Send)) -> FleetError {
        self.session = None;
        let said = panic.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| panic.downcast_ref::<&str>().copied());
        FleetError::Fault {
            target: self.target().url.clone(),
            said: said.unwrap_or("no text").to_owned(),
        }
    }
}
