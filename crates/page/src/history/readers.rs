//! Who reads the history for screens, and how many at the same time.

use super::super::error::HmiError;
use history::Archive;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_blocking;

/// Readers at the same time; further ones wait.
const AT_ONCE: usize = 4;

/// The file, and the places before it.
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

    /// An open archive and the place it takes, to be dropped together.
    pub async fn open(&self) -> Result<(Archive, OwnedSemaphorePermit), HmiError> {
        let place = Arc::clone(&self.places).acquire_owned().await;
        let place = place.map_err(|_| HmiError::ReaderLost)?;
        let db = self.db.clone();
        let archive = spawn_blocking(move || Archive::open(&db)).await;
        Ok((archive.map_err(|_| HmiError::ReaderLost)??, place))
    }

    /// What `read` makes of the archive, beside the async threads.
    pub async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&Archive) -> Result<T, HmiError> + Send + 'static,
    ) -> Result<T, HmiError> {
        let (archive, place) = self.open().await?;
        let work = move || {
            let found = read(&archive);
            drop(place);
            found
        };
        spawn_blocking(work)
            .await
            .map_err(|_| HmiError::ReaderLost)?
    }
}
