//! `GET /api/calibration`: what measurements lean on, of the rig that the view shows.

use super::error::HmiError;
use super::router::Desk;
use axum::Json;
use axum::extract::State;
use config::Plant;
use history::inquiry::instruments::{Instruments, instruments};

/// `GET /api/calibration`.
pub(super) async fn calibration(State(desk): State<Desk>) -> Result<Json<Instruments>, HmiError> {
    let simulated = desk.shared.view.borrow().simulated;
    let dir = desk.shared.config.clone();
    let read = move |archive: &history::Archive| {
        let plant = Plant::load(&dir)?;
        Ok(instruments(
            archive,
            simulated,
            &plant.golden.certificates(),
        )?)
    };
    desk.readers.read(read).await.map(Json)
}
