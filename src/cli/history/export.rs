//! `history export`: CSV that spreadsheets open right, Chinese included.

use super::filter::{PartArgs, RangeArgs, known_parameter};
use super::output::Output;
use super::query;
use crate::history::{Archive, csv::BYTE_ORDER_MARK};
use anyhow::Context;
use clap::Args;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct ExportArgs {
    #[command(flatten)]
    parts: PartArgs,
    #[command(flatten)]
    range: RangeArgs,
    /// File to write; - is stdout
    #[arg(default_value = "-")]
    file: PathBuf,
}

pub(super) fn run(archive: &Archive, args: &ExportArgs) -> anyhow::Result<()> {
    let filter = args.parts.within(&args.range)?;
    let parameters = archive.parameters()?;
    if let Some(param) = &filter.param {
        known_parameter(&parameters, param)?;
    }
    let name = args.file.display();
    let mut out = if args.file.as_os_str() == "-" {
        Output::stdout()
    } else {
        Output::to(File::create(&args.file).with_context(|| format!("making {name}"))?)
    };
    out.write_all(BYTE_ORDER_MARK.as_bytes())?;
    query::write_csv(archive, &filter, &parameters, &mut out)?;
    out.flush().with_context(|| format!("writing {name}"))
}
