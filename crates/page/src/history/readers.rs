//! Readers of the history for HTTP clients, limited in number.

use super::super::error::{ApiError, blocking};
use history::Archive;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Largest number of readers at the same time; further ones wait.
const AT_ONCE: usize = 4;

/// The history file and the permits to read it.
#[derive(Debug, Clone)]
pub(crate) struct Readers {
    db: PathBuf,
    places: Arc<Semaphore>,
}

impl Readers {
    pub fn new(db: PathBuf) -> Self {
        let places = Arc::new(Semaphore::new(AT_ONCE));
        Self { db, places }
    }

    /// Opens the archive; the caller keeps the returned permit until it drops the archive.
    pub async fn open(&self) -> Result<(Archive, OwnedSemaphorePermit), ApiError> {
        let place = Arc::clone(&self.places).acquire_owned().await;
        let place = place.map_err(|_| ApiError::ReaderLost)?;
        let db = self.db.clone();
        Ok((blocking(move || Archive::open(&db)).await?, place))
    }

    /// Runs `read` over the archive on a blocking thread.
    pub async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&Archive) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let (archive, place) = self.open().await?;
        blocking(move || {
            let found = read(&archive);
            drop(place);
            found
        })
        .await
    }
}
