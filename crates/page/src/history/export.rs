//! `/api/history/export.csv` and `.xlsx`: `history export` over HTTP. The server streams CSV without a limit, but
//! builds a whole spreadsheet in memory before sending, so [`SHEET_PARTS`] limits its size.
//!
//! `history prune` does not count such an export as a copy, because the server cannot know whether the client got it.

use super::super::error::{ApiError, blocking};
use super::members::{Printed, filter};
use super::{Readers, feed};
use crate::answers::{As, Csv, Sheet};
use crate::asked::Asked;
use crate::language::Preferred;
use axum::http::HeaderName;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use history::csv::BYTE_ORDER_MARK;
use history::inquiry::{InquiryError, checks, export, paper};
use std::io::{self, Write};

/// Largest number of parts in a spreadsheet, about 15 MB; the command `history export` makes larger ones.
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
pub(crate) async fn csv(
    readers: Readers,
    Asked(asked): Asked<super::Filtered>,
) -> Result<As<Csv>, ApiError> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let (archive, place) = readers.open().await?;
    let asked = filter.clone();
    let known = move || {
        checks::known_runs(&archive, &asked)?;
        checks::parameters(&archive, asked.param.as_deref()).map(|it| (archive, it))
    };
    let (archive, keys) = blocking(known).await?;
    let lines = feed::streamed((archive, place), move |archive, out| {
        out.write_all(BYTE_ORDER_MARK.as_bytes())?;
        export::csv_lines(archive, &filter, &keys, out).map_err(io::Error::other)
    });
    Ok(As::new((CSV, lines).into_response()))
}

/// `GET /api/history/export.xlsx`.
pub(crate) async fn xlsx(
    readers: Readers,
    preferred: Preferred,
    Asked((asked, printed)): Asked<(super::Filtered, Printed)>,
) -> Result<As<Sheet, (Saved, Vec<u8>)>, ApiError> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let made = move |archive: &history::Archive| {
        checks::known_runs(archive, &filter)?;
        let keys = checks::parameters(archive, filter.param.as_deref())?;
        let parts = archive.count_parts(&filter)?;
        if parts > SHEET_PARTS {
            let reason = format!(
                "found {parts} parts, a spreadsheet takes up to {SHEET_PARTS} here; \
                 `relayrig history export` takes all"
            );
            return Err(InquiryError::member("limit", reason).into());
        }
        let paper = paper::paper_of(archive, &filter, preferred.unless(printed.lang))?;
        let mut book = export::spreadsheet(archive, &filter, &keys, &paper, || {})?;
        Ok(book.save_to_buffer().map_err(InquiryError::from)?)
    };
    Ok(As::new((XLSX, readers.read(made).await?)))
}
