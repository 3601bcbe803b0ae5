//! Serves the page on a thread of its own, so that no screen delays the line.

use crate::controls::Controls;
use crate::order::Files;
use crate::planning::ToolingPlanner;
use anyhow::Context;
use machine::view::{Mimic, OrderRequest};
use page::Listener;
use page::access::SetupCode;
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::sync::{mpsc, watch};

pub(super) struct Page {
    pub url: String,
    /// Code that adds the first engineer; `None` when there is an engineer.
    pub setup: Option<SetupCode>,
    ended: watch::Sender<bool>,
    thread: JoinHandle<()>,
}

impl Page {
    pub fn start(
        listener: Listener,
        files: &Files,
        controls: &Controls,
        orders: mpsc::Sender<OrderRequest>,
        mimic: Mimic,
    ) -> anyhow::Result<Self> {
        let (listener, tls) = listener.into_parts();
        listener
            .set_nonblocking(true)
            .context("the page's socket")?;
        let address = listener.local_addr().context("the page's socket")?;
        let scheme = if tls.is_some() { "https" } else { "http" };
        let opened = ::page::Sessions::open(&files.db);
        let (sessions, setup) = opened.context("the logins are kept beside the history (--db)")?;
        let shared = ::page::Shared {
            sessions,
            mimic: Arc::new(mimic),
            view: controls.view.subscribe(),
            traffic: ::page::Traffic::new(controls.traffic()),
            db: files.db.clone(),
            config: files.config.clone(),
            plans: Arc::new(ToolingPlanner::new(&files.config)),
            orders,
        };
        let (ended, seen) = watch::channel(false);
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::spawn(move || {
            let served = runtime.block_on(async {
                let listener = tokio::net::TcpListener::from_std(listener)?;
                ::page::serve(listener, tls, shared, seen).await;
                Ok::<_, std::io::Error>(())
            });
            if let Err(error) = served {
                tracing::error!("the page failed: {error}");
            }
        });
        Ok(Self {
            url: format!("{scheme}://{address}/"),
            setup,
            ended,
            thread,
        })
    }

    /// Ends the server and all its streams.
    pub fn end(self) {
        self.ended.send_replace(true);
        if self.thread.join().is_err() {
            tracing::error!("an assertion of the page failed");
        }
    }
}
