//! `history`: lots, parts, filters, statistics, CSV, backup; and `quality`, which works on files.
//!
//! Data goes to stdout, remarks to stderr. A closed pipe (`| head`) is no error.

mod alarms;
mod backup;
mod compare;
mod export;
mod filter;
mod from;
mod generate;
mod import;
mod lots;
mod orders;
pub(in crate::cli) mod paper;
mod pareto;
mod plans;
mod prune;
mod quality;
mod query;
mod rejudge;
mod report;
mod restore;
mod results;
mod shifts;
mod show;
mod spc;
mod stats;

pub use quality::{QualityArgs, run_quality};

use super::output::Output;
use app::exit::Exit;
use app::order::Files;
use clap::{Args, Subcommand};
use history::Archive;
use history::inquiry::InquiryError;
use std::path::Path;

/// Arguments of `history`.
#[derive(Debug, Args)]
pub struct HistoryArgs {
    #[command(flatten)]
    from: from::FromArgs,
    #[command(subcommand)]
    command: Box<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Runs of lots with their counts
    #[command(after_help = "Example: relayrig history list --recipe jzc-22f-012")]
    List(lots::ListArgs),
    /// One lot, or one part with everything down to the raw replies
    #[command(
        visible_alias = "part",
        after_help = "Examples:\n  relayrig history show A\n  relayrig history show A 17 --json\n  \
        relayrig history part --serial L-1122-000017"
    )]
    Show(show::ShowArgs),
    /// Parts that match a filter
    #[command(
        after_help = "Examples:\n  relayrig history query --lot A --verdict fail\n  \
        relayrig history query --param operate_voltage_v --min 8.5 --format csv\n  \
        relayrig history query --suspect"
    )]
    Query(query::QueryArgs),
    /// Statistics and capability of one parameter
    #[command(
        after_help = "Example: relayrig history stats --param operate_voltage_v --lot A --json"
    )]
    Stats(stats::StatsArgs),
    /// One parameter of several lots: means, spreads, tests whether they are equal
    #[command(
        after_help = "Examples:\n  relayrig history compare A B --param operate_voltage_v\n  \
        relayrig history compare A B C --param operate_voltage_v --page --out compared.html"
    )]
    Compare(compare::CompareArgs),
    /// Reasons of rejects, or alarms, the most frequent first
    #[command(after_help = "Examples:\n  relayrig history pareto --lot A\n  \
        relayrig history pareto --alarms --since -7d")]
    Pareto(pareto::ParetoArgs),
    /// Yield and output by shift, with the shifts of fleet.toml; without --since, of the last seven days
    #[command(after_help = "Examples:\n  relayrig history shifts --since -30d\n  \
        relayrig history shifts --from postgres://office@db/relayrig --site suzhou")]
    Shifts(shifts::ShiftsArgs),
    /// Control charts of a parameter, or of the share of every bin
    #[command(
        after_help = "Examples:\n  relayrig history spc --param operate_voltage_v --lot A\n  \
        relayrig history spc --param operate_voltage_v --subgroup 5 --page --out wall.html"
    )]
    Spc(spc::SpcArgs),
    /// Paper: report of a lot, certificate of a part, list of alarms
    #[command(
        after_help = "Examples:\n  relayrig history report --lot A --out lot-a.html\n  \
        relayrig history report --lot A --part 17 --lang en --out part.html\n  \
        relayrig history report --alarms --out alarms.html"
    )]
    Report(report::ReportArgs),
    /// Orders with person, place and answer
    #[command(after_help = "Examples:\n  relayrig history orders --lot A\n  \
        relayrig history orders --who li --since today --refused\n  \
        relayrig history orders --order people")]
    Orders(orders::OrdersArgs),
    /// Plans for tooling that people started, or the steps of one with who did them
    #[command(
        after_help = "Examples:\n  relayrig history plans\n  relayrig history plans 1 --json\n  \
        relayrig history plans 1 --page --lang zh --out plan-1.html"
    )]
    Plans(plans::PlansArgs),
    /// Every occurrence of an alarm, with lot, acknowledgement and text
    #[command(after_help = "Examples:\n  relayrig history alarms --lot A\n  \
        relayrig history alarms --code part_lost --since 2026-03-01T00:00:00Z --json")]
    Alarms(alarms::AlarmsArgs),
    /// Parts as CSV (UTF-8 with byte order mark) or as a spreadsheet with charts
    #[command(
        after_help = "Examples:\n  relayrig history export --lot A lot-a.csv\n  \
        relayrig history export --lot A lot-a.xlsx"
    )]
    Export(export::ExportArgs),
    /// CSV or spreadsheet of an older system: a header of parameter keys, optionally time, verdict, serial, bin
    #[command(
        after_help = "Example: relayrig history import old.csv --lot 2019-07 --map Uop=operate_voltage_v"
    )]
    Import(import::ImportArgs),
    /// Results of a lot that were measured outside of the rig
    #[command(after_help = "Example: relayrig history results A --json")]
    Results(results::ResultsArgs),
    /// Enter results that were measured outside of the rig: a file with columns key and value, optionally serial, run, seq,
    /// unit, u, at
    #[command(
        after_help = "Example: relayrig history import-results hipot.csv --lot A --by zhao\n\n\
        hipot.csv:\n  serial,key,value,u,at\n  A-000017,r_iso_ohm,4.2e10,4e9,2026-11-22T08:00\n  \
        A-000017,dwv_ua,3.1,0.2,2026-11-22T08:05"
    )]
    ImportResults(results::ImportResultsArgs),
    /// Judge a lot by another recipe; writes nothing
    #[command(after_help = "Example: relayrig history rejudge --lot A --recipe jzc-22f-012")]
    Rejudge(rejudge::RejudgeArgs),
    /// Delete the parts of old runs that a backup or an export holds whole
    #[command(after_help = "Example: relayrig history prune --older-than-days 365 --yes")]
    Prune(prune::PruneArgs),
    /// Copy the history, or the whole rig, while it is in use
    #[command(
        after_help = "Examples:\n  relayrig history backup /mnt/backup/relayrig-2026-03.db\n  \
        relayrig history backup --into /mnt/backup --keep 30"
    )]
    Backup(backup::BackupArgs),
    /// Check a backup, then put history, people and configuration in place
    #[command(
        after_help = "Examples:\n  relayrig history restore /mnt/backup --check\n  \
        relayrig history restore /mnt/backup/relayrig-20260302T023000Z --replace"
    )]
    Restore(restore::RestoreArgs),
    /// Fill the history with random parts, for trying queries and reports
    #[command(after_help = "Example: relayrig --db big.db history generate --parts 1000000")]
    Generate(generate::GenerateArgs),
    /// Check the file for damage
    #[command(after_help = "Example: relayrig history check")]
    Check,
}

