//! `/api/history/export.csv` and `.xlsx`: `history export` over HTTP. CSV is streamed, however long; a
//! spreadsheet must be whole before it leaves, so it has an end ([`SHEET_PARTS`]).
//!
//! Such a copy does not count for the retention: nobody here sees whether it arrived.

use super::super::error::HmiError;
use super::super::router::Desk;
use super::asked::{Printed, asked, language};
use super::feed;
use axum::extract::State;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::http::{HeaderName, Uri};
use axum::response::{IntoResponse, Response};
use history::csv::BYTE_ORDER_MARK;
use history::inquiry::{InquiryError, checks, export};
use std::io::{self, Write};
use tokio::task::spawn_blocking;

/// Parts of a spreadsheet that one answer holds, some 15 MB; larger ones are made by the command line.
const SHEET_PARTS: u64 = 100_000;

type Saved = [(HeaderName, &'static str); 2];

const CSV: Saved = [
    (CONTENT_TYPE, "text/csv; charset=utf-8"),
    (
        CONTENT_DISPOSITION,
        "attachment; filename=\"relayrig-parts.csv\"",
    ),
];
const XLSX: Saved = [
    (
        CONTENT_TYPE,
        "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    ),
    (
        CONTENT_DISPOSITION,
        "attachment; filename=\"relayrig-parts.xlsx\"",
    ),
];

/// `GET /api/history/export.csv`.
pub(in super::super) async fn csv(
    State(desk): State<Desk>,
    filter: super::Filtered,
) -> Result<Response, HmiError> {
    let filter = filter?.0;
    checks::validate(&filter)?;
    let (archive, place) = desk.readers.open().await?;
    let asked = filter.clone();
    let known = move || {
        checks::known_runs(&archive, &asked)?;
        checks::parameters(&archive, asked.param.as_deref()).map(|it| (archive, it))
    };
    let known = spawn_blocking(known).await;
    let (archive, keys) = known.map_err(|_| HmiError::ReaderLost)??;
    let lines = feed::streamed((archive, place), move |archive, out| {
        out.write_all(BYTE_ORDER_MARK.as_bytes())?;
        export::csv_lines(archive, &filter, &keys, out).map_err(io::Error::other)
    });
    Ok((CSV, lines).into_response())
}

/// `GET /api/history/export.xlsx`.
pub(in super::super) async fn xlsx(
    State(desk): State<Desk>,
    uri: Uri,
) -> Result<(Saved, Vec<u8>), HmiError> {
    let (filter, own) = asked::<Printed>(&uri)?;
    checks::validate(&filter)?;
    super::paper::refuse("seq", own.seq.is_some())?;
    super::paper::refuse("ideal_cycle_s", own.ideal_cycle_s.is_some())?;
    let made = move |archive: &history::Archive| {
        checks::known_runs(archive, &filter)?;
        let keys = checks::parameters(archive, filter.param.as_deref())?;
        let parts = archive.how_many(&filter)?;
        if parts > SHEET_PARTS {
            let reason = format!(
                "found {parts} parts, a spreadsheet takes up to {SHEET_PARTS} here; \
                 `relayrig history export` takes all"
            );
            return Err(InquiryError::member("limit", reason).into());
        }
        let language = language(own.lang);
        let mut book = export::spreadsheet(archive, &filter, &keys, language, || {})?;
        Ok(book.save_to_buffer().map_err(InquiryError::from)?)
    };
    Ok((XLSX, desk.readers.read(made).await?))
}
