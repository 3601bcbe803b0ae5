//! The page of many rigs: one task asks the database what all rigs do, the page shows the answer, and each question
//! about a history opens a reader of its own.

use super::controls::Interrupts;
use super::exit::Exit;
use config::{FleetSettings, FleetTarget};
use fleet::overview::{Watched, watch};
use fleet::{Reader, Rigs};
use history::inquiry::rigs::Overview;
use history::inquiry::shifts::Shift;
use history::{Archive, HistoryError};
use jiff::tz::TimeZone;
use page::{Archives, FleetShared, Listener, RigName};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch::{Sender, channel};

/// Longest time for one SQL statement, shorter than the time for which the page waits for an answer.
const PATIENCE: Duration = Duration::from_secs(15);

/// The page, ready to serve.
#[derive(Debug)]
pub struct FleetPage {
    listener: Listener,
    watched: Watched,
}

impl FleetPage {
    /// Creates the page on the socket of `listener`, for the rigs in `target`; the database need not answer yet.
    #[must_use]
    pub fn new(listener: Listener, settings: &FleetSettings, target: FleetTarget) -> Self {
        let shift = |it: &config::Shift| Shift {
            name: it.name.clone(),
            minutes: it.minutes(),
        };
        let watched = Watched {
            target,
            shifts: settings.shifts.iter().map(shift).collect(),
            zone: TimeZone::system(),
        };
        Self { listener, watched }
    }

    /// Serves the page until Ctrl-C or SIGTERM; calls `listening` with its address first.
    ///
    /// # Errors
    /// Fails when the system refuses a thread, a signal handler or the socket.
    pub fn run(self, listening: impl FnOnce(&str)) -> anyhow::Result<Exit> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let done = runtime.block_on(self.serve(listening));
        // Does not wait for a reader that still waits for the database.
        runtime.shutdown_background();
        done
    }

    async fn serve(self, listening: impl FnOnce(&str)) -> anyhow::Result<Exit> {
        let mut interrupts = Interrupts::listen()?;
        let (socket, tls) = self.listener.into_parts();
        socket.set_nonblocking(true)?;
        let scheme = if tls.is_some() { "https" } else { "http" };
        let url = format!("{scheme}://{}/", socket.local_addr()?);
        let socket = tokio::net::TcpListener::from_std(socket)?;
        let (seen, overview) = channel(Overview {
            target: self.watched.target.url.clone(),
            ..Overview::default()
        });
        let (end, ended) = channel(false);
        let archives = Database(self.watched.target.clone());
        let shared = FleetShared {
            overview,
            archives: Arc::new(archives),
        };
        listening(&url);
        tokio::join!(
            page::serve_fleet(socket, tls, shared, ended),
            watch_until(&mut interrupts, &self.watched, &seen, &end),
        );
        Ok(Exit::Done)
    }
}

/// Watches the rigs until a signal comes, then ends the page.
async fn watch_until(
    interrupts: &mut Interrupts,
    watched: &Watched,
    seen: &Sender<Overview>,
    end: &Sender<bool>,
) {
    tokio::select! {
        () = interrupts.next() => {}
        () = watch(watched, seen) => {}
    }
    end.send_replace(true);
}

/// The database that holds the histories of all rigs.
#[derive(Debug)]
struct Database(FleetTarget);

impl Archives for Database {
    fn open(&self, rig: Option<&RigName>) -> history::Result<Archive> {
        let rigs = Rigs {
            site: rig.map(|it| it.site.clone()),
            rig: rig.map(|it| it.rig.clone()),
        };
        let reader = Reader::open_within(&self.0, &rigs, Some(PATIENCE));
        let reader = reader.map_err(|error| HistoryError::Server(Box::new(error)))?;
        Ok(Archive::of_server(Box::new(reader)))
    }
}
