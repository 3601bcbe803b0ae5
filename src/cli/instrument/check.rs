//! `relayrig instrument check`: tries a profile on an instrument.

use super::{LinkArgs, Place, sentence, text};
use crate::cli::output::{Fixed, latency_ms, listing, print};
use anyhow::Context;
use app::controls::Interrupts;
use app::exit::Exit;
use app::instrument::message;
use bus::instrument::Link;
use bus::{Histogram, Pace};
use config::Folder;
use scpi::{Failure, Form, Profile, Program, Reply};
use serde_json::json;

/// Try a profile.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  relayrig instrument check --link tcp:192.168.1.20:5025 --profile smu-2450
  relayrig instrument check --link tcp:192.168.1.20:5025 --profile smu-2450 --run current_at_level,level_v=4
  relayrig instrument check --instrument dmm
  relayrig instrument check --link gpib-serial:/dev/ttyUSB0:115200:9 --profile ac-source-61500 --json

The check sends the set-up of the profile, which may reset the instrument, then the programs of --run, and at the end the \
commands that make it safe, also after Ctrl-C. \
Exit status: 0 everything is right, 1 something is not, 2 bad input, 4 after Ctrl-C.")]
pub struct CheckArgs {
    #[command(flatten)]
    link: LinkArgs,
    /// Profile of the instrument, a file of config/instruments
    #[arg(long, value_name = "NAME", required_unless_present = "instrument")]
    profile: Option<String>,
    /// Program of the profile to run, with its arguments; may be given several times
    #[arg(long, value_name = "PROGRAM[,ARGUMENT=VALUE]...")]
    run: Vec<String>,
    /// Print the traffic after the table
    #[arg(long, conflicts_with = "json")]
    traffic: bool,
    /// One JSON object per row
    #[arg(long)]
    json: bool,
}

/// Number of queries that measure the latency.
const QUERIES: usize = 32;
/// An instrument is slow when its latency exceeds the usual latency of the profile by more than this factor.
const SLOW: f64 = 3.0;

/// A row of the table.
struct Row {
    what: String,
    is_good: bool,
    found: String,
    failure: Option<Failure>,
}

impl Row {
    fn new(what: &str, outcome: Result<String, Failure>) -> Self {
        let failure = outcome.as_ref().err().cloned();
        let is_good = failure.is_none();
        let found = outcome.unwrap_or_else(|failure| sentence(&failure));
        Self {
            what: what.to_owned(),
            is_good,
            found,
            failure,
        }
    }
}

const COLUMNS: [Fixed<Row>; 3] = [
    ("check", -20, |it| it.what.clone()),
    ("result", -6, |it| {
        if it.is_good { "ok" } else { "FAILED" }.to_owned()
    }),
    (" found", 0, |it| format!(" {}", it.found)),
];

pub(super) async fn run(folder: &Folder, args: &CheckArgs) -> anyhow::Result<Exit> {
    let (place, profile) = args.link.place(folder, args.profile.as_ref())?;
    let profile = profile.context("--profile: found nothing, expected the name of a profile")?;
    let mut link = place.link(Some(&profile));
    let programs = args.run.iter().map(|it| program(&profile, it));
    let programs = programs.collect::<anyhow::Result<Vec<_>>>()?;
    let mut interrupts = Interrupts::listen()?;
    let mut rows = Vec::new();
    let interrupted = tokio::select! {
        () = check(&mut link, &place, &profile, programs, &mut rows) => false,
        () = interrupts.next() => true,
    };
    if link.session().identity().is_some() {
        let safe = link.make_safe(profile.safe()).await;
        let steps = profile.safe().steps.len();
        rows.push(Row::new("safe", safe.map(|_| carried_out(steps))));
    }
    let object = args.json.then_some(object as fn(&Row) -> String);
    print(&listing(&rows, &COLUMNS, "", object))?;
    if args.traffic {
        let traffic = link.log().traffic();
        print(
            &traffic
                .iter()
                .map(|it| format!("{it}\n"))
                .collect::<String>(),
        )?;
    }
    Ok(match (interrupted, rows.iter().all(|it| it.is_good)) {
        (true, _) => Exit::Stopped,
        (false, true) => Exit::Done,
        (false, false) => Exit::AnswerIsNo,
    })
}

/// Returns the program that `--run` names, with its name.
fn program(profile: &Profile, text: &str) -> anyhow::Result<(String, Program)> {
    let mut words = text.split(',');
    let name = words.next().unwrap_or_default();
    let wrong = |word| format!("--run: found {word:?}, expected ARGUMENT=NUMBER");
    let arguments = words.map(|word| argument(word).with_context(|| wrong(word)));
    let arguments = arguments.collect::<anyhow::Result<Vec<(&str, f64)>>>()?;
    Ok((name.to_owned(), profile.program(name, &arguments)?))
}

fn argument(word: &str) -> Option<(&str, f64)> {
    let (name, value) = word.split_once('=')?;
    Some((name, value.parse().ok()?))
}

fn carried_out(steps: usize) -> String {
    format!("{steps} steps, error queue empty")
}

/// Tries identity, set-up, latency and programs, a row each.
async fn check(
    link: &mut Link,
    place: &Place,
    profile: &Profile,
    programs: Vec<(String, Program)>,
    rows: &mut Vec<Row>,
) {
    let begun = link.run(Program::default()).await;
    let Some(identity) = link.session().identity() else {
        rows.extend(begun.err().map(|it| Row::new("identity", Err(it))));
        return;
    };
    rows.push(Row::new("identity", Ok(identity.to_owned())));
    let steps = link.session().settings().set_up.steps.len();
    let is_set_up = begun.is_ok();
    rows.push(Row::new("set-up", begun.map(|_| carried_out(steps))));
    if !is_set_up {
        return;
    }
    rows.push(latency(link, place, profile).await);
    let names: Vec<&str> = profile.programs().collect();
    rows.push(Row::new("programs", Ok(names.join(", "))));
    for (name, program) in programs {
        let values = link.run(program).await;
        let shown = |it: Vec<Reply>| it.iter().map(text).collect::<Vec<_>>().join(", ");
        rows.push(Row::new(&name, values.map(shown)));
    }
}

async fn latency(link: &mut Link, place: &Place, profile: &Profile) -> Row {
    let pace = Pace::real();
    let mut latencies = Histogram::default();
    for _ in 0..QUERIES {
        let began = pace.now();
        if let Err(failure) = link.exchange("*IDN?", Some(Form::Line)).await {
            return Row::new("latency", Err(failure));
        }
        latencies.add(pace.now().since(began));
    }
    let share = |share| latency_ms(&latencies, share).unwrap_or(0.0);
    let identity = link.session().identity().unwrap_or_default();
    let usual = profile.latency_ms + place.wire_ms("*IDN?".len() + identity.len() + 2);
    let (p50, p99) = (share(0.5), share(0.99));
    let found = format!("p50 {p50:.2} ms, p99 {p99:.2} ms, usual {usual:.2} ms");
    Row {
        what: "latency".to_owned(),
        is_good: p50 <= SLOW * usual,
        found,
        failure: None,
    }
}

fn object(row: &Row) -> String {
    let failure = row.failure.as_ref().map(message);
    json!({ "check": row.what, "ok": row.is_good, "found": row.found, "failure": failure })
        .to_string()
}
