//! Readers of the history for HTTP clients, limited in number.

use super::super::error::ApiError;
use history::Archive;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_blocking;

/// Most readers at the same time; further ones wait.
const AT_ONCE: usize = 4;

/// The history file and the permits to read it.
#[derive(Debug, Clone)]
pub(in super::super) struct Readers {
    db: PathBuf,
    places: Arc<Semaphore>,
}

impl Readers {
    pub fn new(db: PathBuf) -> Self {
        let places = Arc::new(Semaphore::new(AT_ONCE));
        Self { db, places }
    }

    /// Opens the archive; the caller keeps the permit as long as the archive.
    pub async fn open(&self) -> Result<(Archive, OwnedSemaphorePermit), ApiError> {
        let place = Arc::clone(&self.places).acquire_owned().await;
        let place = place.map_err(|_| ApiError::ReaderLost)?;
        let db = self.db.clone();
        let archive = spawn_blocking(move || Archive::open(&db)).await;
        Ok((archive.map_err(|_| ApiError::ReaderLost)??, place))
    }

    /// Runs `read` over the archive on a blocking thread.
    pub async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&Archive) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let (archive, place) = self.open().await?;
        let work = move || {
            let found = read(&archive);
            drop(place);
            found
        };
        spawn_blocking(work)
            .await
            .map_err(|_| ApiError::ReaderLost)?
    }
}
