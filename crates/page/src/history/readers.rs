//! Readers of the history for HTTP clients, limited in number.

use super::super::error::{ApiError, blocking};
use crate::api::Input;
use axum::extract::{FromRef, FromRequestParts, RawPathParams};
use axum::http::request::Parts;
use history::Archive;
use std::fmt::Debug;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Greatest number of readers at the same time; further readers wait.
const AT_ONCE: usize = 4;

/// Plant and name of a rig.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RigName {
    /// Name of the plant.
    pub site: String,
    /// Name of the rig.
    pub rig: String,
}

/// Source of histories: the file of one rig, or a database with the histories of many.
pub trait Archives: Debug + Send + Sync {
    /// Opens the history of `rig`; with `None`, the history of all rigs. Blocks.
    ///
    /// # Errors
    /// Fails when the history cannot be read, and when the source has no such rig.
    fn open(&self, rig: Option<&RigName>) -> history::Result<Archive>;
}

impl Archives for PathBuf {
    fn open(&self, rig: Option<&RigName>) -> history::Result<Archive> {
        assert!(rig.is_none(), "a file is of one rig");
        Archive::open(self)
    }
}

/// The histories and the permits to read them. A route that takes this input reads the history of the rig in its path,
/// or of all rigs when the path names none.
#[derive(Debug, Clone)]
pub(crate) struct Readers {
    archives: Arc<dyn Archives>,
    places: Arc<Semaphore>,
    rig: Option<RigName>,
}

impl Readers {
    pub fn new(archives: Arc<dyn Archives>) -> Self {
        let places = Arc::new(Semaphore::new(AT_ONCE));
        Self {
            archives,
            places,
            rig: None,
        }
    }

    /// Opens the archive; the caller keeps the returned permit until it drops the archive.
    pub async fn open(&self) -> Result<(Archive, OwnedSemaphorePermit), ApiError> {
        let place = Arc::clone(&self.places).acquire_owned().await;
        let place = place.map_err(|_| ApiError::ReaderLost)?;
        let (archives, rig) = (Arc::clone(&self.archives), self.rig.clone());
        Ok((blocking(move || archives.open(rig.as_ref())).await?, place))
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

impl<S: Send + Sync> FromRequestParts<S> for Readers
where
    Self: FromRef<S>,
{
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let named = RawPathParams::from_request_parts(parts, state).await;
        let named = named.map_err(|refused| ApiError::Query {
            reason: refused.body_text(),
        })?;
        let member = |name| named.iter().find(|(it, _)| *it == name);
        let member = |name| member(name).map(|(_, value)| value.to_owned());
        let rig = member("site").zip(member("rig"));
        Ok(Self {
            rig: rig.map(|(site, rig)| RigName { site, rig }),
            ..Self::from_ref(state)
        })
    }
}

impl Input for Readers {}