/// Runs `relayrig history`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: HistoryArgs) -> anyhow::Result<Exit> {
    let done = dispatch(files, &args.from, *args.command).map_err(by_option);
    super::unless_pipe_closed(done, Exit::Done)
}

/// Replaces the member of the filter that an error names by its command line option; lots to compare have no option.
fn by_option(error: anyhow::Error) -> anyhow::Error {
    match error.downcast_ref::<InquiryError>() {
        Some(InquiryError::Member {
            field: "lots",
            reason,
        }) => anyhow::anyhow!("{reason}"),
        Some(InquiryError::Member { field, reason }) => {
            anyhow::anyhow!("--{}: {reason}", field.replace('_', "-"))
        }
        _ => error,
    }
}

fn dispatch(files: &Files, from: &from::FromArgs, command: Command) -> anyhow::Result<Exit> {
    let (config, db) = (&files.config, files.db.as_path());
    if let Some(of_file) = command.of_file() {
        from.refuse(of_file)?;
    }
    let archive = || from.open(files);
    match command {
        Command::Import(args) => return import::run(db, &args),
        Command::ImportResults(args) => return results::import(db, &args),
        Command::Generate(args) => return generate::run(config, db, &args),
        Command::Check => return check(db),
        Command::Restore(args) => return restore::run(files, &args),
        Command::Prune(args) => return prune::run(db, &args),
        Command::List(args) => lots::run(&archive()?, &args)?,
        Command::Show(args) => show::run(&archive()?, &args)?,
        Command::Query(args) => query::run(&archive()?, &args)?,
        Command::Alarms(args) => alarms::run(&archive()?, &args)?,
        Command::Plans(args) => plans::run(&archive()?, &args)?,
        Command::Orders(args) => orders::run(&archive()?, &args)?,
        Command::Stats(args) => stats::run(&archive()?, &args)?,
        Command::Compare(args) => compare::run(&archive()?, &args)?,
        Command::Pareto(args) => pareto::run(&archive()?, &args)?,
        Command::Spc(args) => spc::run(&archive()?, &args)?,
        Command::Shifts(args) => shifts::run(config, &archive()?, &args)?,
        Command::Report(args) => report::run(&archive()?, &args)?,
        Command::Rejudge(args) => rejudge::run(config, &archive()?, &args)?,
        Command::Results(args) => results::run(&archive()?, &args)?,
        Command::Export(args) => export::run(&archive()?, from.file(db), &args)?,
        Command::Backup(args) => backup::run(files, &args)?,
    }
    Ok(Exit::Done)
}

impl Command {
    /// Returns the name of a command that works only on the history file of a rig; `None` for a command that also takes
    /// a database.
    const fn of_file(&self) -> Option<&'static str> {
        match self {
            Self::Import(_) => Some("import"),
            Self::ImportResults(_) => Some("import-results"),
            Self::Generate(_) => Some("generate"),
            Self::Check => Some("check"),
            Self::Restore(_) => Some("restore"),
            Self::Prune(_) => Some("prune"),
            Self::Backup(_) => Some("backup"),
            Self::Plans(_) => Some("plans"),
            Self::List(_)
            | Self::Show(_)
            | Self::Query(_)
            | Self::Alarms(_)
            | Self::Orders(_)
            | Self::Stats(_)
            | Self::Compare(_)
            | Self::Pareto(_)
            | Self::Spc(_)
            | Self::Shifts(_)
            | Self::Report(_)
            | Self::Rejudge(_)
            | Self::Results(_)
            | Self::Export(_) => None,
        }
    }
}

/// Checks the file; damage gives exit status 1, not an error.
fn check(db: &Path) -> anyhow::Result<Exit> {
    match Archive::open(db)?.check() {
        Ok(()) => {
            Output::stdout().line(&format!("{}: whole", db.display()))?;
            Ok(Exit::Done)
        }
        Err(damage) => {
            eprintln!("{damage}");
            Ok(Exit::AnswerIsNo)
        }
    }
}
