//! `relayrig run`: a lot on a rig, or on the simulated rig in real or virtual time.

use super::output::{Fixed, Output, cells, headings};
use super::person;
use super::rig::RigArgs;
use super::table::lateness_line;
use super::terminal::{Rows, Terminal};
use anyhow::Context;
use app::answers::Answers;
use app::exit::Exit;
use app::gauge_study::{self, Figure};
use app::lot::Purpose;
use app::order::{Files, LotOrder};
use app::real_time::BareLoop;
use app::run_answered;
use quality::gauge_rr::GaugeRr;
use serde_json::json;
use std::path::PathBuf;

/// A lot to run.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig run --sim --lot A --recipe jzc-22f-012 --count 20
  relayrig run --sim --pace real --lot A --recipe jzc-22f-012 --count 5 --json
  relayrig run --lot A --recipe jzc-22f-012 --count 12 --retest 'Li Na'
  relayrig run --lot A --recipe jzc-22f-012 --count 12 --answer reference_parts=loaded --by li
  relayrig run --sim --study grr --lot G --recipe jzc-22f-012
  relayrig run --lot A --recipe jzc-22f-012 --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1

`bodies: not watched` in the summary: the simulated rig of this program does not look for bodies that touch; a build with
`--features bodies` does.")]
pub struct RunArgs {
    /// The rig.
    #[command(flatten)]
    pub rig: RigArgs,
    /// Name of the lot
    #[arg(long, value_name = "ID")]
    pub lot: String,
    /// Recipe in config/recipes
    #[arg(long, value_name = "NAME")]
    pub recipe: String,
    /// Number of parts in the lot; when absent, the lot goes on until it is stopped
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
    /// Write the true values of every part into this file
    #[arg(long, value_name = "FILE", requires = "sim")]
    pub truth: Option<PathBuf>,
    /// One JSON object per part, then a summary
    #[arg(long)]
    pub json: bool,
    /// Test parts of the lot a second time with the consent of NAME; the first results stay
    #[arg(long, value_name = "NAME")]
    pub retest: Option<String>,
    /// Answer to a prompt of recipe or lot.toml; one for each prompt
    #[arg(long, value_name = "PROMPT=CHOICE", requires = "by", value_parser = answer)]
    pub answer: Vec<(String, String)>,
    /// Person who answers
    #[arg(long, value_name = "NAME", requires = "answer")]
    pub by: Option<String>,
    /// Run a bare real-time loop beside the lot, to compare how late this computer wakes lot and loop
    #[arg(long)]
    pub bare_loop: bool,
    /// Gauge study instead of one lot: three simulated rigs measure ten parts (or --count) three times each
    #[arg(long, value_enum, value_name = "NAME", requires = "sim")]
    pub study: Option<StudyArg>,
}

fn answer(text: &str) -> Result<(String, String), &'static str> {
    let (prompt, choice) = text.split_once('=').ok_or("expected PROMPT=CHOICE")?;
    Ok((prompt.to_owned(), choice.to_owned()))
}

/// A study that measures the same parts again and again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum StudyArg {
    /// Gauge repeatability and reproducibility
    Grr,
}

/// Runs `relayrig run`; an error is bad input (exit status 2).
pub fn run(files: &Files, args: &RunArgs) -> anyhow::Result<Exit> {
    let source = args.rig.source(args.truth.clone())?;
    let order = LotOrder {
        lot: args.lot.clone(),
        recipe: args.recipe.clone(),
        count: args.count,
        retest: args.retest.clone(),
    };
    if let Some(StudyArg::Grr) = args.study {
        let study = gauge_study::run(files, &source, &order, &mut Terminal::quiet())?;
        return match study {
            Ok(figures) => print_study(&figures, args.json).map(|()| Exit::Done),
            Err(exit) => Ok(exit),
        };
    }
    if let Some(path) = &args.truth {
        std::fs::File::create(path).with_context(|| format!("--truth {}", path.display()))?;
    }
    let rows = match args.json {
        true => Rows::Json,
        false => Rows::Table,
    };
    let mut terminal = Terminal::new(rows);
    let bare_loop = args.bare_loop.then(BareLoop::start).transpose()?;
    let answers = Answers {
        by: args
            .by
            .as_deref()
            .map(person)
            .transpose()?
            .unwrap_or_default(),
        given: args.answer.clone(),
    };
    let exit = run_answered(
        files,
        &source,
        &order,
        Purpose::Lot,
        (&answers, &mut terminal),
    )?;
    terminal.ended(&exit);
    if let Some(bare_loop) = bare_loop {
        let lateness = bare_loop.end().view();
        Output::stdout().line(&match args.json {
            true => json!({"type": "bare_loop", "lateness": lateness}).to_string(),
            false => lateness_line("lateness of a bare loop", &lateness),
        })?;
    }
    Ok(exit)
}

const COLUMNS: [Fixed<(&str, GaugeRr, Option<f64>)>; 7] = [
    ("parameter", -28, |it| it.0.to_owned()),
    ("repeat sd", 12, |it| format!("{:.6}", it.1.repeatability)),
    ("rigs sd", 12, |it| format!("{:.6}", it.1.reproducibility)),
    ("parts sd", 12, |it| format!("{:.6}", it.1.part)),
    ("% grr", 8, |it| percent(it.1.pct_grr)),
    ("ndc", 6, |it| {
        it.1.ndc.map_or("-".to_owned(), |it| it.to_string())
    }),
    ("% by range", 10, |it| percent(it.2)),
];

fn percent(it: Option<f64>) -> String {
    it.map_or("-".to_owned(), |it| format!("{it:.2}"))
}

fn print_study(figures: &[Figure], as_json: bool) -> anyhow::Result<()> {
    let object = |it: &Figure| {
        let key = it.characteristic.key();
        match &it.anova {
            Ok(anova) => {
                json!({"type": "grr", "param": key, "anova": anova, "average_range": it.by_range})
            }
            Err(why) => json!({"type": "grr", "param": key, "why_not": why.to_string()}),
        }
    };
    let row = |it: &Figure| {
        let (key, by_range) = (it.characteristic.key(), it.by_range.as_ref());
        match &it.anova {
            Ok(anova) => cells(&(key, *anova, by_range.and_then(|it| it.pct_grr)), &COLUMNS),
            Err(why) => format!("{key:<28} {why}"),
        }
    };
    let mut out = Output::stdout();
    if !as_json {
        out.line(&headings(&COLUMNS))?;
    }
    Ok(out.lines(as_json, figures, object, row)?)
}
