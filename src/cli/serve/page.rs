//! The page on a thread of its own, so that the line never waits for a screen.

use super::Controls;
use anyhow::Context;
use machine::view::{Mimic, OrderRequest};
use page::{self, access};
use std::path::Path;
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::sync::{mpsc, watch};

/// The page, being served.
pub struct Page {
    ended: watch::Sender<bool>,
    thread: JoinHandle<()>,
}

impl Page {
    /// From now on; of the first engineer of a first start the password is told.
    pub fn start(
        listener: std::net::TcpListener,
        config: &Path,
        controls: &Controls,
        orders: mpsc::Sender<OrderRequest>,
        db: &Path,
        mimic: Mimic,
    ) -> anyhow::Result<Self> {
        listener
            .set_nonblocking(true)
            .context("the page's socket")?;
        let people = access::beside(db);
        let (gate, first) = ::page::Gate::open(&people)?;
        if let Some((name, password)) = first {
            eprintln!(
                "relayrig: log in as {name} with {password} (told this once; people are in {})",
                people.display()
            );
        }
        let shared = ::page::Shared {
            gate,
            mimic: Arc::new(mimic),
            view: controls.view.subscribe(),
            traffic: ::page::Traffic::new(controls.traffic()),
            db: db.to_path_buf(),
            config: config.to_path_buf(),
            orders,
        };
        let (ended, seen) = watch::channel(false);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::spawn(move || {
            let served = runtime.block_on(async {
                let listener = tokio::net::TcpListener::from_std(listener)?;
                ::page::serve(listener, shared, seen).await
            });
            if let Err(error) = served {
                tracing::error!("the page ended: {error}");
            }
        });
        Ok(Self { ended, thread })
    }

    /// Ends it, with every stream.
    pub fn end(self) {
        self.ended.send_replace(true);
        if self.thread.join().is_err() {
            tracing::error!("the page ended by an assertion");
        }
    }
}
