//! `GET /api/calibration`: calibration factors and reference parts of the rig that the server shows.

use super::error::JsonResult;
use super::router::App;
use axum::Json;
use axum::extract::State;
use config::Plant;
use history::inquiry::instruments::{Instruments, instruments};

/// `GET /api/calibration`.
pub(super) async fn calibration(State(app): App) -> JsonResult<Instruments> {
    let simulated = app.shared.view.borrow().simulated;
    let folder = app.shared.config.clone();
    let read = move |archive: &history::Archive| {
        let plant = Plant::load(&folder)?;
        Ok(instruments(
            archive,
            simulated,
            &plant.reference_parts.certificates(),
        )?)
    };
    app.readers.read(read).await.map(Json)
}
