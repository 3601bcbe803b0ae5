//! Serves the page on a thread of its own, so that no screen delays the line.

use crate::controls::Controls;
use crate::order::Files;
use anyhow::Context;
use machine::view::{Mimic, OrderRequest};
use page::access;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::sync::{mpsc, watch};

/// Login of the first engineer, created at the first start.
#[derive(Debug)]
pub struct FirstLogin {
    /// Name of the engineer.
    pub name: String,
    /// Password; stored nowhere.
    pub password: String,
    /// File of the logins.
    pub people: PathBuf,
}

pub(super) struct Page {
    pub address: SocketAddr,
    /// Login created at a first start; `None` at every later start.
    pub first_login: Option<FirstLogin>,
    ended: watch::Sender<bool>,
    thread: JoinHandle<()>,
}

impl Page {
    pub fn start(
        listener: TcpListener,
        files: &Files,
        controls: &Controls,
        orders: mpsc::Sender<OrderRequest>,
        mimic: Mimic,
    ) -> anyhow::Result<Self> {
        listener
            .set_nonblocking(true)
            .context("the page's socket")?;
        let address = listener.local_addr().context("the page's socket")?;
        let people = access::access_path(&files.db);
        let opened = ::page::Sessions::open(&people);
        let (sessions, first) = opened.context("the logins are kept beside the history (--db)")?;
        let first_login = first.map(|(name, password)| FirstLogin {
            name,
            password,
            people,
        });
        let shared = ::page::Shared {
            sessions,
            mimic: Arc::new(mimic),
            view: controls.view.subscribe(),
            traffic: ::page::Traffic::new(controls.traffic()),
            db: files.db.clone(),
            config: files.config.clone(),
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
                tracing::error!("the page failed: {error}");
            }
        });
        Ok(Self {
            address,
            first_login,
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
