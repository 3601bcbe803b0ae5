//! A link that breaks: it forwards bytes between rig and server and cuts a connection after a drawn number of bytes.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;

/// The link; it ends with this value.
pub struct Proxy {
    /// Port on 127.0.0.1.
    pub port: u16,
    /// Connections cut so far.
    pub cuts: Arc<AtomicU64>,
    most: Arc<AtomicU64>,
    carrier: JoinHandle<()>,
}

impl Proxy {
    /// Listens; every connection is cut after up to `most` bytes, in either direction.
    pub async fn start(server: u16, most: u64, seed: u64) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let port = listener.local_addr().unwrap().port();
        let cuts = Arc::new(AtomicU64::new(0));
        let count = Arc::clone(&cuts);
        let limit = Arc::new(AtomicU64::new(most));
        let most = Arc::clone(&limit);
        let carrier = tokio::spawn(async move {
            let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
            while let Ok((rig, _)) = listener.accept().await {
                let budget = 1 + random.next_u64() % limit.load(Ordering::Relaxed);
                let budget = if limit.load(Ordering::Relaxed) == u64::MAX {
                    u64::MAX
                } else {
                    budget
                };
                tokio::spawn(carry(rig, server, budget, Arc::clone(&count)));
            }
        });
        Self {
            port,
            cuts,
            most,
            carrier,
        }
    }

    /// Cuts no later connection.
    pub fn heal(&self) {
        self.most.store(u64::MAX, Ordering::Relaxed);
    }
}

impl Drop for Proxy {
    fn drop(&mut self) {
        self.carrier.abort();
    }
}

async fn carry(mut rig: TcpStream, port: u16, mut budget: u64, cuts: Arc<AtomicU64>) {
    let Ok(mut server) = TcpStream::connect(("127.0.0.1", port)).await else {
        return;
    };
    let (mut up, mut down) = ([0; 4096], [0; 4096]);
    loop {
        let (bytes, to) = tokio::select! {
            read = rig.read(&mut up) => (read.map(|n| &up[..n]), &mut server),
            read = server.read(&mut down) => (read.map(|n| &down[..n]), &mut rig),
        };
        let Ok(bytes) = bytes else { return };
        if bytes.is_empty() {
            return;
        }
        let some = bytes.len().min(usize::try_from(budget).unwrap());
        if to.write_all(&bytes[..some]).await.is_err() {
            return;
        }
        budget -= some as u64;
        if budget == 0 {
            cuts.fetch_add(1, Ordering::Relaxed);
            return;
        }
    }
}
