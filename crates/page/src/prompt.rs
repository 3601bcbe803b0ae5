//! `GET /api/picture`: the picture of the prompt that waits at the rig. The view has the prompt's text and choices.

use super::error::{ApiError, JsonResult, blocking};
use super::router::App;
use axum::Json;
use axum::extract::State;
use data_encoding::BASE64;

/// `GET /api/picture`: a `data:` address; null without a prompt, or when the prompt has no picture.
pub(super) async fn picture(State(app): App) -> JsonResult<Option<String>> {
    let prompt = app.shared.view.borrow().machine.prompt.clone();
    let name = prompt.and_then(|it| it.picture);
    let folder = app.shared.config.clone();
    blocking(move || {
        let picture = name.and_then(|it| folder.picture(&it));
        let address = |(media, bytes): (&str, Vec<u8>)| {
            format!("data:{media};base64,{}", BASE64.encode(&bytes))
        };
        Ok::<_, ApiError>(Json(picture.map(address)))
    })
    .await
}
