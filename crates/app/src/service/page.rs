//! The page on a thread of its own, so that the line never waits for a screen.

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

/// The first engineer of a first start, who may log in.
#[derive(Debug)]
pub struct FirstLogin {
    /// Name.
    pub name: String,
    /// Password; it is stored nowhere.
    pub password: String,
    /// File of the people who may log in.
    pub people: PathBuf,
}

/// The page, being served.
pub(super) struct Page {
    /// Where it listens.
    pub address: SocketAddr,
    /// Made by a first start.
    pub first_login: Option<FirstLogin>,
    ended: watch::Sender<bool>,
    thread: JoinHandle<()>,
}

impl Page {
    /// Serves from now on.
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
        let (sessions, first) = ::page::Sessions::open(&people)?;
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
                tracing::error!("the page ended: {error}");
            }
        });
        Ok(Self {
            address,
            first_login,
            ended,
            thread,
        })
    }

    /// Ends it, with every stream.
    pub fn end(self) {
        self.ended.send_replace(true);
        if self.thread.join().is_err() {
            tracing::error!("the page ended by an assertion");
        }
    }
}
