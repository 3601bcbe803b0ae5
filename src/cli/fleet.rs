//! `fleet`: PostgreSQL behind the histories of many rigs.
//!
//! The databases are those of `fleet.toml`; `--target` names one.

mod check;
mod generate;
mod init;
mod push;
mod serve;
mod status;

use app::exit::Exit;
use app::order::Files;
use clap::{Args, Subcommand};
use config::{FleetSettings, FleetTarget, load_fleet};

/// Arguments of `fleet`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  relayrig fleet init
  relayrig fleet push
  relayrig fleet status --json
  relayrig fleet serve --listen 127.0.0.1:9000

The password comes from PGPASSWORD or the file that PGPASSFILE names. `serve` and `run` send by themselves.")]
pub struct FleetArgs {
    /// Only the database with this URL
    #[arg(long, global = true, value_name = "URL")]
    target: Option<String>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Make the schema, roles and partitions, or bring them up to date; needs the owner of the database
    #[command(after_help = "Example: relayrig fleet init --user postgres")]
    Init(init::InitArgs),
    /// Send what the databases lack
    #[command(after_help = "Examples:\n  relayrig fleet push\n  relayrig fleet push --take-over")]
    Push(push::PushArgs),
    /// What each database has and lacks
    #[command(after_help = "Example: relayrig fleet status")]
    Status(status::StatusArgs),
    /// Fill a database without real rigs with made-up histories, for trying questions at size
    #[command(after_help = "Example: relayrig fleet generate --parts 4000000 --rigs 200")]
    Generate(generate::GenerateArgs),
    /// Show all rigs of a database on a web page, which only reads
    #[command(after_help = "Examples:
  relayrig fleet serve
  relayrig fleet serve --listen 0.0.0.0:8443 --tls-cert cert.pem --tls-key key.pem

Exit status: 0 ended, 2 bad input. Without the database the page says why, and goes on when it is back.")]
    Serve(serve::ServeArgs),
    /// Check that the databases take this history; exit status 1 when one does not
    #[command(
        after_help = "Examples:\n  relayrig fleet check\n  relayrig fleet check --questions 500"
    )]
    Check(check::CheckArgs),
}

/// Runs `relayrig fleet`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: &FleetArgs) -> anyhow::Result<Exit> {
    let fleet = load_fleet(&files.config)?;
    let targets = chosen(files, &fleet, args.target.as_deref())?;
    let done = match &args.command {
        Command::Init(args) => init::run(&targets, args),
        Command::Push(args) => push::run(files, (&fleet, &targets), args),
        Command::Status(args) => status::run(files, (&fleet, &targets), args),
        Command::Generate(args) => generate::run(&targets, args),
        Command::Serve(args) => serve::run((&fleet, &targets), args),
        Command::Check(args) => check::run(files, (&fleet, &targets), args),
    };
    super::unless_pipe_closed(done, Exit::Done)
}

/// Returns the databases of `fleet.toml`, or only the one with `url`. Fails without a database, or for an unknown
/// `url`.
fn chosen(
    files: &Files,
    fleet: &FleetSettings,
    url: Option<&str>,
) -> anyhow::Result<Vec<FleetTarget>> {
    let path = files.config.path("fleet.toml");
    let known: Vec<&str> = fleet.targets.iter().map(|it| it.url.as_str()).collect();
    anyhow::ensure!(
        !known.is_empty(),
        "{}: found no target, expected [[target]] with the url of a database",
        path.display()
    );
    if let Some(url) = url {
        let expected = known.join(", ");
        anyhow::ensure!(
            known.contains(&url),
            "--target: found {url:?}, expected one of {expected}"
        );
    }
    let wanted = fleet
        .targets
        .iter()
        .filter(|it| url.is_none_or(|url| it.url == url));
    Ok(wanted.cloned().collect())
}

/// Runs `work` on a runtime of this thread.
fn block_on<T>(work: impl Future<Output = anyhow::Result<T>>) -> anyhow::Result<T> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(work)
}
