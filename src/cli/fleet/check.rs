//! `fleet check`: whether the databases take this history.

use crate::cli::output::Output;
use app::exit::Exit;
use app::order::Files;
use config::{FleetSettings, FleetTarget};

pub(super) fn run(
    files: &Files,
    (settings, targets): (&FleetSettings, &[FleetTarget]),
) -> anyhow::Result<Exit> {
    let reports = super::status::reports(files, settings, targets)?;
    let mut out = Output::stdout();
    for report in &reports {
        match report.faults.as_slice() {
            [] => out.line(&format!("{}: in order", report.url))?,
            faults => faults
                .iter()
                .try_for_each(|it| out.line(&format!("{}: {it}", report.url)))?,
        }
    }
    let in_order = reports.iter().all(|it| it.faults.is_empty());
    Ok(if in_order {
        Exit::Done
    } else {
        Exit::AnswerIsNo
    })
}
